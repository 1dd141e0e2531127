"""Optimization-based contact mechanics: limit surfaces, frictional loads, sensorless alignment.

Imported as ``ls`` in the documentation. Names are loaded on first use, so that importing the
package is quick.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from limitsurf.actuators.activation import Activation as Activation
    from limitsurf.actuators.activation import squeeze_activation as squeeze_activation
    from limitsurf.actuators.actuator_array import ActuatorArray as ActuatorArray
    from limitsurf.actuators.actuator_array import load_array as load_array
    from limitsurf.actuators.carrying import Carried as Carried
    from limitsurf.actuators.carrying import carry as carry
    from limitsurf.actuators.density_field import DensityField as DensityField
    from limitsurf.actuators.density_field import push_density as push_density
    from limitsurf.actuators.density_piece import DensityPiece as DensityPiece
    from limitsurf.actuators.field_error import direction_errors as direction_errors
    from limitsurf.actuators.field_error import load_error as load_error
    from limitsurf.actuators.force_fields import elliptic_field as elliptic_field
    from limitsurf.actuators.force_fields import radial_field as radial_field
    from limitsurf.actuators.force_fields import skewed_squeeze_field as skewed_squeeze_field
    from limitsurf.actuators.force_fields import squeeze_field as squeeze_field
    from limitsurf.actuators.force_fields import uniform_field as uniform_field
    from limitsurf.actuators.pixel_lattice import PixelLattice as PixelLattice
    from limitsurf.actuators.pixel_lattice import headings as headings
    from limitsurf.actuators.potential_field import FieldSum as FieldSum
    from limitsurf.actuators.radial_density import RadialField as RadialField
    from limitsurf.actuators.realised_field import RealisedField as RealisedField
    from limitsurf.actuators.realised_field import activate as activate
    from limitsurf.actuators.realised_field import realise as realise
    from limitsurf.actuators.resonator_contact import FloatingPart as FloatingPart
    from limitsurf.actuators.resonator_sweep import ResonatorSweep as ResonatorSweep
    from limitsurf.actuators.resonator_sweep import sweep_resonators as sweep_resonators
    from limitsurf.actuators.rim_force import force_scaling as force_scaling
    from limitsurf.actuators.torsional_resonator import TorsionalResonator as TorsionalResonator
    from limitsurf.contacts.contact_set import ContactSet as ContactSet
    from limitsurf.contacts.coulomb import contact_map as contact_map
    from limitsurf.contacts.coulomb import coulomb_contact as coulomb_contact
    from limitsurf.contacts.coulomb import elliptic_contact as elliptic_contact
    from limitsurf.contacts.coulomb import polygonal_contact as polygonal_contact
    from limitsurf.contacts.friction_load import FrictionLoad as FrictionLoad
    from limitsurf.contacts.friction_load import friction_load as friction_load
    from limitsurf.contacts.lattice_contacts import LatticeContacts as LatticeContacts
    from limitsurf.contacts.load_sharing import LoadShare as LoadShare
    from limitsurf.contacts.load_sharing import share_load as share_load
    from limitsurf.contacts.oscillating_contact import OscillatingContact as OscillatingContact
    from limitsurf.contacts.pressure_patch import PressurePatch as PressurePatch
    from limitsurf.contacts.project_many import project_many as project_many
    from limitsurf.contacts.soft_contact import SoftContact as SoftContact
    from limitsurf.contacts.tip_dissipation import TipDissipation as TipDissipation
    from limitsurf.contacts.uniform_friction import UniformFriction as UniformFriction
    from limitsurf.contacts.wheel import Wheel as Wheel
    from limitsurf.geometry.part import Part as Part
    from limitsurf.motion.drag import air_film_drag as air_film_drag
    from limitsurf.motion.feet import feet_motion as feet_motion
    from limitsurf.motion.field_motion import field_motion as field_motion
    from limitsurf.motion.load_table import LoadTable as LoadTable
    from limitsurf.motion.pushing import Push as Push
    from limitsurf.motion.pushing import push as push
    from limitsurf.motion.pushing import push_along as push_along
    from limitsurf.motion.schedule import Schedule as Schedule
    from limitsurf.motion.simulate import simulate as simulate
    from limitsurf.motion.simulate_many import Runs as Runs
    from limitsurf.motion.simulate_many import simulate_many as simulate_many
    from limitsurf.motion.steady_walk import SteadyWalk as SteadyWalk
    from limitsurf.motion.steady_walk import steady_walk as steady_walk
    from limitsurf.motion.trajectory import Trajectory as Trajectory
    from limitsurf.motion.walk import walk as walk
    from limitsurf.planning.alignment import AlignmentPlan as AlignmentPlan
    from limitsurf.planning.alignment import plan_alignment as plan_alignment
    from limitsurf.planning.array_verification import ArrayVerification as ArrayVerification
    from limitsurf.planning.basin_steps import centred_squeeze_function as centred_squeeze_function
    from limitsurf.planning.basin_steps import shift_squeeze_function as shift_squeeze_function
    from limitsurf.planning.basin_steps import unknown_offset_function as unknown_offset_function
    from limitsurf.planning.diameter_function import DiameterFunction as DiameterFunction
    from limitsurf.planning.diameter_function import diameter_function as diameter_function
    from limitsurf.planning.duration import expected_duration as expected_duration
    from limitsurf.planning.duration import line_durations as line_durations
    from limitsurf.planning.equilibria import Equilibria as Equilibria
    from limitsurf.planning.equilibria import equilibria as equilibria
    from limitsurf.planning.field_errors import FieldErrors as FieldErrors
    from limitsurf.planning.ideal_squeeze import IdealSqueeze as IdealSqueeze
    from limitsurf.planning.ideal_squeeze import SqueezePath as SqueezePath
    from limitsurf.planning.ideal_verification import IdealVerification as IdealVerification
    from limitsurf.planning.line_plan import LinePlan as LinePlan
    from limitsurf.planning.median_pieces import MedianPiece as MedianPiece
    from limitsurf.planning.plan_lines import plan_lines as plan_lines
    from limitsurf.planning.robustness import Robustness as Robustness
    from limitsurf.planning.robustness import robustness as robustness
    from limitsurf.planning.separatrices import Separatrix as Separatrix
    from limitsurf.planning.separatrices import boundary_shift as boundary_shift
    from limitsurf.planning.separatrices import separatrices as separatrices
    from limitsurf.planning.skewed_equilibria import skewed_equilibria as skewed_equilibria
    from limitsurf.planning.squeeze_function import SqueezeFunction as SqueezeFunction
    from limitsurf.planning.squeeze_function import squeeze_function as squeeze_function
    from limitsurf.planning.turn_certificate import TurnCertificate as TurnCertificate
    from limitsurf.planning.turn_function import TurnFunction as TurnFunction
    from limitsurf.planning.turn_function import turn_function as turn_function
    from limitsurf.planning.universal_feeder import feeder_field as feeder_field
    from limitsurf.planning.universal_feeder import feeder_range as feeder_range
    from limitsurf.planning.universal_feeder import pivot_point as pivot_point
    from limitsurf.planning.verification import Verification as Verification
    from limitsurf.planning.verification import verify_alignment as verify_alignment
    from limitsurf.sets.contact_sum import ContactSum as ContactSum
    from limitsurf.sets.convex_set import ConvexSet as ConvexSet
    from limitsurf.sets.ellipsoid import Ellipsoid as Ellipsoid
    from limitsurf.sets.h_polytope import HPolytope as HPolytope
    from limitsurf.sets.linear_image import LinearImage as LinearImage
    from limitsurf.sets.linear_image import transport as transport
    from limitsurf.sets.minkowski_sum import MinkowskiSum as MinkowskiSum
    from limitsurf.sets.polynomial_set import PolynomialSet as PolynomialSet
    from limitsurf.sets.projection import Projection as Projection
    from limitsurf.sets.sections import Section as Section
    from limitsurf.sets.sections import limit_curve as limit_curve
    from limitsurf.sets.sections import section as section
    from limitsurf.sets.v_polytope import VPolytope as VPolytope
    from limitsurf.sets.zonotope import Zonotope as Zonotope


__version__ = "0.1.0"

_HOME = {
    "Activation": "actuators.activation",
    "ActuatorArray": "actuators.actuator_array",
    "AlignmentPlan": "planning.alignment",
    "ArrayVerification": "planning.array_verification",
    "Carried": "actuators.carrying",
    "ContactSet": "contacts.contact_set",
    "ContactSum": "sets.contact_sum",
    "ConvexSet": "sets.convex_set",
    "DensityField": "actuators.density_field",
    "DensityPiece": "actuators.density_piece",
    "DiameterFunction": "planning.diameter_function",
    "Ellipsoid": "sets.ellipsoid",
    "Equilibria": "planning.equilibria",
    "FieldErrors": "planning.field_errors",
    "FieldSum": "actuators.potential_field",
    "FloatingPart": "actuators.resonator_contact",
    "FrictionLoad": "contacts.friction_load",
    "HPolytope": "sets.h_polytope",
    "IdealSqueeze": "planning.ideal_squeeze",
    "IdealVerification": "planning.ideal_verification",
    "LatticeContacts": "contacts.lattice_contacts",
    "LinePlan": "planning.line_plan",
    "LinearImage": "sets.linear_image",
    "LoadShare": "contacts.load_sharing",
    "LoadTable": "motion.load_table",
    "MedianPiece": "planning.median_pieces",
    "MinkowskiSum": "sets.minkowski_sum",
    "OscillatingContact": "contacts.oscillating_contact",
    "Part": "geometry.part",
    "PixelLattice": "actuators.pixel_lattice",
    "PolynomialSet": "sets.polynomial_set",
    "PressurePatch": "contacts.pressure_patch",
    "Projection": "sets.projection",
    "Push": "motion.pushing",
    "RadialField": "actuators.radial_density",
    "RealisedField": "actuators.realised_field",
    "ResonatorSweep": "actuators.resonator_sweep",
    "Robustness": "planning.robustness",
    "Runs": "motion.simulate_many",
    "Schedule": "motion.schedule",
    "Section": "sets.sections",
    "Separatrix": "planning.separatrices",
    "SoftContact": "contacts.soft_contact",
    "SqueezeFunction": "planning.squeeze_function",
    "SqueezePath": "planning.ideal_squeeze",
    "SteadyWalk": "motion.steady_walk",
    "TipDissipation": "contacts.tip_dissipation",
    "TorsionalResonator": "actuators.torsional_resonator",
    "Trajectory": "motion.trajectory",
    "TurnCertificate": "planning.turn_certificate",
    "TurnFunction": "planning.turn_function",
    "UniformFriction": "contacts.uniform_friction",
    "VPolytope": "sets.v_polytope",
    "Verification": "planning.verification",
    "Wheel": "contacts.wheel",
    "Zonotope": "sets.zonotope",
    "activate": "actuators.realised_field",
    "air_film_drag": "motion.drag",
    "boundary_shift": "planning.separatrices",
    "carry": "actuators.carrying",
    "centred_squeeze_function": "planning.basin_steps",
    "contact_map": "contacts.coulomb",
    "coulomb_contact": "contacts.coulomb",
    "diameter_function": "planning.diameter_function",
    "direction_errors": "actuators.field_error",
    "elliptic_contact": "contacts.coulomb",
    "elliptic_field": "actuators.force_fields",
    "equilibria": "planning.equilibria",
    "expected_duration": "planning.duration",
    "feeder_field": "planning.universal_feeder",
    "feeder_range": "planning.universal_feeder",
    "feet_motion": "motion.feet",
    "field_motion": "motion.field_motion",
    "force_scaling": "actuators.rim_force",
    "friction_load": "contacts.friction_load",
    "headings": "actuators.pixel_lattice",
    "limit_curve": "sets.sections",
    "line_durations": "planning.duration",
    "load_array": "actuators.actuator_array",
    "load_error": "actuators.field_error",
    "pivot_point": "planning.universal_feeder",
    "plan_alignment": "planning.alignment",
    "plan_lines": "planning.plan_lines",
    "polygonal_contact": "contacts.coulomb",
    "project_many": "contacts.project_many",
    "push": "motion.pushing",
    "push_along": "motion.pushing",
    "push_density": "actuators.density_field",
    "radial_field": "actuators.force_fields",
    "realise": "actuators.realised_field",
    "robustness": "planning.robustness",
    "section": "sets.sections",
    "separatrices": "planning.separatrices",
    "share_load": "contacts.load_sharing",
    "shift_squeeze_function": "planning.basin_steps",
    "simulate": "motion.simulate",
    "simulate_many": "motion.simulate_many",
    "skewed_equilibria": "planning.skewed_equilibria",
    "skewed_squeeze_field": "actuators.force_fields",
    "squeeze_activation": "actuators.activation",
    "squeeze_field": "actuators.force_fields",
    "squeeze_function": "planning.squeeze_function",
    "steady_walk": "motion.steady_walk",
    "sweep_resonators": "actuators.resonator_sweep",
    "transport": "sets.linear_image",
    "turn_function": "planning.turn_function",
    "uniform_field": "actuators.force_fields",
    "unknown_offset_function": "planning.basin_steps",
    "verify_alignment": "planning.verification",
    "walk": "motion.walk",
}
_MODULES = ("datasets", "errors", "plot", "units")
_EXTRAS = ("fitting",)  # needs more to be installed: not for ``import *``

__all__ = [*_HOME, *_MODULES]


def __getattr__(name: str) -> Any:
    """Import a public name from the module that defines it (PEP 562)."""
    if name in _HOME:
        return getattr(import_module(f"limitsurf.{_HOME[name]}"), name)
    if name in _MODULES + _EXTRAS:
        return import_module(f"limitsurf.{name}")
    raise AttributeError(f"module 'limitsurf' has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names."""
    return sorted([*__all__, *_EXTRAS, "__version__"])
