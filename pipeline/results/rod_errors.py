"""How wrong each rod is: against the finite elements on the same mesh, and because of that mesh."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.errors import Reason, Values
from pipeline.values.formats import ARM_LAW, EXTENSIBLE, FIVE
from pipeline.values.formatting import percent
from pipeline.values.law import DRAFT, DeliveredLaw
from pipeline.values.parameters import Column
from pipeline.values.run import SMALLEST_TURN, RodError, Run

#: the rods in words
TITLES = {
    FIVE: "five parameters",
    EXTENSIBLE: "five parameters and stretch",
    ARM_LAW: "the arm's own law",
}
#: distance over the length beyond which no rod is recommended
POOR = 0.10
#: relative error of the mesh above which a number should not be used
LARGE_MESH_ERROR = 0.10
#: errors of shape and of force below which one rod is as good as another
EQUAL = 1e-3


@dataclass(frozen=True)
class RodErrors:
    """The largest errors of one rod over all loads; the force is relative to the largest force of all loads."""

    rod: str
    loads_in_sample: int
    loads_out_of_sample: int
    distance_over_length_in_sample: float | None  #: None without loads
    distance_over_length_out_of_sample: float | None
    force_error_in_sample: float | None
    force_error_out_of_sample: float | None
    loads_without_solution: int

    @staticmethod
    def of(run: Run, rod: str) -> "RodErrors":
        """The errors of one of the rods of a run."""
        rows = run.errors_of(rod)
        inside, outside = ([row for row in rows if row.sample == s and not row.reason] for s in ("in", "out"))
        largest = max((abs(row.force_N) for row in run.rod_errors if row.force_N is not None), default=0.0)
        shapes = [_largest(row.distance_over_length for row in part) for part in (inside, outside)]
        forces = [_largest(_force_error(row, largest) for row in part) for part in (inside, outside)]
        missing = sum(bool(row.reason) for row in rows)
        return RodErrors(rod, len(inside), len(outside), shapes[0], shapes[1], forces[0], forces[1], missing)

    @property
    def shape(self) -> float:
        """Largest distance between the curves over the length; infinite where the rod has no solution at all."""
        known = _largest([self.distance_over_length_in_sample, self.distance_over_length_out_of_sample])
        return math.inf if known is None else known

    @property
    def force(self) -> float:
        """Largest error of the end force; 0 where no load had one."""
        return _largest([self.force_error_in_sample, self.force_error_out_of_sample]) or 0.0


def _force_error(row: RodError, largest_N: float) -> float | None:
    if row.force_error is None or row.force_N is None:
        return None
    return row.force_error * row.force_N / largest_N if largest_N else 0.0


def _largest(values: Iterable[float | None]) -> float | None:
    return max((abs(value) for value in values if value is not None), default=None)


def rod_errors(run: Run) -> tuple[RodErrors, ...]:
    """The errors of every rod, the rod to take first.

    A rod without a solution under some load comes behind those that have one, and a rod farther than `POOR` last. Of
    two others that is first which is nearer by the larger factor, in shape or in force.
    """

    def rank(errors: RodErrors) -> tuple[bool, int, float]:
        both = max(errors.shape, EQUAL) * max(errors.force, EQUAL)
        return errors.shape > POOR, errors.loads_without_solution, both

    return tuple(sorted((RodErrors.of(run, rod) for rod in run.rods), key=rank))


@dataclass(frozen=True)
class MeshErrors:
    """Relative errors of a rod's numbers because of the mesh, one standard deviation; None where not estimated."""

    kappa_0: float | None
    rigidity: float | None
    force: float | None  #: the moment that bends a cell, or the force in experiment III

    @property
    def largest(self) -> float | None:
        """The largest of those that are known."""
        return _largest([self.kappa_0, self.rigidity, self.force])

    @property
    def worst(self) -> tuple[str, float]:
        """The quantity with the largest error in words, and the error."""
        errors = {"curvature without load": self.kappa_0, "bending rigidity": self.rigidity, "moment": self.force}
        return max(((name, error or 0.0) for name, error in errors.items()), key=lambda pair: pair[1])


def mesh_errors(run: Run, rod: str) -> MeshErrors:
    """The errors of the mesh in the numbers of a rod, at the worst pressure."""
    if rod == ARM_LAW:
        return law_mesh_errors(run.law)
    known = run.parameters.mesh_error
    if known is None:
        return MeshErrors(None, None, None)
    return MeshErrors(*map(_largest, (known.kappa_0_relative, known.alpha2_relative, known.force_relative)))


def law_mesh_errors(law: DeliveredLaw | None) -> MeshErrors:
    """The errors of the mesh in the numbers of an arm's own law: of curvature and moment over their largest values.

    Both may pass through zero at a pressure, where the shape is as certain as elsewhere; see `uncertain_forces`.
    """
    if law is None or not law.mesh_error:
        return MeshErrors(None, None, None)
    error, turning = law.mesh_error, SMALLEST_TURN / law.law.length
    stiffest = _largest(error.rigidity_N_mm2) or 0.0
    rigidity = _relative(error.rigidity_N_mm2, error.rigidity_N_mm2_std)
    return MeshErrors(
        _over_largest(error.kappa_0_per_mm, error.kappa_0_per_mm_std, turning),
        _largest(relative for relative in rigidity if relative is not None),
        _over_largest(error.moment_N_mm, error.moment_N_mm_std, 0.5 * turning * stiffest),
    )


def unknown_mesh_error(run: Run) -> Reason:
    """Why the error of the mesh is not known."""
    return Reason("draft", {"draft": DRAFT}) if run.law and run.law.draft else Reason("mesh_error_unknown")


def uncertain_forces(law: DeliveredLaw | None) -> Reason | None:
    """Pressures at which the moment that straightens the cells is uncertain by more than a tenth of itself, if any."""
    if law is None or not law.mesh_error:
        return None
    error = law.mesh_error
    relative = _relative(error.moment_N_mm, error.moment_N_mm_std)
    found = {p: one for p, one in zip(error.pressures_kPa, relative, strict=False) if p and one}
    wide = {pressure: one for pressure, one in found.items() if one > LARGE_MESH_ERROR}
    values: Values = {"pressures_kPa": list(wide), "percent": 100.0 * max(wide.values(), default=0.0)}
    return Reason("forces_uncertain", values) if wide else None


def _relative(values: Column, deviations: Column) -> list[float | None]:
    """Deviations over their values; None where one of them is not known, or the value is zero."""
    return [
        None if not value or std is None else std / abs(value) for value, std in zip(values, deviations, strict=False)
    ]


def _over_largest(values: Column, deviations: Column, least: float) -> float | None:
    """The largest deviation over the largest value, or over the least value that counts."""
    largest = _largest(deviations)
    return None if largest is None else largest / max(_largest(values) or 0.0, least)


@dataclass(frozen=True)
class RodAndMesh:
    """The largest errors of a rod under the loads that it was compared under, those of its mesh added where known."""

    shape: float  #: over the length; infinite where the rod has no solution
    force: float | None  #: over the largest force; None where no load had one
    largest_N: float | None  #: the largest force
    mesh: MeshErrors  #: the part of the mesh
    is_compared: bool = True  #: False without finite elements of the whole arm; the error is then that of the mesh

    @property
    def is_known(self) -> bool:
        """Whether the error of the shape is."""
        return math.isfinite(self.shape) and (self.is_compared or self.mesh.largest is not None)

    @property
    def text(self) -> str:
        """The errors of shape and force in words."""
        if not self.is_compared and self.mesh.largest is None:
            return "its errors are not known; no whole arm was solved"
        if not self.is_compared:
            moved = f"error of the shape {percent(self.shape)} of the length because of its mesh"
            return f"{moved}; no whole arm was solved"
        force = "" if self.force is None else f", of the force {percent(self.force)}"
        mesh = "rod and mesh added" if self.mesh.largest is not None else "without the error of the mesh"
        return f"error of the shape {percent(self.shape)} of the length{force} ({mesh})"


def rod_to_take(run: Run, errors: Sequence[RodErrors] | None = None) -> tuple[str, RodAndMesh] | None:
    """The rod with the smallest errors, and these; the arm's own law where none was compared. None without a rod.

    errors: those of `rod_errors`, where they are known.
    """
    ranked = rod_errors(run) if errors is None else errors
    if ranked:
        return ranked[0].rod, rod_and_mesh(run, ranked[0])
    return (ARM_LAW, _of_mesh_alone(run.law, mesh_errors(run, ARM_LAW))) if run.law else None


def rod_and_mesh(run: Run, errors: RodErrors) -> RodAndMesh:
    """The errors of a rod together with those of its mesh."""
    mesh = mesh_errors(run, errors.rod)
    bent = [curve for curve in run.curves_of("II") if not curve.load]
    largest = _largest(row.force_N for row in run.rod_errors)
    moved = (tip_moves_by(curve["s_mm"], curve["theta_rad"], mesh.kappa_0 or 0.0) for curve in bent)
    return RodAndMesh(
        shape=errors.shape + max(moved, default=0.0),
        force=None if largest is None else errors.force + (mesh.force or 0.0),
        largest_N=largest,
        mesh=mesh,
    )


def _of_mesh_alone(law: DeliveredLaw, mesh: MeshErrors) -> RodAndMesh:
    """Of the arm without a load, as circular arcs."""
    angles = [state.bending_deg for state in law.unloaded]
    angles += [law.most_bent[1].bending_deg] if law.most_bent else []
    arcs = [np.linspace(0.0, math.radians(angle), 50) for angle in angles]
    moved = (tip_moves_by(np.linspace(0.0, 1.0, 50), arc, mesh.kappa_0 or 0.0) for arc in arcs)
    return RodAndMesh(max(moved, default=0.0), None, None, mesh, is_compared=False)


def tip_moves_by(s: Array, theta: Array, relative: float) -> float:
    """Largest distance over the length that a curve moves by where all of its curvature is larger by a fraction.

    s, theta: (n,) rest arc lengths and angles in rad.
    """
    more = theta[0] + (1.0 + relative) * (theta - theta[0])
    apart = _positions(s, more) - _positions(s, theta)
    return float(np.hypot(*apart).max() / (s[-1] - s[0]))


def _positions(s: Array, theta: Array) -> Array:
    """(2, n) positions of an inextensible curve with these angles (n,) at s (n,)."""
    directions = np.array([np.cos(theta), np.sin(theta)])
    steps = 0.5 * (directions[:, 1:] + directions[:, :-1]) * np.diff(s)
    return np.concatenate([np.zeros((2, 1)), np.cumsum(steps, axis=1)], axis=1)
