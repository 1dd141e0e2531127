import numpy as np
import pandas as pd
import pytest
import xarray as xr

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError
from limitsurf.fitting.columns import named_rows
from limitsurf.fitting.pairs import read_pairs, scaled_motions
from tests.fitting.simulated import pairs_of

SURFACE = ContactSet([[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.04]], 1.0).limit_surface()
RHO = 0.05


def read(loads, twists, **options):
    return read_pairs(loads, twists, options.pop("sample_weight", None), RHO, **options)


def test_scaling():
    pairs = read([[3.0, 0.0, 0.2]], [[1.0, 0.0, 20.0]])
    np.testing.assert_allclose(pairs.loads, [[3.0, 0.0, 4.0]])
    np.testing.assert_allclose(pairs.motions, [[np.sqrt(0.5), 0.0, np.sqrt(0.5)]])
    assert pairs.force == pytest.approx(5.0)


def test_what_says_nothing_is_dropped_and_said():
    loads, twists = pairs_of(SURFACE, 12)
    loads[0, 1], twists[1, 2] = np.nan, np.nan
    loads[2], twists[3], twists[4] = 0.0, 0.0, -twists[4]
    with pytest.warns(UserWarning, match="dropped") as caught:
        pairs = read(loads, twists)
    assert [str(w.message) for w in caught] == [
        "dropped 2 of 12 pairs: NaN",
        "dropped 1 of 12 pairs: no load",
        "dropped 1 of 12 pairs: no motion",
        "dropped 1 of 8 pairs: negative power, which friction does not allow",
    ]
    assert len(pairs) == 7
    with pytest.warns(UserWarning, match="NaN|no motion") as caught:
        assert (
            len(read(loads, twists, passive=False)) == 9
        )  # active contacts drive an unloaded part
    assert len(caught) == 2


def test_loads_of_the_contacts_have_the_wrong_sign():
    loads, twists = pairs_of(SURFACE, 12)
    with pytest.raises(InputError, match=r"12 of 12 loads point against .*change the sign"):
        read(-loads, twists)


@pytest.mark.parametrize(
    "scale",
    [
        {"loads": [1.0, 1.0, 1e3]},  # N mm
        {"loads": [1.0, 1.0, 1e-3]},  # kN m
        {"twists": [1e3, 1e3, 1.0]},  # mm, rad
    ],
)
def test_wrong_units(scale):
    loads, twists = pairs_of(SURFACE, 12)
    read(loads, twists)
    with pytest.raises(InputError, match=r"moments weigh .* give moments in N m"):
        read(loads * scale.get("loads", 1.0), twists * scale.get("twists", 1.0))


def test_right_units_of_odd_supports_pass():
    for reach in (0.2, 1.0, 5.0):  # feet nearer to, and farther from, the centre than rho
        feet = ContactSet(reach * np.array([[RHO, 0.0], [0.0, RHO], [-RHO, -RHO]]), 1.0)
        read(*pairs_of(feet.limit_surface(), 30))


@pytest.mark.parametrize(
    ("loads", "twists", "message"),
    [
        (np.ones((4, 3)), np.ones((5, 3)), "twists: has 5 rows, but loads has 4"),
        (np.ones((4, 2)), np.ones((4, 3)), r"loads: has shape \(4, 2\)"),
        ([[1.0, 2.0, np.inf]], np.ones((1, 3)), "loads: has infinite entries"),
        ([["a", "b", "c"]], np.ones((1, 3)), "loads: is no array of numbers"),
        (np.ones((2, 3)) * 1j, np.ones((2, 3)), "Complex data"),
        (
            np.ones((2, 3)) * [1, 1, 0.1],
            np.ones((2, 3)) * [1, 1, 9],
            "2 usable pairs, but 3 is the minimum",
        ),
    ],
)
def test_bad_arrays(loads, twists, message):
    with pytest.raises(InputError, match=message):
        read(loads, twists, least=3)


@pytest.mark.parametrize(
    ("weight", "message"),
    [([1.0], "shape"), ([1.0, -1.0], "at least 0"), ([1.0, np.nan], "finite"), ([0, 0], "zero")],
)
def test_bad_weights(weight, message):
    with pytest.raises(InputError, match=f"sample_weight: .*{message}"):
        read(np.ones((2, 3)), np.ones((2, 3)), sample_weight=weight)


def test_pairs_of_weight_zero_are_left_out():
    loads, twists = pairs_of(SURFACE, 5)
    assert len(read(loads, twists, sample_weight=[0.0, 1.0, 2.0, 0.0, 1.0])) == 3


def test_motions_without_motion_are_zero():
    np.testing.assert_array_equal(scaled_motions(np.zeros((1, 3)), RHO), np.zeros((1, 3)))


class TestColumns:
    def test_any_order_and_units(self):
        frame = pd.DataFrame(
            {"push": [1], "m [N mm]": [50.0], "Fy [mN]": [2000.0], "fx": [1.0], "t [s]": [0.1]}
        )
        np.testing.assert_allclose(named_rows("loads", frame), [[1.0, 2.0, 0.05]])
        frame = pd.DataFrame({"dtheta [deg]": [180.0], "dx [mm]": [1.0], "dy [m]": [2.0]})
        np.testing.assert_allclose(named_rows("twists", frame), [[1e-3, 2.0, np.pi]])
        frame = pd.DataFrame({"vx [mm/s]": [1.0], "vy [m/s]": [2.0], "omega [rad/s]": [3.0]})
        np.testing.assert_allclose(named_rows("twists", frame), [[1e-3, 2.0, 3.0]])

    def test_xarray(self):
        array = xr.DataArray([[1.0, 2.0, 3.0]], dims=("n", "k"), coords={"k": ["m", "fx", "fy"]})
        np.testing.assert_array_equal(named_rows("loads", array), [[2.0, 3.0, 1.0]])
        plain = xr.DataArray([[1.0, 2.0, 3.0]])
        np.testing.assert_array_equal(named_rows("loads", plain), [[1.0, 2.0, 3.0]])

    def test_three_columns_of_other_names_are_taken_in_order(self):
        frame = pd.DataFrame([[1.0, 2.0, 3.0]], columns=["a", "b", "c"])
        np.testing.assert_array_equal(named_rows("loads", frame), [[1.0, 2.0, 3.0]])

    def test_missing_names(self):
        frame = pd.DataFrame({"fx": [1.0], "fy": [1.0], "moment": [1.0], "t": [0.0]})
        with pytest.raises(InputError, match="name them fx, fy, m"):
            named_rows("loads", frame)

    def test_unknown_units(self):
        frame = pd.DataFrame({"fx [furlong]": [1.0], "fy": [1.0], "m": [1.0]})
        with pytest.raises(InputError, match=r"fx \[furlong\]"):
            named_rows("loads", frame)
