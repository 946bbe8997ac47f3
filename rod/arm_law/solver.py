"""The equilibrium of a rod with the arm's own law: Newton's method at the end, steps of the load from the clamp."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from geometry.arrays import Array, read_only
from rod.arm_law.curves import ClampCurve, TipCurve, TipState
from rod.arm_law.integration import ITERATIONS, EndArrays, EndLoad, LawArrays, converge, tip_levers
from rod.arm_law.section import SectionLaw
from rod.errors import RodError, buckles_at
from rod.load import Load
from rod.solution import RodSolution
from rod.spatial import SpatialLoad
from rod.weight import Mass

#: longest step of the integration, mm over the pitch
STEP = 0.2
#: smallest part of the load in one step
SMALLEST_STEP = 1e-3
#: rad, largest change of the end's angle in one step of the load
LARGEST_TURN = 1.0
#: the moment may leave the law by rounding, over the range of the law
ROUNDING = 1e-9
_TABLES = ("kappa", "kappa_slope", "stretch", "stretch_slope", "axial_rigidity", "shear_rigidity")


@dataclass(frozen=True, eq=False)  # arrays inside
class Pieces:
    """The pieces of an arm at one pressure, with the length of the arm."""

    section: SectionLaw
    clamp: ClampCurve
    tip: TipCurve
    pitch: float  #: mm
    length: float  #: mm
    mass: Mass | None = None  #: how the weight of a load is spread along the arm; None: evenly

    @property
    def positions(self) -> Array:
        """(n,) mm: where the integration steps end, from 0 to the length."""
        return np.linspace(0.0, self.length, math.ceil(self.length / (STEP * self.pitch)) + 1)

    def weight(self, load: Load | SpatialLoad, s: Array) -> Array:
        """(n, 4) N and N mm: the weight of a load beyond s (n,), as `EndLoad` has it; (n, 6) of a load in space."""
        return weight_beyond(load, self.mass, self.length, s)

    @cached_property
    def arrays(self) -> LawArrays:
        """The law of the cells as the integrator reads it."""
        law = self.section
        return LawArrays(
            float(law.moment[0]),
            float(law.moment[1] - law.moment[0]),
            *(_copied(getattr(law, name)) for name in _TABLES),
        )

    def ends(self, tip: TipState) -> EndArrays:
        """The clamped end and the tip as the integrator reads them."""
        clamp = self.clamp
        of_turns, slopes = tip.over_turns(np.column_stack([tip.couple, tip.acts_at, tip.beside[:, -1]]))
        return EndArrays(
            _copied(clamp.moment),
            _copied(clamp.rotation),
            _copied(clamp.rotation_by_moment),
            _copied(clamp.offset),
            _copied(clamp.offset_by_moment),
            clamp.position,
            _copied(of_turns),
            _copied(slopes),
            _copied(tip.by_pull[-1]),
        )


def weight_beyond(load: Load | SpatialLoad, mass: Mass | None, length: float, s: Array) -> Array:
    """(n, 4) N and N mm, (n, 6) in space: the weight of a load beyond s (n,) on an arm of a length in mm.

    mass: None for one that is spread evenly.
    """
    mass = mass or Mass.even(length, 1.0, load.weight_height)
    (grams, heights), (all_grams, _) = mass.within(length - s), mass.within(np.array([length]))
    total = np.array(load.weight) * length / all_grams
    return np.column_stack([grams[:, None] * total, heights[:, None] * total])


def _copied(values: Array) -> Array:
    """A copy that may be written, row by row in memory; for other arrays numba would compile the integrator again."""
    return np.array(values, order="C")


class EndConditions(NamedTuple):
    """What acts on the end of an arm."""

    load: Load
    position: tuple[float | None, float | None]  #: mm, prescribed x and y of the end

    def tip_state(self, tip: TipCurve) -> TipState:
        """The tip under these conditions: free, held along x or at a height, or along both in one point."""
        if self.position == (None, None):
            return tip.free
        if self.position[0] is None:
            return tip.held
        return tip.held_along_x if self.position[1] is None else tip.pinned


class _Shooting:
    """Pieces and end conditions, solved by integration from the end to the clamp."""

    def __init__(self, pieces: Pieces, conditions: EndConditions) -> None:
        self.pieces = pieces
        self.load = conditions.load
        self.held = np.array([value is not None for value in conditions.position])
        self.ends = pieces.ends(conditions.tip_state(pieces.tip))
        self.states = np.empty((len(pieces.positions), 4))
        self.weight = pieces.weight(self.load, pieces.positions)
        slope = pieces.section.kappa_slope[len(pieces.section.kappa_slope) // 2]
        # a force that turns the end by about one radian
        self.size = np.array([1.0, *([1.0 / (pieces.length**2 * slope)] * 2)])
        self.outside = self.determinant = 0.0  #: of the last solution

    def converge(self, guess: Array, factor: float, target: Array, grown: float = 1.0) -> Array | None:
        """(3,) angle of the axis at the end and the force on it, at a part of the loads; None without convergence.

        grown: part of the curvature without moment that the rod already has.
        """
        arrays = self.pieces.arrays
        if grown < 1.0:
            arrays = arrays._replace(kappa=arrays.kappa - (1.0 - grown) * self.pieces.section.kappa_0)
        force = factor * np.array(self.load.force)
        load = EndLoad(self.pieces.length, force, factor * self.load.couple, self.held, target, factor * self.weight)
        unknowns = guess.copy()
        converged, self.outside, self.determinant = converge(arrays, self.ends, load, unknowns, self.size, self.states)
        unknowns[1:] = np.where(self.held, unknowns[1:], force)
        return unknowns if converged else None

    def end(self, unknowns: Array) -> Array:
        """(2,) mm, of the material curve in the state last solved."""
        lever, _, _ = tip_levers(self.ends, unknowns[0], unknowns[1:])
        return np.asarray(self.states[-1, 2:] + lever)


def equilibrium(pieces: Pieces, conditions: EndConditions) -> RodSolution:
    """The equilibrium on the path from the inflated arm without load to the full load; `beside` is not set.

    Where the height of the end alone is prescribed the path is that of experiment III: the curvature without moment and
    the height grow together from the straight arm, which selects among several equilibria. A step of the load that
    leads to an unstable equilibrium is shortened.

    Raises `RodError` where the path ends or becomes unstable, and where a moment leaves the law.
    """
    position = conditions.position
    together = position[0] is None and position[1] is not None
    turn = pieces.section.kappa_0 * pieces.length
    guess = np.array([0.0 if together else turn, 0.0, 0.0])
    shooting, free = _Shooting(pieces, conditions), _Shooting(pieces, EndConditions(Load(), (None, None)))
    start = free.converge(guess, 0.0, np.zeros(2), 0.0 if together else 1.0)
    if start is None:
        raise RodError(f"The inflated arm has no equilibrium at {pieces.section.pressure:g} kPa.")
    begin = free.end(start)
    goal = np.array([begin[k] if position[k] is None else position[k] for k in range(2)], float)
    grown = 0.0 if together else 1.0
    is_solved = shooting.converge(start, 0.0, begin, grown) is not None
    sign = math.copysign(1.0, shooting.determinant) if is_solved else 0.0
    before, behind, here, reached, count = start, 0.0, start, 0.0, 0
    step = 1.0 / max(1.0, abs(turn)) if together else 1.0
    while reached < 1.0:
        factor = min(1.0, reached + step)
        ahead = here if reached == 0.0 else here + (factor - reached) / (reached - behind) * (here - before)
        there = shooting.converge(ahead, factor, begin + factor * (goal - begin), factor if together else 1.0)
        is_near = there is not None and abs(there[0] - here[0]) <= LARGEST_TURN
        if there is None or not is_near or shooting.determinant * sign < 0.0:
            step = 0.4 * (factor - reached)
            if step < SMALLEST_STEP:
                nowhere = f"No equilibrium was found beyond {100 * reached:.3g} % of the load."
                raise RodError(buckles_at(reached) if is_near else nowhere)
            continue
        before, behind, here, reached, count = here, reached, there, factor, count + 1
        step = 2.0 * (reached - behind)
    return _solution(shooting, here, count)


def _solution(shooting: _Shooting, unknowns: Array, count: int) -> RodSolution:
    """The state last solved with curvature, stretch and shear by the law."""
    states, law = shooting.states, shooting.pieces.section
    force = unknowns[1:]
    cosine, sine = np.cos(states[:, 0]), np.sin(states[:, 0])
    x, y = (force + shooting.weight[:, :2]).T
    axial, across = x * cosine + y * sine, y * cosine - x * sine
    effective = _effective_moment(law, states[:, 1], axial)
    check_within_law(shooting.pieces, shooting.outside, effective, bool(shooting.weight.any()))
    by_force = axial / np.interp(effective, law.moment, law.axial_rigidity)
    arrays = {
        "s": shooting.pieces.positions,
        "x": states[:, 2],
        "y": states[:, 3],
        "theta": states[:, 0],
        "kappa": np.interp(effective, law.moment, law.kappa),
        "moment": states[:, 1],
        "stretch": np.interp(effective, law.moment, law.stretch) + by_force,
        "force": force,
        "weight": shooting.weight[0, :2],
        "shear": across / np.interp(effective, law.moment, law.shear_rigidity),
    }
    frozen: dict[str, Any] = {name: read_only(array) for name, array in arrays.items()}
    return RodSolution(**frozen, load_steps=count)


def _effective_moment(law: SectionLaw, moment: Array, axial: Array) -> Array:
    """(n,) N mm: the moment that bends the cells, with that of the axial force about their neutral line."""
    effective = moment
    for _ in range(ITERATIONS):
        slope = np.interp(effective, law.moment, law.stretch_slope) / np.interp(effective, law.moment, law.kappa_slope)
        effective = moment + axial * slope
    return effective


def check_within_law(pieces: Pieces, outside: float, moment: Array, is_weighed: bool) -> None:
    """Raise `RodError` where moments leave the law of the cells or of the clamped end.

    outside: by how much they do, N mm. moment: (n,) N mm, those that bend the cells.
    """
    law, clamp = pieces.section, pieces.clamp
    if outside <= ROUNDING * float(np.ptp(law.moment)):
        return
    low, high = max(law.moment[0], clamp.moment[0]), min(law.moment[-1], clamp.moment[-1])
    remedy = ", which counts the weight where effects.gravity is on" if is_weighed else ""
    raise RodError(
        f"The moment that bends the cells goes from {moment.min():.4g} to {moment.max():.4g} N mm; at "
        f"{law.pressure:g} kPa the law is known from {low:.4g} to {high:.4g} N mm, and it is not extrapolated: a law "
        f"is measured for the loads of its configuration{remedy}, and this one is larger."
    )
