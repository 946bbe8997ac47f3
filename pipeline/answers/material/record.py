"""The files of tensile tests: record, curves and page."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from pipeline.answers.material.judged import LawFit
from pipeline.answers.material.laws import STATES
from pipeline.answers.material.page import material_page
from pipeline.answers.material.sentences import yaml_line
from pipeline.answers.material.study import FitOptions, Material, fit_tests
from pipeline.store.owner import MATERIAL, claim
from pipeline.store.provenance import provenance
from pipeline.values.formats import FORMAT
from pipeline.values.json_values import JsonObject

CURVE_COLUMNS = ("law", "stretch", "nominal_stress_MPa", *(f"{state}_stress_MPa" for state in STATES), "holds")


def fit_material(paths: Sequence[Path], options: FitOptions, out: Path) -> Material:
    """Fit everything; `out` then holds material.json, material_curves.csv and material.html.

    Raises InputError, and RunFailed where no law has constants for the tests.
    """
    material = fit_tests(paths, options)
    store = claim(out, MATERIAL)
    store.save_json("material.json", _record(paths, material))
    store.save_rows("material_curves.csv", CURVE_COLUMNS, _curves(material))
    store.save_text("material.html", material_page(material))
    return material


def _record(paths: Sequence[Path], material: Material) -> JsonObject:
    """The content of material.json."""
    options, judged = material.options, material.judged
    return {
        "format": FORMAT,
        "files": [str(path) for path in paths],
        "tests": [
            {
                "test": t.name,
                "kind": t.state,
                "points": len(t.stretch),
                "strain": [t.strain[0], t.strain[-1]],
                "slack": t.slack,
            }
            for t in material.tests
        ],
        "requested": {name: str(v) if isinstance(v, Path) else v for name, v in asdict(options).items()},
        "hold": asdict(material.hold) if material.hold else None,
        "recommended": judged.laws[0].name if judged.usable and not material.kinds.words else None,
        "yaml": material.lines[0] if judged.usable and not material.kinds.words else None,
        "lines": material.lines,
        "sentences": material.words,
        "notes": list(material.notes),
        "laws": [_law_record(fit, options.density) for fit in material.kinds.together.laws],
        "laws_of_one_kind": {
            kind: [_law_record(fit, options.density) for fit in alone.laws]
            for kind, alone in material.kinds.alone.items()
        },
        "refused": judged.refused,
        **provenance(),
    }


def _law_record(fit: LawFit, density: str | None) -> JsonObject:
    return {
        "law": fit.name,
        "constants_MPa": dict(zip(fit.form.constants, fit.constants.tolist(), strict=True)),
        "shear_modulus_at_rest_MPa": fit.law.shear_modulus,
        "fitted_stretches": fit.fitted,
        "misfit": fit.misfit,
        "largest_misfit": fit.largest,
        "holds_between_stretches": fit.holds,
        "ends_by": fit.why,
        "yaml": yaml_line(fit, density) if fit.holds else None,
    }


def _curves(material: Material) -> list[tuple[str | float, ...]]:
    """Every law at the stretches of the tests: as the solver has it, and incompressible in each state."""
    rows: list[tuple[str | float, ...]] = []
    s = material.points.stretch
    for fit in material.judged.laws:
        states = [fit.law.incompressible(s, across(s)) for across in STATES.values()]
        low, high = fit.holds or (np.inf, -np.inf)
        table = np.column_stack([s, fit.law.uniaxial(s).nominal, *states])
        rows += [(fit.name, *row, str(low <= row[0] <= high).lower()) for row in table.tolist()]
    return rows
