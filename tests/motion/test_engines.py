"""What `simulate` does with each kind of drive, and schedules of feet and fields."""

from dataclasses import replace

import numpy as np
import pytest
import xarray

from limitsurf.actuators.activation import squeeze_activation
from limitsurf.actuators.density_field import DensityField
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.contacts.uniform_friction import UniformFriction
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.feet import feet_motion
from limitsurf.motion.field_motion import field_motion
from limitsurf.motion.load_table import LoadTable
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.simulate import simulate
from limitsurf.motion.simulate_many import simulate_many
from limitsurf.motion.trajectory import EventKind, Outcome


@pytest.fixture(scope="module")
def block():
    return Part([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)], 100.0)


@pytest.fixture(scope="module")
def feet():
    return ContactSet(0.05 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]), 0.25)


def test_feet_and_fields_go_to_their_engines(block, feet):
    start, twist = (0.1, 0.2, 0.3), (0.3, 0.1, 4.0)
    one = simulate(block, feet, start, 1.0, twist=twist)
    other = feet_motion(block, feet, start, 1.0, twist=twist)
    assert np.array_equal(one.poses, other.poses)
    field, drag = DensityField.squeeze(0.3, 5.0), (0.5, 0.5, 1e-3)
    one = simulate(block, field, start, drag=drag, mode="quasi-static")
    other = field_motion(block, field, start, drag=drag, mode="quasi-static")
    assert np.array_equal(one.poses, other.poses)
    assert one.outcome is Outcome.REST


def test_tilt_pulls_at_feet_and_in_fields(block, feet):
    from scipy.constants import g

    hold = 0.25 * 4 / (block.mass * g)
    held = simulate(block, feet, duration=10.0, tilt=(0.0, np.arcsin(hold * (1 - 1e-6))))
    assert held.outcome is Outcome.REST
    assert np.array_equal(held.final_pose, np.zeros(3))
    slides = simulate(block, feet, duration=1.0, tilt=(0.0, np.arcsin(2 * hold)))
    fall = 0.5 * 1.0 / block.mass  # half of the net force over the mass
    assert slides.final_pose[1] == pytest.approx(fall, rel=1e-6)
    friction = UniformFriction.under_weight(block, 0.3)
    still = DensityField.uniform(0.0, 0.0)
    rest = simulate(block, still, friction=friction, tilt=(0.29, 0.0), duration=1.0)
    assert rest.outcome is Outcome.REST


def test_a_cart_takes_turns(block):
    """Two sets of feet in turn: the joined record is that of the two motions."""
    corners = 0.05 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    push = np.array([[1.0, 0.0]] * 4)
    forward, still = ContactSet(corners, 0.1, push), ContactSet(corners, 0.25)
    plan = Schedule([(0.0, forward), (0.2, still)])
    path = simulate(block, plan, duration=5.0, method="events")
    first = simulate(block, forward, duration=0.2)
    second = simulate(block, still, first.final_pose, 4.8, twist=first.twists[-1])
    assert path.final_pose == pytest.approx(second.final_pose, abs=1e-12)
    assert path.duration == pytest.approx(0.2 + second.duration)
    assert np.all(np.diff(path.times) >= 0.0)
    assert [e.kind for e in path.events if e.kind is EventKind.SWITCH] == [EventKind.SWITCH]
    size = path.energy.work.max()
    assert size == pytest.approx(first.energy.work[-1])
    assert np.abs(path.energy.residual).max() < 1e-6 * size


def test_fields_in_turn_wait_at_rest(block):
    squeeze = [DensityField.squeeze(a, 5.0) for a in (0.0, 0.5 * np.pi)]
    plan = Schedule([(0.0, squeeze[0]), (50.0, squeeze[1])])
    path = simulate(
        block,
        plan,
        (0.01, 0.02, 0.5),
        100.0,
        drag=(0.5, 0.5, 1e-3),
        mode="quasi-static",
    )
    assert path.final_pose[:2] == pytest.approx([0.0, 0.0], abs=1e-6)
    kinds = [e.kind for e in path.events]
    assert kinds == [EventKind.REST, EventKind.SWITCH, EventKind.START, EventKind.REST]


def test_a_part_that_waits_rests_once(block):
    squeeze, kind = DensityField.squeeze(0.0, 5.0), {"drag": (0.5, 0.5, 1e-3)}
    plan = Schedule([(0.0, squeeze), (50.0, squeeze), (60.0, squeeze)])
    path = simulate(block, plan, (0.01, 0.02, 0.5), 100.0, mode="quasi-static", **kind)
    kinds = [e.kind for e in path.events]
    assert kinds == [EventKind.REST, EventKind.SWITCH, EventKind.SWITCH]


def test_the_pieces_of_a_gait_share_the_frames(block, feet):
    push = ContactSet(feet.position, 0.1, np.array([[1.0, 0.0]] * 4))
    gait = Schedule([(0.0, push), (0.01, feet)], period=0.02)
    path = simulate(block, gait, duration=2.0, frames=400, method="steps")
    assert 400 <= len(path.times) <= 602  # and those at the switches


def test_an_interrupted_gait_leaves_a_readable_file(block, feet, tmp_path, monkeypatch):
    import xarray

    from limitsurf.motion import engines

    moved = []

    def interrupted(*arguments, **options):
        if len(moved) == 3:
            raise KeyboardInterrupt
        moved.append(feet_motion(*arguments, **options))
        return moved[-1]

    monkeypatch.setattr(engines, "feet_motion", interrupted)
    push = ContactSet(feet.position, 0.1, np.array([[1.0, 0.0]] * 4))
    gait = Schedule([(0.0, push), (0.1, feet)], period=0.2)
    with pytest.raises(KeyboardInterrupt):
        simulate(block, gait, duration=2.0, save=tmp_path / "gait.nc")
    with xarray.open_dataset(tmp_path / "gait.nc", engine="scipy") as data:
        assert data.attrs["outcome"] == "interrupted"
        assert float(data.time[-1]) == pytest.approx(0.3)


@pytest.mark.parametrize("first", [0, 1, 2])
def test_schedules_of_different_kinds_are_named(block, feet, array64, first):
    kinds = [feet, DensityField.squeeze(0.0, 5.0), squeeze_activation(array64, 0.0)]
    plan = Schedule([(0.0, kinds[first]), (0.1, kinds[first - 1])])
    with pytest.raises(InputError, match="drive: has a"):
        simulate(block, plan, duration=1.0, drag=(1, 1, 1e-3))


def test_a_table_of_loads_lasts_for_all_fields_in_turn(block):
    table = LoadTable(lambda t: (np.sin(t), 0.0, 0.0), 0.1)
    squeeze = DensityField.squeeze(0.0, 5.0)
    plan = Schedule([(0.0, squeeze), (0.05, squeeze)])
    with pytest.raises(InputError, match="load: is a table of"):
        simulate(block, plan, duration=1.0, load=table, drag=(1, 1, 1e-3))


def test_many_starts_of_any_drive(block, feet):
    starts = np.array([[0, 0, 0], [0, 0, 1.0]])
    runs = simulate_many(block, DensityField.squeeze(0.0, 5.0), starts, drag=(1, 1, 1e-3))
    assert len(runs) == 2
    assert runs.count(Outcome.REST) == 2


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"duration": None}, "duration"),
        ({"tip": OscillatingContact(0.5, [1.0, 0.0], [1.0, -1.0], 1.0)}, "tip"),
        ({"time_step": 1e-3, "method": "events"}, "time_step"),
        ({"duration": -1.0}, "duration"),
        ({"mode": "quasi-static"}, "drag"),
    ],
)
def test_options_that_do_not_fit_feet_are_named(block, feet, change, name):
    with pytest.raises(InputError) as caught:
        simulate(block, feet, **({"duration": 1.0} | change))
    assert caught.value.argument == name


def test_options_that_do_not_fit_arrays_and_fields_are_named(array64, paper_t, block):
    friction = UniformFriction.under_weight(block, 0.3)
    with pytest.raises(InputError, match="friction: is not for arrays"):
        simulate(paper_t, squeeze_activation(array64, 0.0), friction=friction)
    with pytest.raises(InputError, match="duration: is missing"):
        simulate(block, Schedule([(0.0, DensityField.squeeze(0.0, 1.0))]))
    with pytest.raises(InputError, match="drag: "):
        simulate(block, DensityField.squeeze(0.0, 1.0), mode="quasi-static")


def test_events_on_an_array_go_with_schedules_slopes_and_loads(array64):
    """The same motion as in small steps, on points: one drive after the other, on a slope."""
    pixel = replace(array64.pixel, tip_width=0.0, residual_fraction=0.0)
    array = replace(array64, pixel=pixel)
    part = Part(1e-4 * np.array([(0, 0), (18, 2), (21, 13), (9, 11), (3, 19)]), "80 g/m^2")
    plan = Schedule([(0.0, squeeze_activation(array, 0.4)), (0.05, squeeze_activation(array, 1.2))])
    options = {
        "mode": "quasi-static",
        "tilt": (2e-4, -1e-4),
        "load": lambda t: (1e-10 * np.sin(40 * t), 0.0, 0.0),
    }
    start = (3e-4, 2e-4, 0.7)
    path = simulate(part, plan, start, 0.1, method="events", **options)
    kinds = [e.kind for e in path.events]
    assert kinds.count(EventKind.SWITCH) == 1
    assert kinds.count(EventKind.ENTER) > 3
    assert np.all(np.diff(path.times) >= 0.0)
    scale = [array.site_pitch, array.site_pitch, array.site_pitch / part.circumradius]
    errors = []
    for step in (1e-4, 2.5e-5):
        steps = simulate(part, plan, start, 0.1, time_step=step, **options)
        errors.append(np.abs((steps.final_pose - path.final_pose) / scale).max())
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < 2e-3
    with pytest.raises(InputError, match="drive: is a function of time"):
        simulate(part, plan.at, start, 0.1, method="events")
    tip = OscillatingContact(0.5, [1.0, 0.0], [1.0, -1.0], 1.0)
    with pytest.raises(InputError, match="tip: is not for events"):
        simulate(part, plan, start, 0.1, method="events", tip=tip)


@pytest.mark.parametrize("inside", ["alone", "in turn"])
def test_interrupted_events_leave_a_readable_file(array64, paper_t, tmp_path, monkeypatch, inside):
    """A load that fails after a while stands for the user's interrupt."""
    file, drive = tmp_path / "run.nc", squeeze_activation(array64, 0.0)
    plan = drive if inside == "alone" else Schedule([(0.0, drive), (0.01, drive)])
    table = LoadTable(lambda t: (1e-12 * t, 0.0, 0.0), 2.0)

    def interrupt(self, time):
        if time > 0.02:
            raise KeyboardInterrupt
        return np.zeros(3)

    monkeypatch.setattr(LoadTable, "__call__", interrupt)
    options = {"mode": "quasi-static", "method": "events", "load": table}
    with pytest.raises(KeyboardInterrupt):
        simulate(paper_t, plan, (2e-4, 8e-4, 1.2), 2.0, save=file, **options)
    with xarray.open_dataset(file, engine="scipy") as data:
        assert data.attrs["outcome"] == "interrupted"
        assert data.sizes["time"] > 2
        assert data.time[-1] > 0.01
        assert np.isfinite(data.poses.values).all()
