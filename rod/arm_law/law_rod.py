"""A clamped arm with its own law at one pressure: in its plane, and out of it where the law knows that."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, TypeVar

import numpy as np

from geometry.arrays import Array, read_only
from rod.along import AlongLoad, Position, Support, are_heights, part_of, reactions_of, scaled
from rod.arm.chain import positions_between
from rod.arm.end_kernels import EndArrays
from rod.arm.path import NoEquilibrium, Path, PathOptions, follow
from rod.arm.response import SolvedPath
from rod.arm.stability import Stability, stability_of
from rod.arm_law.air import air_along, air_volumes
from rod.arm_law.curves import NO_MOMENT, ClampCurve, TipCurve, TipState
from rod.arm_law.section import SectionLaw
from rod.arm_law.tabulated import TabulatedSection, end_arrays, tip_state
from rod.checked import Amount
from rod.errors import RodError
from rod.frames import planar_frames
from rod.load import Force, Load, Loading, held_place, with_end
from rod.solution import RodSolution, SpatialSolution, solved_in_space
from rod.weight import Mass

#: longest element over the pitch; length of the first one, which is never halved
ELEMENT, FIRST = 0.2, 0.02
#: over the length of the first element: where the moment decides if the first element ends there
SHORT = 0.05, 2.0
#: how exactly the part of a load is told that the law bears
PARTS = 7
#: of a load along the arm, at which it is told where the material curve lies
PLACES = 65

Placeable = TypeVar("Placeable", AlongLoad, Support)


@dataclass(frozen=True, eq=False)  # arrays inside
class LawRod:
    """A clamped rod with the arm's own law at one pressure; it stretches and shears."""

    section: SectionLaw
    clamp: ClampCurve
    tip: TipCurve
    pitch: float  #: mm
    first_middle: float  #: mm
    length: float  #: mm
    mass: Mass | None = None  #: how a weight is spread along the arm; None: evenly
    weight: tuple[float, float] = (0.0, 0.0)  #: N/mm, x and y per rest length, that always acts
    near: float | None = None  #: kPa, a limit of the pressure near by, where the form of the arm is lost
    has_plane: ClassVar[bool] = True

    def __post_init__(self) -> None:
        ends = float(self.clamp.s[-1] - self.tip.s[0])
        if not (math.isfinite(self.length) and self.length >= ends * (1 - 1e-9)):
            raise RodError(
                f"An arm of {self.length:g} mm is shorter than its two disturbed ends, {ends:g} mm; "
                "its own law does not describe it."
            )

    def __repr__(self) -> str:
        return f"LawRod(at {self.section.pressure:g} kPa, length {self.length:g} mm, cells of {self.pitch:g} mm)"

    @property
    def arm(self) -> "LawRod":
        """Itself."""
        return self

    def of(self, length: float, mass: Mass | None) -> "LawRod":
        """The rod of an arm of another length (mm) and mass; None: its own mass."""
        return replace(self, length=length, mass=mass or self.mass)

    @cached_property
    def _model(self) -> "_Model":
        return _Model(self)

    def solve(
        self,
        force: Force | None = None,
        *,
        end_y: Amount | None = None,
        end: Sequence[Amount] | None = None,
        moment: Amount = 0.0,
    ) -> RodSolution:
        """The equilibrium reached when the loads grow on the inflated arm; with end_y alone both grow together.

        force: dead force (F_x, F_y) in N on the end. end_y: the end edge is held at this height (mm), as in experiment
        III, and F_y follows; end: (x, y) of it, and both components follow. moment: a couple on the end, N mm.
        Raises `RodError` where loads contradict each other, where the path ends, and where a moment leaves the law.
        """
        loading = Loading(force, moment, held_place(end, None, end_y))
        shape = self.in_plane(loading.on(self.length, self.mass, self.weight))
        return replace(shape, notes=(*shape.notes, *filter(None, [shape.path.sideways])))

    def under(self, load: Load, end_y: float | None = None, end_x: float | None = None) -> RodSolution:
        """The equilibrium under a load; with a prescribed position of the end (mm) that component of the force follows.

        The weight of the load is spread as the mass of the arm is, where that is known. Raises `RodError` as `solve`
        does, and where the arm falls over.
        """
        shape = self.in_plane(with_end(load, self.length, end_x, end_y))
        shape.path.refuse_fall()
        return shape

    def in_plane(self, load: Load, *, together: bool | None = None) -> RodSolution:
        """The weight of the load is spread as the mass of the arm is, where that is known."""
        load.refuse_out_of_plane()
        how = PathOptions(are_heights(load.supports) if together is None else together, in_space=False)
        return self._planar_solution(self._followed(load, how), load)

    def beside(self, shape: RodSolution, load: Load) -> RodSolution:
        """The equilibrium under a load beside a shape, also beyond the law, which goes on straight there."""
        return self._planar_solution(shape.path.beside(load), load)

    def solve_in_space(self, load: Load) -> SpatialSolution:
        """The equilibrium in space under a load, which grows on the inflated arm.

        Raises `RodError` as `solve` does, and for a law without rigidities out of the plane.
        """
        self._check_in_space()
        path = self._followed(load, PathOptions(together=False, in_space=True))
        nodes = path.nodes
        frame = nodes.frames[-1]
        turn = math.atan2(frame[1, 0], frame[0, 0])
        at_tip = self._tip_state(load).beside_at(turn, float(nodes.force @ frame[:, 0]))
        bending = (nodes.moment[:, None] @ nodes.frames)[:, 0, 2]
        beside = _Beside(self, nodes.s, bending, at_tip)(nodes.s)
        strains = self._model.section.strains(*nodes.acting)
        return solved_in_space(self, path, load, strains, beside)

    def _tip_state(self, load: Load) -> TipState:
        return tip_state(self.tip, load.end_at(self.length))

    def posed(self, load: Load) -> tuple["_Model", Load]:
        """The load with the weight that always acts, where the material curve is without load along the arm."""
        x, y, z = load.weight

        def placed(one: Placeable) -> Placeable:
            at_tip = self._tip_state(load).beside_at(0.0, 0.0)
            curve = _Beside(self, np.array([0.0, self.length]), np.zeros(2), at_tip)
            beside = curve(np.linspace(one.breaks[0], one.breaks[-1], PLACES)).mean(axis=0) + one.beside
            return replace(one, beside=(float(beside[0]), float(beside[1])))

        along, supports = tuple(map(placed, load.along)), tuple(map(placed, load.supports))
        weight = self.weight[0] + x, self.weight[1] + y, z
        return self._model, replace(load, weight=weight, along=along, supports=supports)

    def _followed(self, load: Load, how: PathOptions) -> Path:
        """The path to a load; raises `RodError` where it ends, and where the curvature leaves the law."""
        model, posed = self.posed(load)
        try:
            path = follow(model, posed, how)
        except NoEquilibrium as ended:
            known = f"The {self._known}"
            borne = 1.0 if load.supports else self.part_borne(load, how)
            if borne + 2.0 * 0.5**PARTS < ended.part:
                raise RodError(f"The law ends before the load does. {known} {_remedy(borne)}") from None
            raise RodError(f"{ended} {known}") from None
        if outside := self.outside(path):
            told = _remedy(0.0 if load.supports else self.part_borne(load, how))
            raise RodError(f"{path.fall} {outside} {told}".strip())
        return path

    @property
    def moments(self) -> tuple[float, float]:
        """N mm, the smallest and the largest moment for which cells and clamp are known."""
        law, clamp = self.section.moment, self.clamp.moment
        return float(max(law[0], clamp[0])), float(min(law[-1], clamp[-1]))

    def outside(self, path: Path) -> str:
        """A sentence where the curvature of cells or the moment at the clamp leaves the law; empty elsewhere."""
        law, clamp, found = self.section, self.clamp, path.nodes.found
        if found.outside <= NO_MOMENT * np.ptp(law.kappa) and found.beyond <= NO_MOMENT * np.ptp(clamp.moment):
            return ""
        bends = np.array(self._model.section.strains(*path.nodes.acting)[2])
        bends[0] = max(bends[0], path.nodes.moment[0, 2], key=abs)  # that of cells, and that at the clamp
        low, high = self.moments
        worst = int(np.argmax(np.maximum(low - bends, bends - high)))
        bent = f"At s = {path.nodes.s[worst]:.3g} mm this load bends the cells with {bends[worst]:.4g} N mm"
        return f"{bent}; the {self._known}"

    @property
    def _known(self) -> str:
        """For which moments the law is known, a clause, and whether a limit of the pressure is near."""
        (low, high), pressure = self.moments, self.section.pressure
        near = "" if self.near is None else f" That is near a limit of the pressure, {self.near:.4g} kPa."
        return f"law at {pressure:.4g} kPa is known from {low:.4g} to {high:.4g} N mm.{near}"

    def part_borne(self, load: Load, how: PathOptions | None = None) -> float:
        """The part of a load up to which moments and curvatures stay within the law, to a hundredth of the load."""
        model, load = self.posed(load)
        low, high, part = 0.0, 1.0, 1.0
        for _ in range(PARTS + 1):
            try:
                is_inside = not self.outside(follow(model, Load().plus(load, part), how or PathOptions()))
            except RodError:
                is_inside = False
            low, high = (part, high) if is_inside else (low, part)
            part = 0.5 * (low + high)
        return low

    def _planar_solution(self, path: Path, load: Load) -> RodSolution:
        nodes = path.nodes
        curvature, stretch, _ = self._model.section.strains(*nodes.acting)
        turn = float(nodes.angle[-1])
        pull = float(nodes.force[:2] @ (math.cos(turn), math.sin(turn)))
        at_tip = self._tip_state(load).beside_at(turn, pull)
        moment = read_only(np.ascontiguousarray(nodes.moment[:, 2]))
        return RodSolution(
            s=read_only(nodes.s),
            x=read_only(np.ascontiguousarray(nodes.place[:, 0])),
            y=read_only(np.ascontiguousarray(nodes.place[:, 1])),
            theta=read_only(nodes.angle),
            kappa=read_only(np.ascontiguousarray(curvature[:, 2])),
            moment=moment,
            stretch=read_only(np.ascontiguousarray(stretch[:, 0])),
            force=read_only(nodes.force[:2].copy()),
            reactions=reactions_of(load.supports, nodes.reaction),
            weight=read_only((np.array(load.weight[:2]) + self.weight) * self.length),
            load_steps=path.steps,
            shear=read_only(np.ascontiguousarray(stretch[:, 1])),
            beside=_Beside(self, nodes.s, moment, at_tip),
            path=SolvedPath(self, load, path.chains, fall=path.fall),
            notes=path.notes,
        )

    @property
    def kappa_0(self) -> Array:
        """(2,) 1/mm: the curvatures about y and z without moment."""
        return np.array([0.0, self.section.kappa_0])

    def rigidity_at(self, kappa: Array) -> float:
        """N mm2, of cells at curvatures (2,) about y and z, or as far as the law goes there."""
        return 1.0 / float(np.interp(kappa[1], self.section.kappa, self.section.kappa_slope))

    def used_by(self, shape: RodSolution) -> float:
        """The part of the law, its curvatures and moments at the clamp, that a shape takes; above 1 it is beyond it."""
        origin, most = self.section.kappa_0, 0.0
        for taken, known in (
            (shape.kappa - origin, self.section.kappa - origin),
            (shape.moment[:1], self.clamp.moment),
        ):
            for end in (0, -1):
                most = max(most, float((taken / known[end]).max()))
        return most

    def volumes(self, state: RodSolution) -> Array:
        """(c,) mm3: air in each cavity of the arm in a state of this rod, as finite elements of the arm have it.

        Raises `RodError` for a law without volumes.
        """
        return air_volumes(self.section, self.clamp, self.tip, state)

    def air_along(self, h: Array, kappa: Array) -> Array:
        """(t, c) mm3: the same of elements of lengths h (n,) with curvatures (t, n, 3); (t, 0) without volumes."""
        return air_along(self.section, self.clamp, self.tip, h, kappa[..., 2])

    def stability(self, state: RodSolution) -> Stability:
        """Stability of a state of this rod against motions out of its plane. Its force keeps its direction.

        Raises `RodError` for a law without rigidities out of the plane.
        """
        self._check_in_space()
        return stability_of(state.path, out_of_plane=True)

    def buckling_part(self, load: Load) -> float | None:
        """The part of a load in the plane, to 0.1 %, at which the rod buckles out of it; None where it does not.

        The load grows on the inflated rod, which must be stable. Raises `RodError` as `solve` and `stability` do.
        """
        low, high = 0.0, 1.0
        if self.stability(self.under(load)).is_stable:
            return None
        while high - low > 1e-3:
            part = 0.5 * (low + high)
            force, couple = (scaled(values, part) for values in (load.force, load.couple))
            reduced = replace(load, force=force, couple=couple, along=part_of(load.along, part))
            low, high = (part, high) if self.stability(self.under(reduced)).is_stable else (low, part)
        return high

    @property
    def is_in_space(self) -> bool:
        """Whether the law has rigidities out of its plane."""
        return bool(self.section.in_space) and bool(self.clamp.lateral_compliance.size)

    def _check_in_space(self) -> None:
        if not self.is_in_space:
            raise RodError("The law has no rigidities out of the plane; measure it with law_in_space: true.")


def _remedy(borne: float) -> str:
    """What to do where a law bears a part of a load."""
    part = f"It bears {100 * borne:.2g} % of this load. " if borne else ""
    return f"{part}Put this load into the configuration and measure the law again."


class _Model:
    """The rod as the path asks for it (`rod.arm.solver.ArmModel`)."""

    def __init__(self, rod: LawRod) -> None:
        self.rod = rod
        self.section, self.mass = TabulatedSection(rod.section, rod.length), rod.mass
        self.clamp_reach = float(rod.clamp.s[-1])
        self.decides_at = rod.clamp.position
        usual = FIRST * rod.pitch
        self._first = self.decides_at if SHORT[0] < self.decides_at / usual < SHORT[1] else usual
        self._ends: dict[tuple[bool, ...], EndArrays] = {}

    def positions(self, breaks: tuple[float, ...]) -> Array:
        """Positions as `ArmModel` has them; so are the others."""
        rod, first = self.rod, self._first
        places = [s for s in sorted((self.decides_at, *breaks)) if s > first]
        return np.append(0.0, positions_between([first, *places, rod.length], ELEMENT * rod.pitch))

    def ends(self, end: Position) -> EndArrays:
        """The ends: of the clamp, and of the tip that is held so."""
        held = tuple(at is not None for at in end)
        if held not in self._ends:
            self._ends[held] = end_arrays(self.rod.clamp, tip_state(self.rod.tip, end))
        return self._ends[held]

    def begin(self) -> tuple[Array, Array]:
        """Where the clamp puts the axis without moment."""
        return self._begin

    @cached_property
    def _begin(self) -> tuple[Array, Array]:
        rotation, offset = self.rod.clamp.at(0.0)
        return np.array([*offset, 0.0]), planar_frames(np.array([rotation]))[0]


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
