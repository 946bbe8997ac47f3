"""How wrong each rod is: against the finite elements on the same mesh, and because of that mesh."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from geometry.errors import Reason, Values
from pipeline.values.formats import ARM_LAW, FIVE
from pipeline.values.formatting import percent
from pipeline.values.law import DRAFT, DeliveredLaw
from pipeline.values.parameters import Column
from pipeline.values.run import SMALLEST_TURN, RodError, Run

#: the rods in words
TITLES = {
    FIVE: "five parameters",
    ARM_LAW: "the arm's own law",
}
#: errors up to which a rod is recommended, of rod and mesh together: of the shape over the length, and of the force
#: over the largest one
LARGEST_SHAPE, LARGEST_FORCE = 0.05, 0.10
#: relative error of a moment or a rigidity above which forces at its pressure are noted; part of the largest moment
#: below which a moment is too small to be noted
NOTED, SMALL = 0.10, 0.10
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
    def title(self) -> str:
        """The rod in words."""
        return TITLES[self.rod]

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

    A rod that `RodAndMesh.is_good` comes before the others, then one that bears at least half of its loads. Of two such
    that is first which is nearer by the larger factor, in shape or in force. All is of rod and mesh together; a mesh
    whose error is not known for a rod has that of the other rods here.
    """
    found = [RodErrors.of(run, rod) for rod in run.rods]
    parts = [(_shape_by_mesh(run, errors.rod), mesh_errors(run, errors.rod).force or 0.0) for errors in found]
    others = [max(part) for part in zip(*parts, strict=True)]

    def rank(errors: RodErrors) -> tuple[bool, bool, float]:
        both, part = (
            rod_and_mesh(run, errors),
            [0.0, 0.0] if mesh_errors(run, errors.rod).largest is not None else others,
        )
        both = replace(both, shape=both.shape + part[0], force=(both.force or 0.0) + part[1])
        loads = errors.loads_in_sample + errors.loads_out_of_sample
        product = max(both.shape, EQUAL) * max(both.force or 0.0, EQUAL)
        return not both.is_good, errors.loads_without_solution > loads, product

    return tuple(sorted(found, key=rank))


@dataclass(frozen=True)
class MeshErrors:
    """Errors of a rod's numbers because of the mesh, one standard deviation each; None where not estimated."""

    kappa_0: float | None = None  #: over the largest curvature without load, or over one that bends the arm little
    rigidity: float | None = None  #: relative, at the worst pressure
    force: float | None = None  #: over the largest one: of the moments that bend a cell, or of the forces in III

    @property
    def largest(self) -> float | None:
        """The largest of the relative ones that are known."""
        return _largest([self.kappa_0, self.rigidity, self.force])


def mesh_errors(run: Run, rod: str) -> MeshErrors:
    """The errors of the mesh in the numbers of a rod."""
    if rod == ARM_LAW:
        return law_mesh_errors(run.law)
    five, known = run.parameters, run.parameters.mesh_error
    if known is None:
        return MeshErrors()
    held = {s.pressure_kPa: math.hypot(*s.reaction_N) for s in run.states if s.experiment == "III" and s.reached}
    forces = tuple(held.get(pressure) for pressure in five.pressures_kPa)
    return MeshErrors(
        _over_largest(five.kappa_0.middle_per_mm, _kappa_0_errors(run, rod)[1], SMALLEST_TURN / run.length_mm),
        _largest(known.alpha2_relative),
        _over_largest(forces, _products(forces, known.force_relative), 0.0),
    )


def law_mesh_errors(law: DeliveredLaw | None) -> MeshErrors:
    """The errors of the mesh in the numbers of an arm's own law."""
    if law is None or not law.mesh_error:
        return MeshErrors()
    error, turning = law.mesh_error, SMALLEST_TURN / law.law.length
    stiffest = _largest(error.rigidity_N_mm2) or 0.0
    return MeshErrors(
        _over_largest(error.kappa_0_per_mm, error.kappa_0_per_mm_std, turning),
        _largest(_relative(error.rigidity_N_mm2, error.rigidity_N_mm2_std)),
        _over_largest(error.moment_N_mm, error.moment_N_mm_std, 0.5 * turning * stiffest),
    )


def unknown_mesh_error(run: Run) -> Reason:
    """Why the error of the mesh is not known."""
    return Reason("draft", {"draft": DRAFT}) if run.law and run.law.draft else Reason("mesh_error_unknown")


def uncertain_forces(run: Run, rod: str) -> Reason | None:
    """Pressures at which a rigidity, or a moment that is not small, is uncertain by more than a tenth of itself."""
    law, five = run.law and run.law.mesh_error, run.parameters.mesh_error
    if rod == ARM_LAW and law:
        moments = _relative(law.moment_N_mm, law.moment_N_mm_std, SMALL * (_largest(law.moment_N_mm) or 0.0))
        pressures, columns = law.pressures_kPa, [moments, _relative(law.rigidity_N_mm2, law.rigidity_N_mm2_std)]
    else:
        pressures, columns = run.parameters.pressures_kPa, [five.alpha2_relative] if five and rod != ARM_LAW else []
    rows = [(p, one) for column in columns for p, one in zip(pressures, column, strict=False) if one and one > NOTED]
    values: Values = {
        "pressures_kPa": sorted({p for p, _ in rows}),
        "percent": 100.0 * max([e for _, e in rows] or [0]),
    }
    return Reason("forces_uncertain", values) if rows else None


def _relative(values: Column, deviations: Column, least: float = 0.0) -> Column:
    """Deviations over their values; None where one of them is not known, or the value is not above the least one."""
    return tuple(
        None if value is None or std is None or abs(value) <= least else std / abs(value)
        for value, std in zip(values, deviations, strict=False)
    )


def _products(values: Column, parts: Column) -> Column:
    return tuple(a * b if a is not None and b is not None else None for a, b in zip(values, parts, strict=False))


def _over_largest(values: Column, deviations: Column, least: float) -> float | None:
    """The largest deviation over the largest value, or over the least value that counts."""
    largest, over = _largest(deviations), max(_largest(values) or 0.0, least)
    return None if largest is None or not over else largest / over


@dataclass(frozen=True)
class RodAndMesh:
    """The largest errors of a rod under the loads that it was compared under, those of its mesh added where known."""

    shape: float  #: over the length; infinite where the rod has no solution
    force: float | None  #: over the largest force; None where no load had one
    largest_N: float | None  #: the largest force
    mesh: MeshErrors  #: the part of the mesh
    is_compared: bool = True  #: False without finite elements of the whole arm; the error is then that of the law
    ends: float = 0.0  #: then the part of the shape by cells that the ends of the arm still disturb

    @property
    def is_known(self) -> bool:
        """Whether the error of the shape is."""
        return math.isfinite(self.shape) and (self.is_compared or self.mesh.largest is not None)

    @property
    def is_good(self) -> bool:
        """Whether the rod is recommended."""
        return self.shape <= LARGEST_SHAPE and (self.force or 0.0) <= LARGEST_FORCE

    @property
    def text(self) -> str:
        """The errors of shape and force in words."""
        if not self.is_compared and self.mesh.largest is None:
            return "its errors are not known; no whole arm was solved"
        force = "" if self.force is None else f", of the force {percent(self.force)}"
        errors = f"error of the shape {percent(self.shape)} of the length{force}"
        if not self.is_compared:
            causes = "mesh and ends" if self.ends > NOTED * self.shape else "mesh"
            return f"{errors} because of its {causes}; no whole arm was solved"
        return f"{errors} ({'without the error of the mesh' if self.mesh.largest is None else 'rod and mesh added'})"


def rod_to_take(run: Run, errors: Sequence[RodErrors] | None = None) -> tuple[str, RodAndMesh] | None:
    """The rod with the smallest errors, and these; the arm's own law where none was compared. None without a rod.

    errors: those of `rod_errors`, where they are known.
    """
    ranked = rod_errors(run) if errors is None else errors
    if ranked:
        return ranked[0].rod, rod_and_mesh(run, ranked[0])
    mesh = law_mesh_errors(run.law)
    known = run.law and run.law.interpolation_error
    ends = (known and known.ends_over_length) or 0.0
    alone = RodAndMesh(_shape_by_mesh(run, ARM_LAW) + ends, mesh.force, None, mesh, is_compared=False, ends=ends)
    return (ARM_LAW, alone) if run.law else None


def rod_and_mesh(run: Run, errors: RodErrors) -> RodAndMesh:
    """The errors of a rod together with those of its mesh."""
    mesh, largest = mesh_errors(run, errors.rod), _largest(row.force_N for row in run.rod_errors)
    return RodAndMesh(
        shape=errors.shape + _shape_by_mesh(run, errors.rod),
        force=None if largest is None else errors.force + (mesh.force or 0.0),
        largest_N=largest,
        mesh=mesh,
    )


def _shape_by_mesh(run: Run, rod: str) -> float:
    """How far the mesh moves the arm without a load, over the length; 0 where that is not known.

    Without finite elements of the arm it is an arc.
    """
    bent = [(one.pressure_kPa, one["s_mm"], one["theta_rad"]) for one in run.curves_of("II") if not one.load]
    if run.law and not bent:
        s = np.linspace(0.0, run.law.law.length, 50)
        angles = [(one.pressure_kPa, math.radians(one.bending_deg)) for one in run.law.unloaded]
        if not angles and (error := run.law.mesh_error):  # in space
            angles = [(p, k * s[-1]) for p, k in zip(error.pressures_kPa, error.kappa_0_per_mm, strict=True)]
        bent = [(pressure, s, angle * s / s[-1]) for pressure, angle in angles]
    known = {p: error for p, error in zip(*_kappa_0_errors(run, rod), strict=False) if error is not None}
    if not known:
        return 0.0
    more = [float(np.interp(p, list(known), list(known.values()))) for p, _, _ in bent]
    return max((tip_moves_by(s, theta, by) for by, (_, s, theta) in zip(more, bent, strict=True)), default=0.0)


def _kappa_0_errors(run: Run, rod: str) -> tuple[tuple[float, ...], Column]:
    """Pressures, and deviations of the curvature without load because of the mesh in 1/mm; empty where not known."""
    if rod == ARM_LAW:
        error = run.law.mesh_error if run.law else None
        return (error.pressures_kPa, error.kappa_0_per_mm_std) if error else ((), ())
    five, known = run.parameters, run.parameters.mesh_error
    return five.pressures_kPa, _products(five.kappa_0.middle_per_mm, known.kappa_0_relative) if known else ()


def tip_moves_by(s: Array, theta: Array, more: float) -> float:
    """Largest distance over the length that a curve moves by where it is bent by a curvature more, 1/mm.

    s, theta: (n,) rest arc lengths in mm and angles in rad.
    """
    apart = _positions(s, theta + more * (s - s[0])) - _positions(s, theta)
    return float(np.hypot(*apart).max() / (s[-1] - s[0]))


def _positions(s: Array, theta: Array) -> Array:
    """(2, n) positions of an inextensible curve with these angles (n,) at s (n,)."""
    directions = np.array([np.cos(theta), np.sin(theta)])
    steps = 0.5 * (directions[:, 1:] + directions[:, :-1]) * np.diff(s)
    return np.concatenate([np.zeros((2, 1)), np.cumsum(steps, axis=1)], axis=1)
