"""Many small problems at once are the same problems one by one."""

import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.contacts.project_many import project_many
from limitsurf.errors import InputError, SolveFailed
from limitsurf.sets.projection import Status

FIELDS = ("point", "distance", "normal", "twist", "error_bound", "status")
W = np.array([[1.0, 0.2, 0.1], [0.2, 2.0, -0.3], [0.1, -0.3, 0.7]])


def problems(rng, k=60, active=False):
    """Return sets of 0 to 40 contacts, one of 5,000, and a load for each."""
    sizes = np.append(rng.integers(0, 40, k), [0, 1, 2, 5000, 0])
    sets = []
    for i, n in enumerate(sizes):
        radius = rng.uniform(0.1, 1.0, n) * (i % 7 > 0)
        push = rng.normal(size=(n, 2)) if active and i % 2 else None
        sets.append(ContactSet(rng.normal(size=(n, 2)) + 3 * rng.normal(size=2), radius, push))
    loads = np.array([rng.normal(size=3) * max(c.radius.sum(), 1.0) for c in sets])
    return sets, loads * rng.choice([0.1, 0.5, 1.0, 5.0], size=(len(sets), 1))


def ragged(sets):
    return (
        np.concatenate([c.position for c in sets]),
        np.concatenate([c.radius for c in sets]),
        [len(c) for c in sets],
        np.concatenate([c.offset for c in sets]),
    )


@pytest.mark.parametrize("metric", [None, W])
@pytest.mark.parametrize("active", [False, True])
def test_equals_one_by_one(rng, active, metric):
    sets, loads = problems(rng, active=active)
    together = project_many(sets, loads, metric)
    matrix = np.eye(3) if metric is None else metric
    for k, (contacts, p) in enumerate(zip(sets, loads, strict=True)):
        one = contacts.project(p, metric)
        e = together.point[k] - one.point
        size = 1e-14 * (contacts.radius.sum() + np.abs(p).max() + np.abs(contacts.offset).sum())
        assert np.sqrt(e @ matrix @ e) <= together.error_bound[k] + one.error_bound + size
        assert together.distance[k] == pytest.approx(one.distance, abs=1e-11 * (1 + one.distance))
        assert together.twist[k] == pytest.approx(one.twist, abs=1e-10 * (1 + one.distance))
        assert together.inside[k] == one.inside


def test_lists_and_arrays_and_threads_give_the_same_bits(rng):
    sets, loads = problems(rng, active=True)
    reference = project_many(sets, loads)
    for again in (
        project_many(tuple(sets), loads),
        project_many(ragged(sets), loads),
        project_many(sets, loads, threads=2),
        project_many(ragged(sets), loads, threads=3),
        project_many(sets, loads, threads=500),
    ):
        for field in FIELDS:
            assert np.array_equal(getattr(again, field), getattr(reference, field)), field


def test_nothing_to_do():
    P = project_many([], np.empty((0, 3)))
    assert P.point.shape == (0, 3)
    assert P.status.shape == (0,)
    alone = project_many([ContactSet(np.empty((0, 2)), [])], [[1.0, 2.0, 2.0]])
    assert np.array_equal(alone.point, [[0.0, 0.0, 0.0]])
    assert np.array_equal(alone.twist, [[-1.0, -2.0, -2.0]])
    assert alone.distance == pytest.approx([3.0])
    arrays = project_many((np.empty((0, 2)), [], [0, 0]), np.eye(3)[:2], threads=2)
    assert arrays.distance == pytest.approx([1.0, 1.0])


def test_failures_carry_the_best_answers():
    pair = ContactSet([[1.0, 0.0], [-1.0, 0.0]], 0.5)
    loads = [[0.0, 0.0, 3.0], [1e200, 0.0, 0.0]]
    with pytest.raises(SolveFailed) as caught:
        project_many([pair, pair], loads)
    assert np.array_equal(caught.value.best.status, [Status.OUTSIDE, Status.FAILED])
    quiet = project_many([pair, pair], loads, throw=False)
    assert np.array_equal(quiet.status, [Status.OUTSIDE, Status.FAILED])


def test_inputs_are_not_changed(rng):
    sets, loads = problems(rng)
    position, radius, counts, offset = ragged(sets)
    copies = position.copy(), radius.copy(), loads.copy()
    project_many((position, radius, counts, offset), loads, threads=2)
    for before, after in zip(copies, (position, radius, loads), strict=True):
        assert np.array_equal(before, after)


GOOD = {"contacts": ([[1.0, 0.0], [-1.0, 0.0]], [0.5, 0.5], [2]), "loads": [[0.0, 0.0, 3.0]]}


@pytest.mark.parametrize(
    ("argument", "given"),
    [
        ("position", {"contacts": ([[1.0, np.nan], [0.0, 0.0]], [0.5, 0.5], [2])}),
        ("position", {"contacts": ([[1.0], [0.0]], [0.5, 0.5], [2])}),
        ("radius", {"contacts": ([[1.0, 0.0], [0.0, 0.0]], [0.5, -0.5], [2])}),
        ("radius", {"contacts": ([[1.0, 0.0], [0.0, 0.0]], [0.5], [2])}),
        ("radius", {"contacts": ([[1.0, 0.0], [0.0, 0.0]], [0.5, np.inf], [2])}),
        ("counts", {"contacts": ([[1.0, 0.0], [0.0, 0.0]], [0.5, 0.5], [1])}),
        ("counts", {"contacts": ([[1.0, 0.0], [0.0, 0.0]], [0.5, 0.5], [3, -1])}),
        ("counts", {"contacts": ([[1.0, 0.0], [0.0, 0.0]], [0.5, 0.5], [1.5, 0.5])}),
        ("counts", {"contacts": ([[1.0, 0.0], [0.0, 0.0]], [0.5, 0.5], [np.nan])}),
        ("offset", {"contacts": ([[1.0, 0.0], [0.0, 0.0]], [0.5, 0.5], [2], [[0.0, 0.0]])}),
        ("contacts", {"contacts": ([[1.0, 0.0]],)}),
        ("contacts", {"contacts": ([[1.0, 0.0]], [1.0], [1], None, None)}),
        ("contacts", {"contacts": 7}),
        ("loads", {"loads": [0.0, 0.0, 3.0]}),
        ("loads", {"loads": np.zeros((2, 3))}),
        ("loads", {"loads": [[0.0, 0.0]]}),
        ("loads", {"loads": [[0.0, np.nan, 0.0]]}),
        ("loads", {"loads": [[0.0, np.inf, 0.0]]}),
        ("metric", {"metric": -np.eye(3)}),
        ("tol", {"tol": 0.0}),
        ("tol", {"tol": np.nan}),
        ("tol", {"tol": 2.0}),
        ("threads", {"threads": 0}),
        ("threads", {"threads": 1.5}),
    ],
)
def test_bad_arguments_are_named(argument, given):
    with pytest.raises(InputError) as caught:
        project_many(**(GOOD | given))
    assert caught.value.argument == argument


def test_only_disks():
    wheel = ContactSet([[0.0, 0.0]], 1.0, ellipse=[np.diag([1.0, 0.1])])
    disk = ContactSet([[0.0, 0.0]], 1.0)
    with pytest.raises(InputError, match=r"contacts\[1\]"):
        project_many([disk, wheel], np.zeros((2, 3)))
    with pytest.raises(InputError, match=r"contacts\[0\]"):
        project_many([ContactSet([[0.0, 0.0]], 1.0, sides=6), disk], np.zeros((2, 3)))
