"""The arm's own law of an arm with two cavities, over both pressures.

On a ray both pressures grow in one ratio, and the law is that of `rod.arm_law.law` over the larger of them. Between two
rays states at the same larger pressure are joined as those at two pressures are (`rod.arm_law.between`): M and stretch
by cubics over the direction of the ray, which is their place, with the slopes by the pressure of either cavity.

The direction d of a ray is p_2/p_1 up to equal pressures, d = 1, and 2 - p_1/p_2 beyond, so that the first cavity alone
has d = 0 and the second one alone d = 2. The slopes jump at d = 1, which is therefore always a ray between others.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, TypeVar, get_args

import numpy as np

from geometry.arrays import Array
from rod.arm_law.between import interpolate_columns
from rod.arm_law.curves import CellCurve, ClampCurve, CurveAt, TipCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.law_rod import LawRod
from rod.arm_law.section import bracket, clamp_at, section_at, tip_at
from rod.checked import Amount
from rod.errors import RodError
from rod.same_pressure import Pressures, as_known, pressures_of, ratios_of
from rod.weight import Mass

Curve = TypeVar("Curve", CellCurve, ClampCurve, TipCurve)


def direction_of(pressures: Sequence[float]) -> tuple[float, float]:
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

    kind: ClassVar[str] = "pairs"
    has_plane: ClassVar[bool] = True
    plane: ClassVar[None] = None
    fractions: ClassVar[Mapping[str, float]] = {}
    cavities: tuple[str, ...]  #: two
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
        """Length of the arm, mm."""
        return self.laws[0].length

    @property
    def mass(self) -> Mass | None:
        """None: not known."""
        return self.laws[0].mass

    @property
    def rows(self) -> tuple[Pressures, ...]:
        """The pressures at which it was measured, kPa, by ray."""
        return tuple(
            tuple(part * pressure for part in fractions_of(direction))
            for direction, law in zip(self.directions, self.laws, strict=True)
            for pressure in law.pressures
        )

    @property
    def ratios(self) -> tuple[Pressures, ...]:
        """Ratios of its rays."""
        return ratios_of(self.rows)

    @property
    def notes(self) -> tuple[str, ...]:
        """An error between the rays that is not known."""
        doubt = self.error_between is None and len(self.laws) > 1
        return ("The error of this law between its ratios is not known.",) if doubt else ()

    def at(self, pressures: Amount | Sequence[Amount], length: Amount | None = None) -> LawRod:
        """The rod at the pressures (p_1, p_2) of both cavities in kPa; length as in `ArmLaw.at`.

        Its pressure is the larger one. Raises `RodError` for a ratio beyond those of the law, and for pressures beyond
        those of the nearest ratios.
        """
        larger, direction = direction_of(pressures_of(pressures, self.cavities))
        direction = as_known(self.directions, direction) if larger else self.directions[0]
        lower, upper = self._rays(direction)
        first = self.laws[lower].at(larger, length)
        if lower == upper:
            return first
        rods = first, self.laws[upper].at(larger, length)
        places = self.directions[lower], self.directions[upper]
        tips = [CurveAt(place, rod.tip, {}) for rod, place in zip(rods, places, strict=True)]
        clamps = [self._clamp(k, lower, rod) for k, rod in zip((lower, upper), rods, strict=True)]
        cells, clamps, tips = self.cells_around(lower, larger), _on_equal_nodes(clamps), _on_equal_nodes(tips)
        return replace(
            first,
            section=section_at(cells, direction, larger),
            clamp=clamp_at(clamps, cells, direction, larger),
            tip=tip_at(tips, direction, larger),
        )

    def pressures_along(self, fractions: Pressures) -> tuple[float, ...]:
        """The larger pressures in kPa up to which the law is known in a ratio, of the ray that ends first.

        fractions: of the larger pressure. Raises `RodError` for a ratio beyond those of the law.
        """
        lower, upper = self._rays(direction_of(fractions)[1])
        return min((self.laws[k].pressures for k in (lower, upper)), key=lambda pressures: pressures[-1])

    def ray(self, fractions: Pressures) -> ArmLaw | None:
        """The law over the larger pressure in a ratio of the law; None for one between them."""
        lower, upper = self._rays(direction_of(fractions)[1])
        return self.laws[lower] if lower == upper else None

    def _rays(self, direction: float) -> tuple[int, int]:
        """The rays beside a direction; twice the same one where it is one of them."""
        if not self.directions[0] <= direction <= self.directions[-1]:
            known = " to ".join(_ratio(self.cavities, one) for one in (self.directions[0], self.directions[-1]))
            raise RodError(f"The law goes from {known}; it is not extrapolated to other ratios.")
        lower, upper, _ = bracket(self.directions, direction)
        return lower, upper

    def cells_around(self, lower: int, larger: float) -> list[CurveAt[CellCurve]]:
        """The cells of a ray and the next one where the larger pressure is so high (kPa). Raises `RodError` as `at`."""
        return _on_equal_nodes([self._cell(k, lower, larger) for k in (lower, lower + 1)])

    def _cell(self, k: int, lower: int, larger: float) -> CurveAt[CellCurve]:
        law = self.laws[k]
        section = section_at([cell.placed for cell in law.cells], larger, larger)

        def mixed(name: str) -> Array:
            return _mixed(law.cells, larger, name, "kappa", section.kappa)

        slopes = {
            name: self._slopes(k, lower, larger, law.cells, name, "kappa", section.kappa)
            for name in ("moment", "stretch")
        }
        cell = CellCurve(
            pressure=larger,
            moment=section.moment,
            kappa=section.kappa,
            rigidity=1.0 / section.kappa_slope,
            moment_by_pressure=mixed("moment_by_pressure"),
            stretch=section.stretch,
            stretch_by_kappa=section.stretch_slope / section.kappa_slope,
            stretch_by_pressure=mixed("stretch_by_pressure"),
            axial_rigidity=section.axial_rigidity,
            shear_rigidity=section.shear_rigidity,
            contact=mixed("contact") > 0.5,
            min_J=mixed("min_J"),
            s=section.s,
            ripple=section.ripple,
            volume=section.volume,
            **section.in_space,
        )
        return CurveAt(self.directions[k], cell, slopes)

    def _clamp(self, k: int, lower: int, rod: LawRod) -> CurveAt[ClampCurve]:
        curve, larger = rod.clamp, rod.section.pressure
        slopes = self._slopes(k, lower, larger, self.laws[k].clamps, "rotation", "moment", curve.moment)
        return CurveAt(self.directions[k], curve, {"rotation": slopes})

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


def _ratio(cavities: Sequence[str], direction: float) -> str:
    one, other = fractions_of(direction)
    return f"{cavities[0]} : {cavities[1]} = {one:g} : {other:g}"


def _mixed(curves: Sequence[Any], pressure: float, name: str, over: str, at: Array) -> Array:
    """A quantity (n,) of the curves at a pressure in kPa, over another one at (n,), by straight lines."""
    lower, upper, t = bracket([curve.pressure for curve in curves], pressure)
    if not all(getattr(curves[k], name).size for k in (lower, upper)):
        raise RodError("The law on a ray has no derivatives by the pressure of one cavity; set law_by_cavity: true.")
    low, high = (np.interp(at, getattr(curves[k], over), getattr(curves[k], name)) for k in (lower, upper))
    return np.asarray((1.0 - t) * low + t * high)


def _on_equal_nodes(path: Sequence[CurveAt[Curve]]) -> list[CurveAt[Curve]]:
    """Two curves whose material curve has the nodes of the shorter one; other meshes and longer ends have others."""
    shorter = min((at.curve for at in path), key=lambda curve: abs(float(curve.s[-1] - curve.s[0])))
    return [at if at.curve is shorter else replace(at, curve=_on_nodes(at.curve, shorter.s)) for at in path]


def _on_nodes(curve: Curve, s: Array) -> Curve:
    changed: dict[str, Any] = {"s": s}
    for field in fields(curve):
        values, shape = getattr(curve, field.name), get_args(field.type)[2:]
        if shape[-2:-1] == ("m",):
            along = interpolate_columns(s, curve.s, np.moveaxis(values, -2, 0))
            changed[field.name] = np.moveaxis(along, 0, -2)
    return replace(curve, **changed)
