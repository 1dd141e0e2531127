"""What the benchmarks share."""

import time
from statistics import median


def timed(call, repeats=5):
    """Return the median time of a call [s] and its last result."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        result = call()
        times.append(time.perf_counter() - start)
    return median(times), result
