"""Numerical tolerances, each with the reason for its size.

All are relative: lengths to the square root of the part's area, angles in radians, forces to the
sum of the contact radii and the load.
"""

from __future__ import annotations

from typing import Final

__all__ = [
    "ANGLE",
    "CONTACT_STEP",
    "CONTACT_SUM",
    "FLATTEN",
    "FLAT_MOMENT",
    "GIVEN_LOAD",
    "GOAL",
    "LINE_MARGIN",
    "NEUTRAL",
    "REST_SPEED",
    "SHARED_LOAD",
    "TIP_AT_REST",
    "TIP_WIDTH",
]

#: Two orientations closer than this are one. Simple roots of U' are found to about 1e-15;
#: a double root, which rounding splits, comes apart by the square root of that.
ANGLE: Final = 1e-9

#: |U'| below this (area 1, centroid at the origin) is rounding: a moment sum of terms of size 1.
FLAT_MOMENT: Final = 2e-15

#: Error bound that a projection on a sum of contacts must certify, relative to sum m_i + |c|.
CONTACT_SUM: Final = 1e-12

#: The same for the steps of a simulation, whose own errors are larger.
CONTACT_STEP: Final = 1e-9

#: Chord error when curves of a drawing become polygons, relative to the drawing's diagonal.
FLATTEN: Final = 2e-4

#: How far the end of a plan on given lines may be from its goal [rad]: goals are copied from
#: messages with five decimals of a degree, or rounded by hand, and no array is that accurate.
GOAL: Final = 1e-6

#: A plan whose margin is below this is no plan: rounding alone could break it.
LINE_MARGIN: Final = 1e-9

#: A part whose critical angle [rad] is below this is neutral in practice: a force direction off by
#: six seconds of arc outweighs every moment. Polygons of a disk or of a Zindler curve are.
NEUTRAL: Final = 3e-5

#: Slower than this, relative to the speed that the drive can give, is at rest. Friction lets an
#: overdamped part approach the edge of its resting set exponentially, without ever reaching it.
REST_SPEED: Final = 1e-5

#: Distance from an oscillating tip's line within which its Hessian is smoothed, relative to the
#: largest tip speed: well below speeds that matter, well above their rounding.
TIP_WIDTH: Final = 1e-6

#: The same if no tip moves, and no speed is known to measure by [m/s].
TIP_AT_REST: Final = 1e-12

#: Forces and moments that shared loads may leave unbalanced, relative to the weight and to the size
#: of the support: rounding of the sums over a million contacts.
SHARED_LOAD: Final = 1e-12

#: The same for loads that a user gives: sums of numbers with nine digits.
GIVEN_LOAD: Final = 1e-9
