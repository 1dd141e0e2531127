"""The motion under a load of free size, against Clarabel and cases known by hand."""

import cvxpy as cp
import numpy as np
import pytest

from limitsurf.kernels.load_ray import motions_on_rays
from limitsurf.sets.contact_sum import ContactSum


def motions(places, radii, loads, width=1e-9):
    contacts = np.ascontiguousarray(np.column_stack([places, radii]).T)
    F = np.array(loads) / np.linalg.norm(loads, axis=1, keepdims=True)
    v, error = np.empty_like(F), np.empty((len(F), 2))
    motions_on_rays(F, contacts, width, v, error)
    return F, v, error


def feet(seed, count):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 2)), rng.uniform(0.1, 1.0, count), rng


@pytest.mark.parametrize("count", [2, 3, 10, 100])
def test_the_load_on_the_boundary_is_that_of_clarabel(count):
    places, radii, rng = feet(count, count)
    F, v, error = motions(places, radii, rng.normal(size=(6, 3)))
    surface = ContactSum(places, radii)
    assert np.abs((F * v).sum(axis=1) - 1.0).max() < 1e-12
    assert np.abs(error).max() < 1e-6
    for load, motion in zip(F, v, strict=True):
        s = cp.Variable()
        problem = cp.Problem(cp.Maximize(s), surface.constraints(s * load + np.zeros(3)))
        assert surface.support(motion) == pytest.approx(problem.solve("CLARABEL"), rel=1e-6)


def test_motions_come_back_from_the_loads_that_they_need():
    places, radii, rng = feet(1, 20)
    v = rng.normal(size=(200, 3))
    _, found, _ = motions(places, radii, ContactSum(places, radii).support_point(v))
    unit = [x / np.linalg.norm(x, axis=1, keepdims=True) for x in (v, found)]
    assert np.abs(unit[0] - unit[1]).max() < 1e-6


def test_a_load_on_a_facet_turns_the_part_about_that_foot():
    places, radii, _ = feet(2, 3)
    x, y = places[1]
    about = np.array([y, -x, 1.0])  # the velocity of foot 1 vanishes
    others = np.flatnonzero(np.arange(3) != 1)
    load = ContactSum(places[others], radii[others]).support_point(about)
    force = 0.3 * radii[1] * np.array([0.6, 0.8])  # anything in its disk
    load += [*force, x * force[1] - y * force[0]]
    _, v, error = motions(places, radii, [load])
    assert np.abs(np.cross(v[0], about)).max() < 1e-7 * np.linalg.norm(v[0]) * 2
    assert np.abs(error).max() < 1e-6


def test_a_load_that_nothing_balances_meets_no_friction():
    F, v, _ = motions([[2.0, 0.0]], [1.0], [[0.0, 0.0, 1.0]])
    assert ContactSum([[2.0, 0.0]], [1.0]).support(v[0]) < 1e-6
    assert F[0] @ v[0] == pytest.approx(1.0)


def test_the_error_tells_of_a_wide_smoothing():
    places, radii, rng = feet(3, 3)
    loads = rng.normal(size=(100, 3))
    _, _, sharp = motions(places, radii, loads)
    _, _, wide = motions(places, radii, loads, width=0.1)
    assert wide[:, 0].max() > 1e-3 > 1e-6 > np.abs(sharp).max()


def test_without_friction_the_part_moves_along_the_load():
    F, v, _ = motions(np.empty((0, 2)), np.empty(0), [[3.0, 0.0, 4.0]])
    assert v == pytest.approx(F)
