"""The wanted numbers of an arm, and their derivatives by what is free, from its own law."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from pipeline.study.wishes.wish import PRESSURE, Wishes
from rod.arm_law.curves import CellCurve, ClampCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.quantities import Asked, jacobian
from rod.arm_law.rates import CellRate, ClampRate, LawRate


def numbers_of(law: ArmLaw, wishes: Wishes, values: Mapping[str, float]) -> Array:
    """(m,) all numbers of the wishes, one after the other; values: of what is free, by key.

    Raises `RodError` where the arm has no equilibrium.
    """
    return np.concatenate([one.of(law.at) for one in _asked(law, wishes, values)])


def rates_of(law: ArmLaw, wishes: Wishes, values: Mapping[str, float]) -> Array:
    """(m, n) derivatives of all numbers by what is free, per mm or kPa. Raises `RodError`.

    law: with derivatives by the free dimensions (`with_pressures` for the pressures).
    """
    asked = [one.of for one in _asked(law, wishes, values)]
    return jacobian(law.rods_after(list(values)), asked, [*map(law.step, values)])


def _asked(law: ArmLaw, wishes: Wishes, values: Mapping[str, float]) -> list[Asked]:
    pairs = [(wish, wish.pressure(values)) for wish in wishes.wishes]
    return [Asked(wish.quantity, pressure, law.at(pressure), wish.given) for wish, pressure in pairs]


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
