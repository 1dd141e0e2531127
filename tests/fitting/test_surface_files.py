import numpy as np
import pytest

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError, ModelError
from limitsurf.fitting.surface_files import load_surface, surface_toml
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.linear_image import LinearImage
from limitsurf.sets.minkowski_sum import MinkowskiSum
from limitsurf.sets.polynomial_set import PolynomialSet
from limitsurf.sets.v_polytope import VPolytope

FEET = ContactSet([[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.04]], [1.0, 2.0, 0.5], [[0.1, 0.2]] * 3)
QUARTIC = PolynomialSet([[4, 0, 0], [0, 4, 0], [0, 0, 4], [2, 2, 0]], [1.0, 0.5, 1e5, 0.2])
SURFACES = [
    Ellipsoid([0.1, 0.0, -0.02], np.diag([2.0, 1.0, 0.1])),
    Ellipsoid([0.1, 0.0, -0.02], np.empty((3, 0))),
    QUARTIC,
    LinearImage(np.eye(3), QUARTIC, [0.1, 0.2, 0.3]),
    FEET.limit_surface(),
    VPolytope([[1.0, 0.0, 0.1], [0.0, 1.0, 0.0], [0.0, 0.0, -0.1], [-1.0, 0.0, 0.0]]),
]


@pytest.mark.parametrize("surface", SURFACES, ids=repr)
def test_round_trip(surface, tmp_path, rng):
    path = tmp_path / "surface.toml"
    path.write_text(surface_toml(surface, 0.05, 'a "test"', "made up"))
    again = load_surface(path)
    assert type(again) is type(surface)
    d = rng.normal(size=(30, 3)) * [1.0, 1.0, 20.0]
    np.testing.assert_allclose(again.support(d), surface.support(d), rtol=1e-11, atol=1e-13)


def test_other_sets_are_refused():
    both = MinkowskiSum(SURFACES[0], QUARTIC)
    with pytest.raises(InputError, match="MinkowskiSum, which model files do not hold"):
        surface_toml(both, 0.05, "a sum", "made up")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"0.05 m"', '"0.05 N"', "rho"),
        ('source = "made up"', "", "force"),
        ("[ellipsoid]", "[sphere]", "sphere"),
        ("axes = ", "axis = ", "ellipsoid.axis|ellipsoid.axes"),
        ("center = [0.05, ", "center = [", "center"),
        ("[ellipsoid]", "[polytope]\nvertices = [[0.0, 0.0, 0.0]]\n[ellipsoid]", "2 surfaces"),
    ],
)
def test_broken_files(old, new, message, tmp_path):
    text = surface_toml(SURFACES[0], 0.05, "a test", "made up")
    assert old in text
    path = tmp_path / "surface.toml"
    path.write_text(text.replace(old, new))
    with pytest.raises(ModelError, match=message):
        load_surface(path)
