"""The arm's own law of a run, with its errors and the arm without a load."""

import math
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from geometry.arrays import Array
from pipeline.values.parameters import Column, Numbers
from rod.arm_law.curves import CellCurve, ClampCurve
from rod.arm_law.kinds import Law
from rod.arm_law.law import ArmLaw
from rod.errors import RodError
from rod.load import Load
from rod.same_pressure import is_same
from rod.solution import RodSolution, SpatialSolution

#: what a draft is called beside its numbers
DRAFT = "draft, error of the mesh unknown, usually 1 to 15 %"


@dataclass(frozen=True)
class LawMeshError:
    """Standard deviations of the arm's own law due to its mesh, by pressure (the key mesh_error of law.json)."""

    size_mm: float | None = None
    second_mm: float | None = None
    pressures_kPa: Numbers = ()
    kappa_0_per_mm: Column = ()
    rigidity_N_mm2: Column = ()
    moment_N_mm: Column = ()
    kappa_0_per_mm_std: Column = ()
    rigidity_N_mm2_std: Column = ()
    moment_N_mm_std: Column = ()
    lateral_rigidity_N_mm2: Column = ()
    lateral_rigidity_N_mm2_std: Column = ()
    torsional_rigidity_N_mm2: Column = ()
    torsional_rigidity_N_mm2_std: Column = ()


@dataclass(frozen=True)
class Unloaded:
    """The clamped arm without a load at one pressure, by its own law."""

    pressure_kPa: float
    kappa_0_per_mm: float  #: curvature of the cell
    rigidity_N_mm2: float  #: dM/dkappa of the cell there
    bending_deg: float  #: rotation of the end section
    tip_mm: tuple[float, float]  #: relative to the clamped end


@dataclass(frozen=True)
class LawMetadata:
    """What stands in law.json beside the law."""

    mesh_error: LawMeshError | None = None
    unloaded: tuple[Unloaded, ...] = ()  #: at the pressures of the configuration
    notes: tuple[str, ...] = ()  #: how far the law may be trusted, a sentence each
    draft: bool = False  #: whether it is of one mesh whose error was not measured


@dataclass(frozen=True, eq=False)  # arrays inside
class DeliveredLaw(LawMetadata):
    """The arm's own law as law.json has it."""

    law: Law = field(kw_only=True)

    @property
    def plane(self) -> ArmLaw | None:
        """The law where it has one pressure; None for one of several pressures."""
        return self.law.plane

    @property
    def pressures_kPa(self) -> Numbers:
        """The largest pressures at which it was measured, ascending."""
        return tuple(sorted({max(row) for row in self.law.rows}))

    @property
    def has_rows(self) -> bool:
        """Whether it has several pressures."""
        return len(self.law.cavities) > 1

    @cached_property
    def most_bent(self) -> tuple[tuple[float, ...], RodSolution | SpatialSolution] | None:
        """Of a law of several pressures: those at which the arm without a load bends the most, and its shape.

        None where there is no equilibrium.
        """
        shapes: list[tuple[tuple[float, ...], RodSolution | SpatialSolution]] = []
        for row in self.law.rows if self.has_rows else ():
            arm = self.law.at(row)
            with suppress(RodError):
                shapes.append((row, arm.in_plane(Load()) if arm.has_plane else arm.solve_in_space(Load())))
        return max(shapes, key=lambda one: one[1].bending_deg, default=None)

    @cached_property
    def angles(self) -> dict[str, Array]:
        """By form, (n, 2): pressures in kPa, and how far the arm without a load bends, in degrees.

        "rising" as it is inflated from rest, "unstable" along the volume of the air beyond a limit of the pressure, and
        "swollen" after the snap; empty for a law of several pressures.
        """
        law = self.plane
        if law is None:
            return {}
        forms = {"rising": law.before_snap} | ({"swollen": law.swollen} if law.swollen else {})
        rows = {name: np.array([_bent(form, p) for p in form.pressures]) for name, form in forms.items()}
        if law.limit and len(law.limit.kappas):
            _, angle, kappa = np.array([row for one in rows.values() for row in one if row[1] * abs(row[2]) > 0.0]).T
            order, way = np.argsort(np.abs(kappa)), np.abs(law.limit.kappas)
            ratio = np.interp(way, np.abs(kappa)[order], (angle / np.abs(kappa))[order])
            rows["unstable"] = np.column_stack([law.limit.pressures, ratio * way])
        return {name: columns[:, :2] for name, columns in rows.items()}

    def curves(self, pressure_kPa: float) -> tuple[CellCurve, ClampCurve] | None:
        """The cell and the clamped end at a pressure, before a snap where it has both; None where there are none."""
        forms = filter(None, [self.plane, self.plane and self.plane.swollen])
        pairs = (pair for form in forms for pair in zip(form.cells, form.clamps, strict=True))
        return next((pair for pair in pairs if is_same(pair[0].pressure, pressure_kPa)), None)


def _bent(law: ArmLaw, pressure: float) -> tuple[float, float, float]:
    """The pressure in kPa, the angle in degrees, not finite where the arm has no equilibrium, and the curvature."""
    rod, angle = law.at(pressure), math.nan
    with suppress(RodError):
        angle = abs(rod.under(Load()).bending_deg)
    return pressure, angle, rod.section.kappa_0
