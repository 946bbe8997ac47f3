"""The arm's own law of an arm with two cavities in closed form."""

import numpy as np

from geometry.arrays import Array
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import fractions_of

PRESSURES = (0.0, 10.0, 20.0, 30.0)
KAPPA = np.linspace(-0.03, 0.03, 13)
LENGTH, PITCH = 60.0, 10.0
TURNS = 8


def moment(kappa: Array, first: float, second: float) -> tuple[Array, Array, Array, Array]:
    """N mm, and its derivatives by the curvature and both pressures; the arm without moment bends by 1e-5 (p2 - p1)."""
    rigidity = 200.0 + 2.0 * first + 2.0 * second + 0.05 * first * second
    bend = kappa - 1e-5 * (second - first) * (1.0 + 0.02 * (first + second))
    by_first = 1e-5 * (1.0 + 0.04 * first)
    by_second = -1e-5 * (1.0 + 0.04 * second)
    ones = np.ones_like(kappa)
    return (
        rigidity * bend,
        rigidity * ones,
        (2.0 + 0.05 * second) * bend + rigidity * by_first,
        (2.0 + 0.05 * first) * bend + rigidity * by_second,
    )


def rotation(moments: Array, first: float, second: float) -> tuple[Array, float, float, float]:
    """rad, and its derivatives by moment and both pressures."""
    return 1e-3 * moments + 1e-5 * (first - 2.0 * second), 1e-3, 1e-5, -2e-5


def ray(direction: float, positions: int = 3, highest: float = 30.0, stiffer: float = 1.0) -> ArmLaw:
    """The exact law on a ray; positions: nodes of the material curve in the clamped end; stiffer: factor of moments."""
    one, other = fractions_of(direction)
    cells, clamps, tips = [], [], []
    for pressure in (p for p in PRESSURES if p <= highest):
        first, second = one * pressure, other * pressure
        moments, rigidity, by_first, by_second = (stiffer * value for value in moment(KAPPA, first, second))
        ones = np.ones_like(KAPPA)
        cells.append(
            CellCurve(
                pressure=pressure,
                moment=moments,
                kappa=KAPPA,
                rigidity=rigidity,
                moment_by_pressure=one * by_first + other * by_second,
                stretch=1.0 + 1e-4 * (first + second) + 0.5 * KAPPA,
                stretch_by_kappa=0.5 * ones,
                stretch_by_pressure=1e-4 * (one + other) * ones,
                axial_rigidity=60.0 * ones,
                shear_rigidity=10.0 * ones,
                contact=np.zeros(len(KAPPA), bool),
                min_J=ones,
                s=np.array([0.0, PITCH / 2]),
                ripple=np.zeros((len(KAPPA), 2, 2)),
                moment_by_other=by_first if direction > 1.0 else by_second,
                stretch_by_other=1e-4 * ones,
            )
        )
        turns, by_moment, turn_first, turn_second = rotation(moments, first, second)
        clamps.append(
            ClampCurve(
                pressure=pressure,
                moment=moments,
                rotation=turns,
                rotation_by_moment=by_moment * ones,
                rotation_by_pressure=(one * turn_first + other * turn_second) * ones,
                offset=np.zeros((len(KAPPA), 2)),
                offset_by_moment=np.zeros((len(KAPPA), 2)),
                s=np.linspace(0.0, 5.0 * (positions - 1), positions),
                beside=np.zeros((len(KAPPA), positions, 2)),
                rotation_by_other=(turn_first if direction > 1.0 else turn_second) * ones,
            )
        )
        zeros = np.zeros((2, 2))
        held = np.zeros((TURNS, 2, 2))
        sides = np.array([-5.0, 0.0]), zeros, np.zeros(2), np.zeros(TURNS), np.zeros((TURNS, 2)), held, zeros, zeros
        tips.append(TipCurve(pressure, *sides))
    return ArmLaw(PITCH, PITCH / 2, LENGTH, tuple(cells), tuple(clamps), tuple(tips))
