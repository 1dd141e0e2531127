"""Measured pushes beside what least dissipation on the exact three feet predicts.

First table: the displacement of the point of the triangle that is touched first is the measured
one; the rotation is predicted. "No rotation" leaves it out. "Ellipsoid" puts, in place of the feet,
the ellipsoid with their largest force and their largest moment about the centroid. Second table:
the displacement is the path of the finger, for pushes in which it slips by less than 1 mm.

Usage: python benchmarks/bench_pushes.py
"""

import numpy as np
from zhou2016 import read_pushes, rotation

from limitsurf.datasets.zhou2016 import SUPPORTS, three_feet
from limitsurf.motion.pushing import push_along

STEPS = 20
STUCK = 1e-3  # slip of the finger [m]


def predicted(contacts, push, path):
    """Return the rotation [rad] of a push along a path of the touched point."""
    arm = rotation(push.before[2]) @ push.point
    start = np.array([*(path[0] - arm), push.before[2]])
    return push_along(contacts, path, start).final_pose[2] - start[2]


def by_ellipsoid(contacts, push, path):
    """Return the rotation [rad] with ``|F|^2/F_max^2 + M^2/M_max^2 = 1`` as limit surface.

    The rate is ``-u.w / (w.w + c^2)``, with w the velocity per rate of the centroid about the
    pushed point and c the ratio of largest moment and force; midpoint steps.
    """
    m = contacts.radius
    c = m @ np.hypot(*contacts.position.T) / m.sum()
    w = np.array([push.point[1], -push.point[0]])

    def rate(theta, step):
        return -(rotation(theta).T @ step) @ w / (w @ w + c * c)

    theta = push.before[2]
    for step in np.diff(path, axis=0):
        theta += rate(theta + 0.5 * rate(theta, step), step)
    return theta - push.before[2]


def touched_path(push):
    """Return the straight path from where the touched point was to where it ends."""
    begin = push.before[:2] + rotation(push.before[2]) @ push.point
    return begin + np.linspace(0.0, 1.0, STEPS + 1)[:, None] * push.displacement


def finger_path(push):
    """Return the finger's path, begun at the touched point."""
    begin = push.before[:2] + rotation(push.before[2]) @ push.point
    return begin + push.finger - push.finger[0]


def errors(support, path_of, chosen):
    """Return errors [deg] of the three predictions, (3, n): feet, ellipsoid, no rotation."""
    contacts = three_feet(support)
    rows = []
    for push in filter(chosen, read_pushes(support)):
        path = path_of(push)
        models = (predicted(contacts, push, path), by_ellipsoid(contacts, push, path), 0.0)
        rows.append([model - push.rotation for model in models])
    return np.degrees(rows).T


def table(path_of, chosen):
    """Print a row for each support, and one for all."""
    names = ("three feet", "ellipsoid", "no rotation")
    head = ["support", "pushes", *(f"{name}: {k}" for name in names for k in ("mean", "median"))]
    print(f"| {' | '.join(head)} |\n{'|---' * len(head)}|")
    found = {support: errors(support, path_of, chosen) for support in SUPPORTS}
    found["all"] = np.hstack(list(found.values()))
    for support, e in found.items():
        size = [f"{k(np.abs(row)):.2f}" for row in e for k in (np.mean, np.median)]
        print(f"| {support} | {e.shape[1]} | {' | '.join(size)} |")


def main():
    """Print both tables: absolute errors of the rotation [deg]."""
    table(touched_path, lambda push: True)
    print()
    table(finger_path, lambda push: push.slip < STUCK)


if __name__ == "__main__":
    main()
