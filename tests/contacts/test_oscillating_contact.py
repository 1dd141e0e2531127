"""Oscillating tips: closed forms, limits, symmetries, what is refused, and a shaken block."""

import numpy as np
import pytest
import shapely

from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.errors import InputError

PHASE = np.arange(64) / 64
SINE = np.sin(2 * np.pi * PHASE)
SAWTOOTH = np.where(PHASE < 0.75, 1.0, -3.0)
WITH_REST = np.where(PHASE < 0.5, np.sin(4 * np.pi * PHASE), 0.0)


def lossy_tip(**changed):
    """Return a tip that presses more while it moves forwards."""
    given = {
        "mu": 0.5,
        "direction": [3.0, 4.0],
        "tip_velocity": 2.0 * SINE,
        "normal_force": 1.0 + 0.5 * SINE,
    }
    return OscillatingContact(**(given | changed))


def random_tips(rng, shape=(6,), samples=16):
    return OscillatingContact(
        rng.uniform(0.1, 1.0, shape),
        rng.normal(size=(*shape, 2)),
        rng.normal(size=(*shape, samples)),
        rng.uniform(0.0, 1.0, (*shape, samples)),
    )


def test_a_symmetric_waveform_gives_no_offset():
    for w in (SINE, np.sin(2 * np.pi * PHASE + 0.3), np.where(PHASE < 0.5, 1.0, -1.0)):
        tip = lossy_tip(tip_velocity=w, normal_force=1.0)
        assert tip.offset == pytest.approx([0.0, 0.0], abs=1e-15)
        assert tip.drift_velocity == pytest.approx([0.0, 0.0], abs=1e-15)


def test_a_conservative_contact_gives_no_offset():
    """N even about the peak and w odd (design: why there is a bias at all)."""
    tip = lossy_tip(normal_force=np.maximum(np.cos(2 * np.pi * PHASE), 0.0))
    assert tip.offset == pytest.approx([0.0, 0.0], abs=1e-15)


def test_the_offset_of_a_sine_is_known():
    """mean(mu (1 + c sin) sign(sin)) = 2 mu c / pi, up to the error of 64 samples joined."""
    tip = lossy_tip()
    assert tip.offset == pytest.approx(np.array([0.6, 0.8]) * 0.5 * 0.5 * 2 / np.pi, rel=1e-3)
    fine = lossy_tip(
        tip_velocity=lambda s: np.sin(2 * np.pi * s),
        normal_force=lambda s: 1.0 + 0.5 * np.sin(2 * np.pi * s),
        samples=4096,
    )
    assert np.linalg.norm(fine.offset) == pytest.approx(0.5 / np.pi, rel=1e-6)
    assert fine.sampling_error[0] < 1e-6


def test_a_sawtooth_carries_the_part_forwards():
    tip = OscillatingContact(0.5, [0.0, 1.0], [1.0, 1.0, 1.0, -3.0], 2.0)
    # of four pieces two go forwards; of each of the others a quarter
    assert tip.offset == pytest.approx([0.0, (2.5 - 1.5) / 4])
    assert tip.drift_velocity == pytest.approx([0.0, 1.0])
    assert tip.radius == 0.0


def test_rest_for_a_known_part_of_the_cycle():
    tip = OscillatingContact(0.5, [1.0, 0.0], [0.0, 0.0, 0.0, 3.0, 0.0, -3.0], 2.0)
    assert tip.radius == pytest.approx(0.5 * 2.0 / 3)
    assert tip.offset == pytest.approx([0.0, 0.0], abs=1e-16)
    forces = tip.active_set()
    d = np.array([[1.0, 0.0], [0.6, 0.8]])
    assert forces.support(d) == pytest.approx(np.full(2, 1.0 / 3))
    assert tip.passive_set().support(d) == pytest.approx(np.full(2, 1.0))


def test_the_active_set_is_the_sub_gradient_at_rest(rng):
    """-dPhi(0): minus the gradients just beside u = 0."""
    tip = OscillatingContact(0.3, [1.0, 2.0], WITH_REST + 0.3 * np.abs(WITH_REST), 1.0 + PHASE)
    angle = rng.uniform(0.0, 2 * np.pi, 20)
    d = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    near = -tip.gradient(-1e-9 * d)
    assert near == pytest.approx(tip.offset + tip.radius * d, abs=1e-7)
    h = tip.potential(-1e-9 * d) - tip.potential([0.0, 0.0])
    assert tip.active_set().support(d) == pytest.approx(h / 1e-9, abs=1e-6)


def test_far_away_friction_is_passive(rng):
    tips = random_tips(rng)
    u = 1e4 * np.array([0.6, -0.8])
    expected = tips.passive_radius[:, None] * u / 1e4
    assert tips.gradient(u) == pytest.approx(expected, abs=1e-3)
    assert tips.potential(u) == pytest.approx(tips.passive_radius * 1e4, rel=1e-3)


def test_potentials_are_convex_and_dissipate(rng):
    tips = random_tips(rng)
    u, v = rng.normal(size=(2, 200, 1, 2))
    middle = tips.potential(0.5 * (u + v))
    assert np.all(middle <= 0.5 * (tips.potential(u) + tips.potential(v)) + 1e-15)
    assert np.all(np.linalg.eigvalsh(tips.hessian(u)) >= -1e-13)
    # power of friction and tips together: mean of mu N |u - w|
    assert np.all(tips.potential(u) >= 0.0)
    # part and friction at u beside part and friction at v: monotone
    g = tips.gradient(u) - tips.gradient(v)
    assert np.all((g * (u - v)).sum(axis=-1) >= -1e-15)


def test_gradient_and_hessian_are_the_differences(rng):
    tips = random_tips(rng)
    u, h = rng.normal(size=(50, 1, 2)), 1e-5
    for k, step in enumerate(h * np.eye(2)):
        slope = (tips.potential(u + step) - tips.potential(u - step)) / (2 * h)
        assert slope == pytest.approx(tips.gradient(u)[..., k], abs=1e-6)
        near = np.abs(np.einsum("...k,jk->...j", u[:, 0], tips.direction @ [[0, 1], [-1, 0]])) < 0.1
        bend = (tips.gradient(u + step) - tips.gradient(u - step)) / (2 * h)
        off = np.abs(bend - tips.hessian(u)[..., k]).max(axis=-1)
        assert off[~near].max() < 1e-6


def test_a_rotation_turns_everything(rng):
    tip = lossy_tip()
    c, s = 0.6, -0.8
    R = np.array([[c, -s], [s, c]])
    turned = lossy_tip(direction=R @ [3.0, 4.0])
    u = rng.normal(size=(20, 2))
    assert turned.potential(u @ R.T) == pytest.approx(tip.potential(u), rel=1e-14)
    assert turned.gradient(u @ R.T) == pytest.approx(tip.gradient(u) @ R.T, abs=1e-14)
    assert turned.hessian(u @ R.T) == pytest.approx(R @ tip.hessian(u) @ R.T, abs=1e-12)
    assert turned.offset == pytest.approx(R @ tip.offset, abs=1e-15)


def test_tips_together_are_the_tips_alone(rng):
    tips, u = random_tips(rng, (2, 3)), rng.normal(size=(5, 1, 1, 2))
    assert tips.potential(u).shape == (5, 2, 3)
    assert tips.hessian(u).shape == (5, 2, 3, 2, 2)
    for i in np.ndindex(2, 3):
        alone = tips[i]
        assert alone.shape == ()
        assert tips.gradient(u)[(slice(None), *i)] == pytest.approx(
            alone.gradient(u[:, 0, 0]), rel=1e-14
        )
        assert tips.offset[i] == pytest.approx(alone.offset, rel=1e-14)
        assert tips.drift_velocity[i] == pytest.approx(alone.drift_velocity, rel=1e-14)
    assert tips[1].shape == (3,)
    assert len(tips) == 2
    contacts = tips[0].contact_set(np.eye(3, 2))
    assert contacts.offset == pytest.approx(tips[0].offset)


@pytest.mark.parametrize("speed", [0.0, 0.1, 1.0, 10.0])
@pytest.mark.parametrize("w", [SINE, SAWTOOTH, WITH_REST])
def test_reach_holds_the_friction_at_all_speeds_up_to_its_own(rng, w, speed):
    tip = lossy_tip(tip_velocity=w)
    outline = tip.reach(speed)
    angle, r = rng.uniform(0, 2 * np.pi, 500), speed * np.sqrt(rng.uniform(0, 1, 500))
    f = -tip.gradient(r[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1))
    distance = shapely.distance(outline, shapely.points(f))
    assert distance.max() <= 1e-4 * tip.passive_radius
    assert shapely.distance(outline, shapely.Point(tip.offset)) <= 1e-12


def test_reach_grows_from_the_active_to_the_passive_set():
    tip = lossy_tip(tip_velocity=WITH_REST)
    areas = [tip.reach(U).area for U in (0.0, 0.01, 0.1, 1.0, 100.0)]
    assert areas == sorted(areas)
    assert areas[0] == pytest.approx(np.pi * tip.radius**2, rel=1e-3)
    assert areas[-1] == pytest.approx(np.pi * tip.passive_radius**2, rel=2e-3)
    assert lossy_tip().reach(0.0).geom_type == "Point"
    assert lossy_tip(mu=0.0).reach(1.0).geom_type == "Point"


def shaken(w_of, N_of, push, periods=300, steps=2000):
    """Return the mean speed in the last tenth of a block on a shaken tip: v' = -push N sign(v - w).

    Implicit steps are exact for Coulomb friction: the tip drags the block towards its own speed,
    by at most push N dt. Period 1.
    """
    phase = (np.arange(steps) + 1.0) / steps
    w, most = w_of(phase).tolist(), (push * N_of(phase) / steps).tolist()
    v, last = 0.0, []
    for period in range(periods):
        for k in range(steps):
            v = min(max(w[k], v - most[k]), v + most[k])
            if period >= 0.9 * periods:
                last.append(v)
    return np.mean(last)


def one(s):
    return np.ones_like(s)


def ramps(s):
    """Return a sawtooth with finite ramps: 0.6 forwards at 1, back at -1.5, mean 0."""
    return np.interp(s % 1.0, [0.0, 0.05, 0.6, 0.65, 0.95, 1.0], [0.0, 1.0, 1.0, -1.5, -1.5, 0.0])


def rests(s):
    """Return a waveform that rests for 0.2 of the period, goes forwards for 0.55."""
    return np.interp(s % 1.0, [0.0, 0.1, 0.5, 0.55, 0.75, 0.8, 1.0], [0, 1.0, 0.8, 0, 0, -2.0, 0])


@pytest.mark.parametrize(
    ("w", "N", "speed"),
    [
        (lambda s: np.sin(2 * np.pi * s), one, 1.0),
        (lambda s: np.sin(2 * np.pi * s), lambda s: 1.0 + 0.8 * np.sin(2 * np.pi * s), 1.0),
        (ramps, one, 1.5),
        (rests, one, 2.0),
        (rests, lambda s: 1.0 + 0.5 * np.cos(2 * np.pi * s), 2.0),
    ],
    ids=["sine", "sine, pressing forwards", "sawtooth", "rest phase", "rest phase, lossy"],
)
@pytest.mark.parametrize("ripple", [0.2, 0.05])
def test_a_block_on_a_shaken_tip_drifts_as_the_potential_says(w, N, speed, ripple):
    """Drift within 0.25 ripple A, ripple = mu g / (f A): the block is heavy for one period."""
    tip = OscillatingContact(1.0, [1.0, 0.0], w, N, samples=400)
    drift = shaken(w, N, ripple * speed)
    assert abs(drift - tip.drift_velocity[0]) <= 0.25 * ripple * speed


@pytest.mark.parametrize(
    ("changed", "argument"),
    [
        ({"mu": -0.1}, "mu"),
        ({"mu": np.nan}, "mu"),
        ({"direction": [0.0, 0.0]}, "direction"),
        ({"direction": [1.0, 0.0, 0.0]}, "direction"),
        ({"tip_velocity": [1.0, np.inf]}, "tip_velocity"),
        ({"tip_velocity": []}, "tip_velocity"),
        ({"tip_velocity": lambda s: s}, "tip_velocity"),
        ({"tip_velocity": lambda s: np.zeros(3)}, "tip_velocity"),
        ({"normal_force": lambda s: 1.0 + 0.1 * s}, "normal_force"),
        ({"normal_force": SINE}, "normal_force"),
        ({"normal_force": np.ones(63)}, "normal_force"),
        ({"normal_force": "much"}, "normal_force"),
        ({"samples": 1}, "samples"),
        ({"samples": np.nan}, "samples"),
        ({"mu": "dry"}, "mu"),
        ({"mu": np.ones(2), "tip_velocity": np.zeros((3, 64))}, "contacts"),
    ],
)
def test_bad_arguments_are_named(changed, argument):
    with pytest.raises(InputError) as caught:
        lossy_tip(**changed)
    assert caught.value.argument == argument


def test_bad_queries_are_named():
    tips = lossy_tip(mu=np.full(3, 0.5))
    for call, argument in (
        (lambda: tips.potential([1.0, 2.0, 3.0]), "u"),
        (lambda: tips.potential(np.zeros((2, 2))), "u"),
        (lambda: tips.potential([np.nan, 0.0]), "u"),
        (lambda: tips.hessian([0.0, 0.0], width=0.0), "width"),
        (lambda: tips.reach(1.0), "reach"),
        (lambda: tips.active_set(), "active_set"),
        (lambda: lossy_tip().reach(-1.0), "speed"),
        (lambda: lossy_tip().reach("slow"), "speed"),
        (lambda: lossy_tip().reach(1.0, tol=0.0), "tol"),
    ):
        with pytest.raises(InputError) as caught:
            call()
        assert caught.value.argument == argument
