"""The explicit sixth-order Runge-Kutta method of H. A. Luther, Math. Comp. 22 (1968) 434-436: seven stages."""

import math

import numpy as np

_ROOT = math.sqrt(21.0)
#: where a step of length 1 evaluates kappa_0
ABSCISSAE = np.array([0.0, 1.0, 1 / 2, 2 / 3, (7 - _ROOT) / 14, (7 + _ROOT) / 14])
#: which of ABSCISSAE every one of the seven stages stands at
STAGE_ABSCISSA = np.array([0, 1, 2, 3, 4, 5, 1])
STAGES = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [1, 0, 0, 0, 0, 0],
        [3 / 8, 1 / 8, 0, 0, 0, 0],
        [8 / 27, 2 / 27, 8 / 27, 0, 0, 0],
        [3 * (3 * _ROOT - 7) / 392, -8 * (7 - _ROOT) / 392, 48 * (7 - _ROOT) / 392, -3 * (21 - _ROOT) / 392, 0, 0],
        [
            -5 * (231 + 51 * _ROOT) / 1960,
            -40 * (7 + _ROOT) / 1960,
            -320 * _ROOT / 1960,
            3 * (21 + 121 * _ROOT) / 1960,
            392 * (6 + _ROOT) / 1960,
            0,
        ],
        [
            15 * (22 + 7 * _ROOT) / 180,
            120 / 180,
            40 * (7 * _ROOT - 5) / 180,
            -63 * (3 * _ROOT - 2) / 180,
            -14 * (49 + 9 * _ROOT) / 180,
            70 * (7 - _ROOT) / 180,
        ],
    ]
)
WEIGHTS = np.array([9, 0, 64, 0, 49, 49, 9]) / 180
