"""Random step functions, and slow twins of the planner that tests and benchmarks share."""

import itertools

import numpy as np

from limitsurf.planning.squeeze_function import SqueezeFunction
from limitsurf.tolerances import LINE_MARGIN


def random_steps(rng, k, *, bands=False, inside=True, period=np.pi, modulus=np.pi):
    """Return k random steps a period; images inside their steps, or anywhere in their order."""
    corners = np.sort(rng.uniform(0.0, period, 2 * k))
    breaks = corners[::2]
    following = np.append(breaks[1:], breaks[0] + period)
    ends = corners[1::2] if bands else following
    images = rng.uniform(breaks, ends)
    if not inside:
        images = np.sort(rng.uniform(0.0, period, k)) + rng.uniform(-period, period)
    copies = np.repeat(np.arange(round(modulus / period)) * period, k)
    tiled = (np.tile(x, len(copies) // k) + copies for x in (breaks, ends, images))
    return SqueezeFunction(*tiled, period, modulus)


def step_tables(squeeze):
    """Return (d, 2^k): the set of steps that each set may come to, for every kind of turn.

    Turns are the middles of the intervals between those that take an image to the end of a step:
    within an interval, each image comes to the same steps.
    """
    k, period = squeeze.steps, squeeze.period
    breaks, ends, images = (x[:k] for x in (squeeze.breaks, squeeze.ends, squeeze.images))
    corners = np.concatenate([breaks, ends])
    critical = np.unique(np.mod(np.subtract.outer(corners, images), period))
    widths = np.diff(critical, append=critical[0] + period)
    turns = (critical + 0.5 * widths)[widths > 2 * LINE_MARGIN]
    at = np.mod(images + turns[:, None] - breaks[0], period) + breaks[0]
    step = np.searchsorted(breaks, at, side="right") - 1
    bits = 1 << step
    bits |= np.where(at >= ends[step], 1 << (step + 1) % k, 0)  # between two steps: to either
    table = np.zeros((len(turns), 1 << k), dtype=np.int64)
    for image in range(k):
        half = 1 << image
        table[:, half : 2 * half] = table[:, :half] | bits[:, image, None]
    return table


def shortest_by_sets(squeeze):
    """Return the length of the shortest plan by breadth-first search over sets of images, or None.

    A set is the steps whose images are possible.
    """
    k = squeeze.steps
    table = step_tables(squeeze)
    front = seen = np.array([(1 << k) - 1])
    length = 1
    while len(front):
        if np.any(front & (front - 1) == 0):
            return length
        front = np.setdiff1d(np.unique(table[:, front]), seen)
        seen = np.concatenate([seen, front])
        length += 1
    return None


def naive_chain(squeeze, gap):
    """Return the widths of the arcs of the planner with gap, the last first, by a triple loop."""
    k, period = squeeze.steps, squeeze.period
    turn = np.repeat([0.0, period], k)
    breaks, ends, images = (
        (np.tile(x[:k], 2) + turn).tolist() for x in (squeeze.breaks, squeeze.ends, squeeze.images)
    )
    widths = []
    room = 0.0
    while not widths or widths[-1] < period:
        widest = 0.0
        for i in range(k):
            low = high = images[i]
            for j in range(i, i + k):
                low, high = min(low, images[j]), max(high, images[j])
                width = period if j == i + k - 1 else ends[j] - breaks[i]
                if high - low <= room and width > widest:
                    widest = width
        if widths and widest <= widths[-1]:
            return None
        widths.append(widest)
        room = widest - gap
    return widths


def ends_of(plan, errors, starts, rng):
    """Return orientations at the end, over the plan's final, modulo its period.

    Between two steps, either image comes by chance.
    """
    squeeze, phi = plan.squeeze, starts
    n = len(squeeze.breaks)
    for line, error in zip(plan.lines, errors, strict=True):
        reduced = np.mod(phi - line - error - squeeze.breaks[0], squeeze.modulus)
        reduced += squeeze.breaks[0]
        step = np.searchsorted(squeeze.breaks, reduced, side="right") - 1
        step += (reduced >= squeeze.ends[step]) & (rng.uniform(size=len(phi)) < 0.5)
        phi = squeeze.images[step % n] + squeeze.modulus * (step // n) + line + error
    off = phi - errors[-1] - plan.final
    return off - plan.period * np.round(off / plan.period)


def all_sequences(squeeze, lines, margin, longest):
    """Return the shortest sequences of given lines that align, with their least margins, or [].

    Every sequence is tried. A set of starts is followed as intervals: an image moved by the margin
    either way may come to all steps that it then meets.
    """
    k, period = squeeze.steps, squeeze.period
    breaks, ends, images = (x[:k] for x in (squeeze.breaks, squeeze.ends, squeeze.images))

    def may_come(place):
        met = set()
        for j, lift in itertools.product(range(k), range(-3, 4)):
            low = ends[j - 1] - (period if j == 0 else 0.0) + lift * period
            high = (breaks[j + 1] if j + 1 < k else breaks[0] + period) + lift * period
            if low - place < margin and place - high < margin:
                met.add(j)
        return met

    for length in range(1, longest + 1):
        found = []
        for sequence in itertools.product(range(len(lines)), repeat=length):
            steps = set(range(k))
            for a, b in itertools.pairwise(sequence):
                seen = [(images[i] + lines[a] - lines[b]) % period for i in steps]
                steps = set().union(*(may_come(place) for place in seen))
            if len(steps) == 1:
                found.append(sequence)
        if found:
            return found
    return []
