"""Fitted limit surfaces as model files: written by `to_toml`, read by `load_surface`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limitsurf.errors import InputError, ModelError
from limitsurf.modelfiles import Model, Sourced, load_model, number
from limitsurf.sets.contact_sum import ContactSum
from limitsurf.sets.convex_set import ConvexSet
from limitsurf.sets.ellipsoid import Ellipsoid
from limitsurf.sets.linear_image import LinearImage
from limitsurf.sets.polynomial_set import PolynomialSet
from limitsurf.sets.v_polytope import VPolytope

__all__ = ["load_surface", "surface_toml"]

Array = NDArray[np.float64]
Rows = list[list[float]]
Triple = tuple[float, float, float]

_HEAD = """description = {description}

# loads that the contacts exert on the part, in units of force, force and force * rho
[rho]
value = "{rho!r} m"
source = "chosen for the fit"

[force]
value = "{force!r} N"
source = {source}

"""


class EllipsoidTable(Model):
    """The set ``{center + axes u : |u| <= 1}``."""

    center: Triple
    axes: Rows


class QuarticTable(Model):
    """The set ``{center + x : sum_k coefficients_k x^exponents_k <= 1}``."""

    center: Triple
    exponents: list[list[int]]
    coefficients: list[float]


class ContactsTable(Model):
    """Contacts with friction, as in `ContactSum`; positions in units of rho."""

    center: Triple
    position: Rows
    radius: list[float]


class PolytopeTable(Model):
    """The convex hull of vertices."""

    vertices: Rows


class SurfaceFile(Model):
    """A limit surface: two units, and one table that names its kind."""

    description: str
    rho: number("m", above=0.0)  # type: ignore[valid-type]
    force: number("N", above=0.0)  # type: ignore[valid-type]
    ellipsoid: EllipsoidTable | None = None
    quartic: QuarticTable | None = None
    contacts: ContactsTable | None = None
    polytope: PolytopeTable | None = None


def surface_toml(surface: ConvexSet, rho: float, description: str, source: str) -> str:
    """Return a limit surface as the text of a model file.

    Parameters
    ----------
    surface : ConvexSet
        Ellipsoid, quartic, sum of contacts (disks) or polytope of loads [N, N, N m].
    rho : float
        Length that makes moments forces [m].
    description, source : str
        What it is, and where its numbers come from.

    Raises
    ------
    InputError
        Another kind of set.
    """
    widths = [0.5 * float(surface.support(d) + surface.support(-d)) for d in np.eye(3)[:2]]
    force = max(widths) or 1.0
    unit = np.array([force, force, force * rho])
    kind, table = _table(surface, unit, rho)
    rows = [f"{name} = {json.dumps(np.asarray(v).tolist())}" for name, v in table.items()]
    head = _HEAD.format(
        description=json.dumps(description), rho=float(rho), force=force, source=json.dumps(source)
    )
    return head + "\n".join([f"[{kind}]", *rows]) + "\n"


def load_surface(path: str | Path) -> ConvexSet:
    """Read a limit surface [N, N, N m] from a model file.

    Raises
    ------
    ModelError
        Unreadable file, a field that does not fit, or not exactly one kind of surface.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> ball = Ellipsoid(np.zeros(3), np.diag([2.0, 2.0, 0.1]))
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder) / "ball.toml"
    ...     _ = file.write_text(surface_toml(ball, 0.05, "a ball", "an example"))
    ...     load_surface(file)
    Ellipsoid(center [0., 0., 0.], semi-axes [2. , 2. , 0.1])
    """
    file = load_model(Path(path), SurfaceFile)
    rho, force = _value(file.rho), _value(file.force)
    unit = np.array([force, force, force * rho])
    given = [
        kind for kind in ("ellipsoid", "quartic", "contacts", "polytope") if getattr(file, kind)
    ]
    if len(given) != 1:
        raise ModelError(path, "", f"describes {len(given)} surfaces", remedy="keep one table")
    try:
        return _surface(getattr(file, given[0]), unit, rho)
    except ValueError as error:  # rows of different lengths, or what the sets refuse
        raise ModelError(path, given[0], str(error)) from error


def _value(given: Sourced) -> float:
    return given.value


def _table(surface: ConvexSet, unit: Array, rho: float) -> tuple[str, dict[str, Any]]:
    """Return the kind of a surface and its numbers in the given units."""
    if isinstance(surface, Ellipsoid):
        axes = surface.axes / unit[:, None]
        return "ellipsoid", {"center": surface.center / unit, "axes": axes}
    center = np.zeros(3)
    if isinstance(surface, LinearImage) and np.array_equal(surface.matrix, np.eye(3)):
        center = surface.offset
        surface = surface.set
    if isinstance(surface, PolynomialSet):
        powers = np.prod(unit**surface.exponents, axis=1)
        numbers = {"exponents": surface.exponents, "coefficients": surface.coefficients * powers}
        return "quartic", {"center": center / unit, **numbers}
    if isinstance(surface, ContactSum) and surface.stretch is None:
        places, radius = surface.position / rho, surface.radius / unit[0]
        return "contacts", {"center": surface.center / unit, "position": places, "radius": radius}
    if (polytope := surface.by_vertices()) is not None and isinstance(polytope, VPolytope):
        return "polytope", {"vertices": (polytope.vertices + center) / unit}
    raise InputError("surface", f"is a {type(surface).__name__}, which model files do not hold")


def _surface(table: Model, unit: Array, rho: float) -> ConvexSet:
    match table:
        case EllipsoidTable():
            return Ellipsoid(np.array(table.center) * unit, np.array(table.axes) * unit[:, None])
        case QuarticTable():
            powers = np.prod(unit ** np.array(table.exponents), axis=1)
            centred = PolynomialSet(table.exponents, table.coefficients / powers)
            offset = np.array(table.center) * unit
            return LinearImage(np.eye(3), centred, offset) if offset.any() else centred
        case ContactsTable():
            places = np.array(table.position).reshape(-1, 2) * rho
            return ContactSum(
                places, np.array(table.radius) * unit[0], np.array(table.center) * unit
            )
        case PolytopeTable():
            return VPolytope(np.array(table.vertices) * unit)
    raise AssertionError(table)
