from dataclasses import replace

import numpy as np
import pytest

from limitsurf.geometry.part import Part
from limitsurf.kernels.turn_roots import CLEAR, FLAT, MONOTONE, ROOT
from limitsurf.planning.turn_certificate import changes_in_cells
from limitsurf.planning.turn_function import turn_function
from tests.reference_cases import CASES, NAMES


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_a_root_that_is_removed_is_missed(case):
    turn = turn_function(Part(case["vertices"]))
    assert turn.certificate.complete
    assert "complete: " in repr(turn.certificate)
    for shorter in (
        replace(turn, stable=turn.stable[1:]),
        replace(turn, unstable=turn.unstable[:-1]),
    ):
        assert not shorter.certificate.complete
        assert "not complete" in repr(shorter.certificate)


def test_a_root_in_the_wrong_place_shows_in_the_residual(paper_t):
    turn = turn_function(paper_t)
    moved = replace(turn, stable=turn.stable + 1e-6)
    assert turn.certificate.residual < 1e-15
    assert moved.certificate.residual > 1e-8


def test_a_triple_root_is_left_to_rounding():
    turn = turn_function(Part([(0, 0), (np.sqrt(1.5), 0), (np.sqrt(1.5), 1), (0, 1)]))
    certificate = turn.certificate
    assert certificate.equilibria == certificate.bound == 2
    assert not certificate.complete
    assert certificate.unresolved == 1
    assert 1e-6 < certificate.widest < 1e-3
    assert "1 unresolved" in repr(certificate)


def cells(*rows):
    """Return rows (width, kind, sign, root); roots are where told, else in the middle."""
    borders = np.concatenate([[0.0], np.cumsum([row[0] for row in rows])])
    borders *= np.pi / borders[-1]
    return np.array(
        [
            (a, b, row[1], row[2], 0.5 * (a + b), 1e-3)
            for a, b, row in zip(borders, borders[1:], rows, strict=False)
        ]
    )


def test_roots_of_cells():
    found = changes_in_cells(cells((1, CLEAR, -1), (1, ROOT, 1), (1, CLEAR, 1), (1, ROOT, -1)))
    assert found.rising == pytest.approx([3 * np.pi / 8])
    assert found.falling == pytest.approx([7 * np.pi / 8])
    assert (found.bound, found.unresolved) == (2, 0)


@pytest.mark.parametrize("shift", range(6))
def test_runs_of_cells_with_unclear_borders(shift):
    """A root on the border of two cells comes once, wherever the list of cells starts."""
    rows = [
        (1, CLEAR, -1),
        (1, MONOTONE, 1),
        (1, MONOTONE, 1),
        (1, CLEAR, 1),
        (1, ROOT, -1),
        (1, CLEAR, -1),
    ]
    found = changes_in_cells(cells(*rows[shift:], *rows[:shift]))
    assert len(found.rising) == len(found.falling) == 1
    assert (found.bound, found.unresolved) == (2, 0)


def test_a_touch_is_no_root():
    """Monotone cells between equal signs hold no root; flat ones are left to rounding."""
    clear = (1, CLEAR, 1)
    found = changes_in_cells(cells(clear, (1, MONOTONE, 1), clear))
    assert (found.bound, found.unresolved) == (0, 0)
    found = changes_in_cells(cells(clear, (1, MONOTONE, -1), (1, MONOTONE, 1), clear))
    assert (found.bound, found.unresolved) == (0, 1)
    found = changes_in_cells(cells(clear, (1, FLAT, 0), clear))
    assert (found.bound, found.unresolved) == (0, 1)
    found = changes_in_cells(cells(clear, (1e-11, FLAT, 0), clear))
    assert (found.bound, found.unresolved) == (0, 0)


def test_nothing_but_rounding():
    found = changes_in_cells(cells((1, FLAT, 0), (1, MONOTONE, 1)))
    assert len(found.rising) == len(found.falling) == 0
    assert found.unresolved == 1
    assert found.widest == np.pi
