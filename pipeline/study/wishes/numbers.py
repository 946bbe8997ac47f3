"""The wanted numbers of an arm, and their derivatives by what is free, from its own law."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from pipeline.study.wishes.wish import PRESSURE, Wish, Wishes
from pipeline.values.run import bending_deg
from rod.arm_law.curves import CellCurve, ClampCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.rates import CellRate, ClampRate, LawRate
from rod.mechanics.equilibrium import Rod

#: displacement of the tip over the length, to both sides, over which its stiffness is meant
DEFLECTION = 0.01


def numbers_of(law: ArmLaw, wishes: Wishes, values: Mapping[str, float]) -> Array:
    """(m,) all numbers of the wishes, one after the other; values: of what is free, by key.

    Raises `RodError` where the arm has no equilibrium.
    """
    return np.concatenate([_number(law, wish, wish.pressure(values)) for wish in wishes.wishes])


def rates_of(law: ArmLaw, wishes: Wishes, values: Mapping[str, float]) -> Array:
    """(m, n) derivatives of all numbers by what is free, per mm or kPa. Raises `RodError`.

    law: with derivatives by the free dimensions (`with_pressures` for the pressures).
    """
    columns = []
    for key in values:
        step = law.step(key)
        less, more = (numbers_of(law.with_changes({key: sign * step}), wishes, values) for sign in (-1.0, 1.0))
        columns.append((more - less) / (2.0 * step))
    return np.array(columns).T


def with_pressures(law: ArmLaw, values: Mapping[str, float]) -> ArmLaw:
    """The law with derivatives by the free pressures as well, which its curves have: of the curve at that pressure
    alone, which then is that of a higher one. values: of what is free, by key."""
    rates = dict(law.rates)
    for key, at in values.items():
        if key.startswith(PRESSURE):
            cells = tuple(_by_pressure(cell, float(cell.pressure == at)) for cell in law.cells)
            clamps = tuple(_turned_by_pressure(clamp, float(clamp.pressure == at)) for clamp in law.clamps)
            rates[key] = LawRate(at, "kPa", 0.0, 0.0, 0.0, cells, clamps)
    return replace(law, rates=rates)


def _by_pressure(cell: CellCurve, part: float) -> CellRate:
    ripple = np.zeros((len(cell.moment), 2, 2))
    return CellRate(part * cell.moment_by_pressure, part * cell.stretch_by_pressure, ripple, np.zeros(()))


def _turned_by_pressure(clamp: ClampCurve, part: float) -> ClampRate:
    return ClampRate(part * clamp.rotation_by_pressure, np.zeros_like(clamp.offset))


def _number(law: ArmLaw, wish: Wish, pressure: float) -> Array:
    """(1,), or (2,) of a tip."""
    rod = Rod(law.length, law=law.at(pressure))
    if wish.quantity == "kappa_0":
        return np.array([law.at(pressure).section.kappa_0])
    if wish.quantity == "force":
        return np.array([rod.solve(end_y=wish.height_mm).force[1]])
    shape = rod.solve()
    if wish.quantity == "tip":
        return np.array(shape.end, dtype=float)
    if wish.quantity == "angle":
        x, y = shape.end
        return np.array([bending_deg((float(x), float(y)))])
    turn, force = float(shape.theta[-1]), DEFLECTION * law.length * abs(wish.target[0])
    across = np.array([-np.sin(turn), np.cos(turn)])
    back, ahead = (np.array(rod.solve(tuple(sign * force * across)).end) for sign in (-1.0, 1.0))
    return np.array([2.0 * force / float((ahead - back) @ across)])  # the stiffness, of a force to both sides
