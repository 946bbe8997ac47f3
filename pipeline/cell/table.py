"""The arm's own law in a table and in sentences."""

import numpy as np

from pipeline.cell.build import MeasuredLaw
from pipeline.cell.mesh_error import NUMBERS
from pipeline.cell.study import LawReport
from rod.arm_law.curves import CellCurve

#: heads of the table, two lines each
COLUMNS = (
    "p\nkPa",
    "κ₀\n1/mm",
    "dM/dκ\nN mm²",
    "EA\nN",
    "GA\nN",
    "moments\nN mm",
    "walls\ntouch from",
    "states",
    "s",
)


def cell_rows(measured: MeasuredLaw) -> list[tuple[str, ...]]:
    """One row per pressure: the cell without moment, its range of moments, and the work for the cell."""
    return [_row(cell, seconds) for cell, seconds in zip(measured.law.cells, measured.seconds_of_cells, strict=True)]


def _row(cell: CellCurve, seconds: float) -> tuple[str, ...]:
    rigidity, axial, shear = (
        float(np.interp(0.0, cell.moment, values))
        for values in (cell.rigidity, cell.axial_rigidity, cell.shear_rigidity)
    )
    return (
        f"{cell.pressure:g}",
        f"{cell.at(0.0)[0]:.5f}",
        f"{rigidity:.4g}",
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
    return f"{touching[0]:.4f} 1/mm" if cell.contact[-1] else f"{touching[0]:.4f} ... {touching[-1]:.4f} 1/mm"


def law_sentences(report: LawReport) -> list[str]:
    """How the law was interpolated, how far its mesh is off, and where it ends."""
    measured = report.measured
    error = measured.mesh_error
    cells = f"end pieces of {measured.half_cells} half {'cell' if measured.half_cells == 1 else 'cells'}"
    sentences = [
        "κ₀: curvature without moment; dM/dκ, EA, GA: rigidities there against bending, stretching and shear",
        f"{cells}; {len(measured.law.pressures)} pressures"
        + (
            f", of which {_list(measured.added_kPa)} kPa were added for the interpolation" if measured.added_kPa else ""
        ),
        f"interpolated curvature: within {100 * measured.error_along:.2g} % of the largest one along a curve, "
        + ("not checked" if measured.error_between is None else f"{100 * measured.error_between:.2g} %")
        + " between pressures",
    ]
    for i, pressure in enumerate(error.pressures_kPa):
        kappa_0, rigidity, moment = (error.deviations[name][i] for name in NUMBERS)
        rigidity /= error.values["rigidity_N_mm2"][i]
        sentences.append(
            f"standard deviations due to the mesh at {pressure:g} kPa: κ₀ {kappa_0:.2g} 1/mm, mean dM/dκ from "
            f"there on {100 * rigidity:.2g} %, M at κ₀/2 {moment:.2g} N mm"
        )
    if report.refined is not None:
        sentences.append(report.refined.sentence)
    sentences += [sentence for sentence in (error.reason, *measured.limits) if sentence]
    return sentences


def _list(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:g}" for value in values)
