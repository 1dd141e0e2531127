r"""Plans whose lines are taken from a finite set: breadth-first search, complete.

After a squeeze towards line a the part lies at one of the images ``lines[a] + images[i]``. A state
is a line and a set of steps: those from which that line and the lines after it surely end in the
target. The search runs backwards from single steps, so that the target may be prescribed:
step i belongs to the set before line a if the image of i, seen from the next line b and moved by
the margin either way, can only come to steps of the set at b. A plan is found when a set
holds all steps. For steps in the order of their images all sets are runs of steps, so there
are at most k^2 of them for each line; in general there may be 2^k, and the search gives up
honestly.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import SolveFailed
from limitsurf.planning.largest_margin import with_largest_gap
from limitsurf.planning.line_plan import LinePlan
from limitsurf.planning.squeeze_function import SqueezeFunction

__all__ = ["GivenLines", "Target", "fewest_lines", "margins_of", "plan_through", "safest_lines"]

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

Target = tuple[int, int]  # a line and the step from which the last squeeze starts
Node = tuple[int, int]  # a line and a set of steps, bit i for step i
Chain = list[Node]

_MOST_STATES = 200_000


@dataclass(frozen=True)
class GivenLines:
    """Steps of one period, and the lines that may be used.

    Attributes
    ----------
    squeeze : SqueezeFunction
        The steps.
    lines : (L,) float
        World angles [rad].
    """

    squeeze: SqueezeFunction
    lines: Array

    @property
    def images(self) -> Array:
        """Images of the steps of one period."""
        return self.squeeze.images[: self.squeeze.steps]

    def distances(self, b: int) -> Array:
        """Return how far images lie from the starts that may come to each step [rad].

        Entry (a, i, j): the image of step i at line a, seen from line b, to the interval from the
        end of the step before j to the beginning of the one after; negative inside.
        """
        k, period = self.squeeze.steps, self.squeeze.period
        breaks, ends = self.squeeze.breaks[:k], self.squeeze.ends[:k]
        low = np.append(ends[-1] - period, ends[:-1])
        high = np.append(breaks[1:], breaks[0] + period)
        seen = (self.lines - self.lines[b])[:, None, None] + self.images[None, :, None]
        from_middle = seen - 0.5 * (low + high)
        from_middle -= period * np.round(from_middle / period)
        reach: Array = np.abs(from_middle) - 0.5 * (high - low)
        return reach

    def targets(self, goal: float | None, tolerance: float) -> list[Target]:
        """Return the lines and steps whose images are the goal; all without a goal."""
        finals = self.lines[:, None] + self.images[None, :]
        if goal is None:
            return [(a, i) for a in range(len(self.lines)) for i in range(self.squeeze.steps)]
        off = finals - goal
        off -= self.squeeze.period * np.round(off / self.squeeze.period)
        return [(int(a), int(i)) for a, i in np.argwhere(np.abs(off) <= tolerance)]


@dataclass
class _Search:
    """Sets that were reached, the largest only, and what follows each."""

    given: GivenLines
    margin: float
    after: dict[Node, Node | None] = field(default_factory=dict)
    largest: dict[int, list[int]] = field(default_factory=dict)
    next_margin: float = 0.0  # the largest smaller margin for which the outcome may be another

    def add(self, node: Node, after: Node | None) -> bool:
        """Keep a set unless one that holds it was there before."""
        line, steps = node
        known = self.largest.setdefault(line, [])
        if any(steps & ~other == 0 for other in known):
            return False
        known[:] = [other for other in known if other & ~steps] + [steps]
        self.after[node] = after
        if len(self.after) > _MOST_STATES:
            raise SolveFailed(
                f"lines: no plan among the first {_MOST_STATES} sets of steps; whether there is a "
                "longer one was not found out; give fewer lines"
            )
        return True

    def before(self, b: int, sets: list[int]) -> list[tuple[Node, Node]]:
        """Return the sets that every line leads surely into sets at line b, with these."""
        k = self.given.squeeze.steps
        distances = self.given.distances(b)
        near = distances < self.margin
        self.next_margin = float(distances[near].max(initial=self.next_margin))
        may_come = near.astype(np.float32)
        outside = ~_as_rows(sets, k)
        astray = np.matmul(outside.astype(np.float32), may_come.transpose(0, 2, 1))  # (a, set, i)
        codes = _as_bits((astray == 0.0).reshape(-1, k))
        pairs = itertools.product(range(len(distances)), [(b, bits) for bits in sets])
        return [((a, bits), late) for bits, (a, late) in zip(codes, pairs, strict=True) if bits]

    def step_back(self, front: Chain) -> Chain:
        """Return the new sets from which some line leads surely into one of these."""
        found: dict[Node, Node] = {}
        for b in sorted({line for line, _ in front}):
            for node, after in self.before(b, [steps for line, steps in front if line == b]):
                found.setdefault(node, after)
        large_first = sorted(found, key=lambda node: -node[1].bit_count())
        return [node for node in large_first if self.add(node, found[node])]

    def chain(self, node: Node) -> Chain:
        """Return the sets from a first one to the target."""
        nodes = [node]
        while (following := self.after[nodes[-1]]) is not None:
            nodes.append(following)
        return nodes


def fewest_lines(
    given: GivenLines, margin: float, targets: list[Target], most: float = np.inf
) -> Chain | None:
    """Return the shortest plan of at most `most` lines as (line, set of steps), or None.

    Parameters
    ----------
    given : GivenLines
        Steps and lines.
    margin : float
        Error of each line that the plan has to tolerate [rad]; positive.
    targets : list of (line, step)
        Where it may end.
    """
    return _search(_Search(given, margin), targets, most)


def safest_lines(
    given: GivenLines, chain: Chain, targets: list[Target], most: float = np.inf
) -> Chain:
    """Return the plan of at most `most` lines with the largest least margin, as good as `chain`."""

    def search(margin: float) -> tuple[Chain | None, float]:
        record = _Search(given, margin)
        return _search(record, targets, most), record.next_margin

    return with_largest_gap(
        chain, lambda nodes: float(margins_of(given, nodes).min()), search, given.squeeze.period
    )


def _search(search: _Search, targets: list[Target], most: float) -> Chain | None:
    everything = (1 << search.given.squeeze.steps) - 1
    front = [node for b, j in targets if search.add(node := (b, 1 << j), None)]
    length = 1
    while front and length <= most:
        for node in front:
            if node[1] == everything:
                return search.chain(node)
        front = search.step_back(front) if length < most else []
        length += 1
    return None


def margins_of(given: GivenLines, nodes: Chain) -> Array:
    """Return the distance of each line's images to the starts that could come astray."""
    k = given.squeeze.steps
    margins = [np.inf]
    for (a, early), (b, late) in itertools.pairwise(nodes):
        starts, ends = _as_rows([early, late], k)
        astray = given.distances(b)[a][starts][:, ~ends]
        margins.append(float(astray.min(initial=np.inf)))
    return np.array(margins)


def plan_through(given: GivenLines, nodes: Chain) -> LinePlan:
    """Return the plan of a chain of sets."""
    squeeze = given.squeeze
    last, target = nodes[-1]
    final = given.lines[last] + given.images[target.bit_length() - 1]
    return LinePlan(
        lines=np.mod(given.lines[[a for a, _ in nodes]], squeeze.modulus),
        margins=margins_of(given, nodes),
        final=float(np.mod(final, squeeze.period)),
        period=squeeze.period,
        squeeze=squeeze,
    )


def _as_rows(sets: list[int], k: int) -> Bools:
    octets = (k + 7) // 8
    packed = np.frombuffer(b"".join(s.to_bytes(octets, "little") for s in sets), dtype=np.uint8)
    rows = np.unpackbits(packed.reshape(len(sets), octets), axis=1, bitorder="little")
    return rows[:, :k].astype(np.bool_)


def _as_bits(rows: Bools) -> list[int]:
    packed = np.packbits(rows, axis=1, bitorder="little")
    if packed.shape[1] <= 8:
        words = np.zeros((len(packed), 8), dtype=np.uint8)
        words[:, : packed.shape[1]] = packed
        return list(words.view("<u8").ravel().tolist())
    return [int.from_bytes(row.tobytes(), "little") for row in packed]
