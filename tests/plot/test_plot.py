"""Pictures show the numbers of the objects, with units on their axes."""

import numpy as np
import pytest
import shapely
import shapely.affinity

from limitsurf import plot
from limitsurf.actuators.actuator_array import load_array
from limitsurf.contacts.coulomb import coulomb_contact
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.alignment import plan_alignment
from limitsurf.planning.diameter_function import diameter_function
from limitsurf.planning.turn_function import turn_function
from limitsurf.planning.verification import verify_alignment
from limitsurf.sets.minkowski_sum import MinkowskiSum
from tests.sets.specimens import SPECIMENS


@pytest.fixture(scope="module")
def turn():
    return turn_function(Part.from_file("paper_t"))


@pytest.fixture(scope="module")
def verification(paper_t, array64):
    return verify_alignment(plan_alignment(paper_t), paper_t, array64, samples=3, seed=2)


def trace(figure, name):
    return next(t for t in figure.data if t.name == name)


def labels(figure):
    return figure.layout.xaxis.title.text, figure.layout.yaxis.title.text


def test_part(turn):
    figure = plot.draw_part(turn.part, turn)
    x = np.array(trace(figure, "paper_t").x)
    assert np.nanmax(x) - np.nanmin(x) == pytest.approx(4.8)
    stable = [t for t in figure.data if t.name == "stable median"]
    assert len(stable) == 2
    assert stable[0].line.width > 2 * trace(figure, "unstable median").line.width
    low, high = figure.layout.xaxis.range
    assert low < np.nanmin(x) < np.nanmax(x) < high
    assert labels(figure) == ("x [mm]", "y [mm]")


def test_turn_function(turn):
    figure = plot.draw_turn_function(turn)
    assert np.array(trace(figure, "stable").x) == pytest.approx(np.degrees(turn.stable))
    moment = trace(figure, "moment / largest moment")
    assert np.max(np.abs(moment.y)) == pytest.approx(1.0)
    assert labels(figure) == ("orientation phi [deg]", "turn function t [1]")


def test_squeeze_function_covers_all_orientations(turn):
    plan = plan_alignment(turn.part)
    steps = trace(plot.draw_squeeze_function(plan.squeeze), "squeeze function s")
    x = np.array(steps.x, dtype=float).reshape(-1, 3)
    assert np.sum(x[:, 1] - x[:, 0]) == pytest.approx(180.0)
    for (a, b, _), (y, _, _) in zip(x, np.array(steps.y).reshape(-1, 3), strict=True):
        assert np.degrees(plan.squeeze(np.radians((a + b) / 2))) == pytest.approx(y)


def test_plan_ends_in_one_orientation(turn):
    plan = plan_alignment(turn.part)
    ways = plot.draw_plan(plan).data[0]
    x, y = (np.array(v, dtype=float).reshape(-1, 3) for v in (ways.x, ways.y))
    ends = y[x[:, 1] == len(plan.lines), 1]
    assert np.mod(ends, 180.0) == pytest.approx(np.full(len(ends), np.degrees(plan.final)))


def test_errors(verification):
    figure = plot.draw_errors(verification)
    assert np.array(figure.data[0].x) == pytest.approx(np.degrees(verification.errors))
    assert "[deg]" in labels(figure)[0]
    low, high = figure.layout.xaxis.range
    assert [low, high] == [-high, high]
    assert high > max(np.abs(figure.data[0].x).max(), np.degrees(verification.tolerance))
    assert [s.x0 for s in figure.layout.shapes] == pytest.approx([-6.0, 6.0])


@pytest.mark.parametrize(("size", "name"), [(1e-6, "um"), (1e-3, "mm"), (1e3, "m")])
def test_the_unit_of_length_suits_the_part(size, name):
    """Numbers on the axes are about 1 for a part of any size."""
    part = Part(size * np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2.5), (0, 2.5)]))
    scale = {"um": 1e6, "mm": 1e3, "m": 1.0}[name]
    figure = plot.draw_part(part, turn_function(part))
    assert labels(figure) == (f"x [{name}]", f"y [{name}]")
    assert np.nanmax(trace(figure, "part").x) == pytest.approx(3.0 * size * scale)
    diameter = plot.draw_diameter_function(diameter_function(part))
    assert labels(diameter)[1] == f"distance of the jaws [{name}]"
    assert trace(diameter, "stable").y[0] == pytest.approx(2.5 * size * scale)
    phase = plot.draw_phase_portrait(part, paths=0)
    assert labels(phase)[1] == f"offset of the line from the centroid [{name}]"
    offset = turn_function(part).median(turn_function(part).stable[0])[0]
    assert trace(phase, "stable").y[0] == pytest.approx(offset * scale)


def test_animation_moves_the_part_from_start_to_end(verification):
    figure = plot.animate_runs(verification, runs=2, frames=10)
    assert len(figure.frames) == 20
    for k, frame in ((0, figure.frames[0]), (-1, figure.frames[-1])):
        for run in (0, 1):
            outline = frame.data[4 + run]
            shape = verification.part.at(verification.poses[run, k])
            bounds = np.array(shape.bounds) * 1e3
            assert np.nanmin(np.array(outline.x)) == pytest.approx(bounds[0], abs=2e-2)
            assert np.nanmax(np.array(outline.y)) == pytest.approx(bounds[3], abs=2e-2)
    shown = [[trace.visible for trace in frame.data[:4]] for frame in figure.frames]
    assert shown[0] == [True, True, False, False]
    assert shown[-1] == [False, False, True, True]
    assert [t.type for t in figure.frames[0].data[:4]] == ["heatmap", "scatter"] * 2
    assert len(figure.layout.sliders[0].steps) == 20
    assert [b.label for b in figure.layout.updatemenus[0].buttons] == ["Play", "Pause"]


def test_animation_colours_pixels_by_their_push(verification):
    figure = plot.animate_runs(verification, runs=1, frames=2)
    pushes = np.array(figure.data[0].z)  # line at 0 degrees: down above it, up below
    assert np.all(pushes[32:] == 3)
    assert np.all(pushes[:32] == 2)


def test_animation_of_a_push_squeeze_shows_the_line_beside_the_centre(paper_t):
    """The line is where the pixels change their push, a circumradius and more from the centre."""
    array = load_array("resonator128").running_under(paper_t)
    plan = plan_alignment(paper_t, model="push-squeeze")
    verification = verify_alignment(plan, paper_t, array, samples=1, seed=2)
    figure = plot.animate_runs(verification, runs=1, frames=2)
    pixels, line = figure.data[:2]
    rows = np.asarray(pixels.z)[:, 0]  # the first line lies at 0 degrees
    below, above = np.asarray(pixels.y)[rows == 2], np.asarray(pixels.y)[rows == 3]
    assert below.max() < np.mean(line.y) < above.min()
    assert np.mean(line.y) == pytest.approx(-1.1e3 * paper_t.circumradius)
    assert "after centring the part" in figure.layout.title.text


def drawn(trace):
    return np.column_stack([trace.x, trace.y, trace.z])


def test_the_bar_of_figures_8_and_9():
    """Two disks tilted by 45 degrees, and their sum: as wide as its support function everywhere."""
    contacts = [coulomb_contact([x, 0.0], 1.0) for x in (1.0, -1.0)]
    bar = MinkowskiSum(*contacts)
    figure = plot.draw_limit_surface(*contacts, bar, names=("at (1, 0)", "at (-1, 0)", "bar"))
    assert [t.name for t in figure.data] == ["at (1, 0)", "at (-1, 0)", "bar"]
    for sheet, slope in zip(figure.data[:2], (1.0, -1.0), strict=True):
        assert drawn(sheet)[:, 2] == pytest.approx(slope * drawn(sheet)[:, 1], abs=1e-9)
        assert np.ptp(drawn(sheet), axis=0) == pytest.approx([2.0, 2.0, 2.0], abs=1e-4)
    surface = drawn(figure.data[2])
    directions = np.random.default_rng(3).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for d in (np.vstack([np.eye(3), -np.eye(3)]), directions):
        reach = (d @ surface.T).max(axis=1)
        assert np.all(reach <= bar.support(d) + 1e-12)  # nothing is drawn outside
        assert reach == pytest.approx(bar.support(d), abs=6e-3)
    # where both disks hold the load, a ridge: no vertex of the mesh is farther than its ends
    assert surface[:, 0].max() == pytest.approx(2.0, abs=2e-3)
    axes = figure.layout.scene
    assert [axes.xaxis.title.text, axes.yaxis.title.text, axes.zaxis.title.text] == [
        "F<sub>x</sub> [N]",
        "F<sub>y</sub> [N]",
        "M [N m]",
    ]
    assert axes.aspectmode == "data"


def test_the_mesh_of_the_bar_is_closed_and_outward():
    """Volume of a sum of flat sets: area of each times the width of the other across it."""
    bar = MinkowskiSum(coulomb_contact([1.0, 0.0], 1.0), coulomb_contact([-1.0, 0.0], 1.0))
    (mesh,) = plot.draw_limit_surface(bar).data
    corners = drawn(mesh)[np.column_stack([mesh.i, mesh.j, mesh.k])]
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    exact = 2 * (np.pi * np.sqrt(2)) * (2 * np.sqrt(2))
    assert volume == pytest.approx(exact, rel=5e-3)
    assert volume < exact


@pytest.mark.parametrize("name", [name for name, S in SPECIMENS.items() if S.dim == 3])
def test_every_set_can_be_drawn(name):
    """Solids, sheets, segments and points, each as large as its support function says."""
    S = SPECIMENS[name]
    (trace,) = plot.draw_limit_surface(S).data
    flat = "point" in name or "segment" in name or name in ("no generators", "sum of no contacts")
    assert trace.type == ("scatter3d" if flat else "mesh3d")
    d = np.vstack([np.eye(3), -np.eye(3)])
    reach, h = (d @ drawn(trace).T).max(axis=1), S.support(d)
    size = np.abs(h + np.roll(h, 3)).max()
    assert np.all(reach <= h + 1e-9 * np.abs(h).max())
    assert reach == pytest.approx(h, abs=6e-3 * size + 1e-9)


def test_there_is_something_to_draw():
    with pytest.raises(InputError, match="surfaces"):
        plot.draw_limit_surface()
    with pytest.raises(InputError, match="meshes need 3"):
        plot.draw_limit_surface(SPECIMENS["ellipse"])


def test_alignment_ends_alike_with_the_median_on_the_line():
    """Whatever the start, the last column is the same; lines halve the part."""
    plan = plan_alignment(Part.from_file("paper_t"))
    starts = [0.3, 2.0]
    figure = plot.draw_alignment(plan, starts)
    outlines = [np.column_stack([t.x, t.y]) for t in figure.data if t.name == "paper_t"]
    lines = [np.column_stack([t.x, t.y]) for t in figure.data if t.name == "line"]
    assert len(outlines) == 2 * (1 + len(plan.lines))
    assert len(lines) == 2 * len(plan.lines)
    columns = 1 + len(plan.lines)
    shapes = [shapely.Polygon(outline) for outline in outlines]
    ends = [
        shapes[columns - 1],
        shapely.affinity.translate(shapes[-1], 0.0, lines[1][0, 1] - lines[3][0, 1]),
    ]
    assert ends[0].symmetric_difference(ends[1]).area < 1e-9 * ends[0].area
    for k, line in enumerate(lines):
        shape = shapes[k // len(plan.lines) * columns + 1 + k % len(plan.lines)]
        middle, along = line.mean(axis=0), line[1] - line[0]
        normal = np.array([-along[1], along[0]])
        half = np.array(
            [
                middle - 2 * along,
                middle + 2 * along,
                middle + 2 * along + 3 * normal,
                middle - 2 * along + 3 * normal,
            ]
        )
        assert shape.intersection(shapely.Polygon(half)).area == pytest.approx(shape.area / 2)
    assert figure.layout.xaxis.ticktext == ("start", "line 1<br>0.0 deg", "line 2<br>45.0 deg")
    low, high = figure.layout.xaxis.range
    assert all(low <= s.bounds[0] and s.bounds[2] <= high for s in shapes)
    with pytest.raises(InputError, match="starts"):
        plot.draw_alignment(plan, 0.3)
