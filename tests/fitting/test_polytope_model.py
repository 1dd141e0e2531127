"""Polytopes from inside and outside, and the quadratic program behind them."""

import cvxpy as cp
import numpy as np
import pytest

from limitsurf.errors import InputError
from limitsurf.fitting.polytope_fit import consistent_points, violations
from limitsurf.fitting.polytope_model import PolytopeModel
from limitsurf.fitting.surface_files import load_surface
from limitsurf.sets.contact_sum import ContactSum

SURFACE = ContactSum([[0.06, 0.0], [-0.03, 0.05], [-0.03, -0.05]], [1.0, 2.0, 1.5])
RHO = 0.05


def pairs(n, noise=0.0, center=(0.0, 0.0, 0.0), seed=0):
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(n, 3)) * [1.0, 1.0, 1.0 / RHO]
    loads = SURFACE.support_point(v) - center
    return loads + noise * rng.normal(size=(n, 3)) * [1.0, 1.0, RHO], v


@pytest.mark.parametrize("symmetric", [False, True])
def test_points_are_those_of_all_conditions_at_once(symmetric):
    F, v = pairs(12, noise=0.5)
    F, v = F / [1, 1, RHO], v * [1, 1, RHO]
    weight = np.random.default_rng(1).uniform(0.5, 2.0, 12)
    ours = consistent_points(F, v, weight, symmetric)
    x = cp.Variable((12, 3))
    conditions = [v[i] @ (x[j] - x[i]) <= 0 for i in range(12) for j in range(12) if i != j]
    if symmetric:
        conditions += [v[i] @ (-x[j] - x[i]) <= 0 for i in range(12) for j in range(12)]
    miss = cp.multiply(np.sqrt(weight)[:, None], x - F)
    cp.Problem(cp.Minimize(cp.sum_squares(miss)), conditions).solve("CLARABEL")
    assert ours == pytest.approx(x.value, abs=1e-4)
    assert max(np.max(over) for over in violations(ours, v, symmetric)) < 1e-5


def test_exact_pairs_are_consistent_as_they_are():
    F, v = pairs(60)
    assert consistent_points(F, v, np.ones(60), True) == pytest.approx(F, abs=1e-6)


def test_the_surface_lies_between_inner_and_outer():
    F, v = pairs(60)
    model = PolytopeModel(RHO).fit(F, v)
    probe = np.random.default_rng(1).normal(size=(100, 3)) * [1.0, 1.0, 1.0 / RHO]
    inner, exact, outer = (s.support(probe) for s in (model.inner_, SURFACE, model.outer_))
    assert (inner <= exact + 1e-6).all()
    assert (exact <= outer + 1e-6).all()
    assert inner.mean() < 0.97 * outer.mean()


@pytest.mark.parametrize("kind", ["inner", "outer"])
def test_more_pairs_predict_better(kind):
    held = pairs(200, seed=9)
    few, many = (PolytopeModel(RHO, kind=kind).fit(*pairs(n)).score(*held) for n in (20, 300))
    assert -np.degrees(many) < 8.0 < -np.degrees(few)


@pytest.mark.parametrize("kind", ["inner", "outer"])
def test_an_active_load_needs_no_symmetry(kind, tmp_path):
    center = np.array([1.0, -0.5, 0.02])
    F, v = pairs(200, center=center)
    model = PolytopeModel(RHO, kind=kind, symmetric=False).fit(F, v)
    probe = np.random.default_rng(1).normal(size=(20, 3)) * [1.0, 1.0, 1.0 / RHO]
    exact = ContactSum(SURFACE.position, SURFACE.radius, center).support(probe)
    assert model.surface_.support(probe) == pytest.approx(exact, rel=0.2, abs=0.3)
    file = tmp_path / "surface.toml"
    file.write_text(model.to_toml())
    assert load_surface(file).support(probe) == pytest.approx(model.surface_.support(probe))


def test_what_spans_no_volume_is_refused():
    v = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]])
    with pytest.raises(InputError, match="lie in a plane"):
        PolytopeModel(1.0).fit(v, v)
    with pytest.raises(InputError, match="inner or outer"):
        PolytopeModel(RHO, kind="middle").fit(*pairs(10))
    tilted = np.array([[1.0, 0.0, 0.1], [0.0, 1.0, 0.1], [-1.0, -1.0, 0.1], [0.3, 0.1, 1.0]])
    with pytest.raises(InputError, match="unbounded"):
        PolytopeModel(1.0, kind="outer", symmetric=False).fit(tilted, tilted)
