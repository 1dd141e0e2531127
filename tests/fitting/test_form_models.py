"""Ellipsoids and quartics: known surfaces, signs, units, weights, outliers."""

import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError, SolveFailed
from limitsurf.fitting.base import angles_between
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.form_fit import FittedForm
from limitsurf.fitting.forms import form_basis
from limitsurf.fitting.pairs import scaled_motions
from limitsurf.fitting.quartic_model import QuarticModel
from limitsurf.fitting.surface_files import load_surface
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.linear_image import LinearImage
from limitsurf.sets.polynomial_set import PolynomialSet
from tests.fitting.simulated import pairs_of

RHO = 0.05
AXES = np.array([[2.0, 0.3, 0.2], [0.1, 1.5, -0.4], [0.02, -0.01, 0.1]])
OFFSET = np.array([3.0, -1.0, 0.2])  # farther out than the surface reaches: 0 is not inside
MODELS = [EllipsoidModel, QuarticModel]
FEET = [[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.04]]


def quartic_surface(flat=False):
    """Return a quartic, skew to the axes, that no ellipsoid comes near; `flat` where y = m = 0."""
    E = [[4, 0, 0], [0, 4, 0], [0, 0, 4], [2, 2, 0], [2, 0, 2], [1, 0, 3], [0, 2, 2]]
    centred = PolynomialSet(E, [1.0, 0.5, 1.0, 0.2, 0.4, 0.2, 0.0 if flat else 0.3])
    return LinearImage(AXES, centred)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("center", [np.zeros(3), OFFSET])
def test_ellipsoids_are_recovered(model, center, rng):
    true = Ellipsoid(center, AXES)
    loads, twists = pairs_of(true, 40)
    fit = model(RHO, offset=bool(center.any()), shrinkage=0.0).fit(loads, twists)
    d = rng.normal(size=(50, 3)) * [1.0, 1.0, 20.0]
    np.testing.assert_allclose(fit.surface_.support(d), true.support(d), rtol=1e-5)
    np.testing.assert_allclose(fit.offset_, center, atol=1e-5)
    assert fit.score(loads, twists) > -1e-6


@pytest.mark.parametrize("center", [None, OFFSET])
@pytest.mark.parametrize("flat", [False, True])
def test_quartics_are_recovered(center, flat, rng):
    """On the edge of the cone of convex forms, solver and floor leave a relative 1e-4."""
    true = quartic_surface(flat)
    if center is not None:
        true = LinearImage(np.eye(3), true, center)
    loads, twists = pairs_of(true, 60)
    fit = QuarticModel(RHO, offset=center is not None, shrinkage=0.0).fit(loads, twists)
    d = rng.normal(size=(50, 3)) * [1.0, 1.0, 20.0]
    size = np.abs(true.support(d)).max()
    error = np.abs(fit.surface_.support(d) - true.support(d)).max()
    assert error < (1e-4 if flat else 1e-6) * size
    ellipsoid = EllipsoidModel(RHO, offset=center is not None).fit(loads, twists)
    assert ellipsoid.score(loads, twists) < -0.1
    assert isinstance(fit.surface_, PolynomialSet if center is None else LinearImage)


@pytest.mark.parametrize("model", MODELS)
def test_without_noise_the_defaults_hardly_shrink(model, rng):
    true = Ellipsoid(np.zeros(3), AXES)
    fit = model(RHO).fit(*pairs_of(true, 60))
    d = rng.normal(size=(50, 3)) * [1.0, 1.0, 20.0]
    np.testing.assert_allclose(fit.surface_.support(d), true.support(d), rtol=2e-3)
    assert fit.motion_noise_ < 0.04


@pytest.mark.parametrize("model", MODELS)
def test_surface_is_what_the_contacts_exert(model):
    """With a push of its own, friction on a part that slides along +x pulls towards -x."""
    contacts = ContactSet(FEET, 1.0, np.tile([0.5, 0.1], (3, 1)))
    loads, twists = pairs_of(contacts.limit_surface(), 60)
    fit = model(RHO, offset=True).fit(loads, twists)
    np.testing.assert_allclose(fit.offset_[:2], [1.5, 0.3], atol=0.1)
    exerted = fit.surface_.support_point([-1.0, 0.0, 0.0])
    np.testing.assert_allclose(fit.predict_load([[1.0, 0.0, 0.0]])[0], -exerted, rtol=1e-12)
    assert exerted[0] == pytest.approx(1.5 - 3.0, abs=0.2)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("offset", [False, True])
def test_motion_of_the_predicted_load_is_the_motion(model, offset):
    contacts = ContactSet(FEET, 1.0, np.tile([0.5, 0.1], (3, 1)) if offset else None)
    loads, twists = pairs_of(contacts.limit_surface(), 30, noise=0.1)
    fit = model(RHO, offset=offset).fit(loads, twists)
    predicted = fit.predict(fit.predict_load(twists))
    np.testing.assert_allclose(predicted, scaled_motions(twists, RHO), atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(predicted, axis=1), 1.0)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("offset", [False, True])
def test_units_of_force_length_and_time_do_not_matter(model, offset):
    surface = ContactSet(FEET, 1.0, np.tile([0.5, 0.1], (3, 1)) if offset else None)
    loads, twists = pairs_of(surface.limit_surface(), 25, noise=0.1)
    here = model(RHO, offset=offset).fit(loads, twists)
    force, length = 1e-7, 1e-3
    there = model(RHO * length, offset=offset).fit(
        loads * [force, force, force * length], twists * 60.0 * [length, length, 1.0]
    )
    scale = np.array([force, force, force * length])
    d = np.random.default_rng(1).normal(size=(20, 3)) * [1.0, 1.0, 20.0]
    np.testing.assert_allclose(
        there.surface_.support(d / scale), here.surface_.support(d), rtol=1e-5
    )
    np.testing.assert_allclose(there.predict(loads * scale), here.predict(loads), atol=1e-5)


@pytest.mark.parametrize("model", MODELS)
def test_a_turned_part_has_a_turned_surface(model):
    loads, twists = pairs_of(ContactSet(FEET, 1.0).limit_surface(), 25, noise=0.1)
    a = 0.7
    R = np.array([[np.cos(a), -np.sin(a), 0.0], [np.sin(a), np.cos(a), 0.0], [0.0, 0.0, 1.0]])
    here, there = model(RHO).fit(loads, twists), model(RHO).fit(loads @ R.T, twists @ R.T)
    d = np.random.default_rng(1).normal(size=(20, 3)) * [1.0, 1.0, 20.0]
    np.testing.assert_allclose(there.surface_.support(d @ R.T), here.surface_.support(d), rtol=1e-5)


@pytest.mark.parametrize("model", MODELS)
def test_weights_count_like_repeated_pairs(model):
    loads, twists = pairs_of(ContactSet(FEET, 1.0).limit_surface(), 15, noise=0.2)
    counts = np.random.default_rng(2).integers(0, 4, 15)
    weighted = model(RHO).fit(loads, twists, counts)
    repeated = model(RHO).fit(np.repeat(loads, counts, axis=0), np.repeat(twists, counts, axis=0))
    np.testing.assert_allclose(weighted.predict(loads), repeated.predict(loads), atol=1e-5)
    assert weighted.loss_ == pytest.approx(repeated.loss_, rel=1e-7)
    assert (
        np.abs(weighted.predict(loads) - model(RHO).fit(loads, twists).predict(loads)).max() > 1e-3
    )


@pytest.mark.parametrize("model", MODELS)
def test_outliers_pull_little(model):
    surface = Ellipsoid(np.zeros(3), AXES)
    loads, twists = pairs_of(surface, 60, noise=0.03)
    wrong = loads.copy()
    wrong[:9] = 1.5 * wrong[9:18]  # loads of other pushes
    keep = np.einsum("ij,ij->i", wrong, twists) > 0.0
    clean_loads, clean_twists = pairs_of(surface, 200, seed=1)
    robust, squares = (
        model(RHO, huber=h, motion_noise=0.03, load_noise=0.03).fit(wrong[keep], twists[keep])
        for h in (1.345, np.inf)
    )
    assert robust.score(clean_loads, clean_twists) > -0.04
    assert squares.score(clean_loads, clean_twists) < 1.5 * robust.score(clean_loads, clean_twists)


def test_shrinkage_draws_the_quartic_to_the_ellipsoid():
    loads, twists = pairs_of(ContactSet(FEET, 1.0).limit_surface(), 20, noise=0.1)
    ellipsoid = EllipsoidModel(RHO, shrinkage=1e7).fit(loads, twists).predict(loads)
    angles = [
        angles_between(QuarticModel(RHO, shrinkage=s).fit(loads, twists).predict(loads), ellipsoid)
        for s in (0.0, 1e2, 1e7)
    ]
    mean = np.mean(angles, axis=1)
    assert mean[0] > mean[1] > 10 * mean[2]
    assert mean[2] < 1e-3


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("offset", [False, True])
def test_file_round_trip(model, offset, tmp_path):
    contacts = ContactSet(FEET, 1e-6, np.tile([5e-7, 1e-7], (3, 1)) if offset else None)
    fit = model(RHO, offset=offset).fit(*pairs_of(contacts.limit_surface(), 20))
    path = tmp_path / "surface.toml"
    path.write_text(fit.to_toml())
    assert "fitted to 20 pairs" in path.read_text()
    d = np.random.default_rng(1).normal(size=(20, 3)) * [1.0, 1.0, 20.0]
    np.testing.assert_allclose(load_surface(path).support(d), fit.surface_.support(d), rtol=1e-12)


@pytest.mark.parametrize("model", MODELS)
def test_predictions_of_nothing_and_of_unknown(model):
    fit = model(RHO).fit(*pairs_of(ContactSet(FEET, 1.0).limit_surface(), 20))
    found = fit.predict([[0.0, 0.0, 0.0], [np.nan, 1.0, 0.0], [1.0, 0.0, 0.0]])
    assert not found[0].any()
    assert np.isnan(found[1]).all()
    assert np.linalg.norm(found[2]) == pytest.approx(1.0)
    assert isinstance(fit.surface_, ConvexSet)


def test_scores_leave_out_what_is_unknown():
    loads, twists = pairs_of(ContactSet(FEET, 1.0).limit_surface(), 20)
    fit = EllipsoidModel(RHO).fit(loads, twists)
    expected = fit.score(loads[1:], twists[1:])
    loads[0, 0] = np.nan
    with pytest.warns(UserWarning, match="dropped 1 of 20 pairs: NaN"):
        assert fit.score(loads, twists) == pytest.approx(expected, rel=1e-12)
    with pytest.raises(InputError, match="no pair without NaN"):
        fit.score(loads[:1], twists[:1])


def test_a_form_that_is_all_but_open_is_refused():
    basis = form_basis(4)
    thin = np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1e-5, 1e-5, 0.0]])  # (fx - fy)^2 + m^2
    form = FittedForm(basis, basis.substituted(basis.ball, thin), np.eye(3), np.zeros(3))
    with pytest.raises(SolveFailed, match=r"all but unbounded .* raise shrinkage") as caught:
        QuarticModel(RHO)._surface(form, np.eye(3))
    assert caught.value.best is form


def test_few_pairs_that_leave_the_surface_open_are_drawn_to_the_prior(monkeypatch):
    """Where the surface is refused, the shrinkage is raised tenfold, unless it is none."""
    loads, twists = pairs_of(ContactSet(FEET, 1.0).limit_surface(), 20)
    asked = []

    def refuse_the_first(self, form, to_newtons):
        asked.append(form)
        if len(asked) == 1:
            raise SolveFailed("all but unbounded", best=form)
        return surface(self, form, to_newtons)

    surface = QuarticModel._surface
    monkeypatch.setattr(QuarticModel, "_surface", refuse_the_first)
    fit = QuarticModel(RHO, shrinkage=0.5).fit(loads, twists)
    monkeypatch.undo()
    stronger = QuarticModel(RHO, shrinkage=5.0).fit(loads, twists)
    assert fit.shrinkage_ == stronger.shrinkage_ == 5.0
    assert fit.predict(loads) == pytest.approx(stronger.predict(loads), abs=1e-12)
    assert QuarticModel(RHO).fit(loads, twists).shrinkage_ == 1.0
    asked.clear()
    monkeypatch.setattr(QuarticModel, "_surface", refuse_the_first)
    with pytest.raises(SolveFailed, match="unbounded"):
        QuarticModel(RHO, shrinkage=0.0).fit(loads, twists)


@pytest.mark.parametrize(
    "option",
    [
        {"rho": 0.0},
        {"huber": 0.0},
        {"shrinkage": -1.0},
        {"shrinkage": np.inf},
        {"motion_noise": 0.0},
        {"load_noise": np.nan},
        {"max_iter": 0},
    ],
)
def test_bad_options(option):
    loads, twists = pairs_of(ContactSet(FEET, 1.0).limit_surface(), 20)
    with pytest.raises(InputError, match=next(iter(option))):
        EllipsoidModel(**option).fit(loads, twists)


def test_too_few_steps():
    loads, twists = pairs_of(ContactSet(FEET, 1.0).limit_surface(), 20, noise=0.2)
    with pytest.raises(SolveFailed, match="after 1 steps"):
        QuarticModel(RHO, max_iter=1).fit(loads, twists)


@pytest.mark.parametrize(
    ("model", "offset", "least"),
    [
        (EllipsoidModel, False, 2),
        (EllipsoidModel, True, 3),
        (QuarticModel, False, 5),
        (QuarticModel, True, 6),
    ],
)
def test_fewer_numbers_than_parameters(model, offset, least):
    loads, twists = pairs_of(ContactSet(FEET, 1.0).limit_surface(), least, noise=0.05)
    model(RHO, offset=offset).fit(loads, twists)
    with pytest.raises(InputError, match=f"{least} is the minimum"):
        model(RHO, offset=offset).fit(loads[1:], twists[1:])
