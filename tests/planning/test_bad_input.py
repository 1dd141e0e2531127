"""What users hand to the planner by mistake: each error names the argument."""

import numpy as np
import pytest

from limitsurf.actuators.density_field import DensityField
from limitsurf.errors import InputError
from limitsurf.geometry.part import Part
from limitsurf.planning.alignment import AlignmentPlan, plan_alignment
from limitsurf.planning.diameter_function import diameter_function
from limitsurf.planning.equilibria import equilibria
from limitsurf.planning.ideal_squeeze import IdealSqueeze
from limitsurf.planning.skewed_equilibria import skewed_equilibria
from limitsurf.planning.squeeze_function import squeeze_function
from limitsurf.planning.turn_function import turn_function
from limitsurf.planning.verification import verify_alignment

OUTLINE = [(0, 0), (2, 0), (2.1, 2), (0, 2.2)]
PART = Part(OUTLINE)
PLAN = plan_alignment(PART)
TURN, DIAMETER = turn_function(PART), diameter_function(PART)
ORIENTED = [
    *(getattr(f, name) for f in (TURN, DIAMETER) for name in ("potential", "moment", "curvature")),
    *(TURN, DIAMETER, squeeze_function(TURN), PLAN.predict),
]


@pytest.mark.parametrize("call", ORIENTED)
@pytest.mark.parametrize("phi", ["north", [1j], np.nan, [0.0, np.inf], None, [[0.0], [1.0, 2.0]]])
def test_orientations_are_finite_numbers(call, phi):
    with pytest.raises(InputError) as found:
        call(phi)
    assert found.value.argument == "phi"


@pytest.mark.parametrize("call", ORIENTED)
@pytest.mark.parametrize("shape", [(), (0,), (2, 1), (2, 0, 3)])
def test_orientations_have_any_shape(call, shape):
    phi = np.full(shape, 0.3)
    phi.setflags(write=False)
    assert np.shape(call(phi)) == shape
    assert np.shape(call(phi.tolist())) == np.shape(phi.tolist())


@pytest.mark.parametrize("median", [TURN.median, DIAMETER.median])
@pytest.mark.parametrize("phi", ["north", None, [0.1, 0.2], np.nan, np.inf])
def test_a_median_has_one_orientation(median, phi):
    with pytest.raises(InputError) as found:
        median(phi)
    assert found.value.argument == "phi"


@pytest.mark.parametrize("value", [None, OUTLINE, PART.polygon, "T"])
@pytest.mark.parametrize(
    ("argument", "call"),
    [
        ("part", plan_alignment),
        ("part", turn_function),
        ("part", diameter_function),
        ("part", lambda part: equilibria(part, DensityField.squeeze(0.0, 1.0))),
        ("part", lambda part: verify_alignment(PLAN, part, IdealSqueeze())),
        ("plan", lambda plan: verify_alignment(plan, PART, IdealSqueeze())),
        ("field", lambda field: equilibria(PART, field)),
        ("turn", squeeze_function),
        ("turn", lambda turn: skewed_equilibria(turn, 0.1)),
    ],
)
def test_objects_are_of_the_right_kind(argument, call, value):
    with pytest.raises(InputError) as found:
        call(value)
    assert found.value.argument == argument


@pytest.mark.parametrize("errors", [None, 3])
def test_robustness_wants_an_array_or_errors(errors):
    with pytest.raises(InputError) as found:
        PLAN.robustness(errors)
    assert found.value.argument == "array"


@pytest.mark.parametrize("text", [None, 3])
def test_json_is_text(text):
    with pytest.raises(InputError):
        AlignmentPlan.from_json(text)


@pytest.mark.parametrize(
    ("argument", "start"),
    [("offset", ("a", 0)), ("phi", (0, None)), ("offset, phi", ([0, 1], [0, 1, 2]))],
)
def test_starts_are_numbers_that_fit(argument, start):
    with pytest.raises(InputError) as found:
        IdealSqueeze().rest(PART, *start)
    assert found.value.argument == argument
