"""Animations show where things are at a time, in millimetres."""

import numpy as np
import pytest
import shapely
from matplotlib.figure import Figure

from limitsurf.actuators.activation import squeeze_activation
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.motion.schedule import Schedule
from limitsurf.motion.simulate import simulate
from limitsurf.motion.walk import walk
from limitsurf.plot import animate
from limitsurf.plot.scene import Feet, Outline, Path, Tips

POSE = np.array([1e-3, -2e-3, np.pi / 2])


@pytest.fixture
def axes():
    return Figure().add_subplot()


def rendered(animation, tmp_path):
    """Return the axes after the last frame, and how many frames were drawn."""
    from PIL import Image

    animation.save(tmp_path / "motion.gif", writer="pillow", dpi=50)
    with Image.open(tmp_path / "motion.gif") as image:
        count = getattr(image, "n_frames", 1)
    return animation._fig.axes[0], count


def legs(side):
    """Return a pushing leg on a side, and one or two passive ones: gaits change their number."""
    places = [[0.0, 1e-3 * side], [1e-3, 0.0], [-1e-3, 0.0]][: 2 if side < 0 else 3]
    pushes = np.zeros((len(places), 2))
    pushes[0, 0] = 1e-6
    return ContactSet(places, 1e-8, pushes)


def test_a_part_on_its_array(paper_t, array64, tmp_path):
    drive = squeeze_activation(array64, 0.3)
    motion = simulate(paper_t, drive, (0.0, 1e-3, 1.0), 0.5)
    axes, count = rendered(animate(motion, paper_t, drive, frames=3), tmp_path)
    assert count == 3
    assert axes.get_title(loc="left") == f"{motion.duration:.3g} s"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [mm]", "y [mm]")
    outlines = [line.get_xydata() for line in axes.lines]
    bounds = 1e3 * np.array(paper_t.at(motion.final_pose).bounds)
    drawn = max(outlines, key=lambda xy: np.ptp(xy[:, 0]) if len(xy) else 0.0)
    assert [*drawn.min(axis=0), *drawn.max(axis=0)] == pytest.approx(bounds, abs=1e-9)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    assert left < bounds[0] < bounds[2] < right
    assert bottom < bounds[1] < bounds[3] < top


def test_a_walker_on_its_legs(tmp_path):
    gait = Schedule([(0.0, legs(1.0)), (0.2, legs(-1.0))], period=0.4)
    motion = walk(gait, 0.7, drag=(1e-3, 1e-3, 1e-9))
    axes, count = rendered(animate(motion, gait, frames=4), tmp_path)
    assert count == 4
    assert axes.get_title(loc="left") == "0.7 s"


def test_what_is_at_rest_is_one_picture(tmp_path):
    held = ContactSet([[0.0, 0.0]], 1.0)
    motion = walk(held, 1.0, drag=(1.0, 1.0, 1.0))
    _, count = rendered(animate(motion, held), tmp_path)
    assert count == 1


def test_a_part_with_feet_of_its_own(paper_t, tmp_path):
    feet = legs(1.0)
    motion = walk(feet, 0.5, drag=(1e-3, 1e-3, 1e-9))
    axes, _ = rendered(animate(motion, paper_t, feet, frames=2), tmp_path)
    assert len(axes.patches) == 2  # part and hull of the feet
    assert len(axes.collections) == 2  # feet and arrows


def test_feet_move_and_switch(axes):
    gait = Schedule([(0.0, legs(1.0)), (0.2, legs(-1.0))], period=0.4)
    piece = Feet(axes, gait)
    piece.show(0.3, POSE)
    placed = 1e3 * POSE[:2] + np.array([[1.0, 0.0], [0.0, 1.0]])  # a quarter turn
    assert np.array(piece.places.get_offsets()) == pytest.approx(placed, abs=1e-12)
    shown = [arrows for arrows in piece.arrows.values() if arrows.get_visible()]
    assert len(shown) == 1
    turned = np.column_stack([shown[0].U, shown[0].V])
    assert turned == pytest.approx(np.array([[0.0, 0.7 / np.sqrt(3)], [0.0, 0.0]]), abs=1e-12)
    piece.show(0.45, np.zeros(3))
    assert len(piece.places.get_offsets()) == 3


def test_tips_under_the_part_are_marked(axes, paper_t, array64):
    first, second = (squeeze_activation(array64, angle) for angle in (0.0, 1.0))
    box = (-6.4e-3, -6.4e-3, 6.4e-3, 6.4e-3)
    piece = Tips(axes, Schedule([(0.0, first), (1.0, second)]), paper_t, box)
    piece.show(1.5, POSE)
    visible = {key for key, (_, arrows) in piece.arrows.items() if arrows.get_visible()}
    assert visible == {id(second)}
    places, arrows = piece.arrows[id(second)]
    assert len(places) == second.active.sum()
    colors = arrows.get_facecolor()
    shape = paper_t.at(POSE)
    under = [shape.contains(shapely.Point(place)) for place in places]
    assert len(np.unique(colors, axis=0)) == 2
    assert len(np.unique(colors[under], axis=0)) == 1
    assert 0 < sum(under) < len(places)
    r, c = np.nonzero(second.active)
    assert np.column_stack([arrows.U, arrows.V]) == pytest.approx(
        0.17 * second.array.site_directions[r, c]
    )
    assert np.column_stack([arrows.X, arrows.Y]) == pytest.approx(1e3 * places)
    near = Tips(axes, Schedule([(0.0, first)]), paper_t, (0.0, 0.0, 1e-3, 1e-3))
    ((few, _),) = near.arrows.values()
    assert len(few) == 25  # one a pixel of 0.2 mm
    assert few.min() >= 0.0
    assert few.max() <= 1e-3


def test_an_outline_with_a_hole_keeps_it(axes):
    frame = shapely.box(0, 0, 3e-3, 3e-3) - shapely.box(1e-3, 1e-3, 2e-3, 2e-3)
    piece = Outline(axes, Part(frame))
    piece.show(0.0, POSE)
    x, y = piece.fill.get_xy().T
    area = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    assert area == pytest.approx(8.0)  # mm^2, the hole left out


def test_the_path_grows(axes):
    times, poses = np.array([0.0, 1.0, 2.0]), np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0]]) * 1e-3
    piece = Path(axes, times, poses)
    piece.show(1.5, np.array([1e-3, 0.5e-3, 0.0]))
    assert piece.line.get_xydata() == pytest.approx(np.array([[0, 0], [1, 0], [1, 0.5]]))
    assert piece.center.get_xydata() == pytest.approx(np.array([[1, 0.5]]))


@pytest.mark.parametrize(
    ("changed", "argument"),
    [
        ({"frames": 0}, "frames"),
        ({"seconds": 0.0}, "seconds"),
        ({"body": "part"}, "body"),
        ({"drive": legs(1.0)}, "body"),
        ({"body": Part([(0, 0), (1e-3, 0), (0, 1e-3)]), "drive": "array"}, "drive"),
    ],
)
def test_bad_arguments_are_named(changed, argument):
    motion = walk(legs(1.0), 1.0, drag=(1.0, 1.0, 1.0))
    with pytest.raises(InputError) as found:
        animate(**({"trajectory": motion, "body": legs(1.0)} | changed))
    assert found.value.argument == argument
