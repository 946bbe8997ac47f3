"""The report: one HTML file that opens offline, made from the result files of a run alone."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jinja2

from pipeline.plots import Figure, plotly_script
from pipeline.report import figures
from pipeline.report.law_figure import arm_law
from pipeline.report.numbers import (
    NUMBERS,
    eccentricity,
    estimators,
    linear_range,
    mesh_error,
    observations,
    stretch_of_rod,
    with_spread,
)
from pipeline.report.results import Results, read_results
from pipeline.report.sentences import (
    agreement_of_rod,
    difference_of_rest_curvatures,
    lines_needed,
    number,
    opening,
    remarks,
    time_of_factorization,
)
from pipeline.report.validation import (
    beyond_identified,
    law_rows,
    out_of_sample,
    rod_table,
    rod_to_take,
    simplest_laws,
    validation_rows,
)

_EXPERIMENT_COLUMNS = (
    ("experiment", ""),
    ("pressure_kPa", "p (kPa)"),
    ("end_x_mm", "end x (mm)"),
    ("end_y_mm", "end y (mm)"),
    ("reaction_N", "reaction (N)"),
    ("stretch_of_curve", "stretch of curve"),
    ("min_stretch", "smallest stretch"),
    ("max_stretch", "largest stretch"),
    ("min_J", "smallest J"),
    ("min_gap_mm", "smallest gap (mm)"),
    ("newton_iterations", "Newton iterations"),
    ("factorizations", "factorizations"),
    ("seconds", "seconds"),
    ("status", "status"),
)
_SOLVER_PARTS = {
    "set_up": "set-up",
    "assembly": "assembly",
    "contact": "contact",
    "analysis": "symbolic analysis",
    "factorization": "numeric factorization",
    "solve": "triangular solves",
}


@dataclass(frozen=True)
class _Picture:
    title: str
    data: str  #: PNG, base64


def render_report(directory: Path) -> str:
    """The report on the result files in `directory`, as HTML. It names the files that are missing."""
    results = read_results(directory)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=jinja2.ChainableUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("report.html.j2").render(
        name=results.run.get("config", {}).get("name", directory.name),
        opening=opening(results),
        failures=results.failures,
        **_identification(results),
        **_validation(results),
        body=[_picture(results, name, title) for name, title in _BODY if name in results.pictures],
        deformed=_deformed(results),
        figures=_figures(results),
        rest_curvatures=difference_of_rest_curvatures(results),
        experiment_titles=[title for _, title in _EXPERIMENT_COLUMNS],
        experiments=[[_cell(getattr(row, name)) for name, _ in _EXPERIMENT_COLUMNS] for row in results.experiments],
        stages=results.run.get("seconds", {}),
        factorization=time_of_factorization(results),
        effects=results.effects,
        remarks=remarks(results),
        run=results.run,
        number=number,
        plotly=plotly_script(),
    )


def _identification(results: Results) -> dict[str, object]:
    """What the template needs about the five parameters."""
    return {
        "five": _five_numbers(results),
        "betas": _betas(results),
        "lines": lines_needed(results),
        "linear_range": linear_range(results),
        "estimators": estimators(results),
        "observations": observations(results),
        "mesh_error": mesh_error(results),
        "eccentricity": eccentricity(results),
        "stretch_of_rod": stretch_of_rod(results),
    }


def _validation(results: Results) -> dict[str, object]:
    """What the template needs about the rod against the finite elements."""
    return {
        "agreement": [*agreement_of_rod(results), *out_of_sample(results)],
        "rod_to_take": rod_to_take(results),
        "rods": rod_table(results),
        "validation": validation_rows(results),
        "beyond": beyond_identified(results),
        "laws": law_rows(results),
        "simplest_laws": simplest_laws(results),
    }


_BODY = (("body", "at rest"), ("body_open", "cut open at z = 0"))


def _five_numbers(results: Results) -> list[list[str]]:
    rows = []
    for pressure in results.identified_pressures:
        cells = [f"{pressure:g}"]
        for key, _, _ in NUMBERS:
            cells.append(_with_spread(results.at(key, pressure), results.at(f"{key}_std", pressure)))
        if results.at("d_is_at_most", pressure):
            cells[-1] = f"at most {number(results.at('d_mm', pressure))}"
        d = results.at("d_mm", pressure)
        cells.append("" if d is None else f"{d / results.length:.3f}")
        rows.append(cells)
    return rows


def _betas(results: Results) -> list[str]:
    sentences = []
    for which, symbol in ((1, "β₁"), (2, "β₂")):
        key = f"beta{which}_N_mm2_per_kPa"
        if results.parameters.get(key) is not None:
            spread = results.parameters.get(f"{key}_std")
            sentences.append(f"{symbol} = {_with_spread(results.parameters[key], spread)} N mm²/kPa")
    return sentences


def _figures(results: Results) -> dict[str, str]:
    """The figures that have data, as HTML."""
    drawn: dict[str, Figure] = {}
    if any(curve.experiment in ("II", "III") for curve in results.curves):
        drawn["shapes"] = figures.shapes(results)
    if results.curves:
        drawn["curvatures"] = figures.curvatures(results)
    if any(curve.experiment == "III" for curve in results.curves):
        drawn["moments"] = figures.moments(results)
    if results.validation_curves:
        drawn["validation"] = figures.validation_shapes(results)
    if any(row.force_N is not None for row in results.validation):
        drawn["forces"] = figures.end_forces(results)
    if results.arm_law:
        drawn["arm_law"] = arm_law(results)
    if results.parameters.get("alpha1_N_mm2"):
        drawn["alphas"] = figures.alphas_over_pressure(results)
    parts = results.run.get("solver_seconds") or {}
    if parts:
        drawn["times"] = figures.times([(title, parts[key]) for key, title in _SOLVER_PARTS.items() if key in parts])
    options = {"displaylogo": False, "responsive": True, "modeBarButtonsToRemove": ["select2d", "lasso2d"]}
    return {
        name: figure.to_html(full_html=False, include_plotlyjs=False, config=options, div_id=f"figure-{name}")
        for name, figure in drawn.items()
    }


def _deformed(results: Results) -> list[tuple[str, list[_Picture]]]:
    """The pictures of I, II and III by pressure."""
    rows = []
    for pressure in results.pressures:
        names = [(f"{experiment}_{pressure:g}kPa", experiment) for experiment in ("I", "II", "III")]
        pictures = [_picture(results, name, title) for name, title in names if name in results.pictures]
        if pictures:
            rows.append((f"{pressure:g} kPa", pictures))
    return rows


def _picture(results: Results, name: str, title: str) -> _Picture:
    return _Picture(title, base64.b64encode(results.pictures[name].read_bytes()).decode())


def _with_spread(value: float | None, spread: float | None) -> str:
    return with_spread(value, spread, number(value))


def _cell(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(_cell(item) for item in value)
    if isinstance(value, float):
        return number(value)
    return str(value)
