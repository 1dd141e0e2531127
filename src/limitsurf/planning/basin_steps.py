r"""Step functions of full motion: where starts from a known or an unknown offset come to rest.

Each unstable orientation j has a separatrix, and starts on its right come to rest at the stable
orientation j or beyond, those on its left at j - 1 or before. Over the offsets from which parts
start, the separatrix covers orientations from :math:`m_j` to :math:`M_j`: one point where the
offset is known, a band where it is not, or where the curve crosses that offset several times. So

.. math:: [\max_{j \le i} M_j, \; \min_{j > i} m_j) \to s_i

and starts between the left end of step i and the right end of step k come to one of
:math:`s_i \dots s_k`. That holds for empty steps too: where bands overlap, a step ends before it
begins, but its image still counts in every arc across it.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError, SolveFailed
from limitsurf.geometry.part import Part
from limitsurf.kernels.squeeze_flow import MOVING
from limitsurf.planning.ideal_squeeze import IdealSqueeze
from limitsurf.planning.separatrices import Separatrix, separatrices
from limitsurf.planning.squeeze_function import (
    LEAST_DIFFERENCE,
    SqueezeFunction,
    smallest_period,
    squeeze_function,
)
from limitsurf.planning.turn_function import turn_function
from limitsurf.tolerances import ANGLE

__all__ = ["centred_squeeze_function", "shift_squeeze_function", "unknown_offset_function"]

Array = NDArray[np.float64]
#: (offset [m], orientation [rad]) of a point of a separatrix.
Point = tuple[float, float]

_STEP_ERROR = 1e-9
_SYMMETRIC = 1e-6  # rad; steps of a symmetric part that lie this close map onto one another
_NEAR_IMAGE = 1e-4  # rad; a motion that rests at a stable orientation ends this close to it
_SURE = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5)  # rad on both sides of a border at which motions check it


def shift_squeeze_function(
    part: Part, mobility_ratio: float = 1.0, side: Literal["left", "right"] = "left"
) -> SqueezeFunction:
    """Return where a part comes to rest that starts beside a directed line.

    Parameters
    ----------
    part : Part
        The part.
    mobility_ratio : float
        See `IdealSqueeze`.
    side : {"left", "right"}
        On which side of the line, seen along it, the whole part starts.

    Returns
    -------
    SqueezeFunction
        Orientations modulo 2 pi, relative to the directed line: no half turn stays unknown.

    Raises
    ------
    InputError
        Another side, or a mobility ratio out of range.
    SolveFailed
        The borders of the basins hang on rounding; see `separatrices`.

    Examples
    --------
    >>> shift_squeeze_function(Part([(0, 0), (3, 0), (0, 4)]))
    SqueezeFunction([156.14, 322.85) -> 241.93, [322.85, 516.14) -> 421.93; period 360 deg)
    """
    if side not in ("left", "right"):
        raise InputError("side", "must be 'left' or 'right'", value=side)
    reach = 1.01 * part.circumradius
    first, second = (0, 1) if side == "left" else (1, 0)
    start = -reach if side == "left" else reach
    curves = separatrices(part, mobility_ratio)
    ends = [curve.ends[first] for curve in curves]
    ends += [curve.ends[second] + np.pi for curve in curves]
    bands = [((start, phi), (start, phi)) for phi in ends]
    return _steps(part, mobility_ratio, bands, 2 * np.pi, (start,))


def centred_squeeze_function(part: Part, mobility_ratio: float = 1.0) -> SqueezeFunction:
    """Return where a part comes to rest that starts with its centroid on the line.

    Parameters and errors as in `shift_squeeze_function`.

    Examples
    --------
    >>> centred_squeeze_function(Part([(0, 0), (2, 0), (2, 1), (0, 1)]))
    SqueezeFunction([90.00, 270.00) -> 180.00; period 180 deg)
    """
    bands = [_band_at(curve, 0.0) for curve in separatrices(part, mobility_ratio)]
    return _steps(part, mobility_ratio, bands, np.pi, (0.0,))


def unknown_offset_function(part: Part, mobility_ratio: float = 1.0) -> SqueezeFunction:
    """Return where a part comes to rest for sure, from whatever offset it starts.

    Orientations between two steps may come to either image; a step that ends before it begins
    is swallowed by the bands around it. Parameters and errors as in `shift_squeeze_function`.

    Examples
    --------
    >>> unknown_offset_function(Part([(0, 0), (3, 0), (0, 4)]))
    SqueezeFunction([156.14, 322.85) -> 241.93; period 180 deg)
    """
    bands = [curve.extremes for curve in separatrices(part, mobility_ratio)]
    reach = 1.01 * part.circumradius
    return _steps(part, mobility_ratio, bands, np.pi, tuple(np.linspace(-reach, reach, 5)))


def _band_at(curve: Separatrix, offset: float) -> tuple[Point, Point]:
    crossings = curve.crossings(offset)
    return (offset, float(crossings.min())), (offset, float(crossings.max()))


def _steps(
    part: Part,
    mobility_ratio: float,
    bands: list[tuple[Point, Point]],
    modulus: float,
    offsets: tuple[float, ...],
) -> SqueezeFunction:
    """Return the steps between bands, one for each saddle over the modulus, ascending."""
    if not bands:
        return SqueezeFunction(np.empty(0), np.empty(0), np.empty(0), modulus, modulus)
    nodes = squeeze_function(turn_function(part)).images
    images = np.concatenate([nodes, nodes + np.pi])[: len(bands)]
    before = np.append(images[-1] - modulus, images[:-1])
    drive = IdealSqueeze(mobility_ratio)
    edges = np.array(
        [
            [_confirmed(part, drive, point, left, right) for point in band]
            for band, left, right in zip(bands, before, images, strict=True)
        ]
    )
    breaks = np.maximum.accumulate(np.append(edges[:, 1] - modulus, edges[:, 1]))[len(bands) :]
    later = np.minimum.accumulate(np.append(edges[:, 0], edges[:, 0] + modulus)[::-1])[::-1]
    steps = np.column_stack([breaks, later[1 : len(bands) + 1], images])
    _confirm_middles(part, drive, steps, offsets)
    return _in_order(steps, modulus, part)


def _confirmed(part: Part, drive: IdealSqueeze, point: Point, left: float, right: float) -> float:
    """Return the orientation of a point if motions from both sides of it part there."""
    offset, phi = point
    for width in _SURE:
        ends = _images(part, drive, offset, np.array([phi - width, phi + width]))
        if ends[0] <= left + _NEAR_IMAGE and ends[1] >= right - _NEAR_IMAGE:
            return phi
    raise SolveFailed(
        f"motions do not part at the border of basins at {np.degrees(phi):.6g} deg; "
        "use a smaller mobility_ratio"
    )


def _confirm_middles(
    part: Part, drive: IdealSqueeze, steps: Array, offsets: tuple[float, ...]
) -> None:
    """Raise unless the middle of each step comes to its image from every offset."""
    wide = steps[steps[:, 1] - steps[:, 0] > 4 * _SURE[-1]]
    middles = 0.5 * (wide[:, 0] + wide[:, 1])
    for offset in offsets:
        ends = _images(part, drive, offset, middles)
        if not (np.abs(ends - wide[:, 2]) <= _NEAR_IMAGE).all():
            raise SolveFailed("a motion from the middle of a step does not come to its image")


def _images(part: Part, drive: IdealSqueeze, offset: float, phi: Array) -> Array:
    """Return where motions come to rest, not reduced; NaN if they do not."""
    _, ends, status = drive.settle(part, offset, phi, _STEP_ERROR)
    return np.where(status == MOVING, np.nan, ends)


def _in_order(steps: Array, modulus: float, part: Part) -> SqueezeFunction:
    """Return steps whose breaks ascend within one modulus, equal ones in the order of images."""
    steps = steps - modulus * np.floor(steps[:, :1] / modulus)
    steps = steps[np.lexsort((steps[:, 2], steps[:, 0]))]
    order = part.symmetry_order
    copies = order // 2 if modulus == np.pi and order % 2 == 0 else order
    steps, spread = _symmetric(steps, modulus, copies)
    breaks, ends, images = np.ascontiguousarray(steps.T)
    unsure = LEAST_DIFFERENCE * spread
    period = smallest_period(breaks, ends, images, modulus, max(ANGLE, unsure))
    return SqueezeFunction(breaks, ends, images, period, modulus)


def _symmetric(steps: Array, modulus: float, copies: int) -> tuple[Array, float]:
    """Return steps that repeat exactly, `copies` times, and how far they were from doing so."""
    turns = modulus / copies * np.arange(copies)[:, None, None]
    whole = len(steps) % copies == 0
    base = steps.reshape(copies, -1, 3) - turns if whole else steps[None]
    spread = float(np.ptp(base, axis=0).max())
    if not whole or spread > _SYMMETRIC:
        raise SolveFailed(
            f"the borders of the basins are not {copies} times symmetric, as the part is: they "
            "hang on rounding; use a smaller mobility_ratio"
        )
    return np.asarray((base.mean(axis=0) + turns).reshape(-1, 3)), spread
