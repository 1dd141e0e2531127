import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.fitting.bootstrap import bootstrap, surface_radius
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.quartic_model import QuarticModel
from limitsurf.sets.ellipsoid import Ellipsoid
from tests.fitting.simulated import pairs_of

RHO = 0.05
TRUE = Ellipsoid(np.zeros(3), np.diag([2.0, 1.0, 0.08]))
PROBES = np.array([[1.0, 0.2, 0.01], [0.3, 1.0, -0.02], [0.1, 0.1, 0.05]])


def test_bands_do_not_depend_on_threads_and_follow_the_seed():
    pairs = pairs_of(TRUE, 25, noise=0.1)
    one = bootstrap(EllipsoidModel(RHO), *pairs, n=12)
    two = bootstrap(EllipsoidModel(RHO), *pairs, n=12, n_jobs=2)
    other = bootstrap(EllipsoidModel(RHO), *pairs, n=12, seed=1)
    np.testing.assert_array_equal(one.motion_angle(PROBES), two.motion_angle(PROBES))
    assert (one.motion_angle(PROBES) != other.motion_angle(PROBES)).all()
    assert repr(one) == "Bootstrap(EllipsoidModel, 12 refits)"


def test_bands_shrink_with_the_square_root_of_the_pairs():
    widths = []
    for n in (20, 320):
        bands = bootstrap(EllipsoidModel(RHO), *pairs_of(TRUE, n, noise=0.1), n=60)
        lower, upper = bands.radius(PROBES)
        widths.append([(upper - lower).mean(), bands.motion_angle(PROBES).mean()])
    ratio = np.divide(*widths)
    assert ((ratio > 2.5) & (ratio < 6.5)).all()


@pytest.mark.slow
def test_bands_hold_the_truth_in_most_cases():
    """Of bands named 90 %, three quarters do: refits do not show the bias of noisy loads."""
    held, model = [], EllipsoidModel(RHO, motion_noise=0.1, load_noise=0.1)
    for seed in range(20):
        pairs = pairs_of(TRUE, 60, seed=seed, noise=0.1)
        lower, upper = bootstrap(model, *pairs, n=40).support(np.eye(3))
        held.append((lower <= TRUE.support(np.eye(3))) & (TRUE.support(np.eye(3)) <= upper))
    assert 0.6 < np.mean(held) < 0.95


def test_quartic_with_offset_and_progress(capsys):
    contacts = ContactSet([[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.04]], 1.0, [[0.5, 0.0]] * 3)
    pairs = pairs_of(contacts.limit_surface(), 25, noise=0.05)
    bands = bootstrap(QuarticModel(RHO, offset=True), *pairs, n=3, progress=True)
    lower, upper = bands.radius([[1.0, 0.0, 0.0]])
    assert 2.0 < lower[0] < upper[0] < 4.0
    assert "Refitting" in capsys.readouterr().out


def test_dropped_pairs_are_said_once():
    loads, twists = pairs_of(TRUE, 20, noise=0.05)
    loads[3] = np.nan
    twists[4] = -twists[4]
    with pytest.warns(UserWarning, match="dropped") as caught:
        bands = bootstrap(EllipsoidModel(RHO), loads, twists, n=4)
    assert len(caught) == 2
    assert len(bands.models) == 4


def test_radius_is_where_the_ray_leaves():
    moved = Ellipsoid([5.0, -1.0, 0.2], np.diag([2.0, 1.0, 0.08]))
    d = np.array([[1.0, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0, 0.0, 0.01], [1.0, 1.0, 0.0]])
    np.testing.assert_allclose(
        surface_radius(moved, d), [2.0, 0.5, 8.0, 1 / np.sqrt(1.25)], rtol=1e-7
    )
    with pytest.raises(InputError, match="zero rows"):
        surface_radius(moved, np.zeros((1, 3)))


@pytest.mark.parametrize("option", [{"n": 0}, {"seed": -1}])
def test_bad_options(option):
    with pytest.raises(InputError, match=next(iter(option))):
        bootstrap(EllipsoidModel(RHO), *pairs_of(TRUE, 20), **option)
    with pytest.raises(InputError, match="level"):
        bootstrap(EllipsoidModel(RHO), *pairs_of(TRUE, 20), n=1).motion_angle(PROBES, level=1.0)
