"""The planar rod in equilibrium (paper, section 2.1).

    theta' = kappa,                          x' = cos theta,  y' = sin theta,
    kappa = kappa_0 + (M - m0_i)/alpha_i,    M' = n_x sin theta - n_y cos theta

clamped at s = 0, with n(s) = F + q (l - s), end force F, end moment M(l) and a dead load q per length (gravity; for
that under which kappa_0 was measured see `own_weight`). Given
are F or components of the end position, whose reactions are then unknown components of F. The unknowns, M(0) and those
components, are found by shooting (`shooting`), for large loads with continuation (`continuation`).

Where the rod has an `extension`, x', y' and M' are those times the stretch, and the moment about the neutral axis
stands in the place of M in kappa (`shooting`).
"""

import math
import reprlib
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, get_args, overload

import numpy as np

from geometry.arrays import Array, read_only
from rod.arm_law.law import ArmLaw
from rod.arm_law.law_rod import LawRod
from rod.arm_law.space_law import SpaceRod
from rod.checked import finite, positive
from rod.curves.extension import Extension
from rod.errors import RodError, RodWarning
from rod.identification.moment_range import MomentRange
from rod.law import FiveParameters, TwoSlopes
from rod.load import Load, held_at, pair, requested
from rod.mechanics.continuation import LoadPoint, Problem, continue_to_full_load, too_large
from rod.mechanics.own_weight import rest_moment
from rod.mechanics.profile import Profile, Steps, cut_into_steps
from rod.solution import RodSolution
from rod.spatial import Position, SpatialLoad, SpatialSolution, is_triple, spatially_requested
from rod.weight import Mass, Weighing, weighted

#: how much finer than the usual the steps may become: at nearly twice the force that this solver follows to all ends
FINEST = 60.0

#: N mm, a moment whose own effect is nothing, under which the offsets of the law act
NEXT_TO_NOTHING = 1e-9

Order = Literal["as tested", "together", "pressure first"]


def _no_law() -> FiveParameters:
    raise RodError("A rod needs a law: five parameters, or the arm's own law at a pressure.")


@dataclass(frozen=True)
class Rod:
    """A clamped planar rod with the five-parameter law, two lines of any slope, or the arm's own law at one pressure.

    kappa_0 (1/mm) is a number, an array (n,) of values at equally spaced points from 0 to length, an array (n, 2) of
    columns s and kappa_0, or a function of s; samples are joined by straight lines. The arm's own law,
    `ArmLaw.at(pressure)`, has its curvature without load, its stretch and its clamped end itself: kappa_0, theta0, fade
    and extension are not given then. Raises `RodError` for what is no finite number, a length that is not positive, a
    kappa_0 that does not fit it, a break d off the rod, and for what a law already has or lacks.
    """

    length: float  #: mm
    kappa_0: Profile | None = None  #: 1/mm; None with the arm's own law
    law: TwoSlopes | LawRod | SpaceRod = field(default_factory=_no_law)
    theta0: float = 0.0  #: rad, tangent angle at the clamp
    start: tuple[float, float] = (0.0, 0.0)  #: mm, x and y of the clamp
    fade: float = 0.0  #: N mm, below this |M| the intercepts fade to zero (see `law`)
    extension: Extension | None = None  #: stretch of the curve; None: inextensible, or as the arm's own law says
    #: N/mm, x and y of the weight of the arm per rest length, under which it has kappa_0 where nothing else acts
    weight: tuple[float, float] = (0.0, 0.0)
    weight_height: float = 0.0  #: mm, of its mass above the material curve
    mass: Mass | None = None  #: None: not known, or that of the arm's own law
    moment_range: MomentRange | None = None  #: of the identification of the five parameters
    notes: tuple[str, ...] = ()  #: what limits the trust in this rod, a sentence each; every shape has them too

    def __post_init__(self) -> None:
        positive(self.length, "The length of a rod")
        pair(self.start, "start")
        object.__setattr__(self, "weight", pair(self.weight, "weight"))
        for name in ("theta0", "fade", "weight_height"):
            object.__setattr__(self, name, finite(getattr(self, name), name))
        if isinstance(self.law, ArmLaw):
            raise RodError("A rod has the law of an arm at one pressure: law = arm_law.at(pressure in kPa).")
        if isinstance(self.law, LawRod):
            self._check_nothing_twice(self.law.weight)
            object.__setattr__(self, "mass", self.mass or self.law.mass)
            object.__setattr__(self, "weight", self.law.weight)
            object.__setattr__(self, "law", replace(self.law, length=float(self.length), mass=self.mass))
            return
        if isinstance(self.law, SpaceRod):
            self._check_nothing_twice((0.0, 0.0))
            if not math.isclose(self.length, self.law.length):
                raise RodError(f"The law in space is that of an arm of {self.law.length:g} mm; give law.length.")
            object.__setattr__(self, "mass", self.mass or self.law.own.mass)
            return
        if not isinstance(self.law, TwoSlopes):
            raise RodError("The law of a rod is five parameters, two slopes, or the arm's own law at a pressure.")
        if not 0.0 < self.law.d < self.length:
            raise RodError(f"The break d = {self.law.d:g} mm lies off the rod of {self.length:g} mm.")
        if self.fade < 0.0:
            raise RodError(f"fade is a moment of at least 0 N mm, not {self.fade}.")
        if not isinstance(self.extension, Extension | None):
            raise RodError(f"The extension of a rod is a rod.Extension or None, not {reprlib.repr(self.extension)}.")
        _ = self.steps  # refuses a kappa_0 that does not fit

    def _check_nothing_twice(self, weight: tuple[float, float]) -> None:
        given = {"kappa_0": self.kappa_0 is not None, "extension": self.extension is not None}
        given |= {
            "theta0": self.theta0 != 0.0,
            "fade": self.fade != 0.0,
            "weight": self.weight not in ((0.0, 0.0), weight),
        }
        for name, is_given in given.items():
            if is_given:
                raise RodError(f"A rod with the arm's own law takes no {name}: the law has it or needs none.")

    @cached_property
    def steps(self) -> Steps:
        """The steps of the integration. Raises `RodError` for a kappa_0 that does not fit and for the arm's own law."""
        if self.kappa_0 is None:
            raise RodError("A rod with five parameters needs kappa_0, its curvature without load.")
        return cut_into_steps(self.length, self.kappa_0, self.lines)

    @property
    def five(self) -> FiveParameters:
        """The five parameters. Raises `RodError` for a rod with another law."""
        if isinstance(self.law, FiveParameters):
            return self.law
        if isinstance(self.law, LawRod | SpaceRod):
            raise RodError("This rod follows the arm's own law and has no five parameters.")
        raise RodError("The slopes of this rod may be negative, and are not the five parameters of a rod.")

    @property
    def lines(self) -> TwoSlopes:
        """The two lines of its law. Raises `RodError` for a rod with the arm's own law."""
        return self.law if isinstance(self.law, TwoSlopes) else self.five

    @overload
    def solve(  # type: ignore[overload-overlap]
        self,
        force: tuple[float, float, float],
        *,
        moment: float | Sequence[float] = ...,
        weight: bool = ...,
        direction: str | Sequence[float] | None = ...,
        tip_mass: float | str = ...,
    ) -> SpatialSolution: ...

    @overload
    def solve(  # type: ignore[overload-overlap]
        self,
        force: None = ...,
        *,
        end: tuple[float | None, float | None, float | None],
        moment: float | Sequence[float] = ...,
        weight: bool = ...,
        direction: str | Sequence[float] | None = ...,
    ) -> SpatialSolution: ...

    @overload
    def solve(
        self,
        force: Sequence[float] | None = ...,
        *,
        end: Sequence[float] | None = ...,
        end_x: float | None = ...,
        end_y: float | None = ...,
        moment: float = ...,
        order: Order = ...,
        weight: bool = ...,
        direction: str | Sequence[float] | None = ...,
        tip_mass: float | str = ...,
    ) -> RodSolution: ...

    def solve(
        self,
        force: Sequence[float] | None = None,
        *,
        end: Sequence[float | None] | None = None,
        end_x: float | None = None,
        end_y: float | None = None,
        moment: float | Sequence[float] = 0.0,
        order: Order = "as tested",
        weight: bool = True,
        direction: str | Sequence[float] | None = None,
        tip_mass: float | str = 0.0,
    ) -> RodSolution | SpatialSolution:
        """The equilibrium that is reached when the loads grow from zero.

        force: dead end force (F_x, F_y) in N; or end = (x, y), end_x or end_y in mm, the prescribed position of the
        end (the other force component is zero: end_y alone is experiment III). Either may be combined with moment, M(l)
        in N mm. `under` takes a `Load`.

        direction: of gravity, "hanging", "lying" or "standing", the angle "30 deg" by which the arm rises from its
        clamp to its end at rest, or (x, y); the weight of the arm acts then unless weight is False. tip_mass: hangs on
        the end, in g or written with its unit ("20 g").

        A force, an end, a moment or a direction with three components, z across the plane, gives the rod in space. Its
        law needs rigidities out of the plane. end may have None along axes on which the end is free.

        order selects among several equilibria. "pressure first": the loads grow on the rod that already has
        its kappa_0. "together": kappa_0 and the loads grow together from the straight rod. "as tested": together where
        end_y is prescribed, because in experiment III the end is held while the pressure rises, else pressure first.
        With the arm's own law the order is always "as tested".

        Warns with `RodWarning` where the moments leave those of the identification; the `notes` of the shape say so
        too. Raises `RodError` when the loads contradict each other, when the end is put farther away than the rod is
        long, and when the path ends before the full load is reached.
        """
        is_weighed = direction is not None or tip_mass != 0.0
        carried = self.weight if isinstance(self.law, LawRod) else (0.0, 0.0)
        weighing = Weighing(self.mass, self.length, carried, any(self.weight) and not any(carried))
        if isinstance(self.law, SpaceRod) or any(is_triple(value) for value in (force, end, moment, direction)):
            if order != "as tested":
                raise RodError(f"In space the loads grow on the inflated arm; order = {order!r} is not possible.")
            spatial, position = spatially_requested(force, moment, end, end_x, end_y)
            if is_weighed:
                spatial = weighted(spatial, weighing, weight, direction, tip_mass)
            return self._in_space(spatial, position)
        load, held = requested(force, moment, end, end_x, end_y)
        if is_weighed:
            load = weighted(load, weighing, weight, direction, tip_mass)
        if isinstance(self.law, LawRod):
            return replace(_by_arm_law(self.law, self.start, load, held, order), notes=self.notes)
        load, loaded = _on_free_axes(load, held), force is not None or load.couple != 0.0 or is_weighed
        solution = self._equilibrium(_LoadCase(load, held, _grow_together(order, held, loaded=loaded)))
        if outside := self._outside(solution):
            warnings.warn(outside, RodWarning, stacklevel=2)
        return replace(solution, notes=(*self.notes, *filter(None, [outside])))

    def _in_space(self, load: SpatialLoad, position: Position) -> SpatialSolution:
        """The equilibrium in space, whose clamp is at the start of this rod."""
        if not isinstance(self.law, LawRod | SpaceRod):
            raise RodError("A rod with five parameters stays in its plane; in space a rod has the arm's own law.")
        start = np.array([*self.start, 0.0])
        x, y, z = (None if at is None else at - float(origin) for at, origin in zip(position, start, strict=True))
        solution = self.law.solve_in_space(load, (x, y, z))
        return replace(solution, axis=read_only(solution.axis + start), notes=self.notes)

    def _outside(self, shape: RodSolution) -> str:
        """A sentence where the moments of a shape leave those of the identification; empty elsewhere."""
        outside = "" if self.moment_range is None else self.moment_range.warning(shape)
        if not outside:
            return ""
        jump = math.dist(self.under(Load()).end, self.under(Load(couple=NEXT_TO_NOTHING)).end)
        return (
            f"{outside} Under any load, however small, the offsets m0 bend this rod as well: its end is then "
            f"{jump:.3g} mm from its place without load."
        )

    def under(self, load: Load, end_y: float | None = None, end_x: float | None = None) -> RodSolution:
        """The equilibrium under a load, grown "as tested".

        With end_y, end_x or both (mm) the end is held there as in experiment III: couple and weight act, and of the
        force the components along the other axes; those along an axis on which the end is held follow. Raises
        `RodError` as `solve` does.
        """
        held = held_at(end_x, end_y)
        load = _on_free_axes(load, held)
        if isinstance(self.law, LawRod):
            return _by_arm_law(self.law, self.start, load, held, "as tested")
        if isinstance(self.law, SpaceRod):
            raise RodError("This arm bends in space; `solve` gives its shape.")
        return self._equilibrium(_LoadCase(load, held, _grow_together("as tested", held, loaded=True)))

    def _equilibrium(self, case: "_LoadCase") -> RodSolution:
        """The equilibrium, on finer steps where the end force turns out to be large."""
        solution = self._solved(self.steps, case)
        refinement = _refinement(self, solution, case.load)
        if refinement > FINEST:
            raise RodError(too_large(_growth(self, solution, case.load) ** 2))
        if refinement > 1.0:
            assert self.kappa_0 is not None  # `steps` has refused it
            solution = self._solved(cut_into_steps(self.length, self.kappa_0, self.lines, refinement), case)
        return solution

    def _solved(self, steps: Steps, case: "_LoadCase") -> RodSolution:
        problem = _problem(self, steps, case)
        return _solution(self, problem, *continue_to_full_load(problem))


@dataclass(frozen=True)
class _LoadCase:
    """Loads and end conditions of one solve."""

    load: Load
    end: tuple[float | None, float | None]  #: mm, prescribed x and y of the end
    together: bool  #: kappa_0 grows with the loads


def _on_free_axes(load: Load, end: tuple[float | None, float | None]) -> Load:
    """The load with its force along the axes on which the end is free."""
    fx, fy = (0.0 if held is not None else force for force, held in zip(load.force, end, strict=True))
    return replace(load, force=(fx, fy))


def _by_arm_law(
    law: LawRod, start: tuple[float, float], load: Load, end: tuple[float | None, float | None], order: Order
) -> RodSolution:
    """The equilibrium of a rod with the arm's own law whose clamp is at start (mm)."""
    if order != "as tested":
        raise RodError(f"With the arm's own law the loads grow as tested; order = {order!r} is not possible.")
    x, y = (None if value is None else value - origin for value, origin in zip(end, start, strict=True))
    solution = law.under(load, end_x=x, end_y=y)
    if not any(start):
        return solution
    return replace(solution, x=read_only(solution.x + start[0]), y=read_only(solution.y + start[1]))


def _grow_together(order: Order, held: tuple[float | None, float | None], *, loaded: bool) -> bool:
    end_x, end_y = held
    if order not in get_args(Order):
        raise RodError(f"order is one of {', '.join(get_args(Order))}; {order!r} is not.")
    if order == "as tested":
        return end_x is None and end_y is not None
    # on a rod that nothing acts on nothing can grow together
    return order == "together" and (loaded or end_x is not None or end_y is not None)


def _refinement(rod: Rod, solution: RodSolution, load: Load) -> float:
    """How much finer than the usual the steps must be: at large forces errors grow like exp(s sqrt(F/alpha))."""
    growth = _growth(rod, solution, load)
    return max(1.0, growth / 4.0 * math.exp((growth - 4.0) / 6.0))


def _growth(rod: Rod, solution: RodSolution, load: Load) -> float:
    """l sqrt(F/alpha), by whose exponential function errors grow along the rod."""
    softest = min(abs(rod.lines.alpha1), abs(rod.lines.alpha2))
    force = np.hypot(*solution.force) + rod.length * (math.hypot(*load.weight) + math.hypot(*rod.weight))
    return rod.length * math.sqrt(force / softest)


def _problem(rod: Rod, steps: Steps, case: _LoadCase) -> Problem:
    """The loads on the rod in units of its length l and rigidity B = |alpha2|: moments B/l, forces B/l^2."""
    law, length = rod.lines, rod.length
    base = abs(law.alpha2)
    end = [0.0 if p is None else (p - rod.start[i]) / length for i, p in enumerate(case.end)]
    reach = math.hypot(*end)
    if not reach < 1.0 and rod.extension is None:
        raise RodError(
            f"The end cannot be {reach * length:g} mm from the clamp: the rod of {length:g} mm is inextensible."
        )
    unit = length**2 / base
    stages = steps.stages
    extension = rod.extension
    stretch = np.ones(stages.shape) if extension is None else extension.at(stages * length)
    eccentricity = 0.0 if extension is None else extension.eccentricity / length
    alpha = np.where(steps.first, law.alpha1, law.alpha2) / base
    own_weight = _weight(Load(weight=rod.weight, weight_height=rod.weight_height), unit, length)
    at_rest = (0.0, np.zeros(stages.shape))
    if any(rod.weight):
        at_rest = rest_moment(steps, stretch, own_weight, rod.theta0, eccentricity)
    return Problem(
        steps=steps,
        kappa_0=steps.kappa_0,
        stretch=stretch,
        eccentricity=eccentricity,
        alpha=alpha,
        m0=np.where(steps.first, law.m01, law.m02) * (length / base),
        fade=rod.fade * length / base,
        theta0=rod.theta0,
        free=np.array([True, case.end[0] is not None, case.end[1] is not None]),
        force=np.array(case.load.force) * unit,
        weight=_weight(case.load, unit, length),
        own_weight=own_weight,
        rest_moment=at_rest[1],
        rest_clamp_moment=at_rest[0],
        moment=case.load.couple * length / base,
        end=np.array(end),
        together=case.together,
    )


def _weight(load: Load, unit: float, length: float) -> Array:
    """(4,) weight per length and its couple, without dimension, as in `shooting`; unit: mm2 over the rigidity, 1/N."""
    weight = np.array(load.weight) * (unit * length)
    return np.concatenate([weight, weight * (load.weight_height / length)])


def _solution(rod: Rod, problem: Problem, point: LoadPoint, count: int) -> RodSolution:
    """The dimensionless point in mm and N."""
    law, steps, length = rod.lines, problem.steps, rod.length
    base = abs(law.alpha2)
    kappa_0, at_rest = (np.append(stages[:, 0], stages[-1, 1]) for stages in (steps.kappa_0, problem.rest_moment))
    bending = (_about_neutral_axis(problem, point) - at_rest) * (base / length)
    intercept_factor = np.full(len(bending), 1.0 if count else 0.0)
    if rod.fade > 0.0:
        intercept_factor *= np.minimum(1.0, np.abs(bending) / rod.fade)
    first = np.append(steps.first, False)
    intercept = intercept_factor * np.where(first, law.m01, law.m02)
    deviation = (bending - intercept) / np.where(first, law.alpha1, law.alpha2)
    arrays = {
        "s": steps.s * length,
        "x": rod.start[0] + length * point.states[:, 2],
        "y": rod.start[1] + length * point.states[:, 3],
        "theta": point.states[:, 0],
        "kappa": kappa_0 / length + deviation,
        "moment": point.states[:, 1] * (base / length),
        "bending_moment": bending,
        "stretch": _stretch(rod, steps.s * length, deviation),
        "force": _end_force(problem, point) * (base / length**2),
        "weight": problem.weight_at(1.0)[:2] * (base / length**2),
    }
    frozen: dict[str, Any] = {name: read_only(array) for name, array in arrays.items()}
    return RodSolution(**frozen, load_steps=count)


def _end_force(problem: Problem, point: LoadPoint) -> Array:
    """(2,) F_x and F_y on the end, given or found."""
    return np.where(problem.free[1:], point.unknowns[1:], problem.force)


def _about_neutral_axis(problem: Problem, point: LoadPoint) -> Array:
    """(n,) M + e N at the ends of the steps."""
    theta, moment = point.states[:, 0], point.states[:, 1]
    weight_beyond = np.outer(problem.weight_at(1.0)[:2], 1.0 - problem.steps.s)
    x, y = _end_force(problem, point)[:, None] + weight_beyond
    return moment + problem.eccentricity * (x * np.cos(theta) + y * np.sin(theta))


def _stretch(rod: Rod, s: Array, deviation: Array) -> Array:
    """(n,) lambda at s (mm) for Delta (1/mm)."""
    if rod.extension is None:
        return np.ones(len(s))
    return rod.extension.at(s) + rod.extension.eccentricity * deviation
