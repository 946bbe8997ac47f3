"""The page of tensile tests: which law to take, tests and laws in a picture, all laws in a table."""

from collections.abc import Iterator

import numpy as np

from pipeline.answers.material.laws import STATES, nominal
from pipeline.answers.material.sentences import constants, stretches, yaml_line
from pipeline.answers.material.study import Material
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
    """An HTML page: the recommendation, the picture, the table."""
    usable = material.judged.usable
    others = "\n".join(yaml_line(fit, material.options.density) for fit in usable[1:])
    return page(
        "Tensile tests and laws",
        Section(sentences=material.words, code=material.line if usable else "", panels=_panels(material)),
        Section("All laws", table=law_table(material)),
        *([Section("Other laws", code=others)] if others else []),
        *([Section("Notes", notes=material.notes)] if material.notes else []),
    )


def law_table(material: Material) -> Table:
    """All laws, the one to take first."""
    at = min([material.options.need.high, *(fit.holds[1] for fit in material.judged.usable[:1] if fit.holds)])
    s = np.array([at])
    rows = [
        (
            fit.name,
            constants(fit),
            f"{100 * fit.misfit:.2g} %",
            stretches(fit),
            f"{nominal(fit.law, s, s)[0]:.3g}",
            fit.why,
        )
        for fit in material.judged.laws
    ]
    rows += [(name, "", "", "-", "", why) for name, why in material.judged.refused.items()]
    heads = ("law", "constants (MPa)", "misfit", "stretches", f"biaxial at {at:.3g} (MPa)", "ends by")
    return Table(heads, tuple(rows))


def _panels(material: Material) -> tuple[Panel, ...]:
    """The start of the tests with the tangent of the slack, all strains, and two directions."""
    points, best = material.points, material.judged.laws[0]
    high = max(2.0, float(points.stretch[-1]))
    drawn = (*_tests(material), *_laws(material, "uniaxial", min(points.stretch[0], 1.0), high))
    far = max(FAR * material.options.need.reach, *(fit.holds[1] for fit in material.judged.laws if fit.holds), 1.0)
    ends = float(points.stretch[0]), min(float(points.stretch[-1]), far)
    wide = min(high, material.options.need.high)
    top = float(nominal(best.law, np.array([wide]), np.array([wide]))[0])
    biaxial = tuple(_laws(material, "equibiaxial", 1.0, wide))
    return (
        _limited(material, "Start of the tests", drawn, (1 - 0.1 * START, 1 + START)),
        _limited(material, "All strains", drawn, ends),
        Panel("Pulled in two directions: not measured", STRETCH, STRESS, biaxial, y_range=(0.0, 2 * top)),
    )


def _tests(material: Material) -> Iterator[Line]:
    for test in material.tests:
        for (s, stress), name, marker in (
            ((test.stretch, test.stress), "tests", "circle"),
            (test.left_out, "left out", "x"),
        ):
            if len(s):
                thin = slice(None, None, len(s) // MOST_POINTS + 1)
                yield Line(s[thin], stress[thin], name, GREY, "", marker, marker_size=4.0)
        if test.slack:
            tangent = material.judged.laws[0].law.young_modulus * np.array([0.0, 0.15])
            yield Line([1.0, 1.15], tangent, "tangent after the slack", INK, "dash", width=1.2)
            yield Line([1 - test.slack] * 2, [0.0, float(test.stress.max())], "start of the test", GREY, width=1.0)


def _laws(material: Material, state: str, low: float, high: float) -> Iterator[Line]:
    """Solid within the range of a law, dotted outside."""
    s = np.geomspace(low, high, POINTS_OF_A_LINE)
    for number, fit in enumerate(material.judged.laws):
        stress = fit.law.uniaxial(s).nominal if state == "uniaxial" else nominal(fit.law, s, STATES[state](s))
        least, most = fit.holds or (1.0, 1.0)
        inside = (s >= least) & (s <= most)
        colour, width = COLOURS[number % len(COLOURS)], 1.4 if number else 2.6
        yield Line(s, np.where(inside, stress, np.nan), fit.name, colour, width=width)
        yield Line(s, np.where(inside, np.nan, stress), fit.name, colour, "dot", width=1.0)


def _limited(material: Material, title: str, lines: tuple[Line, ...], ends: tuple[float, float]) -> Panel:
    """Axes that end where measured points end, though laws go on."""
    points, (low, high) = material.points, ends
    shown = points.stress[(points.stretch >= low) & (points.stretch <= high)]
    top, bottom = max(0.0, *shown.tolist()), min(0.0, *shown.tolist())
    margin = 0.05 * (top - bottom)
    ranges = (min(low, 0.97), high), (bottom - margin, top + margin)
    return Panel(title, STRETCH, STRESS, lines, x_range=ranges[0], y_range=ranges[1])
