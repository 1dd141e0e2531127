"""Pairs that tests of the datasets share."""

import numpy as np

RHO = 0.05
NOTES = {"name": "a", "source": "somewhere", "licence": "CC0"}


def same(a, b):
    pairs = [
        (a.loads, b.loads),
        (a.twists, b.twists),
        (a.load_deviations, b.load_deviations),
        (a.twist_deviations, b.twist_deviations),
    ]
    blocks = all((x is None and y is None) or np.array_equal(x, y) for x, y in pairs)
    texts = ("rho", "motion", "name", "source", "licence")
    return blocks and all(getattr(a, key) == getattr(b, key) for key in texts)
