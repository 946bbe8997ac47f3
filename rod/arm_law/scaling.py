"""The curves and derivatives of an arm whose moduli are all multiplied by a factor c, with the same Poisson ratios.

Stresses are then c times as large in every deformed state, and so are the pressures and forces that keep it in
equilibrium:

    M(kappa, p; c) = c M(kappa, p/c; 1),    stretch(kappa, p; c) = stretch(kappa, p/c; 1).

No finite elements are needed. The power of c by which a number is multiplied follows from its unit: one for each N or
kPa above the line, minus one for each below.
"""

import math
from dataclasses import fields, replace
from typing import Any, TypeVar, get_args

from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.rates import LawRate

Curve = TypeVar("Curve", CellCurve, ClampCurve, TipCurve)
#: units that hold a force
OF_FORCE = frozenset({"N", "kPa", "MPa"})


def power_of_modulus(key: str) -> int:
    """The power of the moduli in a number by its key with its unit, such as rotation_by_pressure_rad_per_kPa: -1."""
    above, _, below = key.partition("_per_")
    return sum(part in OF_FORCE for part in above.split("_")) - sum(part in OF_FORCE for part in below.split("_"))


def scaled_curve(curve: Curve, factor: float) -> Curve:
    """The curve of a cell or an end whose moduli are all multiplied by a factor, at its pressure times that factor."""
    changed: dict[str, Any] = {}
    for field in fields(curve):
        if power := power_of_modulus(get_args(field.type)[1]):
            changed[field.name] = getattr(curve, field.name) * factor**power
    return replace(curve, **changed)


def scaled_rate(rate: LawRate, factor: float) -> LawRate:
    """The derivatives of a law whose moduli are all multiplied by a factor, by the same parameter."""
    unit = factor ** power_of_modulus(rate.unit)
    return replace(rate.times(1.0 / unit).with_moments([factor] * len(rate.cells)), value=rate.value * unit)


def stiffened_cell(curve: CellCurve, rate: float) -> CellCurve:
    """The curve of a cell whose moduli are those of the pressure p, exp(rate p) times as large.

    rate: 1/kPa. At the pressure p exp(rate p) its states are those at p.
    """
    factor, slower = _growth(curve.pressure, rate)
    own = curve.moment_by_pressure + rate * curve.moment
    return replace(
        scaled_curve(curve, factor),
        moment_by_pressure=own / slower,
        stretch_by_pressure=curve.stretch_by_pressure / (factor * slower),
    )


def stiffened_clamp(curve: ClampCurve, rate: float) -> ClampCurve:
    """The same of a clamped end."""
    factor, slower = _growth(curve.pressure, rate)
    own = curve.rotation_by_pressure - rate * curve.moment * curve.rotation_by_moment
    return replace(scaled_curve(curve, factor), rotation_by_pressure=own / (factor * slower))


def _growth(pressure: float, rate: float) -> tuple[float, float]:
    """The factor of the moduli at a pressure, and by how much more than that the pressure grows with it."""
    return math.exp(rate * pressure), 1.0 + rate * pressure
