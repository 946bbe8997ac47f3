"""A clamped planar rod with the arm's own law at one pressure."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from geometry.arrays import Array
from rod.arm_law.curves import ClampCurve, TipCurve
from rod.arm_law.planar_arm import PlanarArm, stability_across
from rod.arm_law.section import SectionLaw
from rod.arm_law.solver import EndConditions, Pieces, equilibrium
from rod.arm_law.spatial_solver import spatial_equilibrium
from rod.errors import RodError
from rod.load import Load, held_at, requested
from rod.solution import RodSolution
from rod.spatial import Position, SpatialLoad, SpatialSolution, Stability
from rod.weight import Mass


@dataclass(frozen=True, eq=False)  # arrays inside
class LawRod:
    """A clamped planar rod with the arm's own law at one pressure; it stretches and shears."""

    section: SectionLaw
    clamp: ClampCurve
    tip: TipCurve
    pitch: float  #: mm
    first_middle: float  #: mm
    length: float  #: mm
    mass: Mass | None = None  #: how a weight is spread along the arm; None: evenly
    weight: tuple[float, float] = (0.0, 0.0)  #: N/mm, x and y per rest length, that always acts

    def __post_init__(self) -> None:
        ends = float(self.clamp.s[-1] - self.tip.s[0])
        if not (math.isfinite(self.length) and self.length >= ends * (1 - 1e-9)):
            raise RodError(
                f"An arm of {self.length:g} mm is shorter than its two disturbed ends, {ends:g} mm; "
                "its own law does not describe it."
            )

    def __repr__(self) -> str:
        return f"LawRod(at {self.section.pressure:g} kPa, length {self.length:g} mm, cells of {self.pitch:g} mm)"

    @cached_property
    def _pieces(self) -> Pieces:
        return Pieces(self.section, self.clamp, self.tip, self.pitch, self.length, self.mass)

    def solve(
        self,
        force: Sequence[float] | None = None,
        *,
        end_y: float | None = None,
        end: Sequence[float] | None = None,
        moment: float = 0.0,
    ) -> RodSolution:
        """The equilibrium reached when the loads grow on the inflated arm; with end_y alone both grow together.

        force: dead force (F_x, F_y) in N on the end. end_y: the end edge is held at this height (mm), as in experiment
        III, and F_y follows; end: (x, y) of it, and both components follow. moment: a couple on the end, N mm.
        Raises `RodError` where loads contradict each other, where the path ends, and where a moment leaves the law.
        """
        return self._equilibrium(EndConditions(*requested(force, moment, end, None, end_y)))

    def solve_in_space(self, load: SpatialLoad, position: Position = (None, None, None)) -> SpatialSolution:
        """The equilibrium in space under a load, which grows on the inflated arm.

        position: of the end where it is held, mm; the components of the force along these axes follow. Raises
        `RodError` as `solve` does, and for a law without rigidities out of the plane.
        """
        self._check_in_space()
        x, y = (own + more for own, more in zip(self.weight, load.weight, strict=False))
        arm = PlanarArm(self._pieces, position)
        solution = spatial_equilibrium(arm, replace(load, weight=(x, y, load.weight[2])), position)
        end = solution.frames[-1]
        tip = EndConditions(Load(), position[:2]).tip_state(self.tip)
        at_tip = tip.beside_at(math.atan2(end[1, 0], end[0, 0]), float(solution.force @ end[:, 0]))
        bending = (solution.moment[:, None] @ solution.frames)[:, 0, 2]
        return replace(solution, beside=_Beside(self, solution.s, bending, at_tip)(solution.s))

    def stability(self, state: RodSolution) -> Stability:
        """Of a state of this rod against motions out of its plane. Its force keeps its direction.

        Raises `RodError` for a law without rigidities out of the plane.
        """
        self._check_in_space()
        return stability_across(self._pieces, state)

    def buckling_part(self, load: Load) -> float | None:
        """The part of a load in the plane, to 0.1 %, at which the rod buckles out of it; None where it does not.

        The load grows on the inflated rod, which must be stable. Raises `RodError` as `solve` and `stability` do.
        """
        low, high = 0.0, 1.0
        if self.stability(self.under(load)).is_stable:
            return None
        while high - low > 1e-3:
            part = 0.5 * (low + high)
            x, y = (part * value for value in load.force)
            reduced = replace(load, force=(x, y), couple=part * load.couple)
            low, high = (part, high) if self.stability(self.under(reduced)).is_stable else (low, part)
        return high

    @property
    def is_in_space(self) -> bool:
        """Whether the law has rigidities out of its plane."""
        return bool(self.section.in_space) and bool(self.clamp.lateral_compliance.size)

    def _check_in_space(self) -> None:
        if not self.is_in_space:
            raise RodError("The law has no rigidities out of the plane; measure it with law_in_space: true.")

    def under(self, load: Load, end_y: float | None = None, end_x: float | None = None) -> RodSolution:
        """The equilibrium under a load; with a prescribed position of the end (mm) that component of the force follows.

        The weight of the load is spread as the mass of the arm is, where that is known. Raises `RodError` as `solve`
        does.
        """
        return self._equilibrium(EndConditions(load, held_at(end_x, end_y)))

    def _equilibrium(self, conditions: EndConditions) -> RodSolution:
        load = conditions.load
        x, y = (own + more for own, more in zip(self.weight, load.weight, strict=True))
        conditions = conditions._replace(load=replace(load, weight=(x, y)))
        solution = equilibrium(self._pieces, conditions)
        turn = float(solution.theta[-1])
        pull = float(solution.force @ (math.cos(turn), math.sin(turn)))
        at_tip = conditions.tip_state(self.tip).beside_at(turn, pull)
        return replace(solution, beside=_Beside(self, solution.s, solution.moment, at_tip))


@dataclass(frozen=True, eq=False)  # arrays inside
class _Beside:
    """The material curve beside the axis of a solution; a value, so that solutions can be pickled."""

    rod: LawRod
    s: Array  #: (n,) mm, of the solution
    moment: Array  #: (n,) N mm
    at_tip: Array  #: (k, 2) mm, the nodes of the tip beside the axis, along and normal to it

    def __call__(self, s: Array) -> Array:
        """(m, 2) mm: the material curve beside the axis at s (m,) mm, along and normal to it."""
        rod = self.rod
        cycle = (s - rod.first_middle) / rod.pitch
        moment = np.interp(s, self.s, self.moment)
        result = _ripple(rod.section, (cycle - np.round(cycle)) * rod.pitch, moment)
        clamped, last = s <= rod.clamp.s[-1], s - rod.length >= rod.tip.s[0]
        at_clamp = np.interp([rod.clamp.position], self.s, self.moment)
        (rows,) = rod.clamp.beside_at(at_clamp)
        for k in range(2):
            result[clamped, k] = np.interp(s[clamped], rod.clamp.s, rows[:, k])
            result[last, k] = np.interp(s[last] - rod.length, rod.tip.s, self.at_tip[:, k])
        return result


def _ripple(law: SectionLaw, from_middle: Array, moment: Array) -> Array:
    """(m, 2) mm: the material curve beside the axis within the cells, along and normal to it.

    from_middle: (m,) mm, from the middle of the nearest cell, of which both halves are mirror images. moment: (m,).
    """
    row = np.clip((moment - law.moment[0]) / (law.moment[1] - law.moment[0]), 0.0, len(law.moment) - 1.0)
    i = np.minimum(row.astype(int), len(law.moment) - 2)
    t = row - i
    column = np.clip(np.searchsorted(law.s, np.abs(from_middle), side="right") - 1, 0, len(law.s) - 2)
    u = (np.abs(from_middle) - law.s[column]) / (law.s[column + 1] - law.s[column])
    corner = law.ripple
    values = (1 - t)[:, None] * ((1 - u)[:, None] * corner[i, column] + u[:, None] * corner[i, column + 1])
    values += t[:, None] * ((1 - u)[:, None] * corner[i + 1, column] + u[:, None] * corner[i + 1, column + 1])
    values[:, 0] *= np.where(from_middle < 0.0, -1.0, 1.0)
    return np.asarray(values)
