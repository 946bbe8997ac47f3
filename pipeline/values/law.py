"""The arm's own law of a run, with its errors and the arm without a load."""

import math
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from math import isnan

import numpy as np

from geometry.arrays import Array
from pipeline.values.parameters import Column, Number, Numbers
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
class InterpolationError:
    """How far the arm's own law is from its pieces on one mesh (the key interpolation_error of law.json)."""

    along_curves: float  #: of the curvature between two moments, over the largest curvature of the law
    along_clamped_end: float  #: of the rotation of the clamped end between two moments, rad
    between_pressures: float | None  #: of the curvature, over the largest one, where it was checked; None: nowhere
    #: of the arm's end by cells that the end pieces still disturb, over the length; None: not known
    ends_over_length: float | None


@dataclass(frozen=True)
class Unloaded:
    """The clamped arm without a load at one pressure, by its own law."""

    pressure_kPa: float
    kappa_0_per_mm: float  #: curvature of the cell
    rigidity_N_mm2: float  #: dM/dkappa of the cell there
    bending_deg: float  #: rotation of the end section
    tip_mm: tuple[float, float]  #: relative to the clamped end


@dataclass(frozen=True)
class Layers:
    """What threads and sheets do to the arm without a load at one pressure, by single states of its pieces."""

    pressure_kPa: float
    bending_deg: float
    without_deg: dict[str, float | None]  #: by effect: without it; None where the arm has no equilibrium then
    height: float  #: of the section in the middle of a cell, over that at rest
    width: float  #: the same across the plane of the arm
    pull_N: Number  #: largest force of a thread, with `threads`; NaN without
    pull_N_per_mm: Number  #: the same per length of the arm; NaN without thread
    pull_at: str  #: part of the arm, and the place at rest in words
    stretch: float  #: largest one of the walls
    stretch_at: str

    @property
    def text(self) -> str:
        """The error in sentences."""
        words = {"hoops": "thread", "strain_limiting_layer": "sheet"}
        kinds = {words[name]: angle for name, angle in self.without_deg.items()}
        told = [f"without the {name} " + ("it bulges" if a is None else f"by {a:.0f}°") for name, a in kinds.items()]
        force = f"{self.pull_N_per_mm:.2g} N/mm" if isnan(self.pull_N) else f"{self.pull_N:.2g} N"
        pulls = "" if isnan(self.pull_N_per_mm) else f" The thread pulls with up to {force}, {self.pull_at}."
        return (
            f"At {self.pressure_kPa:.4g} kPa it bends by {self.bending_deg:.0f}°, {', '.join(told)}. Its section is "
            f"{self.height:.2f} times as high and {self.width:.2f} times as wide as at rest.{pulls} "
            f"Walls stretch most, {self.stretch:.2f} times, {self.stretch_at}."
        )


@dataclass(frozen=True)
class LawMetadata:
    """What stands in law.json beside the law."""

    mesh_error: LawMeshError | None = None
    unloaded: tuple[Unloaded, ...] = ()  #: at the pressures of the configuration
    notes: tuple[str, ...] = ()  #: how far the law may be trusted, a sentence each
    draft: bool = False  #: whether it is of one mesh whose error was not measured
    layers: Layers | None = None  #: None without thread and sheet, and for a law in space
    #: how far an arm in space bends at its rows, towards y and on every 45 degrees towards z; empty in a plane
    directions_deg: tuple[float, ...] = ()
    interpolation_error: InterpolationError | None = None  #: None: of several pressures


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
        """Pressures of a law of several at which the arm without a load bends the most, and its shape.

        None where there is no equilibrium.
        """
        shapes: list[tuple[tuple[float, ...], RodSolution | SpatialSolution]] = []
        for row in self.law.rows if self.has_rows else ():
            arm = self.law.at(row)
            with suppress(RodError):
                shapes.append((row, arm.in_plane(Load()) if arm.has_plane else arm.solve_in_space(Load())))
        return max(shapes, key=lambda one: one[1].bending_deg, default=None)

    def ring(self, between: int) -> Array:
        """(n, c) kPa: pressures on the way from each row of an arm in space to the next one, and back to the first.

        between: steps from one row to the next. Empty for an arm in its plane, and for fewer than three ratios.
        """
        rows = np.array([*self.law.rows, self.law.rows[0]])
        parts = np.linspace(0.0, len(rows) - 1.0, between * (len(rows) - 1) + 1)
        around = np.column_stack([np.interp(parts, range(len(rows)), column) for column in rows.T])
        return around[:0] if self.law.has_plane or len(self.law.ratios) < 3 else around

    def towards(self) -> tuple[float, ...]:
        """`directions_deg` of the law, interpolated between the rows and the middles between them."""
        found = list[tuple[float, float]]()
        for pressures in self.ring(2)[:-1]:
            with suppress(RodError):
                shape = self.law.at(tuple(pressures.tolist())).solve_in_space(Load())
                found.append((math.degrees(math.atan2(shape.end[2], shape.end[1])), shape.bending_deg))
        if not found:
            return ()
        directions, bends = np.array(found).T
        return tuple(map(float, np.interp(np.arange(0.0, 360.0, 45.0), directions, bends, period=360.0)))

    @cached_property
    def angles(self) -> dict[str, Array]:
        """Angles by form, (n, 2): pressures in kPa, and how far the arm without a load bends, in degrees.

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
    rod, angle, kappa = law.at(pressure), math.nan, math.nan
    with suppress(RodError):
        kappa = rod.section.kappa_0
        angle = abs(rod.under(Load()).bending_deg)
    return pressure, angle, kappa
