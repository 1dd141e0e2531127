r"""Coefficients of RODAS, a stiffly accurate, L-stable Rosenbrock method of order 4(3).

E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., section IV.7. Each of
six stages solves, with the Jacobian J at the beginning of the step,

.. math:: \left( \frac{1}{\gamma h} I - J \right) U_i = f(t + \alpha_i h, y + \sum_j a_{ij} U_j)
          + \frac1h \sum_j c_{ij} U_j + \gamma_i h f_t, \qquad y_1 = y + \sum_j a_{6j} U_j + U_6 ,

and :math:`U_6` estimates the error.
"""

from __future__ import annotations

import numpy as np

__all__ = ["ALPHA", "GAMMA", "RATES", "A", "C"]

GAMMA = 0.25
ALPHA = np.array([0.0, 0.386, 0.21, 0.63, 1.0, 1.0])
RATES = np.array([0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0])
A = np.zeros((6, 6))
A[1, 0] = 1.544
A[2, :2] = 0.9466785280815826, 0.2557011698983284
A[3, :3] = 3.314825187068521, 2.896124015972201, 0.9986419139977817
A[4, :4] = 1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950
A[5, :5] = *A[4, :4], 1.0
C = np.zeros((6, 6))
C[1, 0] = -5.6688
C[2, :2] = -2.430093356833875, -0.2063599157091915
C[3, :3] = -0.1073529058151375, -9.594562251023355, -20.47028614809616
C[4, :4] = 7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160
C[5, :5] = (
    8.083246795921522,
    -7.981132988064893,
    -31.52159432874371,
    16.31930543123136,
    -6.058818238834054,
)
