"""Logs that are made up: known loads come out, and broken logs are named by line."""

import numpy as np
import pytest

from limitsurf.datasets.push_log import read_push_log
from limitsurf.errors import DataError, InputError
from tests.datasets.logs import push_text, turn, turning_tip_text

PUSHES = [
    {
        "before": (0.6, 0.03, 0.4),
        "after": (0.61, 0.035, 0.52),
        "point": np.array([-0.05, 0.02]),
        "force": np.array([3.0, -1.0]),
    },
    {  # turns through pi
        "before": (0.6, 0.03, 3.1),
        "after": (0.59, 0.03, 3.25),
        "point": np.array([0.01, 0.06]),
        "force": np.array([0.5, -2.0]),
        "tip_angle": -3.0,
    },
]


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "log.txt"
    file.write_text("2\n" + "".join(push_text(**push) for push in PUSHES))
    return file


def test_known_loads_and_motions_come_out(path):
    pushes = read_push_log(path)
    assert len(pushes) == 2
    for push, truth in zip(pushes, PUSHES, strict=True):
        load = [*truth["force"], np.linalg.det([truth["point"], truth["force"]])]
        assert push.averaged.tolist() == [False] * 11 + [True] * 29
        assert push.loads == pytest.approx(np.tile(load, (29, 1)), abs=1e-9)
        moved = np.array(truth["after"]) - truth["before"]
        moved[:2] = turn(truth["before"][2]).T @ moved[:2]
        assert push.displacement == pytest.approx(moved, abs=1e-12)
        assert push.force_time == pytest.approx(0.01 * np.arange(40), abs=1e-6)
        assert push.tip[:, 2] == pytest.approx(np.full(40, truth.get("tip_angle", 0.7)))


def test_forces_are_in_world_axes(path):
    push, truth = read_push_log(path)[0], PUSHES[0]
    ends = [turn(truth["before"][2]) @ truth["force"], turn(truth["after"][2]) @ truth["force"]]
    assert push.force[11] == pytest.approx(ends[0])
    assert push.force[-1] == pytest.approx(ends[1])
    assert push.force[:11] == pytest.approx(np.zeros((11, 2)))


def test_tips_turn_through_pi_between_their_samples(tmp_path):
    log = tmp_path / "log.txt"
    log.write_text("1\n" + turning_tip_text((3.0, 3.3)))
    (push,) = read_push_log(log)
    assert len(push.tip) == 14
    assert push.tip_at_samples[:, 2] == pytest.approx(np.linspace(3.0, 3.3, 40))


def test_the_reference_point_moves_poses_and_moments(path):
    c = np.array([0.05, 0.04])
    for at_corner, at_c in zip(read_push_log(path), read_push_log(path, c), strict=True):
        assert at_c.before[:2] == pytest.approx(
            at_corner.before[:2] + turn(at_corner.before[2]) @ c
        )
        fx, fy, _ = at_c.loads[0]
        assert at_c.loads[0, 2] == pytest.approx(at_corner.loads[0, 2] - c[0] * fy + c[1] * fx)


def edited(path, line, change):
    lines = path.read_text().splitlines()
    lines[line - 1] = change(lines[line - 1])
    path.write_text("\n".join(lines) + "\n")


# lines: 1 count, 2-3 poses, 4 n, 5-44 forces, 45 m, 46-85 tips, 86-87 poses, 88 n, ...
@pytest.mark.parametrize(
    ("line", "change", "found", "message"),
    [
        (7, lambda s: s + "x", 7, "is no finite number"),
        (50, lambda s: s.replace("0.0", "nan", 1), 50, "is no finite number"),
        (1, lambda s: "2.5", 1, "has no whole number of pushes"),
        (4, lambda s: "0", 4, "has no whole number of forces of push 0"),
        (45, lambda s: "-3", 45, "has no whole number of tip poses of push 0"),
        (1, lambda s: "1", 86, "goes on after push 0"),
        (1, lambda s: "3", 169, "ends within the poses of push 2"),
        (88, lambda s: "4000", 169, "ends within forces of push 1"),
        (20, lambda s: "1.3e9 0 0", 20, "time runs backwards among the forces of push 0"),
        (50, lambda s: s.replace("0.0 0.0", "0.0 0.5"), 50, "quaternion of another norm than 1"),
        (2, lambda s: "610 35 10 0.9 0 0 0.9", 2, "quaternion of another norm than 1"),
        (3, lambda s: "610 35 10 0.9 0 0 0.9", 3, "quaternion of another norm than 1"),
    ],
)
def test_broken_logs_are_named_by_line(path, line, change, found, message):
    edited(path, line, change)
    with pytest.raises(DataError, match=message) as caught:
        read_push_log(path)
    assert (caught.value.file, caught.value.line) == (str(path), found)


def test_a_push_whose_force_comes_too_early(tmp_path):
    log = tmp_path / "log.txt"
    lines = ("1\n" + turning_tip_text((0.0, 0.1))).splitlines()
    lines[6] = lines[6].replace("0.0 0.0", "90.0 0.0")
    log.write_text("\n".join(lines))
    with pytest.raises(DataError, match="push 0, which has no force worth averaging"):
        read_push_log(log)


def test_logs_that_are_none(tmp_path):
    empty = tmp_path / "empty.txt"
    empty.write_text(" \n")
    with pytest.raises(DataError, match="is empty"):
        read_push_log(empty)
    with pytest.raises(DataError, match="cannot be read"):
        read_push_log(tmp_path / "none.txt")
    with pytest.raises(InputError, match="reference"):
        read_push_log(empty, [0.0])
