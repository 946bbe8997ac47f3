"""Curves of a law whose states move: to other moments, curvatures and stretches, by as much as the pressure says.

A law changes in this way when all moduli are multiplied by a factor c with the same Poisson ratios, when they grow with
the pressure, when it is corrected to the limit of its mesh, and when its rubber departs from that of a law in the
second order of the strain. No finite elements are needed.

With a factor c of the moduli, stresses are c times as large in every deformed state, and so are the pressures and
forces that keep it in equilibrium:

    M(kappa, p; c) = c M(kappa, p/c; 1),    stretch(kappa, p; c) = stretch(kappa, p/c; 1).

The power of c by which a number is multiplied follows from its unit: one for each N or kPa above the line, minus one
for each below.

Rubbers of equal moduli have equal stresses up to terms with the square of the strain. Under a pressure p the strains of
an arm are of the order

    e = p h^2 / EA,    h^2 = 12 EI / EA,

with EI and EA without moment; h is the height of a solid bar with these rigidities. So the curvature without moment may
differ by a multiple of e^2 / h, and the stretch by a multiple of e^2. Arms without gaps bend by the small difference of
what their two sides stretch, of which the first order nearly vanishes in an incompressible round wall. The second order
then decides how far they bend.
"""

import math
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any, TypeVar, final

import numpy as np

from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve, key_of
from rod.arm_law.rates import LawRate

Curve = TypeVar("Curve", CellCurve, ClampCurve, TipCurve)
#: units that hold a force
OF_FORCE = frozenset({"N", "kPa", "MPa"})
#: MPa
KPA = 1e-3


@final
@dataclass(frozen=True)
class Move:
    """How the states at one pressure move, and the slopes of that by the pressure.

    M -> ratio M, kappa -> kappa + shift, stretch -> stretch + longer.
    """

    shift: float = 0.0  #: 1/mm
    ratio: float = 1.0
    longer: float = 0.0
    shift_slope: float = 0.0  #: 1/mm per kPa
    ratio_slope: float = 0.0  #: 1/kPa
    longer_slope: float = 0.0  #: 1/kPa
    faster: float = 1.0  #: by how much the pressure to which states move grows with that at which they are


def moved_cell(curve: CellCurve, by: Move) -> CellCurve:
    """The states of a cell at other moments and curvatures; what a state has besides stays with it.

    But for the air, in equal parts that of all cavities: dM/dp at fixed curvature is minus its slope by the curvature.
    """
    by_pressure = by.ratio * curve.moment_by_pressure + by.ratio_slope * curve.moment
    stretch_by_pressure = curve.stretch_by_pressure - curve.stretch_by_kappa * by.shift_slope + by.longer_slope
    volume = curve.volume
    if volume.size:
        volume = volume + by.ratio * by.shift_slope * curve.moment[:, None] / (KPA * volume.shape[1])
    return replace(
        curve,
        moment=by.ratio * curve.moment,
        kappa=curve.kappa + by.shift,
        rigidity=by.ratio * curve.rigidity,
        stretch=curve.stretch + by.longer,
        moment_by_pressure=(by_pressure - by.ratio * curve.rigidity * by.shift_slope) / by.faster,
        stretch_by_pressure=stretch_by_pressure / by.faster,
        moment_by_other=by.ratio * curve.moment_by_other,
        volume=volume,
    )


def moved_clamp(curve: ClampCurve, by: Move) -> ClampCurve:
    """The states of a clamped end at other moments."""
    turned = curve.rotation_by_moment * curve.moment * by.ratio_slope / by.ratio
    return replace(
        curve,
        moment=by.ratio * curve.moment,
        rotation_by_moment=curve.rotation_by_moment / by.ratio,
        rotation_by_pressure=(curve.rotation_by_pressure - turned) / by.faster,
        offset_by_moment=curve.offset_by_moment / by.ratio,
    )


def power_of_modulus(key: str) -> int:
    """The power of the moduli in a number by its key with its unit, such as rotation_by_pressure_rad_per_kPa: -1."""
    above, _, below = key.partition("_per_")
    return sum(part in OF_FORCE for part in above.split("_")) - sum(part in OF_FORCE for part in below.split("_"))


def scaled_curve(curve: Curve, factor: float) -> Curve:
    """The curve of a cell or an end whose moduli are all multiplied by a factor, at its pressure times that factor."""
    kind: Any = type(curve)
    return replace(curve, **{name: getattr(curve, name) * factor**power for name, power in _powers(kind)})


@cache
def _powers(kind: type[Curve]) -> list[tuple[str, int]]:
    """Fields of a kind of curve that change with the moduli, and the power of each."""
    return [(field.name, power) for field in fields(kind) if (power := power_of_modulus(key_of(field)))]


def scaled_rate(rate: LawRate, factor: float) -> LawRate:
    """The derivatives of a law whose moduli are all multiplied by a factor, by the same parameter."""
    unit = factor ** power_of_modulus(rate.unit)
    return replace(rate.times(1.0 / unit).with_moments([factor] * len(rate.cells)), value=rate.value * unit)


def growing(pressure: float, rate: float) -> tuple[float, Move]:
    """The factor exp(rate p) of moduli that grow with the pressure, and the move of states before it.

    rate: 1/kPa. At the pressure p exp(rate p) the states are those at p, scaled by the factor.
    """
    return math.exp(rate * pressure), Move(ratio_slope=rate, faster=1.0 + rate * pressure)


def second_order(cell: CellCurve, bend: float, stretch: float) -> Move:
    """The move by which the curvature without moment differs by bend e^2 / h, and the stretch by stretch e^2."""
    strain, height = order_of_strain(cell)
    curved, longer = bend * strain**2 / height, stretch * strain**2
    by_pressure = 2.0 / cell.pressure if cell.pressure else 0.0  # both grow with the square of the pressure
    return Move(curved, 1.0, longer, by_pressure * curved, 0.0, by_pressure * longer)


def order_of_strain(cell: CellCurve) -> tuple[float, float]:
    """The strain e, and the height h in mm."""
    bending, axial = (float(np.interp(0.0, cell.moment, values)) for values in (cell.rigidity, cell.axial_rigidity))
    height = math.sqrt(12.0 * bending / axial)
    return KPA * cell.pressure * height**2 / axial, height
