"""A clamped arm without a plane of symmetry, with its law at given pressures."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from geometry.arrays import Array
from rod.along import Position
from rod.arm.chain import positions_between
from rod.arm.end_kernels import EndArrays
from rod.arm.path import Path, PathOptions, follow
from rod.arm.section_kernels import BEYOND, POLYNOMIAL, SectionArrays
from rod.arm_law.polynomial import Plane
from rod.arm_law.tabulated import SETTLED, STRAINS, writable
from rod.errors import RodError
from rod.frames import rotation
from rod.load import Load
from rod.solution import RodSolution, SpatialSolution, solved_in_space
from rod.weight import Mass

#: longest element over the pitch, and over the length; length of the first one, which is never halved, over these
ELEMENT, LONGEST, FIRST = 0.25, 1 / 48, 0.05
#: a curvature may leave the law by rounding, over its reach
ROUNDING = 1e-9


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class PolynomialSection:
    """The law of an arm without a plane of symmetry at given pressures, as polynomials of both curvatures."""

    #: of the curvatures: the columns of `SectionArrays.table`
    plane: Plane
    EA: float  #: N
    compliance: Array  #: (3, 3) of twist, shear and lateral shear
    origin: Array  #: (2,) 1/mm, curvatures without moment
    reach: float  #: 1/mm

    @staticmethod
    def of(w: Plane, stretch: Plane, EA: Plane, compliance: Array, reach: float) -> "PolynomialSection":
        """From polynomials of the curvatures. Raises `RodError` where no curvature has no moment."""
        first, other = w.derivative(0), w.derivative(1)
        by_first, by_other = stretch.derivative(0), stretch.derivative(1)
        columns = [first, other, first.derivative(0), first.derivative(1), other.derivative(1), stretch]
        columns += [by_first, by_other, by_first.derivative(0), by_first.derivative(1), by_other.derivative(1)]
        plane = Plane.joined(columns)
        origin = np.zeros(2)
        for _ in range(60):
            values = plane(origin)
            origin = origin - np.linalg.solve(_matrix(values), values[:2])
        softest = float(np.linalg.eigvalsh(_matrix(plane(origin)))[0]) if np.isfinite(origin).all() else -1.0
        if not softest > 0.0:
            raise RodError("The law in space has no stable state without moment at these pressures.")
        return PolynomialSection(plane, float(EA(origin)[0]), compliance, origin, reach)

    def arrays(self, s: Array, factor: float = 1.0, grown: float = 1.0) -> SectionArrays:
        """Arrays as `Section` has them."""
        stiff = np.linalg.inv(self.compliance)
        numbers = np.concatenate([[self.EA], stiff.ravel(), self.origin, [self.reach]])
        return SectionArrays(POLYNOMIAL, np.ascontiguousarray(self.plane.table), numbers, np.zeros((len(s) - 1, 4)))

    def rest(self, s: Array, grown: float = 1.0) -> Array:
        """Strains at rest as `Section` has them."""
        return np.tile([0.0, *self.origin, float(self.plane(self.origin)[5])], (len(s) - 1, 1))

    @property
    def rigidities(self) -> tuple[float, float]:
        """N mm2, the smaller and the larger one, without moment."""
        least, most = np.linalg.eigvalsh(_matrix(self.plane(self.origin)))
        return float(least), float(most)

    @property
    def rigidity(self) -> float:
        """N mm2, the smaller one."""
        return self.rigidities[0]

    def strains(self, moment: Array, force: Array) -> tuple[Array, Array]:
        """Curvatures (N, 3) and stretch and shears (N, 3) under moments and forces (N, 3) in the frame."""
        kappa = np.tile(self.origin, (len(moment), 1))
        for _ in range(STRAINS):
            values = self.plane(kappa)
            left = values[:, :2] - force[:, :1] * values[:, 6:8] - moment[:, 1:]
            matrices = values[:, [2, 3, 3, 4]] - force[:, :1] * values[:, [8, 9, 9, 10]]
            away = kappa - np.linalg.solve(matrices.reshape(-1, 2, 2), left[..., None])[..., 0] - self.origin
            size = np.linalg.norm(away, axis=1, keepdims=True)
            before, kappa = kappa, self.origin + away * np.minimum(1.0, BEYOND * self.reach / np.maximum(size, 1e-300))
            if np.abs(kappa - before).max() <= SETTLED * self.reach:
                break
        twisted = np.column_stack([moment[:, 0], force[:, 1:]]) @ self.compliance
        stretch = self.plane(kappa)[:, 5] + force[:, 0] / self.EA
        return np.column_stack([twisted[:, 0], kappa]), np.column_stack([stretch, twisted[:, 1:]])


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SpaceRod:
    """A clamped rod in space. Its sections' y and z are those of the arm at rest."""

    section: PolynomialSection
    air: Plane  #: mm2, per rest length in each cavity, of the curvatures about y and z
    #: turns (rad) and shifts (mm) along x, y and z by the moments about y and z, and air beyond that of cells (mm3)
    clamp: Plane
    #: (3 + c,) from the end of the axis to that of the material curve, in the frame there (mm), and such air (mm3)
    tip: Array
    pitch: float  #: mm
    length: float  #: mm
    clamp_reach: float  #: mm, how far the clamped end reaches
    mass: Mass | None  #: None: not known
    pressures: tuple[float, ...]  #: kPa
    is_in_space: ClassVar[bool] = True
    has_plane: ClassVar[bool] = False
    weight: ClassVar[tuple[float, float]] = (0.0, 0.0)  #: N/mm, that always acts

    @property
    def arm(self) -> "SpaceRod":
        """Itself."""
        return self

    def of(self, length: float, mass: Mass | None) -> "SpaceRod":
        """The rod of an arm of another mass; None: its own. Raises `RodError` for another length (mm)."""
        if not math.isclose(length, self.length):
            raise RodError(f"The law in space is that of an arm of {self.length:g} mm; give law.length.")
        return replace(self, mass=mass or self.mass)

    def solve_in_space(self, load: Load) -> SpatialSolution:
        """The equilibrium under a load, which grows on the inflated arm.

        Raises `RodError` where the path ends or becomes unstable, and where the curvature leaves the law.
        """
        path = follow(self, load, PathOptions(in_space=True))
        if outside := self.outside(path):
            raise RodError(outside)
        return self._solution(path, load)

    def beside(self, shape: SpatialSolution, load: Load) -> SpatialSolution:
        """The equilibrium under a load beside a shape, also beyond the law, which goes on straight there."""
        return self._solution(shape.path.beside(load), load)

    def _solution(self, path: Path, load: Load) -> SpatialSolution:
        nodes = path.nodes
        beside = np.zeros((len(nodes.s), 3))
        beside[-1] = self.tip[:3]
        return solved_in_space(self, path, load, self.section.strains(*nodes.acting), beside)

    def posed(self, load: Load) -> tuple["SpaceRod", Load]:
        """The rod itself, and all that acts on it."""
        return self, load

    def in_plane(self, load: Load, *, together: bool | None = None) -> RodSolution:
        """Refused: it has no plane."""
        raise RodError("This arm bends in space; `solve` gives its shape.")

    @property
    def decides_at(self) -> float:
        """mm: the moments at the start decide on the clamp."""
        return 0.0

    @property
    def kappa_0(self) -> Array:
        """(2,) 1/mm: the curvatures about y and z without moment."""
        return self.section.origin

    def rigidity_at(self, kappa: Array) -> float:
        """N mm2, about y and z together, at curvatures (2,), or as far as the law goes there."""
        away = kappa - self.kappa_0
        away *= min(1.0, self.section.reach / max(float(np.hypot(*away)), 1e-300))
        return float(self.section.plane(self.kappa_0 + away)[[2, 4]].sum())

    def positions(self, breaks: tuple[float, ...]) -> Array:
        """Positions as `rod.arm.solver.ArmModel` has them; so are the others."""
        longest = min(ELEMENT * self.pitch, LONGEST * self.length)
        first = FIRST * longest
        inner = [s for s in sorted(breaks) if s > first]
        return np.append(0.0, positions_between([first, *inner, self.length], longest))

    def ends(self, end: Position) -> EndArrays:
        """The clamp, and a tip that is a point beside the axis."""
        clamp = np.array([-1.0, 1.0]), np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 2))
        rows = np.tile(np.concatenate([[0.0], self.tip[:3], self.tip[:3]]), (2, 1))
        table = writable(self.clamp.table[..., :6])
        return EndArrays(True, *clamp, table, rows, np.zeros_like(rows), np.zeros(2))

    def begin(self) -> tuple[Array, Array]:
        """Where the clamp puts the axis without moment."""
        turn, shift, _ = np.split(self.clamp(np.zeros(2)), (3, 6))
        return shift, rotation(turn)

    def volumes(self, state: SpatialSolution) -> Array:
        """(c,) mm3: air in each cavity of the arm in a state of this rod, as finite elements of the arm have it."""
        along = np.trapezoid(self.air(state.curvature[:, 1:]), state.s, axis=0)
        return np.asarray(along + self.clamp((state.moment[0] @ state.frames[0])[1:])[6:] + self.tip[3:])

    def air_along(self, h: Array, kappa: Array) -> Array:
        """(t, c) mm3: the same of elements of lengths h (n,) with curvatures (t, n, 3)."""
        at_clamp = self.clamp(self.section.plane(kappa[:, 0, 1:])[:, :2])
        return np.asarray(np.einsum("e,tec->tc", h, self.air(kappa[..., 1:])) + at_clamp[:, 6:] + self.tip[3:])

    @property
    def moments(self) -> tuple[float, float]:
        """N mm, about those at which the curvatures reach the end of the law."""
        most = self.section.rigidity * self.section.reach
        return -most, most

    def used_by(self, shape: SpatialSolution) -> float:
        """The part of the reach of the law that the curvatures of a shape take; above 1 it is beyond the law."""
        return float(np.hypot(*(shape.curvature[:, 1:] - self.section.origin).T).max()) / self.section.reach

    def outside(self, path: Path) -> str:
        """A sentence where the curvature leaves the law; empty elsewhere."""
        outside, reach = path.nodes.found.outside, self.section.reach
        if outside <= ROUNDING * reach:
            return ""
        moments = path.nodes.acting[0][:, 1:]
        largest = float(np.linalg.norm(moments, axis=1).max())
        return (
            f"The bending moment reaches {largest:.4g} N mm. The law is known up to curvatures that are "
            f"{reach:.3g} 1/mm from that without moment, and these are {outside:.3g} 1/mm beyond it. "
            "It is not extrapolated: this load is too large."
        )


def _matrix(values: Array) -> Array:
    """(2, 2) rigidities among the columns of a polynomial section."""
    return np.array([[values[2], values[3]], [values[3], values[4]]])
