"""Limit surfaces fitted to measured loads and motions, as scikit-learn estimators.

``ls.fitting.QuarticModel(rho=0.05).fit(loads, twists).surface_``. Needs the extra
``limitsurf[fit]``.
"""

from importlib.util import find_spec

if missing := [name for name in ("sklearn", "pandas") if find_spec(name) is None]:
    raise ImportError(
        f"limitsurf.fitting needs {' and '.join(missing)}: pip install 'limitsurf[fit]'"
    )

from limitsurf.fitting.actuator_model import ActuatorModel
from limitsurf.fitting.base import LimitSurfaceModel, angles_between
from limitsurf.fitting.bootstrap import Bootstrap, bootstrap
from limitsurf.fitting.compare_models import compare_models, default_models
from limitsurf.fitting.contact_model import ContactModel
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.model_comparison import ModelComparison
from limitsurf.fitting.polytope_model import PolytopeModel
from limitsurf.fitting.quartic_model import QuarticModel
from limitsurf.fitting.surface_files import load_surface
from limitsurf.fitting.three_point_model import ThreePointModel
from limitsurf.fitting.weights import weights_from_noise

__all__ = [
    "ActuatorModel",
    "Bootstrap",
    "ContactModel",
    "EllipsoidModel",
    "LimitSurfaceModel",
    "ModelComparison",
    "PolytopeModel",
    "QuarticModel",
    "ThreePointModel",
    "angles_between",
    "bootstrap",
    "compare_models",
    "default_models",
    "load_surface",
    "weights_from_noise",
]
