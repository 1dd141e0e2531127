"""Cells cover the disk, once, and still do when some are split."""

import numpy as np
import pytest

from limitsurf.fitting.pressure_cells import polar_cells


def test_cells_cover_the_disk():
    cells = polar_cells(3.0, 8)
    assert len(cells) == 217
    assert cells.area.sum() == pytest.approx(9.0 * np.pi)
    assert cells.area.max() / cells.area.min() < 1.4
    assert np.linalg.norm(cells.places, axis=1).max() < 3.0
    assert np.abs(cells.area @ cells.places).max() < 1e-12


def test_split_cells_cover_the_same_disk_more_finely_there():
    cells = polar_cells(3.0, 8)
    carries = np.arange(217) == 100
    finer = cells.split(carries)
    assert len(finer) == 217 + 3 * 7  # the cell and its neighbours: two beside, two in, two out
    assert np.array_equal(finer.split(np.zeros(len(finer), dtype=bool)).edges, finer.edges)
    assert finer.area.sum() == pytest.approx(9.0 * np.pi)
    apart = np.linalg.norm(finer.places - cells.places[100], axis=1)
    assert apart.min() > 0.0
    assert finer.area[np.argsort(apart)[:4]] == pytest.approx(cells.area[100] / 4.0, rel=0.1)


def test_the_disk_in_the_middle_is_split_into_quarters():
    finer = polar_cells(1.0, 2).split(np.arange(19) == 0)
    inner = finer.edges[finer.edges[:, 1] <= 0.2 + 1e-12]
    assert inner[:, 3] - inner[:, 2] == pytest.approx(np.full(len(inner), np.pi))
