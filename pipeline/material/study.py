"""From tensile tests to the constants of every law: read, fit, write."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from pipeline.material.figure import tensile_page
from pipeline.material.fits import FitOptions, Fits, fit_laws
from pipeline.material.law_fit import LawFit, Refused
from pipeline.material.moduli import PAPER, HighModulusCheck, check_high_modulus
from pipeline.material.sentences import caveats, moduli_sentences, yaml_block
from pipeline.material.tensile import read_tensile
from pipeline.store.formats import FORMAT
from pipeline.store.json_values import JsonObject
from pipeline.store.provenance import provenance
from pipeline.store.result_folder import open_folder

CURVE_COLUMNS = (
    *("law", "fitted_to", "stretch", "strain", "nominal_stress_MPa", "lateral_stretch", "J"),
    *("measured_nominal_stress_MPa", "holds"),
)


def fit_material(paths: Sequence[Path], options: FitOptions, out: Path) -> Fits:
    """Fit everything; `out` then holds material.json, material_curves.csv and material.html. Raises InputError."""
    fits = fit_laws(read_tensile(paths), options)
    store = open_folder(out)
    store.save_json("material.json", _record(paths, fits))
    store.save_rows("material_curves.csv", CURVE_COLUMNS, _curve_rows(fits))
    store.save_text("material.html", tensile_page(fits))
    return fits


def _record(paths: Sequence[Path], fits: Fits) -> JsonObject:
    """The content of material.json."""
    measured = check_high_modulus(fits.moduli.low, fits.moduli.high, fits.options.nu)
    return {
        "format": FORMAT,
        "files": [str(path) for path in paths],
        "tests": [
            {"test": test.name, "points": len(test.stretch), "strain": [test.strain[0], test.strain[-1]]}
            for test in fits.tests
        ],
        "requested": asdict(fits.options),
        "moduli": fits.moduli.record(),
        "choice_of_E_H": {"these_data": _check_record(measured), "paper": _check_record(check_high_modulus(*PAPER))},
        "laws": [
            {"law": law, "fitted_to": name, **_fit_record(fit, fits.options.density)}
            for law, both in fits.laws.items()
            for name, fit in both.items()
        ],
        "notes": list(fits.notes),
        "sentences": [*moduli_sentences(fits), *caveats(fits)],
        **provenance(),
    }


def _check_record(check: HighModulusCheck | None) -> dict[str, float] | None:
    if check is None:
        return None
    return {
        "stretch": check.stretch,
        "line_MPa": check.line,
        "svk_MPa": check.svk,
        "svk_over_line": check.svk / check.line,
        "hencky_MPa": check.hencky,
        "hencky_over_line": check.hencky / check.line,
    }


def _fit_record(fit: LawFit | Refused, density: str | None) -> JsonObject:
    if isinstance(fit, Refused):
        return {"reason": fit.reason}
    return {
        "constants_MPa": fit.constants,
        "standard_errors_MPa": fit.errors,
        "errors_by_tests": fit.by_tests,
        "shear_modulus_at_rest_MPa": fit.solved.shear_modulus,
        "points": fit.points,
        "fitted_stretches": fit.fitted_range,
        "rms_MPa": fit.rms,
        "rms_as_solved_MPa": fit.rms_solved,
        "holds_between_stretches": fit.valid_range,
        "ends_by": fit.limited_by,
        "stretch_limits": fit.solved.stretch_limits,
        "yaml": yaml_block(fit, density),
        "reason": "",
    }


def _curve_rows(fits: Fits) -> list[tuple[str | float, ...]]:
    """Every fitted law, as the solver has it, at the nodes of the measured curve."""
    rows: list[tuple[str | float, ...]] = []
    for law, both in fits.laws.items():
        for name, fit in both.items():
            if isinstance(fit, Refused):
                continue
            bar = fit.solved.uniaxial(fits.curve.nodes)
            low, high = fit.valid_range or (np.inf, -np.inf)
            valid = (bar.stretch >= low) & (bar.stretch <= high)
            table = np.column_stack([bar.stretch, bar.stretch - 1, bar.nominal, bar.lateral, bar.J, fits.curve.mean])
            rows += [
                (law, name, *values, str(inside).lower())
                for values, inside in zip(table.tolist(), valid.tolist(), strict=True)
            ]
    return rows
