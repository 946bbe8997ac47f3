"""The arm's own law as tables and as figures on an HTML page, and where it ends."""

from collections.abc import Iterator

import numpy as np

from geometry import Reason
from pipeline.law.build import MeasuredLaw
from pipeline.law.in_space.measure import FINER, MeasuredInSpace
from pipeline.law.mesh_limit import MeshLimit
from pipeline.values.formatting import percent
from pipeline.values.law import LawMeshError
from pipeline.values.table import Table
from rod.arm_law.curves import IN_SPACE, CellCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.space_law import SpaceLaw, SpaceRod
from rod.load import Load


def law_table(measured: MeasuredLaw) -> Table:
    """One row per pressure: the cell without moment, its range of moments, and the work for the cell."""
    error = measured.mesh_error or LawMeshError()
    kappa_0 = dict(zip(error.pressures_kPa, error.kappa_0_per_mm_std, strict=True))
    relative = np.array(error.rigidity_N_mm2_std, float) / np.array(error.rigidity_N_mm2, float)
    rigidity = dict(zip(error.pressures_kPa, relative, strict=True))
    return Table.of(
        list(zip(measured.law.cells, measured.seconds_of_cells, strict=True)),
        ("p (kPa)", lambda row: f"{row[0].pressure:g}"),
        ("κ₀ (1/mm)", lambda row: f"{row[0].at(0.0)[0]:.5f}"),
        ("mesh ±", lambda row: f"{kappa_0[p]:.2g}" if (p := row[0].pressure) in kappa_0 else ""),
        ("dM/dκ (N mm²)", lambda row: f"{_at_rest(row[0], 'rigidity'):.4g}"),
        ("mesh ±", lambda row: f"{100.0 * rigidity[p]:.2g} %" if (p := row[0].pressure) in rigidity else ""),
        ("EA (N)", lambda row: f"{_at_rest(row[0], 'axial_rigidity'):.3g}"),
        ("GA (N)", lambda row: f"{_at_rest(row[0], 'shear_rigidity'):.3g}"),
        ("moments (N mm)", lambda row: f"{row[0].moment[0]:.3g} ... {row[0].moment[-1]:.3g}"),
        ("walls touch from (1/mm)", lambda row: _contact(row[0])),
        ("states", lambda row: str(len(row[0].moment))),
        ("s", lambda row: f"{row[1]:.1f}"),
        caption="κ₀: curvature without moment; dM/dκ, EA, GA: rigidities there against bending, stretching and shear",
    )


def space_table(law: ArmLaw, error: LawMeshError) -> Table:
    """One row per pressure with the rigidities out of the plane, without moment; empty where they are not known."""
    columns = error.lateral_rigidity_N_mm2_std, error.torsional_rigidity_N_mm2_std
    stds = dict(zip(error.pressures_kPa, zip(*columns, strict=True), strict=False))

    def of_mesh(cell: CellCurve, number: int) -> str:
        std = stds.get(cell.pressure, (None, None))[number]
        return "" if std is None else f"{100.0 * std / _at_rest(cell, IN_SPACE[number]):.2g} %"

    return Table.of(
        [cell for cell in law.cells if cell.is_in_space],
        ("p (kPa)", lambda cell: f"{cell.pressure:g}"),
        ("B₂ (N mm²)", lambda cell: f"{_at_rest(cell, IN_SPACE[0]):.4g}"),
        ("mesh ±", lambda cell: of_mesh(cell, 0)),
        ("GJ (N mm²)", lambda cell: f"{_at_rest(cell, IN_SPACE[1]):.4g}"),
        ("mesh ±", lambda cell: of_mesh(cell, 1)),
        ("GA across (N)", lambda cell: f"{_at_rest(cell, IN_SPACE[2]):.4g}"),
        ("twist axis (mm)", lambda cell: f"{_at_rest(cell, IN_SPACE[3]):.4g}"),
        caption="out of the plane, without moment; the twist axis is above the axis of the rod",
    )


def mesh_table(limit: MeshLimit) -> Table:
    """What accuracy costs: one row per mesh of the cell, with the numbers at the highest pressure."""
    return Table.of(
        limit.meshes,
        ("mesh (mm)", lambda mesh: f"{mesh.size_mm:.3g}"),
        ("unknowns", lambda mesh: str(mesh.degrees_of_freedom)),
        ("error", lambda mesh: f"{100.0 * mesh.error:.2g} %"),
        ("CPU s", lambda mesh: f"{mesh.seconds:.1f}"),
        caption="error: of κ₀, rigidity and the moment that straightens the cell, the largest",
    )


def _at_rest(cell: CellCurve, name: str) -> float:
    """A quantity of a cell without moment."""
    return float(np.interp(0.0, cell.moment, getattr(cell, name)))


def _contact(cell: CellCurve) -> str:
    """The curvatures at which walls touch, in 1/mm."""
    if not cell.contact.any():
        return "nowhere"
    touching = cell.kappa[cell.contact]
    if cell.contact.all():
        return "everywhere"
    return f"{touching[0]:.4f}" if cell.contact[-1] else f"{touching[0]:.4f} ... {touching[-1]:.4f}"


def law_remarks(measured: MeasuredLaw) -> Iterator[Reason]:
    """How the law was interpolated, which mesh was taken, and where it ends."""
    error = measured.interpolation_error
    values = {"half_cells": measured.half_cells, "along_percent": 100.0 * error.along_curves}
    if not measured.draft:  # which says nothing about what lies between
        yield Reason("law_interpolated", values | {"between_percent": 100.0 * (error.between_pressures or 0.0)})
    if measured.limit is not None:
        yield from measured.limit.remarks
    yield from measured.limits


def space_sentences(measured: MeasuredInSpace) -> tuple[str, ...]:
    """How far a law in space may be trusted, and what could not be solved."""
    law = measured.law
    lines = [
        f"The law interpolates {measured.states} states of a half cell; its moments are right to "
        f"{percent(law.error)} of the largest.",
        f"Valid up to {1e3 * law.reach:.3g} 1/m from the unloaded curvature.",
    ]
    if measured.changes is not None:
        curvature, rigidity = map(percent, measured.changes)
        size = f"{100.0 * FINER:.0f} % of the size"
        lines.append(f"On a mesh of {size} its curvature changes by {curvature} and its rigidity by {rigidity}.")
    if measured.left:
        lines.append(f"{len(measured.left)} states have no equilibrium, the first: {measured.left[0]}.")
    return tuple(lines)


def rows_table(law: SpaceLaw) -> Table:
    """One row per row of pressures: the arm without load."""
    heads = ("p (kPa)", "κ_y, κ_z (1/m)", "end (mm)", "bends by", "rigidities (N mm²)", "GJ (N mm²)", "EA (N)")
    caption = f"pressures of {', '.join(law.cavities)}; the arm without load"
    return Table(heads, tuple(_row(law.at(pressures)) for pressures in law.rows), caption)


def _row(rod: SpaceRod) -> tuple[str, ...]:
    shape = rod.solve_in_space(Load())
    least, most = rod.section.rigidities
    return (
        ", ".join(f"{pressure:g}" for pressure in rod.pressures),
        ", ".join(f"{1e3 * value:.3f}" for value in rod.kappa_0),
        ", ".join(f"{value:.2f}" for value in shape.end),
        f"{shape.bending_deg:.1f}°",
        f"{least:.4g}, {most:.4g}",
        f"{1.0 / rod.section.compliance[0, 0]:.4g}",
        f"{rod.section.EA:.3g}",
    )
