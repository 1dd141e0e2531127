import numpy as np
import pytest

from limitsurf.contacts.coulomb import (
    contact_map,
    coulomb_contact,
    elliptic_contact,
    polygonal_contact,
)
from limitsurf.errors import InputError


def test_contact_map_gives_the_moment():
    assert contact_map([2.0, 3.0]) @ [5.0, 7.0] == pytest.approx([5.0, 7.0, 2 * 7 - 3 * 5])


@pytest.mark.parametrize("r", [0.0, 0.5, 1.0, 3.0])
def test_the_disk_is_tilted_by_arctan_r(r):
    """Paper, Figure 8: tan theta = |r|."""
    axes = coulomb_contact([r, 0.0], 1.0).axes
    normal = np.cross(axes[:, 0], axes[:, 1])
    tilt = np.arccos(abs(normal[2]) / np.linalg.norm(normal))
    assert np.tan(tilt) == pytest.approx(r)


@pytest.mark.parametrize("outside", [False, True])
@pytest.mark.parametrize("sides", [3, 4, 7, 32])
def test_polygons_bracket_the_disk_with_the_stated_error(rng, sides, outside):
    disk = coulomb_contact([0.7, -1.2], 2.0)
    polygon, error = polygonal_contact([0.7, -1.2], 2.0, sides, outside=outside)
    d = rng.normal(size=(4000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    excess = polygon.support(d) - disk.support(d)
    signed = excess if outside else -excess
    assert np.all(signed >= -1e-12)
    assert signed.max() <= error * (1 + 1e-12)
    assert signed.max() > 0.5 * error


def test_an_elliptic_contact_holds_its_half_axes(rng):
    """Support sqrt((a d.e)^2 + (b d.n)^2) of the force, moments by the arm."""
    e, a, b, r = np.array([0.6, 0.8]), 2.0, 0.5, np.array([0.7, -1.2])
    contact = elliptic_contact(r, [a, b], 3.0 * e)
    d = rng.normal(size=(50, 3))
    at = d[:, :2] + d[:, 2:] * [-r[1], r[0]]
    across = at @ [-e[1], e[0]]
    assert contact.support(d) == pytest.approx(np.hypot(a * (at @ e), b * across), rel=1e-13)
    round_one = elliptic_contact(r, [a, a], e)
    assert round_one.support(d) == pytest.approx(coulomb_contact(r, a).support(d), rel=1e-13)


def test_bad_arguments():
    with pytest.raises(InputError, match="radius"):
        coulomb_contact([0, 0], -1.0)
    with pytest.raises(InputError, match="sides"):
        polygonal_contact([0, 0], 1.0, 2)
    with pytest.raises(InputError, match="sides"):
        polygonal_contact([0, 0], 1.0, 6.5)
    with pytest.raises(InputError, match="radius"):
        coulomb_contact([0, 0], "large")
    with pytest.raises(InputError, match="position"):
        contact_map([0, 0, 0])
