"""The arm's own law over all pressures, and the rod that follows it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from geometry.arrays import Array
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.integration import EndArrays, EndLoad, LawArrays, converge
from rod.arm_law.section import SectionLaw, clamp_at, section_at, tip_at
from rod.law import RodError
from rod.load import Load

#: longest step of the integration, mm over the pitch
STEP = 0.1
#: smallest part of the load in one step
SMALLEST_STEP = 1e-3
#: rad, largest change of the end's angle in one step of the load
LARGEST_TURN = 1.0


@dataclass(frozen=True)
class LawSolution:
    """A rod with the arm's own law in equilibrium. Arrays are read-only."""

    s: Array  #: (n,) mm, rest arc length
    x: Array  #: (n,) mm, of the axis
    y: Array  #: (n,) mm
    theta: Array  #: (n,) rad
    kappa: Array  #: (n,) 1/mm, rotation per rest length
    moment: Array  #: (n,) N mm
    stretch: Array  #: (n,)
    force: Array  #: (2,) N, on the end
    rod: "LawRod" = field(repr=False)

    def positions(self, s: Array) -> Array:
        """(m, 2) mm: points of the material curve at the rest arc lengths s (m,), mm.

        The axis and what the material curve departs from it: its ripple within the cells, and the two ends. Raises
        `RodError` for an s off the rod.
        """
        s = np.asarray(s, float)
        if s.size and (s.min() < -1e-9 * self.s[-1] or s.max() > (1 + 1e-9) * self.s[-1]):
            raise RodError(f"The rod goes from s = 0 to {self.s[-1]:g} mm.")
        axis = np.stack([_cubic_positions(self, s, name) for name in ("x", "y")], axis=1)
        theta = np.interp(s, self.s, self.theta)
        along, normal = self.rod.beside(s, np.interp(s, self.s, self.moment), self.moment_at_clamp, self.is_held).T
        cosine, sine = np.cos(theta), np.sin(theta)
        return np.asarray(axis + np.stack([along * cosine - normal * sine, along * sine + normal * cosine], axis=1))

    @property
    def moment_at_clamp(self) -> float:
        """Moment that decides on the clamped end, N mm."""
        return float(np.interp(self.rod.clamp_position, self.s, self.moment))

    is_held: bool = False  #: whether the end is held by its edge


def _cubic_positions(shape: LawSolution, s: Array, name: str) -> Array:
    values = getattr(shape, name)
    i = np.clip(np.searchsorted(shape.s, s, side="right") - 1, 1, len(shape.s) - 3)
    nodes = np.stack([i - 1, i, i + 1, i + 2])
    result = np.zeros(len(s))
    for j in range(4):
        weight = np.ones(len(s))
        for k in range(4):
            if k != j:
                weight *= (s - shape.s[nodes[k]]) / (shape.s[nodes[j]] - shape.s[nodes[k]])
        result += weight * values[nodes[j]]
    return result


@dataclass(frozen=True, eq=False)  # arrays inside
class ArmLaw:
    """The law of an arm: a cell, its clamped end and its tip over pressures that rise.

    Raises `RodError` where there is no curve, or the pressures of the parts differ.
    """

    pitch: float  #: mm
    first_middle: float  #: mm, from the clamp to the middle of the first cell
    length: float  #: mm, of the arm whose pieces were solved
    cells: tuple[CellCurve, ...]
    clamps: tuple[ClampCurve, ...]
    free_tips: tuple[TipCurve, ...]
    held_tips: tuple[TipCurve, ...]

    def __post_init__(self) -> None:
        parts = [[curve.pressure for curve in curves] for curves in (self.cells, self.clamps, self.free_tips)]
        parts.append([curve.pressure for curve in self.held_tips])
        if not parts[0] or any(part != parts[0] for part in parts) or np.any(np.diff(parts[0]) <= 0.0):
            raise RodError("A law has a cell, a clamped end and two tips at each of its pressures, which rise.")

    @property
    def pressures(self) -> tuple[float, ...]:
        """kPa"""
        return tuple(curve.pressure for curve in self.cells)

    def at(self, pressure: float, length: float | None = None) -> "LawRod":
        """The rod at a pressure in kPa, of the arm's length or another one that is made of the same cells (mm).

        Raises `RodError` for a pressure outside those of the law and a length without room for both ends.
        """
        return LawRod(
            section_at(self.cells, pressure),
            clamp_at(self.clamps, pressure),
            tip_at(self.free_tips, pressure),
            tip_at(self.held_tips, pressure),
            self.pitch,
            self.first_middle,
            self.length if length is None else length,
        )


@dataclass(frozen=True, eq=False)  # arrays inside
class LawRod:
    """A clamped planar rod with the arm's own law at one pressure; it stretches and shears."""

    section: SectionLaw
    clamp: ClampCurve
    free_tip: TipCurve
    held_tip: TipCurve
    pitch: float  #: mm
    first_middle: float  #: mm
    length: float  #: mm

    def __post_init__(self) -> None:
        ends = float(self.clamp.s[-1] - self.free_tip.s[0])
        if not (math.isfinite(self.length) and self.length >= ends * (1 - 1e-9)):
            raise RodError(
                f"An arm of {self.length:g} mm is shorter than its two disturbed ends, {ends:g} mm; "
                "its own law does not describe it."
            )

    @cached_property
    def clamp_position(self) -> float:
        """s at which the moment decides on the clamped end, mm."""
        return self.clamp.position

    def solve(
        self,
        force: Sequence[float] | None = None,
        *,
        end_y: float | None = None,
        end: Sequence[float] | None = None,
        moment: float = 0.0,
    ) -> LawSolution:
        """The equilibrium reached when the loads grow on the inflated arm.

        force: dead force (F_x, F_y) in N on the end. end_y: the end edge is held at this height (mm), as in experiment
        III, and F_y follows; end: (x, y) of it, and both components follow. moment: a couple on the end, N mm.
        Raises `RodError` where loads contradict each other, where the path ends, and where a moment leaves the law.
        """
        if force is not None and (end is not None or end_y is not None):
            raise RodError("Give either the force on the end or its position, not both: one follows from the other.")
        if end is not None and end_y is not None:
            raise RodError("Give either end = (x, y) or end_y, not both.")
        given = Load((0.0, 0.0) if force is None else (float(force[0]), float(force[1])), moment)
        position = (None, end_y) if end is None else (float(end[0]), float(end[1]))
        return _follow(self, given, position)

    def under(self, load: Load, end_y: float | None = None) -> LawSolution:
        """The equilibrium under a load, or with the end held at a height; raises `RodError` for a weight."""
        if any(load.weight):
            raise RodError("A rod with the arm's own law carries no weight.")
        if end_y is None:
            return self.solve(load.force, moment=load.couple)
        return self.solve(end_y=end_y)

    @cached_property
    def arrays(self) -> LawArrays:
        """The law as the integrator reads it."""
        law = self.section
        return LawArrays(
            float(law.moment[0]),
            float(law.moment[1] - law.moment[0]),
            *(np.ascontiguousarray(getattr(law, name)) for name in _TABLES),
        )

    def beside(self, s: Array, moment: Array, moment_at_clamp: float, is_held: bool) -> Array:
        """(m, 2) mm: the material curve beside the axis at s (m,) mm, along and normal to it."""
        result = self._ripple(s, moment)
        clamped = s <= self.clamp.s[-1]
        rows = _interpolated(self.clamp.moment, self.clamp.beside, moment_at_clamp)
        tip = self.held_tip if is_held else self.free_tip
        last = s - self.length >= tip.s[0]
        for k in range(2):
            result[clamped, k] = np.interp(s[clamped], self.clamp.s, rows[:, k])
            result[last, k] = np.interp(s[last] - self.length, tip.s, tip.beside[:, k])
        return result

    def _ripple(self, s: Array, moment: Array) -> Array:
        """Within the cells, which are mirror images of each other about their middles."""
        cycle = (s - self.first_middle) / self.pitch
        from_middle = (cycle - np.round(cycle)) * self.pitch
        law = self.section
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


_TABLES = ("kappa", "kappa_slope", "stretch", "stretch_slope", "axial_rigidity", "shear_rigidity")


def _interpolated(nodes: Array, values: Array, at: float) -> Array:
    """Row of values (k, ...) at a position between nodes (k,), the end rows outside."""
    i = int(np.clip(np.searchsorted(nodes, at) - 1, 0, len(nodes) - 2))
    t = float(np.clip((at - nodes[i]) / (nodes[i + 1] - nodes[i]), 0.0, 1.0))
    return np.asarray((1 - t) * values[i] + t * values[i + 1])


class _Shooting:
    """One rod and its loads, solved by integration from the end."""

    def __init__(self, rod: LawRod, load: Load, position: tuple[float | None, float | None]) -> None:
        self.rod = rod
        self.load = load
        self.position = position
        self.held = np.array([value is not None for value in position])
        tip, clamp = rod.held_tip if self.held.any() else rod.free_tip, rod.clamp
        self.ends = EndArrays(
            clamp.moment,
            clamp.rotation,
            clamp.rotation_by_moment,
            clamp.offset,
            clamp.offset_by_moment,
            rod.clamp_position,
            float(tip.beside[-1, 0]),
            float(tip.beside[-1, 1]),
            tip.couple,
        )
        self.states = np.empty((math.ceil(rod.length / (STEP * rod.pitch)) + 1, 4))
        slope = rod.section.kappa_slope[len(rod.section.kappa_slope) // 2]
        # a force that turns the end by about one radian
        self.size = np.array([1.0, *([1.0 / (rod.length**2 * slope)] * 2)])
        self.outside = 0.0

    def converge(self, guess: Array, factor: float, target: Array) -> Array | None:
        """(3,) angle of the axis at the end and the force on it, at a part of the loads; None without convergence."""
        force = factor * np.array(self.load.force)
        load = EndLoad(self.rod.length, force, factor * self.load.couple, self.held, target)
        unknowns = guess.copy()
        converged, self.outside = converge(self.rod.arrays, self.ends, load, unknowns, self.size, self.states)
        unknowns[1:] = np.where(self.held, unknowns[1:], force)
        return unknowns if converged else None

    def end(self, unknowns: Array) -> Array:
        """(2,) mm, of the material curve in the state last solved."""
        cosine, sine = math.cos(unknowns[0]), math.sin(unknowns[0])
        along, normal = self.ends.along, self.ends.normal
        return np.asarray(self.states[-1, 2:] + [along * cosine - normal * sine, along * sine + normal * cosine])


def _follow(rod: LawRod, load: Load, position: tuple[float | None, float | None]) -> LawSolution:
    """The equilibrium on the path from the inflated arm without load."""
    guess = np.array([rod.section.kappa_0 * rod.length, 0.0, 0.0])
    shooting, free = _Shooting(rod, load, position), _Shooting(rod, Load(), (None, None))
    start = free.converge(guess, 0.0, np.zeros(2))
    if start is None:
        raise RodError(f"The inflated arm has no equilibrium at {rod.section.pressure:g} kPa.")
    begin = free.end(start)
    goal = np.array([begin[k] if position[k] is None else position[k] for k in range(2)], float)
    before, behind, here, reached, step = start, 0.0, start, 0.0, 1.0
    while reached < 1.0:
        factor = min(1.0, reached + step)
        ahead = here if reached == 0.0 else here + (factor - reached) / (reached - behind) * (here - before)
        there = shooting.converge(ahead, factor, begin + factor * (goal - begin))
        if there is None or abs(there[0] - here[0]) > LARGEST_TURN:
            step = 0.4 * (factor - reached)
            if step < SMALLEST_STEP:
                raise RodError(f"No equilibrium was found beyond {100 * reached:.3g} % of the load.")
            continue
        before, behind, here, reached = here, reached, there, factor
        step = 2.0 * (reached - behind)
    return _solution(shooting, here)


def _solution(shooting: _Shooting, unknowns: Array) -> LawSolution:
    rod = shooting.rod
    states, law = shooting.states, rod.section
    if shooting.outside > 1e-9 * float(np.ptp(law.moment)):
        low, high = float(states[:, 1].min()), float(states[:, 1].max())
        edges = (max(law.moment[0], rod.clamp.moment[0]), min(law.moment[-1], rod.clamp.moment[-1]))
        raise RodError(
            f"The moment goes from {low:.4g} to {high:.4g} N mm; at {law.pressure:g} kPa the law is known from "
            f"{edges[0]:.4g} to {edges[1]:.4g} N mm, and it is not extrapolated."
        )
    force = unknowns[1:]
    axial = force[0] * np.cos(states[:, 0]) + force[1] * np.sin(states[:, 0])
    effective = states[:, 1]
    for _ in range(3):
        slope = np.interp(effective, law.moment, law.stretch_slope) / np.interp(effective, law.moment, law.kappa_slope)
        effective = states[:, 1] + axial * slope
    arrays = {
        "s": np.linspace(0.0, rod.length, len(states)),
        "x": states[:, 2],
        "y": states[:, 3],
        "theta": states[:, 0],
        "kappa": np.interp(effective, law.moment, law.kappa),
        "moment": states[:, 1],
        "stretch": np.interp(effective, law.moment, law.stretch)
        + axial / np.interp(effective, law.moment, law.axial_rigidity),
        "force": force,
    }
    for name, array in arrays.items():
        arrays[name] = np.array(array)
        arrays[name].setflags(write=False)
    return LawSolution(**arrays, rod=rod, is_held=bool(shooting.held.any()))
