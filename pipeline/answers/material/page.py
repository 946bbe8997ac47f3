"""The files of tensile tests: record, curves, and the page with the law to take, pictures and tables."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from pipeline.answers.material.hold import Hold
from pipeline.answers.material.judged import Judged, LawFit, Need
from pipeline.answers.material.kinds import of_kind
from pipeline.answers.material.laws import STATES, Points
from pipeline.answers.material.sentences import constants, stretches, yaml_line
from pipeline.answers.material.study import FitOptions, Material, fit_tests
from pipeline.store.owner import MATERIAL, claim
from pipeline.store.provenance import provenance
from pipeline.values.formats import FORMAT
from pipeline.values.json_values import JsonObject
from pipeline.values.page import Section, page
from pipeline.values.plots import COLOURS, GREY, INK, Line, Panel
from pipeline.values.table import Table

#: measured points that are drawn of each test at most, and points of a line
MOST_POINTS, POINTS_OF_A_LINE = 400, 200
#: over the stretch of the tests that laws are fitted to: the largest one that is drawn
FAR = 1.3
#: strain up to which the start of the tests is drawn
START = 0.5
STRETCH, STRESS = "stretch", "nominal stress (MPa)"


def material_page(material: Material) -> str:
    """An HTML page: the recommendation, the picture, the tables."""
    taken, options = material.kinds.taken, material.options
    lines = [yaml_line(fit, options.density) for judged in taken.values() for fit in judged.usable[1:]]
    kinds = material.kinds.table
    return page(
        "Tests and laws",
        Section(sentences=material.words, code="\n".join(material.lines), panels=_panels(material)),
        *(
            Section(
                "All laws" if len(taken) == 1 else f"Laws of the {kind} test", table=law_table(judged, options.need)
            )
            for kind, judged in taken.items()
        ),
        *([Section("Kinds of tests", table=kinds)] if kinds else []),
        *([Section("Over time", panels=[_held(material.hold)])] if material.hold else []),
        *([Section("Other laws", code="\n".join(lines))] if lines else []),
        *([Section("Notes", notes=material.notes)] if material.notes else []),
    )


def law_table(judged: Judged, need: Need) -> Table:
    """All laws, the one to take first."""
    at = min([need.high, *(fit.high for fit in judged.usable[:1])])
    s = np.array([at])
    rows = [
        (
            fit.name,
            constants(fit),
            f"{100 * fit.misfit:.2g} %",
            stretches(fit),
            f"{fit.law.incompressible(s, s)[0]:.3g}",
            fit.why,
        )
        for fit in judged.laws
    ]
    rows += [(name, "", "", "-", "", why) for name, why in judged.refused.items()]
    heads = ("law", "constants (MPa)", "misfit", "stretches", f"biaxial at {at:.3g} (MPa)", "ends by")
    return Table(heads, tuple(rows))


def _panels(material: Material) -> tuple[Panel, ...]:
    """The start of the tests with the tangent of the slack, all strains of each kind, and two directions."""
    best, need = material.judged.laws[0], material.options.need
    found: list[Panel] = []
    for state in dict.fromkeys(test.state for test in material.tests):
        points = Points.of(of_kind(material.tests, state))
        low, high = min(float(points.stretch[0]), 1.0), max(2.0, float(points.stretch[-1]))
        drawn = (*_tests(material, state), *_laws(material, state, low, high))
        far = max(FAR * need.reach, *(fit.high for _, fit in _fits(material)), 1.0)
        ends = float(points.stretch[0]), min(float(points.stretch[-1]), far)
        found += [] if found else [_limited(points, "Start of the tests", drawn, (1 - 0.1 * START, 1 + START))]
        found.append(_limited(points, "All strains" if state == "uniaxial" else f"All strains, {state}", drawn, ends))
    if not any(test.state == "equibiaxial" for test in material.tests):
        wide = min(max(2.0, float(material.points.stretch[-1])), need.high)
        top = float(best.law.incompressible(np.array([wide]), np.array([wide]))[0])
        biaxial = tuple(_laws(material, "equibiaxial", 1.0, wide))
        title = "Pulled in two directions: not measured"
        found.append(Panel(title, STRETCH, STRESS, biaxial, y_range=(0.0, 2 * top)))
    return tuple(found)


def _held(hold: Hold) -> Panel:
    """What was read, what branches make of it, and where each branch stands with its part."""
    at, read, made = hold.drawn[hold.drawn[:, 0] > 0.0].T
    times = np.array(hold.tau_s)
    title, x, y = "A stretch or a load that is held", "t (s)", "over that at long times"
    if hold.loss:
        title, x, y, times = "Vibrations", "frequency (Hz)", "loss factor", 1.0 / (2.0 * np.pi * times)
    parts = [f"g {g:.3g}, tau {tau:.3g} s" for g, tau in zip(hold.g, hold.tau_s, strict=True)]
    order = np.argsort(at)
    lines = (
        Line(at, read, "measured", GREY, "", "circle", marker_size=4.0),
        Line(at[order], made[order], "branches together", COLOURS[0]),
        Line(times, np.interp(times, at[order], made[order]), "a branch", INK, "", "square", texts=parts),
    )
    return Panel(title, x, y, lines, log_x=True)


def _fits(material: Material) -> list[tuple[str, LawFit]]:
    """The laws that are drawn with their names: all, or the first one of each kind of test."""
    if not material.kinds.words:
        return [(fit.name, fit) for fit in material.judged.laws]
    return [(f"{judged.laws[0].name}, {kind}", judged.laws[0]) for kind, judged in material.kinds.taken.items()]


def _tests(material: Material, state: str) -> Iterator[Line]:
    for test in of_kind(material.tests, state):
        for (s, stress), name, marker in (
            ((test.stretch, test.stress), "tests", "circle"),
            (test.left_out, "left out", "x"),
        ):
            if len(s):
                thin = slice(None, None, len(s) // MOST_POINTS + 1)
                yield Line(s[thin], stress[thin], name, GREY, "", marker, marker_size=4.0)
        if test.slack and state == "uniaxial":
            tangent = material.judged.laws[0].law.young_modulus * np.array([0.0, 0.15])
            yield Line([1.0, 1.15], tangent, "tangent after the slack", INK, "dash", width=1.2)
            yield Line([1 - test.slack] * 2, [0.0, float(test.stress.max())], "start of the test", GREY, width=1.0)


def _laws(material: Material, state: str, low: float, high: float) -> Iterator[Line]:
    """Solid within the range of a law, dotted outside."""
    s = np.geomspace(low, high, POINTS_OF_A_LINE)
    for number, (name, fit) in enumerate(_fits(material)):
        stress = fit.law.uniaxial(s).nominal if state == "uniaxial" else fit.law.incompressible(s, STATES[state](s))
        least, most = fit.holds or (1.0, 1.0)
        inside = (s >= least) & (s <= most)
        colour, width = COLOURS[number % len(COLOURS)], 1.4 if number else 2.6
        yield Line(s, np.where(inside, stress, np.nan), name, colour, width=width)
        yield Line(s, np.where(inside, np.nan, stress), name, colour, "dot", width=1.0)


def _limited(points: Points, title: str, lines: tuple[Line, ...], ends: tuple[float, float]) -> Panel:
    """Axes that end where measured points end, though laws go on."""
    low, high = ends
    shown = points.stress[(points.stretch >= low) & (points.stretch <= high)]
    top, bottom = max(0.0, *shown.tolist()), min(0.0, *shown.tolist())
    margin = 0.05 * (top - bottom)
    ranges = (min(low, 0.97), high), (bottom - margin, top + margin)
    return Panel(title, STRETCH, STRESS, lines, x_range=ranges[0], y_range=ranges[1])


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
