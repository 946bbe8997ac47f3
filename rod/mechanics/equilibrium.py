"""The rod that users solve: five parameters, two lines of any slope, or the arm's own law at one pressure.

A rod with two lines is that of the paper, section 2.1:

    theta' = kappa,  x' = cos theta,  y' = sin theta,  kappa = kappa_0 + (M - m0_i)/alpha_i

clamped at s = 0. All rods are chains of elements (`rod.arm`).
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, Literal, TypeAlias, TypedDict, Unpack, get_args, overload

from geometry.arrays import read_only
from geometry.told import Printable
from rod.along import Along, LineLoad, Support, are_heights, pair
from rod.arm.small_motions import compile_solver
from rod.arm_law.law_rod import LawRod
from rod.arm_law.space_rod import SpaceRod
from rod.checked import Amount, Given, finite, positive
from rod.errors import LoadError, RodError, RodWarning
from rod.identification.moment_range import MomentRange
from rod.law import FiveParameters, TwoSlopes
from rod.load import Force, Load, Loading, held_place, with_end
from rod.mechanics.lines import LinesRod, Profile, sampled
from rod.same_pressure import Pressures
from rod.solution import RodSolution, SpatialSolution
from rod.weight import Hung, Mass

#: N mm, a moment whose own effect is nothing, under which the offsets of the law act
NEXT_TO_NOTHING = 1e-9

#: an arm at one pressure
Arm: TypeAlias = LinesRod | LawRod | SpaceRod
Order = Literal["as tested", "together", "pressure first"]


class _Also(TypedDict, total=False):
    """What `Rod.solve` takes in the plane and in space."""

    moment: Amount | Sequence[Amount]
    weight: bool
    direction: str | Sequence[float] | None
    along: Sequence[Along]
    hung: Hung


def _no_law() -> FiveParameters:
    raise RodError("A rod needs a law: five parameters, or the arm's own law at a pressure.")


@dataclass(frozen=True)
class Rod(Printable):
    """A clamped planar rod with the five-parameter law, two lines of any slope, or the arm's own law at one pressure.

    kappa_0 (1/mm) is a number, an array (n,) of values at equally spaced points from 0 to length, an array (n, 2) of
    columns s and kappa_0, or a function of s; samples are joined by straight lines. The arm's own law,
    `ArmLaw.at(pressure)`, has its curvature without load, its stretch and its clamped end itself: kappa_0 and theta0
    are not given then. Raises `RodError` for what is no finite number, a length that is not positive, a
    kappa_0 that does not fit it, a break d off the rod, and for what a law already has or lacks.
    """

    length: Given  #: mm, or a text with its unit; so are other numbers below
    kappa_0: Profile | None = None  #: 1/mm; None with the arm's own law
    law: TwoSlopes | LawRod | SpaceRod = field(default_factory=_no_law)
    theta0: Given = 0.0  #: rad, tangent angle at the clamp
    start: tuple[Given, Given] = (0.0, 0.0)  #: mm, x and y of the clamp
    #: N/mm, x and y of the weight of the arm per rest length, under which it has kappa_0 where nothing else acts
    weight: tuple[float, float] = (0.0, 0.0)
    weight_height: float = 0.0  #: mm, of its mass above the material curve
    mass: Mass | None = None  #: None: not known, or that of the arm's own law
    moment_range: MomentRange | None = None  #: of the identification of the five parameters
    notes: tuple[str, ...] = ()  #: what limits the trust in this rod, a sentence each; every shape has them too

    #: as of a law over pressures: that of a rod stays as it is, whichever one acts
    cavities: ClassVar[tuple[str, ...]] = ("the arm",)
    rows: ClassVar[tuple[Pressures, ...]] = ((0.0,), (1.0,))

    def __post_init__(self) -> None:
        object.__setattr__(self, "length", positive(self.length, "The length of a rod", "mm"))
        object.__setattr__(self, "start", pair(self.start, "start", "mm"))
        object.__setattr__(self, "weight", pair(self.weight, "weight", "N/mm"))
        for name, unit in (("theta0", "rad"), ("weight_height", "mm")):
            object.__setattr__(self, name, finite(getattr(self, name), name, unit))
        if isinstance(self.law, LawRod | SpaceRod):
            is_weighed = self.weight not in ((0.0, 0.0), self.law.weight)
            given = {"kappa_0": self.kappa_0 is not None, "theta0": self.theta0 != 0.0, "weight": is_weighed}
            for name in (name for name, is_given in given.items() if is_given):
                raise RodError(f"A rod with the arm's own law takes no {name}: the law has it or needs none.")
            object.__setattr__(self, "law", self.law.of(float(self.length), self.mass))
            object.__setattr__(self, "mass", self.law.mass)
            object.__setattr__(self, "weight", self.law.weight)
            return
        if not isinstance(self.law, TwoSlopes):
            own = "the arm's own law at one pressure: law = arm_law.at(pressure in kPa)"
            raise RodError(f"The law of a rod is five parameters, two slopes, or {own}.")
        if not 0.0 < self.law.d < self.length:
            raise RodError(f"The break d = {self.law.d:g} mm lies off the rod of {self.length:g} mm.")
        _ = self.arm  # refuses a kappa_0 that does not fit

    @cached_property
    def arm(self) -> Arm:
        """The arm that answers, with its own law or two lines. Raises `RodError` for a kappa_0 that does not fit."""
        if not isinstance(self.law, TwoSlopes):
            return self.law
        if self.kappa_0 is None:
            raise RodError("A rod with five parameters needs kappa_0, its curvature without load.")
        s, kappa_0 = sampled(self.length, self.kappa_0)
        beside = (0.0, self.weight_height)
        own = (LineLoad(0.0, self.length, self.weight, beside=beside),) if any(self.weight) else ()
        return LinesRod(self.law, self.length, s, kappa_0, self.theta0, own)

    def at(self, pressures: Amount | Sequence[Amount]) -> "Rod":
        """Itself, at any pressure."""
        return self

    @property
    def told(self) -> dict[str, str]:
        """Length and law."""
        return {"length": f"{self.length:g} mm", "law": repr(self.law)}

    @property
    def has_own_law(self) -> bool:
        """Whether its law was measured on a cell; others have two straight lines."""
        return not isinstance(self.law, TwoSlopes)

    @property
    def five(self) -> FiveParameters:
        """The five parameters. Raises `RodError` for a rod with another law."""
        if isinstance(self.law, FiveParameters):
            return self.law
        if self.has_own_law:
            raise RodError("This rod follows the arm's own law and has no five parameters.")
        raise RodError("The slopes of this rod may be negative, and are not the five parameters of a rod.")

    @overload
    def solve(  # type: ignore[overload-overlap]
        self, force: tuple[Amount, Amount, Amount], *, tip_mass: float | str = ..., **also: Unpack[_Also]
    ) -> SpatialSolution: ...

    @overload
    def solve(  # type: ignore[overload-overlap]
        self, force: None = ..., *, end: tuple[Amount | None, Amount | None, Amount | None], **also: Unpack[_Also]
    ) -> SpatialSolution: ...

    @overload
    def solve(
        self,
        force: Force | None = ...,
        *,
        end: Sequence[Amount | None] | None = ...,
        end_x: Amount | None = ...,
        end_y: Amount | None = ...,
        order: Order = ...,
        tip_mass: float | str = ...,
        **also: Unpack[_Also],
    ) -> RodSolution: ...

    def solve(
        self,
        force: Force | None = None,
        *,
        end: Sequence[Amount | None] | None = None,
        end_x: Amount | None = None,
        end_y: Amount | None = None,
        moment: Amount | Sequence[Amount] = 0.0,
        order: Order = "as tested",
        weight: bool = True,
        direction: str | Sequence[float] | None = None,
        tip_mass: float | str = 0.0,
        along: Sequence[Along] = (),
        hung: Hung = (),
    ) -> RodSolution | SpatialSolution:
        """The equilibrium that is reached when the loads grow from zero.

        force: dead end force (F_x, F_y) in N; or end = (x, y), end_x or end_y in mm, the prescribed position of the
        end (the other force component is zero: end_y alone is experiment III). Either may be combined with moment, M(l)
        in N mm. `under` takes a `Load`. A text has its unit: ("0 N", "50 mN"). One force alone acts upwards: "0.05 N".

        along: loads on sections of the arm, `rod.PointLoad` and `rod.LineLoad`, and supports, `rod.Support`; those with
        a part across the plane of the arm give the rod in space. hung: masses along it, such as [("0.5 l", "5 g")], or
        in mm and g; they need a direction.

        direction: of gravity, "hanging", "lying" or "standing", the angle "30 deg" by which the arm rises from its
        clamp to its end at rest, or (x, y); the weight of the arm acts then unless weight is False. tip_mass: hangs on
        the end, in g or written with its unit ("20 g").

        A force, an end, a moment or a direction with three components, z across the plane, gives the rod in space. Its
        law needs rigidities out of the plane. end may have None along axes on which the end is free.

        order selects among several equilibria. "pressure first": the loads grow on the rod that already has
        its kappa_0. "together": kappa_0 and the loads grow together from the straight rod. "as tested": together where
        end_y is prescribed, because in experiment III the end is held while the pressure rises, else pressure first.
        Where an arm buckles on the way, the shape is the stable one to which it falls. Warns with `RodWarning` then,
        and where the moments leave those of the identification; the `notes` of the shape say so too. Raises `RodError`
        when the loads contradict each other, when the end is put farther away than the rod is long, and when the path
        ends before the full load is reached.
        """
        held = held_place(end, end_x, end_y)
        return self.bear(Loading(force, moment, held, along, direction, tip_mass, hung), order=order, weight=weight)

    def bear(
        self, loading: Loading, *, order: Order = "as tested", weight: bool = True
    ) -> RodSolution | SpatialSolution:
        """The equilibrium under a loading, as `solve` gives it for the same loads; and raises and warns as that."""
        if loading.direction is None and (loading.tip_mass or loading.hung):
            raise LoadError("A weight needs the direction of gravity: hanging, lying, standing, an angle, or x and y.")
        if loading.direction is not None and weight and any(self.weight) and not self.has_own_law:
            raise LoadError(
                "The parameters of this rod were identified under its weight, which it carries: no other direction of "
                "gravity is possible."
            )
        load = loading.on(self.length, self.mass, self.arm.weight, weight=weight)
        if loading.is_spatial or not self.arm.has_plane:
            if order != "as tested":
                raise RodError(f"In space the loads grow on the inflated arm; order = {order!r} is not possible.")
            return self._in_space(load)
        loaded = loading != Loading()
        solution = self._in_plane(load, together=_grow_together(order, load.supports, loaded=loaded))
        notes = *solution.notes, *filter(None, [self._outside(solution), solution.path.sideways])
        for note in notes:
            warnings.warn(note, RodWarning, stacklevel=3)  # where `solve` is called
        return replace(solution, notes=(*self.notes, *notes))

    def _in_plane(self, load: Load, *, together: bool) -> RodSolution:
        """The equilibrium in the plane, whose clamp is at the start of this rod."""
        solution = self.arm.in_plane(self._from_start(load), together=together)
        if not any(self.start):
            return solution
        return replace(solution, x=read_only(solution.x + self.start[0]), y=read_only(solution.y + self.start[1]))

    def _in_space(self, load: Load) -> SpatialSolution:
        """The equilibrium in space, whose clamp is at the start of this rod."""
        solution, start = self.arm.solve_in_space(self._from_start(load)), (*self.start, 0.0)
        for note in solution.notes:
            warnings.warn(note, RodWarning, stacklevel=4)
        return replace(solution, axis=read_only(solution.axis + start), notes=(*self.notes, *solution.notes))

    def _from_start(self, load: Load) -> Load:
        """The load where the clamp is the origin."""
        return replace(load, supports=tuple(one.seen_from((*self.start, 0.0)) for one in load.supports))

    def _outside(self, shape: RodSolution) -> str:
        """A sentence where the moments of a shape leave those of the identification; empty elsewhere."""
        outside = "" if self.moment_range is None else self.moment_range.warning(shape)
        if not outside:
            return ""
        jump = math.dist(self.under(Load()).end, self.under(Load(couple=NEXT_TO_NOTHING)).end)
        return f"{outside} The offsets m0 act under any load: the tip jumps by {jump:.3g} mm as soon as one acts."

    def under(self, load: Load, end_y: float | None = None, end_x: float | None = None) -> RodSolution:
        """The equilibrium under a load, grown "as tested".

        With end_y, end_x or both (mm) the end is held there as in experiment III: couple and weight act, and of the
        force the components along the other axes; those along an axis on which the end is held follow. Raises
        `RodError` as `solve` does, and where the arm falls over.
        """
        held = with_end(load, self.length, end_x, end_y)
        shape = self._in_plane(held, together=are_heights(held.supports))
        shape.path.refuse_fall()
        return shape


def _grow_together(order: Order, supports: Sequence[Support], *, loaded: bool) -> bool:
    if order not in get_args(Order):
        raise RodError(f"order is one of {', '.join(get_args(Order))}; {order!r} is not.")
    # on a rod that nothing acts on nothing can grow together
    return are_heights(supports) if order == "as tested" else order == "together" and loaded


def compile_kernels() -> None:
    """Solve a short rod: a minute at the first time, one second from disk."""
    compile_solver()
    Rod(1.0, 0.1, FiveParameters(1.0, 2.0, 0.0, 0.0, 0.5)).under(Load((0.0, 0.1)))
