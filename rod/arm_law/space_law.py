"""The law of an arm without a plane of symmetry, such as one with three chambers, and the rod in space that follows it.

Per rest length of the arm, with the curvatures kappa = (kappa_y, kappa_z) about two fixed directions of its sections
and the pressures p of its cavities, the cells have the potential w(kappa, p) without axial force, the stretch
lambda(kappa, p), and small twist and shear:

    M = dw/dkappa - N dlambda/dkappa,   stretch = lambda + N / EA,   (twist, shear_y, shear_z) = C (T, Q_y, Q_z)

for the moments M, the axial force N, the torque T and the shear forces Q. EA and C are taken at the curvature without
moment. All of them are polynomials. The clamped end turns the rod and shifts it, as functions of the moments there and
of p; the end of the material curve lies beside that of the axis.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, final

import numpy as np

from geometry.arrays import Array
from rod.arm_law.cosserat import Shapes, Strains, in_frame, integrate, rotation
from rod.arm_law.polynomial import Plane, Polynomial
from rod.arm_law.record import mass_of, record_of
from rod.arm_law.small_motions import Ends
from rod.arm_law.solver import weight_beyond
from rod.arm_law.spatial_solver import spatial_equilibrium
from rod.checked import check_table, finite
from rod.errors import RodError
from rod.spatial import Position, SpatialLoad, SpatialSolution
from rod.weight import Mass

#: of the file
FORMAT = 1
#: Newton's method for the curvatures: smallest change over the largest curvature, iterations, and how far beyond the
#: law curvatures may be on the way
SETTLED, ITERATIONS, BEYOND = 1e-11, 30, 1.3
#: step of the integration over the pitch, and the largest part of the length
STEP, LONGEST = 0.25, 1 / 48
#: by how much pressures may leave those of the law, over the largest
ROUNDING = 1e-9
#: change of the moment in difference quotients of the clamped end, over that which the law reaches
DIFFERENCE = 1e-4

_NUMBERS = ("pitch", "length", "clamp_length", "reach", "error")
_POLYNOMIALS = ("potential", "stretch", "axial_rigidity", "compliance", "clamp", "tip")


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SpaceLaw:
    """The law of an arm over the pressures of its cavities.

    Variables of polynomials are curvatures in 1/mm, moments in N mm and, for p, components of the pressures in kPa.
    """

    cavities: tuple[str, ...]
    pressures: Array  #: (r, m) kPa, rows of pressures; the law is known between them and 0 kPa
    onto: Array  #: (m, q): pressures times this are the variables p of the polynomials
    pitch: float  #: mm
    length: float  #: mm
    clamp_length: float  #: mm, of the piece by which the clamped end was measured
    reach: float  #: 1/mm, largest change of the curvature from that without moment
    error: float  #: of the moment between the states of the cell, over the largest moment; one standard deviation
    potential: Polynomial  #: w of (kappa_y, kappa_z, p), N
    stretch: Polynomial  #: lambda of (kappa_y, kappa_z, p)
    axial_rigidity: Polynomial  #: EA of (kappa_y, kappa_z, p), N
    compliance: Polynomial  #: the six upper components of C, of p: 1/(N mm2), 1/(N mm) and 1/N
    clamp: Polynomial  #: turns (rad) and shift (mm) along x, y and z, of (M_y, M_z, p)
    tip: Polynomial  #: the end of the material curve beside that of the axis, in the frame there, mm, of p
    mass: Mass | None = None  #: None: not known

    def __post_init__(self) -> None:
        if self.pressures.ndim != 2 or self.pressures.shape[1] != len(self.cavities):
            raise RodError("A law in space must have rows with a pressure for each cavity.")

    def __repr__(self) -> str:
        return f"SpaceLaw({', '.join(self.cavities)}, up to {self.pressures.max():g} kPa, {self.length:g} mm)"

    def at(self, pressures: Sequence[float]) -> "SpaceRod":
        """The rod at the pressures of all cavities in kPa, in the order of `cavities`.

        Raises `RodError` for another number of pressures, and for those that are not between rows of the law and 0 kPa.
        """
        from scipy.optimize import nnls  # its import takes longer than a rod

        given = np.array([finite(value, "A pressure in kPa") for value in pressures])
        names = ", ".join(self.cavities)
        if len(given) != len(self.cavities):
            raise RodError(f"The law has a pressure for each of {names}; {len(given)} were given.")
        largest = float(np.abs(self.pressures).max())
        matrix = np.vstack([self.pressures.T / largest, np.ones(len(self.pressures))])
        # parts of the rows that make up the pressures; what is left of one in all belongs to 0 kPa
        rows, target = np.column_stack([matrix, [*np.zeros(len(given)), 1.0]]), np.append(given / largest, 1.0)
        if nnls(rows, target)[1] > ROUNDING * len(target):
            told = ", ".join(f"{value:g}" for value in given)
            raise RodError(f"The pressures {told} kPa of {names} are not between rows of the law's pressures_kPa.")
        return SpaceRod(self, given @ self.onto, tuple(given.tolist()))

    def record(self) -> dict[str, Any]:
        """As it stands in law_in_space.json."""
        return {
            "format_in_space": FORMAT,
            "cavities": list(self.cavities),
            "pressures_kPa": self.pressures.tolist(),
            "onto": self.onto.tolist(),
            **{name: getattr(self, name) for name in _NUMBERS},
            **{name: getattr(self, name).record() for name in _POLYNOMIALS},
            "mass": None if self.mass is None else record_of(self.mass),
        }

    @staticmethod
    def from_record(record: Mapping[str, Any]) -> "SpaceLaw":
        """What `record` gave. Raises `RodError` for a file that cannot be used."""
        check_table(record, {"pressures_kPa": ("r", "m"), "onto": ("m", "q"), **dict.fromkeys(_NUMBERS, ())})
        missing = next((name for name in ("cavities", *_POLYNOMIALS) if name not in record), None)
        if missing:
            raise RodError(f"The key {missing!r} is missing.")
        values: dict[str, Any] = {name: float(record[name]) for name in _NUMBERS}
        values |= {name: Polynomial.from_record(record[name], name) for name in _POLYNOMIALS}
        pressures, onto = (np.array(record[key], float) for key in ("pressures_kPa", "onto"))
        return SpaceLaw(
            tuple(map(str, record["cavities"])), pressures, onto, **values, mass=mass_of(record.get("mass"))
        )


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SpaceRod:
    """A clamped rod with such a law at given pressures. Its sections' y and z are those of the arm at rest."""

    own: SpaceLaw
    variables: Array  #: (q,) of the pressures in polynomials
    pressures: tuple[float, ...]  #: kPa

    def solve_in_space(self, load: SpatialLoad, position: Position = (None, None, None)) -> SpatialSolution:
        """The equilibrium under a load, which grows on the inflated arm.

        position: of the end where it is held, mm; the components of the force along these axes follow. Raises
        `RodError` where the path ends or becomes unstable, and where the curvature leaves the law.
        """
        solution = spatial_equilibrium(_Held(self), load, position)
        n = len(solution.s)
        beside = np.zeros((n, 3))
        beside[-1] = self.to_end
        return replace(solution, beside=beside)

    @cached_property
    def law(self) -> "SectionInSpace":
        """The law of its sections."""
        law = self.own
        w, stretch = law.potential.at_last(self.variables), law.stretch.at_last(self.variables)
        rows, columns = np.triu_indices(3)
        compliance = np.zeros((3, 3))
        compliance[rows, columns] = law.compliance(self.variables[None])[0]
        compliance = compliance + compliance.T - np.diag(np.diag(compliance))
        EA = law.axial_rigidity.at_last(self.variables)
        return SectionInSpace.of(w, stretch, EA, compliance, law.reach)

    @property
    def kappa_0(self) -> Array:
        """(2,) 1/mm: the curvatures about y and z without moment."""
        return self.law.origin

    @cached_property
    def to_end(self) -> Array:
        """(3,) mm, from the end of the axis to that of the material curve, in the frame there."""
        return self.own.tip(self.variables[None])[0]

    @property
    def length(self) -> float:
        """mm"""
        return self.own.length

    def clamp_at(self, moments: Array) -> Array:
        """(n, 6): turn (rad) and shift (mm) of the clamped end by moments (n, 2) about y and z."""
        return self.own.clamp(np.column_stack([moments, np.tile(self.variables, (len(moments), 1))]))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SectionInSpace:
    """The law of the sections at given pressures, a `rod.arm_law.cosserat.StrainLaw`."""

    #: of the curvatures: dw/dkappa (2), d2w/dkappa2 (yy, yz, zz), the stretch, and its slopes (2)
    plane: Plane
    EA: float
    compliance: Array  #: (3, 3) C
    origin: Array  #: (2,) 1/mm, curvatures without moment
    softness: Array  #: (2, 2) 1/(N mm2), of curvatures by moments there
    reach: float  #: 1/mm
    step: float  #: N mm, over which moments are told apart

    @staticmethod
    def of(w: Plane, stretch: Plane, EA: Plane, compliance: Array, reach: float) -> "SectionInSpace":
        """From polynomials of the curvatures. Raises `RodError` where no curvature has no moment."""
        first, other = w.derivative(0), w.derivative(1)
        second = first.derivative(0), first.derivative(1), other.derivative(1)
        plane = Plane.joined([first, other, *second, stretch, stretch.derivative(0), stretch.derivative(1)])
        law = SectionInSpace(plane, 1.0, compliance, np.zeros(2), np.zeros((2, 2)), np.inf, 1.0)
        origin = law.curvature(np.zeros(2), np.zeros(()))
        rigidity = law.rigidity(origin)
        softest = float(np.linalg.eigvalsh(rigidity)[0])
        if not (np.isfinite(origin).all() and softest > 0.0):
            raise RodError("The law in space has no stable state without moment at these pressures.")
        own, soft = float(EA(origin)[0]), np.asarray(np.linalg.inv(rigidity), float)
        return replace(law, EA=own, origin=origin, softness=soft, reach=reach, step=softest * reach / 128.0)

    def rigidity(self, kappa: Array) -> Array:
        """(..., 2, 2) N mm2, at curvatures (..., 2)."""
        return _matrices(self.plane(kappa))

    def curvature(self, moment: Array, axial: Array) -> Array:
        """(..., 2) 1/mm under moments (..., 2) and axial forces (...,); no farther than a little beyond the law."""
        kappa = self.origin + moment @ self.softness
        farthest = BEYOND * self.reach
        for _ in range(ITERATIONS):
            values = self.plane(kappa)
            left = values[..., :2] - axial[..., None] * values[..., 6:] - moment
            change = np.linalg.solve(_matrices(values), -left[..., None])[..., 0]
            away = kappa + change - self.origin
            size = np.linalg.norm(away, axis=-1, keepdims=True)
            moved = self.origin + away * np.minimum(1.0, farthest / np.maximum(size, 1e-300))
            largest = float(np.abs(moved - kappa).max(initial=0.0))
            kappa = moved
            if largest <= SETTLED * max(float(np.abs(kappa).max(initial=0.0)), 1e-12):
                break
        return kappa

    def strains(self, force: Array, moment: Array) -> Strains:
        """As `rod.arm_law.cosserat.StrainLaw` says; `outside` is a curvature, 1/mm."""
        kappa = self.curvature(moment[..., 1:], force[..., 0])
        acting = np.concatenate([moment[..., :1], force[..., 1:]], axis=-1)
        twisted = acting @ self.compliance
        along = self.plane(kappa)[..., 5] + force[..., 0] / self.EA
        outside = float(np.max(np.linalg.norm(kappa - self.origin, axis=-1), initial=0.0)) - self.reach
        curvature = np.concatenate([twisted[..., :1], kappa], axis=-1)
        stretch = np.concatenate([along[..., None], twisted[..., 1:]], axis=-1)
        return Strains(curvature, stretch, max(outside, 0.0))


def _matrices(values: Array) -> Array:
    """(..., 2, 2): the rigidities among values (..., 8) of the plane."""
    return values[..., [[2, 3], [3, 4]]]


class _Held:
    """A `rod.arm_law.spatial_solver.SpatialArm`."""

    def __init__(self, rod: SpaceRod) -> None:
        self.rod, self.law, self.length = rod, rod.law, rod.length
        self.rigidity = float(np.linalg.eigvalsh(rod.law.rigidity(rod.kappa_0))[0])
        steps = max(int(np.ceil(self.length / (STEP * rod.own.pitch))), round(1 / LONGEST))
        self.positions = np.linspace(0.0, self.length, steps + 1)

    def weight(self, load: SpatialLoad) -> Array:
        return weight_beyond(load, self.rod.own.mass, self.length, self.positions)

    def inflated(self) -> tuple[Array, Array, Array]:
        turn, shift = np.split(self.rod.clamp_at(np.zeros((1, 2)))[0], 2)
        none = np.zeros((len(self.positions), 6))
        start = np.eye(3)[None], np.zeros((1, 3))
        shapes = integrate(self.law, self.length, none, start[1], start[0], start[1])
        onto = rotation(turn) @ shapes.frames[0, 0].T
        frame = onto @ shapes.frames[-1, 0]
        place = shift + onto @ (shapes.axis[-1, 0] - shapes.axis[0, 0]) + frame @ self.rod.to_end
        return frame, np.zeros(3), place

    def tip(self, frame: Array, force: Array) -> tuple[Array, Array, Array]:
        lever = frame @ self.rod.to_end
        return np.zeros_like(force), lever, lever

    def clamped(self, shapes: Shapes, force: Array) -> tuple[Array, Array, float]:
        there = self.rod.clamp_at(in_frame(shapes.frames[0], shapes.moment[0])[:, 1:])
        return there[:, 3:], rotation(there[:, :3]), 0.0

    def check(self, outside: float, moment: Array, is_weighed: bool) -> None:
        if outside > 0.0:
            largest = float(np.linalg.norm(moment[:, 1:], axis=1).max())
            raise RodError(
                f"The bending moment reaches {largest:.4g} N mm. The law is known up to curvatures that are "
                f"{self.rod.own.reach:.3g} 1/mm from that without moment, and these are {outside:.3g} 1/mm beyond it. "
                "It is not extrapolated: this load is too large."
            )

    def ends(self, moment: Array, lever: Array, to_end: Array, held: Array) -> Ends:
        there = moment[:1, 1:]
        step = DIFFERENCE * self.rigidity * self.rod.own.reach
        turns = np.zeros((3, 3))
        for k in range(2):
            change = step * np.eye(2)[k]
            ahead, behind = (self.rod.clamp_at(there + sign * change)[0, :3] for sign in (1.0, -1.0))
            turns[:, 1 + k] = (ahead - behind) / (2.0 * step)
        return Ends(turns, 0.0, self.rod.own.clamp_length, lever, to_end, held)
