"""The arm's own law as a table, and where it ends."""

from collections.abc import Iterator

import numpy as np

from geometry import Reason
from pipeline.law.build import MeasuredLaw
from pipeline.law.mesh_limit import MeshLimit
from pipeline.law.study import LawReport
from pipeline.values.law import LawMeshError
from pipeline.values.table import Table
from rod.arm_law.curves import IN_SPACE, CellCurve
from rod.arm_law.law import ArmLaw

_HEADS = (
    *("p (kPa)", "κ₀ (1/mm)", "mesh ±", "dM/dκ (N mm²)", "mesh ±", "EA (N)", "GA (N)", "moments (N mm)"),
    *("walls touch from (1/mm)", "states", "s"),
)


def law_table(measured: MeasuredLaw) -> Table:
    """One row per pressure: the cell without moment, its range of moments, and the work for the cell."""
    error = measured.mesh_error or LawMeshError()
    relative = np.array(error.rigidity_N_mm2_std, float) / np.array(error.rigidity_N_mm2, float)
    of_mesh = {
        pressure: (f"{kappa_0:.2g}", f"{100.0 * rigidity:.2g} %")
        for pressure, kappa_0, rigidity in zip(error.pressures_kPa, error.kappa_0_per_mm_std, relative, strict=True)
    }
    rows = tuple(
        _row(cell, of_mesh.get(cell.pressure, ("", "")), seconds)
        for cell, seconds in zip(measured.law.cells, measured.seconds_of_cells, strict=True)
    )
    caption = "κ₀: curvature without moment; dM/dκ, EA, GA: rigidities there against bending, stretching and shear"
    return Table(_HEADS, rows, caption)


def space_table(law: ArmLaw, error: LawMeshError) -> Table | None:
    """One row per pressure with the rigidities out of the plane, without moment; None where they are not known."""
    cells = [cell for cell in law.cells if cell.is_in_space]
    if not cells:
        return None
    columns = error.lateral_rigidity_N_mm2_std, error.torsional_rigidity_N_mm2_std
    stds = dict(zip(error.pressures_kPa, zip(*columns, strict=True), strict=False))
    rows = []
    for cell in cells:
        B, GJ, *others = (float(np.interp(0.0, cell.moment, getattr(cell, name))) for name in IN_SPACE[:4])
        of_mesh = [
            "" if std is None else f"{100.0 * std / value:.2g} %"
            for std, value in zip(stds.get(cell.pressure, (None, None)), (B, GJ), strict=True)
        ]
        errors = f"{B:.4g}", of_mesh[0], f"{GJ:.4g}", of_mesh[1]
        rows.append((f"{cell.pressure:g}", *errors, *(f"{value:.4g}" for value in others)))
    heads = ("p (kPa)", "B₂ (N mm²)", "mesh ±", "GJ (N mm²)", "mesh ±", "GA across (N)", "twist axis (mm)")
    return Table(heads, tuple(rows), "out of the plane, without moment; the twist axis is above the axis of the rod")


def mesh_table(limit: MeshLimit) -> Table:
    """What accuracy costs: one row per mesh of the cell, with the numbers at the highest pressure."""
    rows = tuple(
        (f"{mesh.size_mm:.3g}", str(mesh.degrees_of_freedom), f"{100.0 * mesh.error:.2g} %", f"{mesh.seconds:.1f}")
        for mesh in limit.meshes
    )
    heads = ("mesh (mm)", "unknowns", "error", "CPU s")
    return Table(heads, rows, "error: of κ₀, rigidity and the moment that straightens the cell, the largest")


def _row(cell: CellCurve, of_mesh: tuple[str, str], seconds: float) -> tuple[str, ...]:
    rigidity, axial, shear = (
        float(np.interp(0.0, cell.moment, values))
        for values in (cell.rigidity, cell.axial_rigidity, cell.shear_rigidity)
    )
    return (
        f"{cell.pressure:g}",
        f"{cell.at(0.0)[0]:.5f}",
        of_mesh[0],
        f"{rigidity:.4g}",
        of_mesh[1],
        f"{axial:.3g}",
        f"{shear:.3g}",
        f"{cell.moment[0]:.3g} ... {cell.moment[-1]:.3g}",
        _contact(cell),
        str(len(cell.moment)),
        f"{seconds:.1f}",
    )


def _contact(cell: CellCurve) -> str:
    """The curvatures at which walls touch, in 1/mm."""
    if not cell.contact.any():
        return "nowhere"
    touching = cell.kappa[cell.contact]
    if cell.contact.all():
        return "everywhere"
    return f"{touching[0]:.4f}" if cell.contact[-1] else f"{touching[0]:.4f} ... {touching[-1]:.4f}"


def law_remarks(report: LawReport) -> Iterator[Reason]:
    """How the law was interpolated, which mesh was taken, and where it ends."""
    measured = report.measured
    values = {"half_cells": measured.half_cells, "along_percent": 100.0 * measured.error_along}
    yield Reason("law_interpolated", values | {"between_percent": 100.0 * (measured.error_between or 0.0)})
    if measured.limit is not None:
        yield from measured.limit.remarks
    yield from measured.limits
