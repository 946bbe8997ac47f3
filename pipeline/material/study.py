"""From tensile tests to the constants of every law: read, fit, write."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import fem
from pipeline.material.figure import tensile_page
from pipeline.material.fits import Asked, Fits, fitted
from pipeline.material.law_fit import LawFit, Refused
from pipeline.material.moduli import PAPER, Choice, choice
from pipeline.material.sentences import about_moduli, block, sentences
from pipeline.material.tensile import read_tensile
from pipeline.store.provenance import provenance
from pipeline.store.store import open_folder

CURVE_COLUMNS = (
    *("law", "fitted_to", "stretch", "strain", "nominal_stress_MPa", "lateral_stretch", "J"),
    *("measured_nominal_stress_MPa", "holds"),
)


def fit_material(paths: Sequence[Path], asked: Asked, out: Path) -> Fits:
    """Fit everything; `out` then holds material.json, material_curves.csv and material.html. Raises InputError."""
    fits = fitted(read_tensile(paths), asked)
    store = open_folder(out)
    store.save_json("material.json", _record(paths, fits))
    store.save_rows("material_curves.csv", CURVE_COLUMNS, _curve_rows(fits))
    store.save_text("material.html", tensile_page(fits))
    return fits


def _record(paths: Sequence[Path], fits: Fits) -> dict[str, Any]:
    return {
        "files": [str(path) for path in paths],
        "tests": [
            {"test": test.name, "points": len(test.stretch), "strain": [test.strain[0], test.strain[-1]]}
            for test in fits.tests
        ],
        "asked": asdict(fits.asked),
        "moduli": fits.moduli.record(),
        "choice_of_E_H": {
            "these_data": _choice_record(choice(fits.moduli.low, fits.moduli.high, fits.asked.nu)),
            "paper": _choice_record(choice(*PAPER)),
        },
        "laws": [
            {"law": law, "fitted_to": name, **_fit_record(fit, fits.asked.density)}
            for law, both in fits.laws.items()
            for name, fit in both.items()
        ],
        "sentences": [*about_moduli(fits), *sentences(fits)],
        **provenance(),
    }


def _choice_record(at: Choice | None) -> dict[str, float] | None:
    if at is None:
        return None
    return {
        "stretch": at.stretch,
        "line_MPa": at.line,
        "svk_MPa": at.svk,
        "svk_over_line": at.svk / at.line,
        "hencky_MPa": at.hencky,
        "hencky_over_line": at.hencky / at.line,
    }


def _fit_record(fit: LawFit | Refused, density: str) -> dict[str, Any]:
    if isinstance(fit, Refused):
        return {"reason": fit.reason}
    return {
        "constants_MPa": fit.constants,
        "standard_errors_MPa": fit.errors,
        "errors_by_tests": fit.by_tests,
        "shear_modulus_at_rest_MPa": fit.solved.shear_modulus,
        "points": fit.points,
        "fitted_stretches": fit.fitted,
        "rms_MPa": fit.rms,
        "rms_as_solved_MPa": fit.rms_solved,
        "holds_between_stretches": fit.holds,
        "ends_by": fit.ends,
        "stretch_limits": fit.solved.stretch_limits,
        "yaml": block(fit, density),
        "reason": "",
    }


def _curve_rows(fits: Fits) -> list[tuple[Any, ...]]:
    """Every fitted law, as the solver has it, at the nodes of the measured curve."""
    rows = []
    for law, both in fits.laws.items():
        for name, fit in both.items():
            if isinstance(fit, Refused):
                continue
            bar = fem.uniaxial(fit.solved, fits.curve.nodes)
            low, high = fit.holds or (np.inf, -np.inf)
            held = (bar.stretch >= low) & (bar.stretch <= high)
            table = np.column_stack([bar.stretch, bar.stretch - 1, bar.nominal, bar.lateral, bar.J, fits.curve.mean])
            rows += [
                (law, name, *values, str(inside).lower())
                for values, inside in zip(table.tolist(), held.tolist(), strict=True)
            ]
    return rows
