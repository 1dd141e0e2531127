r"""Torsional stiffness of a rod of rectangular section, isotropic or cut from a crystal.

Prandtl's stress function on a section of width w (thin) and height h, with the shear modulus
:math:`G_t` of the tall faces and :math:`G_f` of the flat ones: the orthotropic section is the
isotropic one of modulus :math:`G_t` after the height is scaled by :math:`\sqrt{G_f/G_t}`. Hence

.. math:: \frac{k L}{G_t} = h w^3 \Big(\frac13 - \frac{64}{\pi^5 r}
   \sum_{n\,\mathrm{odd}} \frac{\tanh(n\pi r/2)}{n^5}\Big), \quad r = \frac hw\sqrt{G_f/G_t}.

S. Timoshenko and J. N. Goodier, *Theory of Elasticity*, 3rd ed., 1970, section 109; scaling as in
S. G. Lekhnitskii, *Theory of Elasticity of an Anisotropic Body*, 1963.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["rod_stiffness", "torsion_constant"]

_ODD = np.arange(1.0, 60.0, 2.0)  # the rest of the series is below 1e-8 of a small term ...
_TAIL = 31.0 / 32.0 * 1.0369277551433699263  # ... and is added exactly: sum of 1/n^5 over odd n


def torsion_constant(
    width: ArrayLike, height: ArrayLike, modulus_ratio: ArrayLike = 1.0
) -> NDArray[np.float64]:
    r"""Return the torsion constant [m^4] of rectangles; stiffness of a length L is G_t J / L.

    Parameters
    ----------
    width, height : array_like
        Sides [m]; either may be the larger.
    modulus_ratio : array_like
        ``G_f / G_t``, shear modulus in the plane of the flat faces (normal to `height`) over that
        of the tall ones.

    Examples
    --------
    A square of side 1 has 0.1406 (Timoshenko and Goodier, table of section 109):

    >>> round(float(torsion_constant(1.0, 1.0)), 4)
    0.1406
    """
    w, h, ratio = (np.asarray(x, np.float64)[..., None] for x in (width, height, modulus_ratio))
    r = h / w * np.sqrt(ratio)
    terms = (np.tanh(0.5 * np.pi * _ODD * r) - 1.0) / _ODD**5
    total = _TAIL + terms.sum(axis=-1)
    constant = h[..., 0] * w[..., 0] ** 3 * (1 / 3 - 64 / np.pi**5 * total / r[..., 0])
    return np.asarray(constant)


def rod_stiffness(
    width: ArrayLike,
    height: ArrayLike,
    length: ArrayLike,
    shear_tall: ArrayLike,
    shear_flat: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Return the torque per angle [N m] of one rod clamped at one end.

    Parameters
    ----------
    width, height, length : array_like
        Section and length [m].
    shear_tall, shear_flat : array_like
        Shear moduli [Pa] in the planes of the tall and of the flat faces; equal by default.

    Examples
    --------
    >>> float(rod_stiffness(1e-6, 3e-6, 30e-6, 79.6e9)).__format__(".3g")
    '2.1e-09'
    """
    flat = shear_tall if shear_flat is None else shear_flat
    ratio = np.asarray(flat, np.float64) / np.asarray(shear_tall, np.float64)
    constant = torsion_constant(width, height, ratio)
    return np.asarray(np.asarray(shear_tall) * constant / np.asarray(length))
