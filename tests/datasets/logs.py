"""Logs of pushes made up for tests, with known loads."""

import numpy as np

TOOL = np.sqrt(0.5) * np.array([[1.0, 1.0], [1.0, -1.0]])


def turn(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def quaternion(angle):
    """Return the one of two quaternions whose first entry is not negative."""
    w, z = np.cos(angle / 2), np.sin(angle / 2)
    return [abs(w), 0.0, 0.0, np.copysign(1.0, w) * z]


def row(numbers):
    return " ".join(repr(float(x)) for x in numbers)


def pose_row(x, y, angle):
    """Return a row of a pose [m, rad], written in mm."""
    return row([1e3 * x, 1e3 * y, 9.9, *quaternion(angle)])


def push_text(before, after, point, force, *, tip_angle=0.7, n=40, offset=(0.3, -0.2)):
    """Return a push of a part that moves evenly while a constant body force acts at a body point.

    The first samples are the sensor's zero, `offset`; then the part moves.
    """
    before, after = np.array(before), np.array(after)
    first = int(np.ceil(0.3 * n)) - 1
    times = 1.4e9 + 0.01 * np.arange(n)
    way = np.concatenate([np.zeros(first), np.linspace(0.0, 1.0, n - first)])
    forces, tips = [], []
    for k, w in enumerate(way):
        pose = before + w * (after - before)
        world = turn(pose[2]) @ force if k >= first else np.zeros(2)
        sensor = offset - np.linalg.solve(TOOL, turn(tip_angle).T @ world)
        place = pose[:2] + turn(pose[2]) @ point
        forces.append(row([times[k], *sensor]))
        tips.append(f"{times[k]} " + pose_row(*place, tip_angle))
    lines = [pose_row(*before), pose_row(*after), str(n), *forces, str(n), *tips]
    return "\n".join(lines) + "\n"


def turning_tip_text(angles, n=40, every=3):
    """Return a push without force of a part at rest, by a tip that turns evenly, seldom seen."""
    times = 1.4e9 + 0.01 * np.arange(n)
    seen = np.arange(0, n, every)
    turning = np.linspace(*angles, n)
    rest, forces = pose_row(0.0, 0.0, 0.0), [row([t, 0.0, 0.0]) for t in times]
    tips = [f"{times[k]} " + pose_row(0.1, 0.0, turning[k]) for k in seen]
    return "\n".join([rest, rest, str(n), *forces, str(len(seen)), *tips]) + "\n"
