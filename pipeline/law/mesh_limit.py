"""What a mesh makes of a cell: the numbers that are compared, their limits, and laws that are moved to them.

At each pressure the moments of a cell are multiplied by a factor and its curvatures are shifted. With the factor r and
the shift s, both functions of the pressure p, that is M(kappa, p) -> r M(kappa - s, p): the same states of the cell at
other moments and curvatures. What a state has besides, such as stretch, ripple and air, stays with it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import copysign, hypot, sqrt

import numpy as np

from geometry import Reason
from geometry.arrays import Array
from pipeline.values.json_values import JsonObject
from pipeline.values.law import LawMeshError
from pipeline.values.parameters import Column
from pipeline.values.richardson import Limit, extrapolate_all
from pipeline.values.run import SMALLEST_TURN
from rod.arm_law.curves import ACROSS, CellCurve, ClampCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.moved import Move, moved_cell, moved_clamp
from rod.arm_law.quantities import key_in_files
from rod.cubics import cubic, cubic_slope, monotone_slopes

#: what a cell at one pressure is compared by: the curvature without moment; the rigidity, a mean over a change of the
#: curvature by one over the length of the arm, towards straight, because where walls touch the slope at a point says
#: more about a node than about the mesh; and the moment that straightens the cell
PLANE = ("kappa_0", "rigidity", "moment")
#: stated standard deviation over that of the extrapolation, and the least one, relative: meshes that are not nested
#: scatter. With these nine of ten true errors are below 1.65 stated ones (docs/cell.md)
INFLATED, LEAST_STD = 1.3, 0.0015
#: these, and where they are measured the rigidities out of the plane of a cell without moment
Numbers = Mapping[str, float]
Limits = Mapping[str, Limit]


def scales_of(limits: Limits, length: float) -> dict[str, float]:
    """The numbers by which errors are divided; those of an arm of `length` mm that hardly bends are larger."""
    turning = SMALLEST_TURN / length
    least = {"kappa_0": turning, "moment": turning * abs(limits["rigidity"].value)}
    return {name: max(abs(one.value), least.get(name, 0.0)) for name, one in limits.items()}


def limits_of(by_size: Mapping[float, Numbers], length: float) -> dict[str, Limit]:
    """Limits of the numbers that two meshes or more have, by size in mm; with deviations. length: mm, of the arm."""
    found = extrapolate_all(by_size)
    limits = {name: Limit(one.limit, INFLATED * one.limit_std) for name, one in found.items()}
    least = {name: LEAST_STD * scale for name, scale in scales_of(limits, length).items()}
    return {name: Limit(one.value, hypot(one.std, least[name])) for name, one in limits.items()}


def halfway(limit: Limit, soft: float) -> Limit:
    """Between a limit and another number, everywhere with the same probability."""
    return Limit(0.5 * (limit.value + soft), hypot(limit.std, (limit.value - soft) / sqrt(12.0)))


@dataclass(frozen=True)
class CellMesh:
    """A mesh of the cell that was tried."""

    size_mm: float
    degrees_of_freedom: int
    error: float  #: largest relative distance of its numbers from their limits
    seconds: float  #: processor time
    kappa_0_per_mm: tuple[float | None, ...]  #: by pressure; None where the cell does not bear it
    rigidity_N_mm2: tuple[float | None, ...]
    moment_N_mm: tuple[float | None, ...]


@dataclass(frozen=True)
class MeshLimit:
    """The numbers of the cell in the limit of its mesh, and the meshes that they come from."""

    requested: float  #: relative error
    reached: float  #: largest relative standard deviation of a limit
    limits: Mapping[float, Limits]  #: by pressure in kPa, from rest on
    meshes: tuple[CellMesh, ...]  #: the coarsest first
    reasons: tuple[Reason, ...] = ()  #: why finer meshes were not tried, and pressures without a limit

    @property
    def is_reached(self) -> bool:
        """Whether the error is within the requested one."""
        return self.reached <= self.requested

    def record(self) -> JsonObject:
        """The key `accuracy` of law.json."""
        common = {"requested": self.requested, "reached": self.reached, "is_reached": self.is_reached}
        return {**common, "pressures_kPa": tuple(self.limits), "meshes": [asdict(mesh) for mesh in self.meshes]}

    def error_of(self, cells: Sequence[CellCurve], length: float, size_mm: float) -> LawMeshError:
        """How far the numbers of a law on a mesh of that size are from the limit, and how uncertain that is.

        length: mm, of the arm.
        """
        known = [cell for cell in cells if cell.pressure and cell.pressure in self.limits]
        rows = []
        for cell in known:
            limits = self.limits[cell.pressure]
            own = numbers_on(cell, length, limits)
            rows.append({name: (own[name], hypot(own[name] - limits[name].value, limits[name].std)) for name in own})
        columns: dict[str, Column] = {}
        for name in dict.fromkeys(name for row in rows for name in row):
            pairs = [row.get(name, (None, None)) for row in rows]
            columns |= zip((key_in_files(name), f"{key_in_files(name)}_std"), zip(*pairs, strict=True), strict=True)
        return LawMeshError(size_mm, self.meshes[-1].size_mm, tuple(cell.pressure for cell in known), **columns)

    @property
    def remarks(self) -> tuple[Reason, ...]:
        """The error that is left, and why it is not smaller."""
        values = {"percent": 100.0 * self.requested, "size_mm": self.meshes[-1].size_mm}
        made = Reason("cell_accuracy", values | {"reached_percent": 100.0 * self.reached})
        return (made, *self.reasons)


def across_on(cell: CellCurve) -> dict[str, float]:
    """The rigidities of a curve out of the plane, without moment; none of a curve of the plane alone."""
    names = ACROSS if cell.is_in_space else ()
    return {name: float(np.interp(0.0, cell.moment, getattr(cell, name))) for name in names}


def numbers_on(cell: CellCurve, length: float, limits: Limits) -> dict[str, float]:
    """The numbers of a curve that have limits, which stand for those that it does not reach; length: mm, of the arm."""
    kappa_0 = cell.at(0.0)[0]
    change = change_for(kappa_0, length)
    moment, bent = moment_at(cell, 0.0), moment_at(cell, kappa_0 + change)
    rigidity = limits["rigidity"].value if bent is None else bent / change
    found = {"kappa_0": kappa_0, "rigidity": rigidity, "moment": limits["moment"].value if moment is None else moment}
    return found | {name: value for name, value in across_on(cell).items() if name in limits}


def moment_at(cell: CellCurve, kappa: float) -> float | None:
    """N mm, where the cubics of the curvature over the moment have a curvature in 1/mm; None beyond the curve."""
    low, high = float(cell.moment[0]), float(cell.moment[-1])
    if not cell.kappa[0] <= kappa <= cell.kappa[-1]:
        return None
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if cell.at(middle)[0] < kappa else (low, middle)
    return 0.5 * (low + high)


def change_for(kappa_0: float, length: float) -> float:
    """The change of the curvature for the rigidity, 1/mm; length: mm, of the arm."""
    return -copysign(1.0 / length, kappa_0)


#: factors of rigidities that are not corrected
STILL = np.zeros(1), np.ones((1, 2))


@dataclass(frozen=True, eq=False)  # arrays inside
class Corrections:
    """Makes a law that of an exact mesh: `shift` is added to the curvature of a cell, `ratio` multiplies its moment.

    Between pressures, from rest on, both follow monotone cubics; beyond the last they are constant.
    """

    pressures: Array  #: (n,) kPa, rising
    shift: Array  #: (n,) 1/mm
    ratio: Array  #: (n,)
    across: tuple[Array, Array] = STILL  #: pressures (m,) in kPa, and (m, 2) factors of the rigidities out of the plane

    @staticmethod
    def of(cells: Sequence[CellCurve], own: Mapping[float, Numbers], limit: MeshLimit, length: float) -> "Corrections":
        """From cells with their own numbers by pressure to those in the limit; none where they have none in common.

        length: mm, of the arm.
        """
        curves, rows = {cell.pressure: cell for cell in cells}, [(0.0, 0.0, 1.0)]
        for pressure, limits in limit.limits.items():
            if pressure in own and (cell := curves.get(pressure)):
                rows = [row for row in rows if row[0] != pressure]
                shift = limits["kappa_0"].value - cell.at(0.0)[0]
                rows.append((pressure, shift, _ratio(cell, own[pressure], limits, length)))
        pressures, shift, ratio = np.array(rows).T
        return Corrections(pressures, shift, ratio, _across(cells, limit))

    def at(self, pressure: float) -> Move:
        """The move of the states at a pressure in kPa."""
        (shift, shift_slope), (ratio, ratio_slope) = (self._at(column, pressure) for column in (self.shift, self.ratio))
        return Move(shift, ratio, shift_slope=shift_slope, ratio_slope=ratio_slope)

    def out_of_plane(self, pressure: float) -> Array:
        """(2,) factors of the rigidities out of the plane at a pressure in kPa, by straight lines over the pressure."""
        pressures, factors = self.across
        return np.array([np.interp(pressure, pressures, column) for column in factors.T])

    def _at(self, column: Array, pressure: float) -> tuple[float, float]:
        if len(column) < 2:
            return float(column[0]), 0.0
        slopes = monotone_slopes(self.pressures, column)
        inside = min(pressure, float(self.pressures[-1]))
        value, slope = (float(f(self.pressures, column, slopes, inside)) for f in (cubic, cubic_slope))
        return value, slope if inside == pressure else 0.0


def _across(cells: Sequence[CellCurve], limit: MeshLimit) -> tuple[Array, Array]:
    """Pressures and factors from the rigidities of cells out of the plane to those in the limit."""
    known = {}
    for cell in cells:
        limits, own = limit.limits.get(cell.pressure, {}), across_on(cell)
        if own and own.keys() <= limits.keys():
            known[cell.pressure] = [limits[name].value / value for name, value in own.items()]
    return (np.array(list(known)), np.array(list(known.values()))) if known else STILL


def corrected(law: ArmLaw, corrections: Corrections) -> ArmLaw:
    """The law with its cells and clamped ends at their corrected moments and curvatures."""
    across = [corrections.out_of_plane(pressure) for pressure in law.pressures]
    moves = [corrections.at(pressure) for pressure in law.pressures]
    cells = [moved_cell(*pair) for pair in zip(law.cells, moves, strict=True)]
    for k, factors in enumerate(across):
        columns = zip(ACROSS, factors, strict=True)
        cells[k] = replace(cells[k], **{name: factor * getattr(cells[k], name) for name, factor in columns})
    clamps = tuple(moved_clamp(*pair) for pair in zip(law.clamps, moves, strict=True))
    return replace(
        law,
        cells=tuple(cells),
        clamps=tuple(_clamp_across(*pair) for pair in zip(clamps, across, strict=True)),
        rates={name: rate.with_moments([move.ratio for move in moves], across) for name, rate in law.rates.items()},
    )


def _ratio(cell: CellCurve, own: Numbers, limits: Limits, length: float) -> float:
    """Of the moments in the limit over those of a cell: where it is straight, if that bends it by more than one over
    the length of the arm, else where it is bent by that much, on which the curve need not reach."""
    kappa_0 = limits["kappa_0"].value
    if abs(kappa_0) > 1.0 / length:
        straight = moment_at(cell, cell.at(0.0)[0] - kappa_0)
        if straight is not None:
            return limits["moment"].value / straight
    return limits["rigidity"].value / own["rigidity"]


def _clamp_across(curve: ClampCurve, factors: Array) -> ClampCurve:
    """The clamped end is stiffer by the factors (2,) of the cells, as it is in the plane.

    That of GJ belongs to torques and that of B_2 to moments about the normal. Turns by the other of the two have the
    mean of both, so that reciprocity holds. Nothing changes where a cell is unstable out of its plane.
    """
    if not curve.lateral_compliance.size or factors.min() <= 0.0:
        return curve
    roots = np.sqrt(factors[::-1])
    return replace(curve, lateral_compliance=curve.lateral_compliance / np.outer(roots, roots))
