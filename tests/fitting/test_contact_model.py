"""Friction of contacts from exact and noisy pairs, on feet and on cells."""

import numpy as np
import pytest
from bench_contact_fit import stated_in_cvxpy
from simulated_supports import SUPPORTS, pairs, support
from sklearn.model_selection import GridSearchCV, cross_val_score

from limitsurf.errors import InputError
from limitsurf.fitting.contact_fit import ContactFit, Contacts
from limitsurf.fitting.contact_model import ContactModel
from limitsurf.fitting.nonnegative import nonnegative_weights
from limitsurf.fitting.pairs import read_pairs
from limitsurf.fitting.pressure_cells import polar_cells
from limitsurf.fitting.surface_files import load_surface
from limitsurf.sets.contact_sum import ContactSum

FEET = np.array([[0.06, 0.0], [-0.03, 0.05], [-0.03, -0.05], [0.0, 0.01]])  # m
RADII = np.array([1.0, 2.0, 1.5, 0.5])  # N
RHO = 0.05


def exact(n, center=(0.0, 0.0, 0.0), seed=0):
    """Return pairs of the feet, in newtons and metres; motions of any length."""
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(n, 3)) * [1e-2, 1e-2, 1e-2 / RHO]
    return -ContactSum(FEET, RADII, center).support_point(-v), v


def noisy(n, seed=1):
    loads, v = exact(n, seed=seed)
    rng = np.random.default_rng(seed)
    return loads + rng.normal(size=(n, 3)) * [0.3, 0.3, 0.3 * RHO], v


def degrees(model, loads, twists):
    return -np.degrees(model.score(loads, twists))


def test_known_feet_come_back():
    model = ContactModel(RHO, FEET, smoothing=0.0, width=1e-6).fit(*exact(30))
    assert model.positions_ == pytest.approx(FEET)
    assert model.radii_ == pytest.approx(RADII, rel=1e-5)
    assert model.noise_ < 1e-9
    assert isinstance(model.surface_, ContactSum)


def test_a_motion_about_a_foot_spoils_little():
    loads, v = exact(30)
    x, y = FEET[1]
    about = np.array([y, -x, 1.0])
    force = 0.5 * RADII[1] * np.array([0.6, 0.8])
    others = ContactSum(FEET, RADII * (np.arange(4) != 1)).support_point(about)
    load = others + np.array(
        [*force, x * force[1] - y * force[0]]
    )  # half of what the foot could hold
    model = ContactModel(RHO, FEET).fit(np.vstack([loads, load]), np.vstack([v, about]))
    assert model.radii_ == pytest.approx(RADII, rel=0.02)
    assert degrees(model, load[None], about[None]) < 0.1


@pytest.mark.parametrize("kind", SUPPORTS)
def test_unknown_supports_are_predicted_to_half_a_degree(kind):
    rng = np.random.default_rng(0)
    surface = support(kind, rng)
    model = ContactModel(1.0).fit(*pairs(surface, 100, rng))
    assert degrees(model, *pairs(surface, 300, rng)) < 0.4


def test_finer_cells_are_what_makes_them_exact():
    rng = np.random.default_rng(0)
    surface = support("three", rng)
    seen, held = pairs(surface, 100, rng), pairs(surface, 300, rng)
    fixed, split = (degrees(ContactModel(1.0, refine=k).fit(*seen), *held) for k in (0, 4))
    assert fixed > 5.0 * split


@pytest.mark.parametrize("balanced", [False, True])
def test_the_convex_program_is_that_of_cvxpy(balanced):
    read = read_pairs(*noisy(25), None, RHO)
    fit = ContactFit(
        read.loads, read.motions, read.weight / 25, False, balanced, 0.0, (0.2, 0.15), 0.05, 0.1
    )
    contacts = Contacts.of_cells(polar_cells(3.0, 4))
    residuals, penalty = fit.in_loads(contacts), fit.penalty(contacts, 0.1)
    m = nonnegative_weights(residuals, penalty)
    if balanced:
        assert np.abs(m @ contacts.places).max() < 1e-4 * m.sum()
    else:
        _, value = stated_in_cvxpy(residuals, penalty)
        assert residuals.loss(m) + penalty.loss(m) == pytest.approx(value, rel=1e-6)


def test_steps_with_the_motions_lower_the_loss_in_both():
    loads, twists = noisy(30)
    models = [ContactModel(RHO, motion_weight=k).fit(loads, twists) for k in (0.0, 3.0)]
    apart = [degrees(model, loads, twists) for model in models]
    assert apart[1] < 0.8 * apart[0]


def test_the_active_load_is_told_from_friction_with_its_sign():
    c = np.array([0.8, -0.4, 0.02])
    loads, twists = exact(60, c)
    model = ContactModel(RHO, FEET, offset=True, smoothing=0.0, width=1e-6).fit(loads, twists)
    assert model.offset_ == pytest.approx(c, rel=1e-4)
    assert model.radii_ == pytest.approx(RADII, rel=1e-4)
    assert model.surface_.center == pytest.approx(c, rel=1e-4)
    assert degrees(model, loads, twists) < 0.01
    assert model.predict_load(twists) == pytest.approx(loads, abs=1e-3)
    unknown = ContactModel(RHO, offset=True).fit(loads, twists)
    assert unknown.offset_ == pytest.approx(c, rel=0.1, abs=0.01)


def test_predicted_motions_are_normals_of_the_surface():
    model = ContactModel(RHO).fit(*noisy(30))
    loads = np.random.default_rng(5).normal(size=(50, 3)) * [1.0, 1.0, RHO]
    v = model.predict(loads) / [1.0, 1.0, RHO]
    assert np.linalg.norm(model.predict(loads), axis=1) == pytest.approx(np.ones(50))
    along = np.cross(model.predict_load(v) / [1, 1, RHO], loads / [1, 1, RHO])
    apart = np.linalg.norm(along, axis=1) / np.linalg.norm(loads / [1, 1, RHO], axis=1)
    assert np.median(apart) < 1e-5  # but for loads on facets


def test_units_scale_out():
    loads, twists = noisy(20)
    here = ContactModel(RHO).fit(loads, twists)
    there = ContactModel(RHO).fit(1e-6 * loads, 1e3 * twists)
    assert there.radii_ == pytest.approx(1e-6 * here.radii_, rel=1e-6)
    assert there.positions_ == pytest.approx(here.positions_)


def test_a_weight_of_two_is_a_pair_twice():
    loads, twists = noisy(20)
    twice = ContactModel(RHO, FEET).fit(
        np.vstack([loads, loads[:5]]), np.vstack([twists, twists[:5]])
    )
    weighted = ContactModel(RHO, FEET).fit(loads, twists, 1.0 + (np.arange(20) < 5))
    # sizes of the loads, and so Huber's limits, may differ by a pair
    assert weighted.radii_ == pytest.approx(twice.radii_, rel=0.1)


def test_huber_shrugs_off_an_outlier():
    loads, twists = exact(30)
    loads[4] *= 4.0
    robust = ContactModel(RHO, FEET, smoothing=0.0).fit(loads, twists)
    squares = ContactModel(RHO, FEET, smoothing=0.0, huber=None).fit(loads, twists)
    errors = [np.abs(model.radii_ - RADII).max() for model in (robust, squares)]
    assert errors[0] < 0.3 * errors[1]


def test_three_pairs_are_enough_to_fit_and_two_are_not():
    loads, twists = noisy(3)
    assert degrees(ContactModel(RHO).fit(loads, twists), loads, twists) < 20.0
    with pytest.raises(InputError, match="2 usable pairs"):
        ContactModel(RHO).fit(loads[:2], twists[:2])


def test_it_works_in_scikit_learn():
    loads, twists = noisy(24)
    assert cross_val_score(ContactModel(RHO), loads, twists, cv=3).max() < 0.0
    search = GridSearchCV(ContactModel(RHO), {"smoothing": [0.005, 0.5]}, cv=3).fit(loads, twists)
    assert search.best_params_["smoothing"] in (0.005, 0.5)


def test_the_surface_survives_its_file(tmp_path):
    model = ContactModel(RHO, offset=True).fit(*exact(40, (0.8, -0.4, 0.02)))
    file = tmp_path / "surface.toml"
    file.write_text(model.to_toml())
    v = exact(10)[1]
    assert load_surface(file).support(v) == pytest.approx(model.surface_.support(v))


@pytest.mark.parametrize(
    "options",
    [
        {"positions": np.empty((0, 2))},
        {"positions": [[1.0, 2.0, 3.0]]},
        {"motion_weight": -1.0},
        {"smoothing": -1.0},
        {"width": np.nan},
        {"huber": (-1.0, 1.0)},
        {"rings": 0},
        {"refine": -1},
    ],
)
def test_options_out_of_range_are_refused(options):
    with pytest.raises(InputError, match=next(iter(options))):
        ContactModel(RHO, **options).fit(*exact(10))
