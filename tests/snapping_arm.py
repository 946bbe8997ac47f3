"""An arm whose chambers swell at a limit of the pressure, with a law in closed form.

Over the swelling v of a chamber the pressure without moment is

    p = 27 v (2 - v)                    up to v = 1, the limit at 27 kPa,
    p = 27 - 5 (3 t^2 - 2 t^3)          with t = (v - 1) / 2 up to v = 3, where the swollen form is lost at 22 kPa,
    p = 22 + 3 (v - 3)^2                beyond,

and the curvature is CURVED v.
"""

from dataclasses import replace

import numpy as np

from rod.arm_law.law import ArmLaw
from rod.arm_law.limit import PressureLimit
from rod.arm_law.rates import CellRate, ClampRate, LawRate
from rod.weight import Mass
from tests.measured_arm import EI, LENGTH, PITCH, parts_of

LIMIT, BACK = 27.0, 22.0
#: 1/mm per swelling; kPa per mm of a wall of 1 mm and per MPa of a modulus of 0.05 MPa, of the limit pressure
CURVED, BY_WALL, BY_MODULUS = -0.003, 40.0, LIMIT / 0.05
RISING, SWOLLEN = (0.0, 8.0, 15.0, 20.0, 23.0, 25.0, 26.0, 26.6), (22.1, 23.0, 25.0, 28.0, 32.0)


def kappa_0(pressure: float, *, after_snap: bool = False) -> float:
    """1/mm, without moment."""
    return CURVED * (3.0 + ((pressure - BACK) / 3.0) ** 0.5 if after_snap else 1.0 - (1.0 - pressure / LIMIT) ** 0.5)


def snapping_law(*, swells: bool = True) -> ArmLaw:
    """With a form after the snap, or without one."""
    v = np.linspace(1.0, 3.0, 21)
    t = (v - 1.0) / 2.0
    way = LIMIT - (LIMIT - BACK) * (3.0 * t**2 - 2.0 * t**3)
    rates = {"geometry.wall": BY_WALL, "material.mu": BY_MODULUS}
    limit, back = PressureLimit(LIMIT, 0.2, rates, way, CURVED * v), PressureLimit(BACK, 0.1)
    rising = replace(_form(RISING, after_snap=False), limit=limit)
    return replace(rising, back=back, swollen=_form(SWOLLEN, after_snap=True)) if swells else rising


def _form(pressures: tuple[float, ...], *, after_snap: bool) -> ArmLaw:
    step = 1e-3
    slopes = [(kappa_0(p + step, after_snap=after_snap) - kappa_0(p, after_snap=after_snap)) / step for p in pressures]
    rows = zip(pressures, (kappa_0(p, after_snap=after_snap) for p in pressures), slopes, strict=True)
    cells, clamps, tips = zip(*(parts_of(*row) for row in rows), strict=True)
    rates = {"geometry.wall": _rate(1.0, "mm", slopes, BY_WALL), "material.mu": _rate(0.05, "MPa", slopes, BY_MODULUS)}
    return ArmLaw(PITCH, 5.0, LENGTH, cells, clamps, tips, Mass.even(LENGTH, 20.0), rates=rates)


def _rate(value: float, unit: str, slopes: list[float], stiffer: float) -> LawRate:
    """As if it moved all pressures by as much as the limit."""
    cells = tuple(
        CellRate(EI * slope * stiffer * np.ones(9), np.zeros(9), np.zeros((9, 2, 2)), np.array(0.0)) for slope in slopes
    )
    clamps = tuple(ClampRate(np.zeros(9), np.zeros((9, 2))) for _ in slopes)
    return LawRate(value, unit, 0.0, 0.0, 0.0, cells, clamps)
