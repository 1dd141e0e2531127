"""Who carries a part on an array: the active tips, or all of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from scipy.constants import g

from limitsurf.actuators.activation import Activation
from limitsurf.contacts.contact_set import ContactSet
from limitsurf.errors import InputError, PartTooHeavy
from limitsurf.geometry.part import Part

__all__ = ["Carried", "carry"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Carried:
    """A part on an activated array.

    If the active tips can carry the weight, they lift the part and the inactive ones hang free
    below it. If not, the part rests on all tips, and those that do not run hold it: of four in a
    pixel, three with up to 3/4 mu W against a push of at most 1/4 mu W.

    Attributes
    ----------
    lifted : bool
        Whether the active tips carry the part.
    active, passive : int
        Tips under the part that run, and that do not.
    load_per_active, load_per_passive : float
        Normal force on each [N].
    vertical_force : float
        What one active tip lifts [N].
    voltage, lifting_voltage : float
        In use, and needed to lift the part [V]; the latter infinite without active tips.
    contacts : ContactSet
        The tips that touch, from the part's centroid in the array's axes, at rest.
    """

    lifted: bool
    active: int
    passive: int
    load_per_active: float
    load_per_passive: float
    vertical_force: float
    voltage: float
    lifting_voltage: float
    contacts: ContactSet

    def require_lifted(self) -> None:
        """Raise PartTooHeavy, which names the voltage needed, unless the part is lifted."""
        if not self.lifted:
            weight = self.load_per_active * self.active + self.load_per_passive * self.passive
            share = weight / self.active if self.active else np.inf
            raise PartTooHeavy(share, self.vertical_force, self.voltage, self.lifting_voltage)


def carry(activation: Activation, part: Part, pose: ArrayLike = (0.0, 0.0, 0.0)) -> Carried:
    """Return who carries a part, sharing its weight equally.

    Parameters
    ----------
    activation : Activation
        The activated array.
    part : Part
        The part, with areal density.
    pose : (3,) float
        Pose of the part in the array's frame [m, m, rad].

    Examples
    --------
    >>> from limitsurf.actuators.activation import squeeze_activation
    >>> from limitsurf.actuators.actuator_array import load_array
    >>> part = Part.from_file("paper_t")
    >>> [carry(squeeze_activation(load_array("resonator64", voltage=v), 0.0), part).lifted
    ...  for v in (50, 15)]
    [True, False]
    """
    array, pixel = activation.array, activation.array.pixel
    spots, runs, pushes = _under(activation, part.at(pose))
    if len(spots) == 0:
        raise InputError("pose", "puts no tip under the part", value=tuple(np.asarray(pose)))
    active, weight = int(runs.sum()), part.mass * g
    force = pixel.vertical_force(array.voltage)
    lifted = active > 0 and weight <= active * force
    load = weight / (active if lifted else len(spots))
    touching = runs if lifted else np.ones_like(runs)
    grip = np.where(runs, pixel.residual_fraction, 1.0) * pixel.friction * load
    push = np.where(runs[:, None], pixel.offset_fraction * pixel.friction * load * pushes, 0.0)
    arms = spots - np.asarray(pose, np.float64)[:2]
    return Carried(
        lifted=lifted,
        active=active,
        passive=len(spots) - active,
        load_per_active=load if active else 0.0,
        load_per_passive=0.0 if lifted else load,
        vertical_force=force,
        voltage=array.voltage,
        lifting_voltage=pixel.lifting_voltage(weight / active) if active else float("inf"),
        contacts=ContactSet(arms[touching], grip[touching], push[touching]),
    )


def _under(
    activation: Activation, outline: shapely.Geometry
) -> tuple[Array, NDArray[np.bool_], Array]:
    """Return positions, whether they run, and pushes of the tips under an outline."""
    array = activation.array
    x0, y0 = array.first_site
    rows, columns = np.indices(activation.active.shape)
    spots = np.stack([x0 + array.site_pitch * columns, y0 + array.site_pitch * rows], axis=-1)
    shapely.prepare(outline)
    inside = shapely.contains_xy(outline, spots[..., 0], spots[..., 1])
    runs = activation.running
    return spots[inside], runs[inside], array.site_directions[inside]
