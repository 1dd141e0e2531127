"""The 20 reference parts of alignment_cases.json."""

import json
from pathlib import Path

import numpy as np

CASES = json.loads((Path(__file__).parent / "reference/alignment_cases.json").read_text())
NAMES = [case["name"] for case in CASES]


def angle_distance(a, b, period=np.pi):
    """Return the largest distance between two sets of angles modulo a period."""
    assert len(a) == len(b), f"{len(a)} angles instead of {len(b)}: {a} and {b}"
    gaps = np.abs(np.subtract.outer(np.asarray(a), np.asarray(b))) % period
    gaps = np.minimum(gaps, period - gaps)
    return max(gaps.min(axis=0).max(), gaps.min(axis=1).max()) if len(a) else 0.0
