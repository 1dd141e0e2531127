"""Cells over which an unknown pressure is spread, split where they carry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["PressureCells", "polar_cells"]

Array = NDArray[np.float64]

_NEAR = 1.5  # distance, in the mean size of two cells, up to which they are neighbours


@dataclass(frozen=True, eq=False)
class PressureCells:
    """Parts of rings about the origin: rows ``r0, r1, t0, t1`` of radii and angles.

    Attributes
    ----------
    edges : (N, 4) float
        Inner and outer radius, first and last angle.
    """

    edges: Array

    def __len__(self) -> int:
        """Return the number of cells."""
        return len(self.edges)

    @property
    def area(self) -> Array:
        """Areas (N,)."""
        r0, r1, t0, t1 = self.edges.T
        return np.asarray(0.5 * (r1**2 - r0**2) * (t1 - t0))

    @property
    def places(self) -> Array:
        """Places (N, 2): the middle of radii and angles, the origin for a full disk."""
        r0, r1, t0, t1 = self.edges.T
        full = (r0 == 0.0) & (t1 - t0 > 6.0)
        r, t = np.where(full, 0.0, 0.5 * (r0 + r1)), 0.5 * (t0 + t1)
        return np.column_stack([r * np.cos(t), r * np.sin(t)])

    def split(self, carries: NDArray[np.bool_]) -> PressureCells:
        """Return the cells with those that carry, and their neighbours, cut into four."""
        size, at = np.sqrt(self.area), self.places
        apart = np.linalg.norm(at[:, None] - at[carries], axis=2)
        cut = (apart <= _NEAR * 0.5 * (size[:, None] + size[carries])).any(axis=1)
        r0, r1, t0, t1 = self.edges[cut].T
        rm, tm = 0.5 * (r0 + r1), 0.5 * (t0 + t1)
        quarters = [
            np.column_stack([*radii, *angles])
            for radii in ((r0, rm), (rm, r1))
            for angles in ((t0, tm), (tm, t1))
        ]
        return PressureCells(np.vstack([self.edges[~cut], *quarters]))


def polar_cells(radius: float, rings: int) -> PressureCells:
    """Return the cells of a disk: a small disk in the middle, then rings of 6, 12, 18, ... cells.

    The rings have the same width but the middle, which has half of it: cells have nearly the same
    area.
    """
    width = radius / (rings + 0.5)
    edges = [np.array([[0.0, 0.5 * width, 0.0, 2.0 * np.pi]])]
    for k in range(1, rings + 1):
        t = 2.0 * np.pi * np.arange(6 * k + 1) / (6 * k)
        r0 = np.full(6 * k, (k - 0.5) * width)
        edges.append(np.column_stack([r0, r0 + width, t[:-1], t[1:]]))
    return PressureCells(np.vstack(edges))
