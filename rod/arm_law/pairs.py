"""The arm's own law of an arm with two cavities, over both pressures.

On a ray both pressures grow in one ratio, and the law is that of `rod.arm_law.law` over the larger of them. Between two
rays states at the same larger pressure are joined as those at two pressures are (`rod.arm_law.between`): M and stretch
by cubics over the direction of the ray, with the slopes of the cell by the pressure of either cavity.

The direction d of a ray is p_2/p_1 up to equal pressures, d = 1, and 2 - p_1/p_2 beyond, so that the first cavity alone
has d = 0 and the second one alone d = 2. The slopes jump at d = 1, which is therefore always a ray between others.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from geometry.arrays import Array
from rod.arm_law.between import interpolate_columns
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.law_rod import LawRod
from rod.arm_law.record import law_from_record, law_record
from rod.arm_law.section import bracket, clamp_at, section_at, tip_at
from rod.errors import RodError
from rod.load import pair
from rod.same_pressure import as_known

Curve = TypeVar("Curve", CellCurve, ClampCurve, TipCurve)
#: of the file
FORMAT = 1


def direction_of(pressures: tuple[float, float]) -> tuple[float, float]:
    """The larger of two pressures (kPa) and the direction of their ray; raises `RodError` below 0 kPa."""
    first, second = pressures
    if min(pressures) < 0.0:
        raise RodError(f"Pressures of two cavities must not be below 0 kPa, as {min(pressures):g} kPa is.")
    if max(pressures) == 0.0:
        return 0.0, 0.0
    return max(pressures), second / first if second <= first else 2.0 - first / second


def fractions_of(direction: float) -> tuple[float, float]:
    """The pressures of both cavities over the larger one."""
    return min(1.0, 2.0 - direction), min(1.0, direction)


@dataclass(frozen=True, eq=False)  # arrays inside
class PairLaw:
    """The law of an arm over the pressures of its two cavities.

    Raises `RodError` unless there are rays, their directions rise from 0 to 2, and d = 1 is one where others lie on
    both sides of it.
    """

    cavities: tuple[str, str]
    directions: tuple[float, ...]  #: of the rays, rising
    laws: tuple[ArmLaw, ...]  #: by ray, over the larger pressure
    #: of the curvature halfway between rays, over the largest one, before the last rays were put there; None: not known
    error_between: float | None = None

    def __post_init__(self) -> None:
        known = np.asarray(self.directions, float)
        if not len(known) or len(known) != len(self.laws) or np.any(np.diff(known) <= 0.0):
            raise RodError("A law over two pressures needs rays in rising directions.")
        if known[0] < 0.0 or known[-1] > 2.0 or (known[0] < 1.0 < known[-1] and 1.0 not in known):
            raise RodError("Directions of rays go from 0 to 2, and 1 is one where others lie on both sides of it.")

    def __repr__(self) -> str:
        return f"PairLaw({len(self.laws)} ratios of the pressures of {' and '.join(self.cavities)})"

    @property
    def length(self) -> float:
        """Of the arm, mm."""
        return self.laws[0].length

    def at(self, pressures: Sequence[float], length: float | None = None) -> LawRod:
        """The rod at the pressures (p_1, p_2) of both cavities in kPa; length as in `ArmLaw.at`.

        Its pressure is the larger one. Raises `RodError` for a ratio beyond those of the law, and for pressures beyond
        those of the nearest ratios.
        """
        larger, direction = direction_of(pair(pressures, "The pressures of both cavities"))
        direction = as_known(self.directions, direction) if larger else self.directions[0]
        if not self.directions[0] <= direction <= self.directions[-1]:
            known = " to ".join(_ratio(self.cavities, one) for one in (self.directions[0], self.directions[-1]))
            raise RodError(f"The law goes from {known}; it is not extrapolated to other ratios.")
        lower, upper, _ = bracket(self.directions, direction)
        first = self.laws[lower].at(larger, length)
        if lower == upper:
            return first
        rods = first, self.laws[upper].at(larger, length)
        places = self.directions[lower], self.directions[upper]
        tips = [replace(rod.tip, pressure=place) for rod, place in zip(rods, places, strict=True)]
        clamps = [self._clamp(k, lower, rod) for k, rod in zip((lower, upper), rods, strict=True)]
        cells, clamps, tips = self.cells_around(lower, larger), _on_equal_nodes(clamps), _on_equal_nodes(tips)
        return replace(
            first,
            section=replace(section_at(cells, direction), pressure=larger),
            clamp=replace(clamp_at(clamps, cells, direction), pressure=larger),
            tip=replace(tip_at(tips, direction), pressure=larger),
        )

    def cells_around(self, lower: int, larger: float) -> list[CellCurve]:
        """The cells of a ray and the next one where the larger pressure is so high (kPa), with the direction in the
        place of the pressure. Raises `RodError` as `at`."""
        return _on_equal_nodes([self._cell(k, lower, larger) for k in (lower, lower + 1)])

    def _cell(self, k: int, lower: int, larger: float) -> CellCurve:
        law, direction = self.laws[k], self.directions[k]
        section = section_at(law.cells, larger)
        moment_by, stretch_by = (
            self._slopes(k, lower, larger, law.cells, name, "kappa", section.kappa) for name in ("moment", "stretch")
        )
        return CellCurve(
            pressure=direction,
            moment=section.moment,
            kappa=section.kappa,
            rigidity=1.0 / section.kappa_slope,
            moment_by_pressure=moment_by,
            stretch=section.stretch,
            stretch_by_kappa=section.stretch_slope / section.kappa_slope,
            stretch_by_pressure=stretch_by,
            axial_rigidity=section.axial_rigidity,
            shear_rigidity=section.shear_rigidity,
            contact=_mixed(law.cells, larger, "contact", "kappa", section.kappa) > 0.5,
            min_J=_mixed(law.cells, larger, "min_J", "kappa", section.kappa),
            s=section.s,
            ripple=section.ripple,
            **section.in_space,
        )

    def _clamp(self, k: int, lower: int, rod: LawRod) -> ClampCurve:
        curve, larger = rod.clamp, rod.section.pressure
        slopes = self._slopes(k, lower, larger, self.laws[k].clamps, "rotation", "moment", curve.moment)
        return replace(curve, pressure=self.directions[k], rotation_by_pressure=slopes, rotation_by_other=np.empty(0))

    def _slopes(
        self, k: int, lower: int, larger: float, curves: Sequence[Any], name: str, over: str, at: Array
    ) -> Array:
        """Of a quantity of a ray over the direction, on the side of the rays from `lower` to the next one."""
        other = _mixed(curves, larger, f"{name}_by_other", over, at)
        if self.directions[lower] < 1.0:  # where the second pressure changes
            return larger * other
        if self.directions[k] > 1.0:
            return -larger * other
        return larger * (other - _mixed(curves, larger, f"{name}_by_pressure", over, at))

    def record(self) -> dict[str, Any]:
        """The content of its law.json."""
        rays = zip(self.directions, self.laws, strict=True)
        return {
            "format": FORMAT,
            "cavities": list(self.cavities),
            "error_between": self.error_between,
            "rays": [{"direction": d, "fractions": fractions_of(d), "law": law_record(law)} for d, law in rays],
        }

    @staticmethod
    def from_record(record: Mapping[str, Any]) -> "PairLaw":
        """The law that `record` wrote. Raises `RodError` for anything else."""
        try:
            if record["format"] != FORMAT:
                raise RodError(f"This is no law over two pressures in format {FORMAT}; repeat the run.")
            rays, (one, other) = record["rays"], record["cavities"]
            directions = tuple(float(ray["direction"]) for ray in rays)
            laws = tuple(law_from_record(ray["law"]) for ray in rays)
            return PairLaw((str(one), str(other)), directions, laws, record["error_between"])
        except RodError:
            raise
        except (KeyError, TypeError, ValueError) as failure:
            raise RodError(f"This is no law over two pressures ({failure}); repeat the run.") from None


def _ratio(cavities: tuple[str, str], direction: float) -> str:
    one, other = fractions_of(direction)
    return f"{cavities[0]} : {cavities[1]} = {one:g} : {other:g}"


def _mixed(curves: Sequence[Any], pressure: float, name: str, over: str, at: Array) -> Array:
    """A quantity (n,) of the curves at a pressure in kPa, over another one at (n,), by straight lines."""
    lower, upper, t = bracket([curve.pressure for curve in curves], pressure)
    if not all(getattr(curves[k], name).size for k in (lower, upper)):
        raise RodError("The law on a ray has no derivatives by the pressure of one cavity; set law_by_cavity: true.")
    low, high = (np.interp(at, getattr(curves[k], over), getattr(curves[k], name)) for k in (lower, upper))
    return np.asarray((1.0 - t) * low + t * high)


def _on_equal_nodes(curves: Sequence[Curve]) -> list[Curve]:
    """Two curves whose material curve has the nodes of the shorter one; other meshes and longer ends have others."""
    shorter = min(curves, key=lambda curve: abs(float(curve.s[-1] - curve.s[0])))
    return [curve if curve is shorter else _on_nodes(curve, shorter.s) for curve in curves]


def _on_nodes(curve: Curve, s: Array) -> Curve:
    changed: dict[str, Any] = {"s": s}
    for field in fields(curve):
        values = getattr(curve, field.name)
        if np.ndim(values) > 1 and values.shape[-2] == len(curve.s) and field.name != "lateral_compliance":
            along = interpolate_columns(s, curve.s, np.moveaxis(values, -2, 0))
            changed[field.name] = np.moveaxis(along, 0, -2)
    return replace(curve, **changed)
