"""Check what users hand to sets: shapes, finite numbers, metrics."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from numbers import Integral
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limitsurf.errors import InputError

__all__ = [
    "Metric",
    "as_array",
    "as_count",
    "as_instance",
    "as_number",
    "as_numbers",
    "as_points",
    "as_positive",
    "as_rows",
    "check_effort",
    "lifted",
    "read_metric",
    "writable",
]

Array = NDArray[np.float64]
T = TypeVar("T", bound=np.generic)
K = TypeVar("K")


def as_array(name: str, value: ArrayLike, *shape: int | None, copy: bool = True) -> Array:
    """Return a read-only float array of the given shape; None leaves a length open.

    Without `copy` it may be the caller's own array, as it is: for what is copied anyway.

    Raises
    ------
    InputError
        No numbers, not finite, or another shape; names the argument and both shapes.
    """
    try:
        array = np.array(value, dtype=np.float64, copy=copy or None)
    except (TypeError, ValueError) as error:
        raise InputError(name, "is no array of numbers", remedy="check its entries") from error
    if array.size == 0 and array.ndim < len(shape):
        array = array.reshape([length or 0 for length in shape])
    fits = array.ndim == len(shape) and all(
        length is None or length == found for length, found in zip(shape, array.shape, strict=True)
    )
    if not fits:
        wanted = tuple("any" if length is None else length for length in shape)
        raise InputError(name, f"has shape {array.shape}, not {wanted}".replace("'", ""))
    if not np.isfinite(array).all():
        raise InputError(name, "has entries that are not finite", remedy="remove NaN and inf")
    if copy:
        array.setflags(write=False)
    return array


def as_number(name: str, value: Any) -> float:
    """Return a number, perhaps not finite, as a float; InputError for anything else."""
    try:
        number = np.asarray(value)
        if number.ndim == 0 and number.dtype.kind in "biuf":
            return float(number)
    except (TypeError, ValueError):
        pass
    raise InputError(name, "is no number", value=value, remedy="give one in SI units")


def as_numbers(name: str, value: ArrayLike) -> Array:
    """Return finite numbers of any shape; InputError for anything else."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(name, "is no array of numbers", remedy="check its entries") from error
    if not np.isfinite(array).all():
        raise InputError(name, "must be finite", value=value, remedy="remove NaN and inf")
    return array


def as_instance(name: str, value: Any, kind: type[K], remedy: str = "") -> K:
    """Return an object of a class; InputError for anything else."""
    if not isinstance(value, kind):
        raise InputError(name, f"is no {kind.__name__}", value=value, remedy=remedy)
    return value


def as_positive(name: str, value: Any) -> float:
    """Return a positive, finite number as a float; InputError for anything else."""
    number = as_number(name, value)
    if not (np.isfinite(number) and number > 0.0):
        raise InputError(name, "must be positive", value=value)
    return number


def as_count(name: str, value: Any, least: int = 1) -> int:
    """Return a whole number from `least` on as an int; InputError for anything else."""
    whole = type(value) is int or (isinstance(value, Integral) and not isinstance(value, bool))
    if not whole or value < least:
        raise InputError(name, f"must be a whole number from {least} on", value=value)
    return int(value)


def as_points(name: str, value: ArrayLike, dim: int) -> tuple[Array, tuple[int, ...]]:
    """Return finite points (..., dim) as rows (k, dim), with the leading shape."""
    rows, shape = as_rows(name, value, dim)
    if not np.isfinite(rows).all():
        raise InputError(name, "has entries that are not finite", remedy="remove NaN and inf")
    return rows, shape


def as_rows(name: str, value: ArrayLike, dim: int) -> tuple[Array, tuple[int, ...]]:
    """Return points (..., dim), perhaps not finite, as rows (k, dim), with the leading shape."""
    try:
        points = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(name, "is no array of numbers", remedy="check its entries") from error
    if points.ndim == 0 or points.shape[-1] != dim:
        raise InputError(name, f"has shape {points.shape}, not (..., {dim})")
    return writable(points.reshape(-1, dim)), points.shape[:-1]


def writable(array: NDArray[T]) -> NDArray[T]:
    """Return an array, or a copy without gaps: kernels are compiled anew for other layouts."""
    ready = array.flags.writeable and array.flags.c_contiguous
    return array if ready else np.array(array, order="C")


def check_effort(tol: float, threads: int) -> None:
    """Check a relative tolerance and a number of threads."""
    if not 0.0 < tol < 1.0:
        raise InputError("tol", "must lie between 0 and 1", value=tol)
    as_count("threads", threads)


@dataclass(frozen=True, eq=False)
class Metric:
    """A metric W = C'C with C upper triangular; `identity` if W is the identity."""

    W: Array
    C: Array
    identity: bool

    def into(self, points: Array) -> Array:
        """Return ``C x`` for rows x: coordinates in which the metric is the identity."""
        return points if self.identity else points @ self.C.T

    def back(self, points: Array) -> Array:
        """Return ``C^-1 x`` for rows x."""
        if self.identity:
            return points
        return np.asarray(np.linalg.solve(self.C, points.T).T, dtype=np.float64)

    def unlifted(self, closest: Array, points: Array, inside: NDArray[np.bool_]) -> Array:
        """Return what a kernel found in `lifted` coordinates; points inside as they were."""
        found = self.back(closest[:, : points.shape[1]])
        return found if self.identity else np.where(inside[:, None], points, found)


def read_metric(metric: ArrayLike | None, dim: int) -> Metric:
    """Return a metric given as a matrix, as its diagonal, or None for the identity.

    Raises
    ------
    InputError
        Wrong shape, not symmetric, or not positive definite.
    """
    if metric is None:
        return _identity(dim)
    matrix = np.asarray(metric, dtype=np.float64)
    matrix = np.diag(matrix) if matrix.ndim == 1 else matrix
    if matrix.shape != (dim, dim):
        raise InputError("metric", f"has shape {np.shape(metric)}, not ({dim},) or ({dim}, {dim})")
    if not np.isfinite(matrix).all() or not np.allclose(matrix, matrix.T, rtol=1e-12, atol=0.0):
        raise InputError("metric", "must be finite and symmetric")
    try:
        factor = np.asarray(np.linalg.cholesky(matrix).T, dtype=np.float64)
    except np.linalg.LinAlgError as error:
        raise InputError("metric", "is not positive definite") from error
    return Metric(matrix, factor, identity=bool(np.array_equal(matrix, np.eye(dim))))


@cache
def _identity(dim: int) -> Metric:
    return Metric(np.eye(dim), np.eye(dim), identity=True)


def lifted(points: Array) -> Array:
    """Return points in up to three dimensions with zeros for those that are missing."""
    k, n = points.shape
    space = np.zeros((k, 3))  # a copy: kernels are compiled anew for read-only arrays
    space[:, :n] = points
    return space
