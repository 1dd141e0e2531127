"""The widest run of whole steps whose images fit into an arc, in one sweep over the steps.

Step i takes ``[breaks[i], ends[i])`` to ``images[i]``. A run i..j is ``ends[j] - breaks[i]`` wide
and its images span ``max - min`` of ``images[i..j]``. The span grows with j and falls with i, so
two fingers pass once over the steps. If the images are in order, their span is that of the two
at the fingers; if not, the largest and the smallest between the fingers stand at the heads of
two monotone queues (Lemire, Nordic Journal of Computing 13, 2006).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from limitsurf.kernels.compile import Floats, compiled

__all__ = ["widest_run"]

Longs = NDArray[np.int64]


@compiled
def widest_run(
    breaks: Floats, ends: Floats, images: Floats, period: float, room: float, in_order: bool
) -> tuple[int, int, float, float, float]:
    """Return the widest run whose images span at most `room`.

    Parameters
    ----------
    breaks, ends, images : (2 k,) float
        The k steps of a period, and those of the next one.
    period : float
        Width of a run of k steps, which is everything.
    room : float
        What the images may span.
    in_order : bool
        Whether the images ascend.

    Returns
    -------
    first, count : int
        First step and number of steps, at most k; 0 steps if none fits. Of several runs, one of
        least span.
    smallest, span : float
        Of its images.
    more : float
        The least span of any run that does not fit; infinity if all do.
    """
    k = breaks.shape[0] // 2
    first, count, smallest, span = 0, 0, 0.0, np.inf
    more = np.inf
    if room < 0.0:
        return first, count, smallest, span, 0.0
    queue = np.empty((2, 0 if in_order else 2 * k), dtype=np.int64)
    heads = np.zeros(2, dtype=np.int64)
    tails = np.zeros(2, dtype=np.int64)
    widest = -np.inf
    last = 0  # one past the run that begins at i
    for i in range(k):
        if in_order:
            while last < i + k and images[last] - images[i] <= room:
                last += 1
            low, high = images[i], images[last - 1]
            next_span = images[last] - low if last < i + k else np.inf
        else:
            last, low, high, next_span = _advance(images, queue, heads, tails, i, last, room)
        more = min(more, next_span)
        width = period if last - i == k else ends[last - 1] - breaks[i]
        if width > widest or (width == widest and high - low < span):
            widest = width
            first, count, smallest, span = i, last - i, low, high - low
    return first, count, smallest, span, more


@compiled
def _advance(
    images: Floats, queue: Longs, heads: Longs, tails: Longs, i: int, last: int, room: float
) -> tuple[int, float, float, float]:
    """Return one past the longest run from i on that fits, its extreme images, the next span.

    ``queue[0]`` holds steps with falling images, the largest first, ``queue[1]`` with rising ones.
    """
    k = images.shape[0] // 2
    next_span = np.inf
    for q in range(2):
        heads[q] += heads[q] < tails[q] and queue[q, heads[q]] < i
    while last < i + k:
        image = images[last]
        if last > i:
            largest = max(image, images[queue[0, heads[0]]])
            smallest = min(image, images[queue[1, heads[1]]])
            if largest - smallest > room:
                next_span = largest - smallest
                break
        for q in range(2):
            sign = 1.0 - 2.0 * q
            while tails[q] > heads[q] and sign * images[queue[q, tails[q] - 1]] <= sign * image:
                tails[q] -= 1
            queue[q, tails[q]] = last
            tails[q] += 1
        last += 1
    return last, images[queue[1, heads[1]]], images[queue[0, heads[0]]], next_span
