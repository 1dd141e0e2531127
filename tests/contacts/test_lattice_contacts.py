"""Sites under a part: from scratch, along random walks, and what is refused."""

import numpy as np
import pytest
import shapely

from limitsurf.contacts.lattice_contacts import LatticeContacts
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from tests.kernels.test_row_spans import PARTS

PITCH, ORIGIN = 0.05, (0.013, -0.021)


def listed(contacts):
    found = set(map(tuple, contacts.sites.tolist()))
    assert len(found) == contacts.count
    return found


@pytest.mark.parametrize("shape", [None, (20, 30)])
@pytest.mark.parametrize("name", PARTS)
def test_a_random_walk_equals_a_fresh_start(rng, name, shape):
    walker = LatticeContacts(PARTS[name], PITCH, ORIGIN, shape)
    pose, before = np.array([0.4, 0.5, 0.0]), set()
    for step in 10.0 ** rng.uniform(-4, 0, 60):
        pose = pose + step * rng.normal(size=3)
        entered, left = walker.move(pose)
        fresh = LatticeContacts(PARTS[name], PITCH, ORIGIN, shape)
        assert fresh.move(pose) == (fresh.count, 0)
        assert listed(walker) == listed(fresh)
        assert (entered, left) == (len(listed(walker) - before), len(before - listed(walker)))
        before = listed(walker)


@pytest.mark.parametrize("name", PARTS)
def test_sites_are_those_inside(rng, name):
    part, contacts = PARTS[name], LatticeContacts(PARTS[name], PITCH, ORIGIN)
    c, r = np.meshgrid(np.arange(-70, 70), np.arange(-70, 70))
    for _ in range(10):
        pose = np.append(rng.uniform(-0.5, 0.5, 2), rng.uniform(0.0, 2 * np.pi))
        contacts.move(pose)
        inside = shapely.contains_xy(part.at(pose), ORIGIN[0] + PITCH * c, ORIGIN[1] + PITCH * r)
        assert listed(contacts) == set(zip(r[inside].tolist(), c[inside].tolist(), strict=True))
        expected = np.array(ORIGIN) + PITCH * contacts.sites[:, ::-1] - pose[:2]
        assert contacts.positions == pytest.approx(expected, abs=1e-15)


def test_edges_and_outlines_are_accepted():
    part = Part([(0, 0), (2, 0), (2, 1), (0, 1)])
    pose = (0.31, 0.22, 0.7)
    for given in (part, part.polygon, [(0, 0), (2, 0), (2, 1), (0, 1)], part.edges):
        contacts = LatticeContacts(given, 0.1)
        assert contacts.move(pose)[0] == contacts.count > 150
        again = LatticeContacts(part, 0.1)
        again.move(pose)
        assert listed(again) == listed(contacts)


def test_a_small_move_changes_few_sites():
    contacts = LatticeContacts(PARTS["ring"], 0.002)
    contacts.move((0.0, 0.0, 0.0))
    many = contacts.count
    entered, left = contacts.move((1e-4, 0.0, 0.0))
    assert many > 600_000
    assert 0 < entered + left < 0.001 * many


def test_before_the_first_move_and_off_the_lattice_there_are_none():
    contacts = LatticeContacts(PARTS["T"], 0.1, shape=(5, 5))
    assert contacts.count == len(contacts.sites) == len(contacts.positions) == 0
    contacts.move((0.2, 0.2, 0.0))
    assert "5 sites" not in repr(LatticeContacts(PARTS["T"], 0.1))
    count = contacts.count
    assert contacts.move((30.0, 0.0, 0.0)) == (0, count)


def test_sites_cannot_be_written():
    contacts = LatticeContacts(PARTS["T"], 0.1)
    contacts.move((0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="read-only"):
        contacts.sites[0, 0] = 1


@pytest.mark.parametrize(
    ("changed", "argument"),
    [
        ({"pitch": 0.0}, "pitch"),
        ({"pitch": -1.0}, "pitch"),
        ({"pitch": np.nan}, "pitch"),
        ({"pitch": 1e-12}, "pitch"),
        ({"origin": (1.0,)}, "origin"),
        ({"origin": (1.0, np.inf)}, "origin"),
        ({"shape": (3, -1)}, "shape"),
        ({"shape": (3, 2.5)}, "shape"),
        ({"shape": 3}, "shape"),
        ({"part": [(0, 0, 1, 0), (1, 0, 1, 1)]}, "edges"),
        ({"part": np.empty((0, 4))}, "edges"),
        ({"part": [(0, 0), (1, 1)]}, "outline"),
        ({"part": shapely.Point(0, 0)}, "outline"),
    ],
)
def test_bad_arguments_are_named(changed, argument):
    given = {"part": PARTS["T"], "pitch": 0.1, "origin": (0.0, 0.0), "shape": (4, 4)} | changed
    with pytest.raises(InputError) as caught:
        LatticeContacts(**given)
    assert caught.value.argument == argument


@pytest.mark.parametrize("pose", [(0, 0), (0, 0, np.nan), "here", (1e9, 0, 0)])
def test_bad_poses_are_refused_and_change_nothing(pose):
    contacts = LatticeContacts(PARTS["T"], 0.1)
    contacts.move((0.0, 0.0, 0.0))
    before = listed(contacts)
    with pytest.raises(InputError) as caught:
        contacts.move(pose)
    assert caught.value.argument == "pose"
    assert listed(contacts) == before
