"""The wanted numbers of an arm, and their derivatives by what is free, from its own law."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from pipeline.results.values import bending_deg
from pipeline.wishes.wish import PRESSURE, Wish, Wishes
from rod.arm_law.curves import CellCurve, ClampCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.rates import CellRate, ClampRate, LawRate
from rod.mechanics.equilibrium import Rod
from rod.solution import RodSolution

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


def with_pressures(law: ArmLaw, wishes: Wishes, values: Mapping[str, float]) -> ArmLaw:
    """The law with derivatives by the free pressures as well, which its curves have: of the curve at that pressure
    alone, which then is that of a higher one."""
    rates = dict(law.rates)
    for name in wishes.pressures:
        at = values[f"{PRESSURE}{name}"]
        cells = tuple(_by_pressure(cell, cell.pressure == at) for cell in law.cells)
        clamps = tuple(_turned_by_pressure(clamp, clamp.pressure == at) for clamp in law.clamps)
        rates[f"{PRESSURE}{name}"] = LawRate(at, "kPa", 0.0, 0.0, 0.0, cells, clamps)
    return replace(law, rates=rates)


def _by_pressure(cell: CellCurve, is_here: bool) -> CellRate:
    part, count = float(is_here), len(cell.moment)
    ripple, still = np.zeros((count, 2, 2)), np.zeros(())
    return CellRate(part * cell.moment_by_pressure, part * cell.stretch_by_pressure, ripple, still)


def _turned_by_pressure(clamp: ClampCurve, is_here: bool) -> ClampRate:
    return ClampRate(float(is_here) * clamp.rotation_by_pressure, np.zeros_like(clamp.offset))


def _number(law: ArmLaw, wish: Wish, pressure: float) -> Array:
    return np.atleast_1d(_NUMBERS[wish.quantity](law, wish, pressure))


def _kappa_0(law: ArmLaw, _: Wish, pressure: float) -> float:
    return law.at(pressure).section.kappa_0


def _angle(law: ArmLaw, _: Wish, pressure: float) -> float:
    x, y = tip_at(law, pressure)
    return bending_deg((float(x), float(y)))


def _tip(law: ArmLaw, _: Wish, pressure: float) -> Array:
    return tip_at(law, pressure)


def _force(law: ArmLaw, wish: Wish, pressure: float) -> float:
    return float(_rod(law, pressure).solve(end_y=wish.height_mm).force[1])


def _stiffness(law: ArmLaw, wish: Wish, pressure: float) -> float:
    """Of a force across the end of the inflated arm, to both sides, over the displacement along it."""
    rod = _rod(law, pressure)
    turn = float(rod.solve().theta[-1])
    across = np.array([-np.sin(turn), np.cos(turn)])
    force = DEFLECTION * law.length * abs(wish.target[0])
    back, ahead = (_end(rod.solve(tuple(sign * force * across))) for sign in (-1.0, 1.0))
    return 2.0 * force / float((ahead - back) @ across)


def tip_at(law: ArmLaw, pressure: float) -> Array:
    """(2,) mm: the tip of the arm without load, from its clamp. Raises `RodError`."""
    return _end(_rod(law, pressure).solve())


def _rod(law: ArmLaw, pressure: float) -> Rod:
    return Rod(law.length, law=law.at(pressure))


def _end(shape: RodSolution) -> Array:
    return np.array([float(value) for value in shape.end])


_NUMBERS: dict[str, Callable[[ArmLaw, Wish, float], float | Array]] = {
    "kappa_0": _kappa_0,
    "angle": _angle,
    "tip": _tip,
    "force": _force,
    "stiffness": _stiffness,
}
