"""Measured and simulated pairs of loads and motions of sliding parts."""

from limitsurf.datasets.plausibility import DroppedRows, ImplausibleUnits
from limitsurf.datasets.simulated_supports import SUPPORT_KINDS, make_support
from limitsurf.datasets.simulation import ZHOU2016_NOISE, SlidingNoise, make_sliding_data
from limitsurf.datasets.sliding_data import SlidingData, read_sliding_data
from limitsurf.datasets.zhou2016 import (
    PushedTriangle,
    fetch_zhou2016,
    load_zhou2016,
    three_feet,
)

__all__ = [
    "SUPPORT_KINDS",
    "ZHOU2016_NOISE",
    "DroppedRows",
    "ImplausibleUnits",
    "PushedTriangle",
    "SlidingData",
    "SlidingNoise",
    "fetch_zhou2016",
    "load_zhou2016",
    "make_sliding_data",
    "make_support",
    "read_sliding_data",
    "three_feet",
]
