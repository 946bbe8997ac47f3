"""A clamped rod with two straight lines between moment and curvature, a chain of elements (`rod.arm`)."""

import math
import reprlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from geometry.arrays import Array, read_only
from rod.along import LineLoad, Position, are_heights, reactions_of, resultant
from rod.arm.chain import halved, positions_between
from rod.arm.end_kernels import EndArrays
from rod.arm.path import Path, PathOptions, follow, positions_under
from rod.arm.response import SolvedPath
from rod.arm.sections import LinesSection
from rod.arm.solver import Solver
from rod.checked import Amount, finite, numbers_in
from rod.errors import LoadError, RodError
from rod.frames import planar_frames
from rod.law import TwoSlopes
from rod.load import Load
from rod.solution import RodSolution, SpatialSolution

#: length of the first element, which is never halved, over that of the rod
FIRST = 1e-3
#: largest strain by a force
STRETCHED = 1e-4
#: distance of a held end from where it is without loads, over the length, within which nothing acts
AT_REST = 1e-7
#: elements along the rod at least, and samples of the rest shape at most that are nodes
ELEMENTS, MOST_SAMPLES = 60, 2000


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class LinesRod:
    """A rod of two lines with its rest shape."""

    law: TwoSlopes
    length: float  #: mm
    s: Array  #: (n,) mm, of kappa_0, joined by straight lines
    rest: Array  #: (n,) 1/mm, the curvature without load
    theta0: float  #: rad
    own: tuple[LineLoad, ...]  #: its weight, under which it has kappa_0 where nothing else acts
    is_in_space: ClassVar[bool] = False
    has_plane: ClassVar[bool] = True
    weight: ClassVar[tuple[float, float]] = (0.0, 0.0)  #: N/mm, that always acts on it as a part of the load

    def solve_in_space(self, load: Load) -> SpatialSolution:
        """Refused: its law is that of the plane."""
        raise RodError("A rod with five parameters stays in its plane; in space a rod has the arm's own law.")

    def in_plane(self, load: Load, *, together: bool | None = None) -> RodSolution:
        """The equilibrium under a load. together: the rest shape grows with the load from the straight rod.

        Raises `RodError` where the path ends, and for a place beyond the reach of the rod, which is inextensible.
        """
        load.refuse_out_of_plane()
        together = are_heights(load.supports) if together is None else together
        is_loaded = not self._is_idle(load) or together
        self._check_reach(load)
        model = _Model(self, self._section(is_loaded=is_loaded))
        path = follow(model, self._all(load), PathOptions(together))
        nodes = path.nodes
        if outside := self.outside(path):
            raise RodError(f"{path.fall} {outside}".strip())
        own = np.interp(nodes.s, model.section.own_s, model.section.own_moment)
        bending, rest = nodes.moment[:, 2] - own, np.interp(nodes.s, self.s, self.rest)
        first = nodes.s < self.law.d - 1e-9 * self.length
        intercept = float(is_loaded) * np.where(first, self.law.m01, self.law.m02)
        deviation = (bending - intercept) / np.where(first, self.law.alpha1, self.law.alpha2)
        return RodSolution(
            s=read_only(nodes.s),
            x=_column(nodes.place[:, 0]),
            y=_column(nodes.place[:, 1]),
            theta=read_only(nodes.angle),
            kappa=read_only(rest + deviation),
            moment=_column(nodes.moment[:, 2]),
            stretch=read_only(np.ones(len(nodes.s))),
            force=_column(nodes.force[:2]),
            reactions=reactions_of(load.supports, nodes.reaction),
            weight=read_only(np.array(load.weight[:2]) * self.length + resultant(self.own, nodes.s)[:2]),
            load_steps=path.steps if is_loaded else 0,
            bending_moment=read_only(bending),
            path=SolvedPath(self, load, path.chains, fall=path.fall),
            notes=path.notes,
        )

    def beside(self, shape: RodSolution, load: Load) -> RodSolution:
        """The curve beside the axis, as of other rods."""
        return self.in_plane(load)

    def used_by(self, shape: RodSolution) -> float:
        """0: its lines have no end."""
        return 0.0

    @property
    def moments(self) -> tuple[float, float]:
        """N mm: those that bend it once around."""
        most = 2.0 * math.pi * abs(self.law.alpha1) / self.length
        return -most, most

    def posed(self, load: Load) -> tuple["_Model", Load]:
        """The rod, with the offsets of its law where something acts, and its weight."""
        is_loaded = not self._is_idle(load) or are_heights(load.supports)
        return _Model(self, self._section(is_loaded=is_loaded)), self._all(load)

    def _all(self, load: Load) -> Load:
        return replace(load, along=(*load.along, *self.own))

    def air_along(self, h: Array, kappa: Array) -> Array:
        """(t, 0): its law has no volumes."""
        return np.empty((len(kappa), 0))

    @property
    def kappa_0(self) -> Array:
        """(2,) 1/mm: about y and z, the mean of its curvature without load."""
        return np.array([0.0, np.trapezoid(self.rest, self.s) / self.length])

    def rigidity_at(self, kappa: Array) -> float:
        """N mm2, of the part at the clamp; the same at all curvatures."""
        return abs(self.law.alpha1)

    def outside(self, path: Path) -> str:
        """A sentence where what holds the rod stretches it; empty elsewhere."""
        stretches = np.hypot(*path.nodes.inner[:, :2].T).max() > STRETCHED * self._section(is_loaded=True).rigid
        return "The rod would have to be stretched by force, which its law does not know." if stretches else ""

    def _check_reach(self, load: Load) -> None:
        for one in load.supports:
            reach = math.hypot(one.x or 0.0, one.y or 0.0)
            if not reach < one.s:
                which = "end" if one.s == self.length else f"point at s = {one.s:g} mm"
                told = f"the rod of {self.length:g} mm is inextensible."
                raise LoadError(f"The {which} cannot be {reach:g} mm from the clamp: {told}")

    def _is_idle(self, load: Load) -> bool:
        """Whether nothing acts on the rod; what is held is then where the unloaded rod has it."""
        if any((*load.force, *load.weight, *load.couple, *load.along)):
            return False
        model = _Model(self, self._section(is_loaded=False))
        s = positions_under(model, load)
        solvers = (Solver(model, places, load, in_space=False) for places in (s, halved(s)))
        coarse, fine = (solver.held(solver.rest()) - solver.load.target for solver in solvers)
        return bool(np.all(np.abs(fine + (fine - coarse) / 3.0) < AT_REST * self.length))

    def _section(self, *, is_loaded: bool) -> LinesSection:
        none = np.zeros(len(self.s))
        section = LinesSection(self.law, self.length, self.s, self.rest, self.s, none, is_loaded)
        if not self.own:
            return section
        model = _Model(self, section)  # for the moment of its weight, in the shape of kappa_0
        s = positions_between([0.0, self.length], self.length / (8 * ELEMENTS))
        solver = Solver(model, s, Load(along=self.own), in_space=False)
        nodes = solver.nodes(solver.rest())
        return replace(section, own_s=nodes.s, own_moment=nodes.moment[:, 2])


def _column(values: Array) -> Array:
    return read_only(np.ascontiguousarray(values))


class _Model:
    """The rod as the path asks for it (`rod.arm.solver.ArmModel`)."""

    def __init__(self, rod: LinesRod, section: LinesSection) -> None:
        self.rod, self.section, self.mass = rod, section, None
        self.decides_at = self.clamp_reach = 0.0

    def positions(self, breaks: tuple[float, ...]) -> Array:
        """Positions as `ArmModel` has them; so are the others."""
        rod = self.rod
        samples = rod.s[1:-1] if len(rod.s) <= MOST_SAMPLES else rod.s[:0]
        inner = sorted({rod.law.d, *breaks, *samples[np.abs(samples - rod.law.d) > 1e-9 * rod.length].tolist()})
        first = min(FIRST * rod.length, 0.5 * inner[0])
        return np.append(0.0, positions_between([first, *inner, rod.length], rod.length / ELEMENTS))

    def ends(self, end: Position) -> EndArrays:
        """A clamp that does not give way."""
        clamp = np.array([-1.0, 1.0]), np.tile([self.rod.theta0, 0.0, 0.0], (2, 1)), np.zeros((2, 3)), np.zeros((2, 2))
        return EndArrays(False, *clamp, np.zeros((1, 1, 6)), np.zeros((2, 7)), np.zeros((2, 7)), np.zeros(2))

    def begin(self) -> tuple[Array, Array]:
        """The clamp."""
        return np.zeros(3), planar_frames(np.array([self.rod.theta0]))[0]


Profile = Amount | Array | Callable[[Array], Array]

#: intervals along the rod at which a kappa_0 that is a function is sampled
FUNCTION_SAMPLES = 640


def sampled(length: float, kappa_0: Profile) -> tuple[Array, Array]:
    """Positions (n,) in mm from 0 to the length, and kappa_0 (n,) in 1/mm there.

    kappa_0: a number, or a text such as "2 1/m"; an array (n,) of values at n equally spaced points from s = 0 to
    s = length; an array (n, 2) of columns s (mm) and kappa_0, s rising from 0 to length; or a function of s that takes
    and returns (m,) arrays.
    Raises `RodError` for anything else.
    """
    if callable(kappa_0):
        s = np.linspace(0.0, length, FUNCTION_SAMPLES + 1)
        return s, _called(kappa_0, s)
    kappa_0 = finite(kappa_0, "kappa_0", "1/mm") if isinstance(kappa_0, str) else kappa_0
    values = numbers_in(kappa_0)
    if values is None:
        raise RodError(
            f"kappa_0 is a number, an array of numbers or a function of s; {reprlib.repr(kappa_0)} is none of them."
        )
    if not np.all(np.isfinite(values)):
        raise RodError("kappa_0 holds a value that is not a finite number.")
    if values.ndim == 0:
        return np.array([0.0, length]), np.full(2, finite(kappa_0, "kappa_0"))
    return _samples(values, length)


def _called(function: Callable[[Array], Array], s: Array) -> Array:
    values = numbers_in(function(s.ravel()))
    if values is None or values.shape != (s.size,) or not np.all(np.isfinite(values)):
        raise RodError("kappa_0 as a function must return a finite number for every s of the array it is given.")
    return values.reshape(s.shape)


def _samples(values: Array, length: float) -> tuple[Array, Array]:
    """Positions and values, from an array of one of the two accepted shapes."""
    if values.ndim == 1 and len(values) >= 2:
        return np.linspace(0.0, length, len(values)), values
    if values.ndim != 2 or values.shape[1] != 2 or len(values) < 2:
        raise RodError(
            "kappa_0 as an array is (n,), values at equally spaced points, or (n, 2), columns s and kappa_0, "
            f"with n of at least 2; its shape is {values.shape}."
        )
    s = values[:, 0]
    if np.any(np.diff(s) <= 0.0):
        raise RodError("The column s of kappa_0 must rise from row to row.")
    if abs(s[0]) > 1e-6 * length or abs(s[-1] - length) > 1e-6 * length:
        raise RodError(
            f"kappa_0 is given from s = {values[0, 0]:g} to {values[-1, 0]:g} mm, the rod goes from 0 to {length:g} mm."
        )
    s = s.copy()
    s[0], s[-1] = 0.0, length
    return s, values[:, 1]
