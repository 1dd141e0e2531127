"""Simulated pairs and supports: on the boundary, along its normal, and as noisy as stated."""

import numpy as np
import pytest
from scipy.optimize import minimize

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.datasets.simulated_supports import SUPPORT_KINDS, make_support
from limitsurf.datasets.simulation import ZHOU2016_NOISE, SlidingNoise, make_sliding_data
from limitsurf.datasets.zhou2016 import SUPPORTS, three_feet
from limitsurf.errors import InputError
from limitsurf.sets.ellipsoid import Ellipsoid

RHO = 0.05
SCALE = np.array([1.0, 1.0, RHO])


def contact_loads(contacts, twists):
    """Return the loads of sliding contacts on the part, contact by contact: ``-mu N u/|u|``."""
    loads = []
    for vx, vy, omega in twists:
        total = np.array(3 * [0.0])
        for (x, y), m, push in zip(
            contacts.position, contacts.radius, contacts.offset, strict=True
        ):
            u = np.array([vx - omega * y, vy + omega * x])
            f = push - m * u / np.linalg.norm(u)
            total += [*f, x * f[1] - y * f[0]]
        loads.append(total)
    return np.array(loads)


@pytest.mark.parametrize("kind", SUPPORT_KINDS)
def test_applied_loads_balance_the_sliding_contacts(kind):
    contacts = make_support(kind, seed=5, friction=3.0)
    data = make_sliding_data(contacts.limit_surface(), 40, seed=1, rho=RHO)
    assert data.loads == pytest.approx(-contact_loads(contacts, data.twists), abs=1e-9)
    assert data.load_deviations is data.twist_deviations is None


def test_an_active_offset_has_the_sign_of_the_conventions():
    """Contacts that push to the right: to hold the part, or move it slowly, one pushes left."""
    contacts = ContactSet([[0.0, 0.03], [0.0, -0.03]], 0.1, [[2.0, 0.0], [2.0, 0.0]])
    data = make_sliding_data(contacts.limit_surface(), 30, rho=RHO)
    assert data.loads == pytest.approx(-contact_loads(contacts, data.twists), abs=1e-9)
    assert (data.loads[:, 0] < -3.7).all()


def test_loads_lie_on_the_boundary_and_motions_along_its_normal():
    A = np.array([[2.0, 0.3, 0.0], [0.0, 1.5, 0.2], [0.1, 0.0, 0.08]])
    center = np.array([0.5, -0.2, 0.03])
    data = make_sliding_data(Ellipsoid(center, A), 60, rho=RHO)
    u = np.linalg.solve(A, (-data.loads - center).T).T
    assert np.linalg.norm(u, axis=1) == pytest.approx(np.ones(60), abs=1e-12)
    normals = np.linalg.solve(A.T, u.T).T  # of L at -F; the motion is its opposite
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    twists = data.twists / np.linalg.norm(data.twists, axis=1, keepdims=True)
    assert twists == pytest.approx(-normals, abs=1e-12)


def test_motions_are_uniform_on_the_sphere_of_scaled_motions():
    data = make_sliding_data(Ellipsoid(np.zeros(3), np.diag(SCALE)), 4000, rho=RHO, distance=0.02)
    motions = data.twists * SCALE / 0.02
    assert np.linalg.norm(motions, axis=1) == pytest.approx(np.ones(4000))
    assert motions.mean(axis=0) == pytest.approx(np.zeros(3), abs=4.0 / np.sqrt(3 * 4000))
    for column in motions.T:  # Archimedes: each coordinate is uniform
        counts = np.histogram(column, bins=8, range=(-1, 1))[0]
        assert np.abs(counts - 500).max() < 4.0 * np.sqrt(500)


def test_noise_is_as_stated_and_deviations_say_so():
    surface = make_support("ring", friction=4.0).limit_surface()
    clean = make_sliding_data(surface, 5000, 0.0, 3, rho=RHO)
    data = make_sliding_data(surface, 5000, SlidingNoise(0.03, 0.02), 3, rho=RHO)
    error = (data.loads - clean.loads) / data.load_deviations
    assert error.mean(axis=0) == pytest.approx(np.zeros(3), abs=4.0 / np.sqrt(5000))
    assert error.std(axis=0) == pytest.approx(np.ones(3), abs=4.0 / np.sqrt(2 * 5000))
    size = np.sqrt(((clean.loads / SCALE) ** 2).sum(axis=1).mean())
    assert data.load_deviations[0] == pytest.approx(0.03 * size * SCALE)
    # motions keep their length, so two of three directions scatter
    a, b = clean.twists * SCALE, data.twists * SCALE
    assert np.linalg.norm(b, axis=1) == pytest.approx(np.full(5000, 0.01))
    angle = np.arccos(np.clip((a * b).sum(axis=1) / 1e-4, -1.0, 1.0))
    assert np.sqrt((angle**2).mean() / 2.0) == pytest.approx(0.02, rel=0.04)
    assert data.twist_deviations[0] == pytest.approx(0.02 * 0.01 / SCALE)


def test_seeds_repeat_and_differ():
    surface = make_support("ten points", 2).limit_surface()
    one, same, other = (make_sliding_data(surface, 9, 0.1, s, rho=RHO) for s in (4, 4, 5))
    assert (one.loads == same.loads).all()
    assert (one.twists == same.twists).all()
    assert (one.loads != other.loads).all()


def angle_off_exact(contacts, data):
    """Return the mean angle [rad] between motions and the normals of the exact surface.

    The normal where the ray of F leaves the set minimises the support function on ``d.F = 1``.
    """
    x, y = contacts.position.T / RHO
    angles = []
    for F, motion in zip(data.loads / SCALE, data.twists * SCALE, strict=True):
        F, motion = F / np.linalg.norm(F), motion / np.linalg.norm(motion)
        across = np.linalg.svd(F[None])[2][1:].T
        d = F
        for blur in (1e-2, 1e-4):

            def power(z, blur=blur, F=F, across=across):
                d = F + across @ z
                ux, uy = d[0] - d[2] * y, d[1] + d[2] * x
                return contacts.radius @ np.sqrt(ux**2 + uy**2 + blur**2)

            start = across.T @ (d - F)
            d = F + across @ minimize(power, start, method="BFGS").x
        cosine = d @ motion / np.linalg.norm(d)
        angles.append(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return np.mean(angles)


@pytest.mark.parametrize(
    ("support", "stated"), list(zip(SUPPORTS, (7.7, 7.3, 12.2, 7.2), strict=True))
)
def test_the_preset_is_as_noisy_as_its_comment_says(support, stated):
    """To three standard errors of the mean of 100 pairs."""
    contacts = three_feet(support)
    data = make_sliding_data(contacts.limit_surface(), 100, ZHOU2016_NOISE, rho=RHO)
    assert np.degrees(angle_off_exact(contacts, data)) == pytest.approx(stated, rel=0.25)


@pytest.mark.parametrize("kind", SUPPORT_KINDS)
def test_supports_are_about_their_centre_and_of_the_size_asked_for(kind):
    contacts = make_support(kind, seed=8, size=0.03, friction=2.0)
    assert contacts.radius.sum() == pytest.approx(2.0)
    assert contacts.radius @ contacts.position == pytest.approx([0.0, 0.0], abs=1e-15)
    assert (contacts.radius > 0.0).all()
    assert np.ptp(contacts.position, axis=0).max() <= 0.06 + 1e-15
    twice = make_support(kind, seed=8, size=0.06, friction=2.0)
    assert twice.position == pytest.approx(2.0 * contacts.position)


def test_shapes_of_supports():
    ring, bar, square = (make_support(k, 1).position for k in ("ring", "bar", "square"))
    assert np.hypot(*ring.T) == pytest.approx(np.full(60, 0.05))
    assert np.linalg.matrix_rank(bar, tol=1e-12) == 1
    assert len({tuple(r) for r in square.round(9)}) == 144
    assert np.abs(square).max() == pytest.approx(0.05 * 11 / 12)
    assert len(make_support("three points")) == 3
    assert len(make_support("ten points")) == 10
    assert not np.allclose(
        make_support("three points", 1).position, make_support("three points", 2).position
    )


@pytest.mark.parametrize(
    ("change", "argument"),
    [
        ({"surface": "ring"}, "surface"),
        ({"surface": Ellipsoid(np.zeros(2), np.eye(2))}, "surface"),
        ({"n": 0}, "n"),
        ({"n": 2.5}, "n"),
        ({"noise": -0.1}, "load"),
        ({"seed": "a"}, "seed"),
        ({"rho": 0.0}, "rho"),
        ({"distance": np.inf}, "distance"),
    ],
)
def test_wrong_arguments_are_named(change, argument):
    good = {"surface": make_support("ring").limit_surface(), "n": 5, "rho": RHO}
    with pytest.raises(InputError) as caught:
        make_sliding_data(**(good | change))
    assert caught.value.argument == argument


@pytest.mark.parametrize(
    ("change", "argument"),
    [({"kind": "star"}, "kind"), ({"size": 0.0}, "size"), ({"friction": -1.0}, "friction")],
)
def test_wrong_supports_are_named(change, argument):
    with pytest.raises(InputError) as caught:
        make_support(**({"kind": "ring"} | change))
    assert caught.value.argument == argument
