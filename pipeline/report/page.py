"""The report: one HTML file that opens offline, made from the result files of a run alone."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jinja2

from pipeline.report import figures
from pipeline.report.body_view import body_view
from pipeline.report.formatting import number, percent, seconds
from pipeline.report.law_figure import arm_law
from pipeline.report.law_range import moments_table
from pipeline.report.numbers import eccentricity, estimators, linear_range, observations, slopes, stretch_of_rod
from pipeline.report.results import Results, read_results
from pipeline.report.sentences import (
    difference_of_rest_curvatures,
    left_out,
    lines_needed,
    not_identified,
    opening,
    remarks,
    third_experiment,
    time_of_factorization,
)
from pipeline.report.validation import beyond_identified, rod_table, under_all_loads, validation_rows
from pipeline.report.verdict import verdict_of

#: what the page is made of
TEMPLATES = Path(__file__).parent / "templates"
_EXPERIMENT_COLUMNS = (
    ("experiment", "experiment"),
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
_EXPERIMENTS = {
    "I": "Experiment I: free under pressure",
    "II": "Experiment II: clamped, under pressure",
    "III": "Experiment III: clamped, under pressure",
}
#: colours of a field on the body, from its smallest to its largest value
_RAMP = ("#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725")


@dataclass(frozen=True)
class _Picture:
    title: str
    data: str  #: PNG, base64


def render_report(directory: Path) -> str:
    """The report on the result files in `directory`, as HTML. It names what a failed run did not reach."""
    results = read_results(directory)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=jinja2.ChainableUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("report.html.j2").render(
        opening=opening(results),
        verdict=verdict_of(results),
        not_identified=not_identified(results),
        **_body(results),
        **_identification(results),
        **_validation(results),
        tests=[(name, title, figure) for name, title in _titles(results).items()
               if (figure := figures.of_experiment(results, name))],
        third=third_experiment(results),
        figures={
            "moments": figures.moments(results),
            "rigidities": figures.rigidities(results),
            "validation": figures.validation_shapes(results),
            "forces": figures.end_forces(results),
            "arm_law": arm_law(results),
        },
        rest_curvatures=difference_of_rest_curvatures(results),
        left_out=left_out(results),
        start_y=_start_y(results),
        experiment_titles=[title for _, title in _EXPERIMENT_COLUMNS],
        experiments=[[_cell(getattr(row, name)) for name, _ in _EXPERIMENT_COLUMNS] for row in results.experiments],
        effects=results.effects,
        remarks=remarks(results),
        **_cost(results),
        run=results.run,
        number=number,
        percent=percent,
        seconds=seconds,
    )  # fmt: skip


#: pictures of the body -> what is under them
_AT_REST = {"body": "At rest, the clamp on the left", "body_open": "At rest, cut open at z = 0"}


def _titles(results: Results) -> dict[str, str]:
    """The experiments by name, the third one with what its end has."""
    return {**_EXPERIMENTS, "III": f"{_EXPERIMENTS['III']}, {third_experiment(results)}"}


def _body(results: Results) -> dict[str, object]:
    """What the template needs about the body at rest and deformed."""
    view = body_view(results.directory)
    states: Any = view.get("states", ())
    return {
        "body": _pictures(results, _AT_REST),
        "dimensions": _dimensions(results.run),
        "view": {name: _plain(value) for name, value in view.items()},
        "view_experiments": sorted({state["experiment"] for state in states}),
        "ramp": [[int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)] for colour in _RAMP],
        "gradient": ", ".join(_RAMP),
        "deformed": _pictures(results, _at_highest_pressure(results)),
    }


def _at_highest_pressure(results: Results) -> dict[str, str]:
    """The pictures of every experiment at the highest pressure that it reached, and what is under them."""
    rows = sorted(results.experiments, key=lambda row: row.pressure_kPa)
    reached = {row.experiment: row.pressure_kPa for row in rows if row.reached}
    highest = {name: f"{reached[name]:g}" for name in _EXPERIMENTS if name in reached}
    return {f"{name}_{pressure}kPa": f"Experiment {name}, {pressure} kPa" for name, pressure in highest.items()}


def _identification(results: Results) -> dict[str, object]:
    """What the template needs about the five parameters."""
    return {
        "cell_mm": results.cell_mm,
        "betas": slopes(results),
        "lines": lines_needed(results),
        "linear_range": linear_range(results),
        "estimators": estimators(results),
        "observations": observations(results),
        "eccentricity": eccentricity(results),
        "stretch_of_rod": stretch_of_rod(results),
    }


def _validation(results: Results) -> dict[str, object]:
    """What the template needs about the rods against the finite elements."""
    return {
        "agreement": under_all_loads(results),
        "rods": rod_table(results),
        "validation": validation_rows(results),
        "beyond": beyond_identified(results),
        "moments_of_law": moments_table(results),
    }


def _cost(results: Results) -> dict[str, object]:
    """What the template needs about computing time."""
    parts = results.run.get("solver_seconds") or {}
    return {
        "stages": results.run.get("seconds", {}),
        "solver_parts": [(title, parts[key]) for key, title in _SOLVER_PARTS.items() if key in parts],
        "factorization": time_of_factorization(results),
    }


def _dimensions(run: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Rows of the table of the design: name and value with its unit."""
    config = run.get("config") or {}
    geometry, material, mesh = (config.get(name) or {} for name in ("geometry", "material", "mesh"))
    rows = [(name, value) for name, value in geometry.items() if not isinstance(value, float)]
    lengths = [f"{name.replace('_', ' ')} {number(v)}" for name, v in geometry.items() if isinstance(v, float)]
    rows += [("dimensions (mm)", ", ".join(lengths))] if lengths else []
    rows += [("material", _law(material))] if material else []
    rows += [(f"material of {name}", _law(other)) for name, other in (config.get("materials") or {}).items()]
    unknowns = max((run.get("degrees_of_freedom") or {"": 0}).values())
    size = f"{number(mesh['size_mm'])} mm, " if isinstance(mesh.get("size_mm"), float) else ""
    rows += [("mesh", f"{size}elements {mesh.get('formulation')}, {unknowns} unknowns")] if mesh else []
    return [(name, str(value)) for name, value in rows if value is not None]


def _law(material: Mapping[str, Any]) -> str:
    """A law with its constants."""
    others = ("density_tonne_mm3", "holds_between")
    constants = [
        f"{name} = {_cell(v)}" for name, v in material.items() if isinstance(v, float | list) and name not in others
    ]
    pure = [name for name in ("nu", "alpha") if name in material]
    units = f"MPa; {' and '.join(pure)} without unit" if pure else "MPa"
    bulk = "; kappa is the bulk modulus" if "kappa" in material else ""
    stretches = material.get("holds_between")
    holds = (
        f"; it holds, according to the configuration, from stretch {stretches[0]:g} to {stretches[1]:g}"
        if stretches
        else ""
    )
    return f"law {material.get('law')}, {', '.join(constants)} ({units}{bulk}){holds}"


def _pictures(results: Results, titles: Mapping[str, str]) -> list[_Picture]:
    """The pictures of these names that there are."""
    there = {name: title for name, title in titles.items() if name in results.pictures}
    return [
        _Picture(title, base64.b64encode(results.pictures[name].read_bytes()).decode()) for name, title in there.items()
    ]


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def _start_y(results: Results) -> float | None:
    """Height of the clamped end of the material curve, mm; None where no clamped state was reached."""
    clamped = next((curve for curve in results.curves if curve.experiment in ("II", "III")), None)
    return None if clamped is None else float(clamped["y_mm"][0])


def _cell(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(_cell(item) for item in value)
    if isinstance(value, float):
        return number(value)
    return str(value)
