"""The page of tensile tests: which law to take, tests and laws in a picture, all laws in a table. It opens offline."""

import io
from html import escape
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.answers.material.laws import STATES, nominal
from pipeline.answers.material.sentences import constants, stretches, yaml_line
from pipeline.answers.material.study import Material
from pipeline.values.plots import COLOURS

#: measured points that are drawn of each test at most, and points of a line
MOST_POINTS, POINTS_OF_A_LINE = 400, 200
#: over the stretch of the tests that laws are fitted to: the largest one that is drawn
FAR = 1.3
#: strain up to which the start of the tests is drawn
START = 0.5
STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:64rem;margin:2rem auto;padding:0 1rem}"
    "table{border-collapse:collapse}td,th{padding:.2rem .8rem .2rem 0;text-align:left;vertical-align:top}"
    "pre{overflow-x:auto;background:#f3f3f3;padding:.6rem}svg{max-width:100%;height:auto}"
)


def material_page(material: Material) -> str:
    """An HTML page: the recommendation, the picture, the table."""
    words = "".join(f"<p>{escape(sentence)}</p>" for sentence in material.words)
    line = f"<pre>{escape(material.line)}</pre>" if material.judged.usable else ""
    notes = "".join(f"<li>{escape(note)}</li>" for note in material.notes)
    lines = [yaml_line(fit, material.options.density) for fit in material.judged.usable[1:]]
    others = f"<h2>Other laws</h2><pre>{escape(chr(10).join(lines))}</pre>" if lines else ""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Tensile tests and laws</title>'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{STYLE}</style></head><body>'
        f"<h1>Tensile tests and laws</h1>{words}{line}{_picture(material)}{_table(material)}{others}"
        f"{'<h2>Notes</h2><ul>' + notes + '</ul>' if notes else ''}</body></html>\n"
    )


def law_rows(material: Material) -> list[tuple[str, ...]]:
    """The laws as a table: heads, then one row each."""
    at = min([material.options.need.high, *(fit.holds[1] for fit in material.judged.usable[:1] if fit.holds)])
    s = np.array([at])
    rows: list[tuple[str, ...]] = [("law", "constants (MPa)", "misfit", "stretches", f"biaxial at {at:.3g}", "ends by")]
    for fit in material.judged.laws:
        misfit = f"{100 * fit.misfit:.2g} %"
        biaxial = f"{nominal(fit.law, s, s)[0]:.3g} MPa"
        rows.append((fit.name, constants(fit), misfit, stretches(fit), biaxial, fit.why))
    rows += [(name, "", "", "-", "", why) for name, why in material.judged.refused.items()]
    return rows


def _table(material: Material) -> str:
    head, *rows = law_rows(material)
    cells = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
    heads = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    return f"<h2>All laws</h2><table><tr>{heads}</tr>{''.join(f'<tr>{row}</tr>' for row in cells)}</table>"


def _picture(material: Material) -> str:
    """SVG: the start of the tests with the tangent of the slack, all strains, and two directions."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "pneurod", "font.size": 9}):
        figure = Figure(figsize=(12, 4), layout="constrained")
        start, whole, biaxial = figure.subplots(1, 3)
        high = max(2.0, float(material.points.stretch[-1]))
        near = (1 - 0.1 * START, 1 + START)
        for axes, title, ends in ((start, "start of the tests", near), (whole, "all strains", None)):
            _draw_tests(axes, material)
            _draw_laws(axes, material, "uniaxial", min(material.points.stretch[0], 1.0), high)
            _limit(axes, material, title, ends)
        _draw_laws(biaxial, material, "equibiaxial", 1.0, min(high, material.options.need.high))
        biaxial.set(title="pulled in two directions: not measured", xlabel="stretch", ylabel="nominal stress (MPa)")
        start.legend(fontsize=7)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    return text.getvalue()[text.getvalue().index("<svg") :]


def _draw_tests(axes: Any, material: Material) -> None:
    for number, test in enumerate(material.tests):
        thin = slice(None, None, len(test.stretch) // MOST_POINTS + 1)
        axes.plot(test.stretch[thin], test.stress[thin], ".", color="0.45", ms=4, label="" if number else "tests")
        thin = slice(None, None, len(test.left_out[0]) // MOST_POINTS + 1)
        out = test.left_out[0][thin], test.left_out[1][thin]
        axes.plot(*out, "x", color="0.75", ms=3, label="left out" if len(out[0]) and not number else "")
        if test.slack:
            axes.axvline(1 - test.slack, color="0.75", lw=0.8)
            modulus = material.judged.laws[0].law.young_modulus
            s = np.array([1.0, 1.15])
            axes.plot(s, modulus * (s - 1), "k--", lw=0.9, label="" if number else "tangent after the slack")


def _draw_laws(axes: Any, material: Material, state: str, low: float, high: float) -> None:
    """Solid within the range of a law, dotted outside."""
    s = np.geomspace(low, high, POINTS_OF_A_LINE)
    for number, fit in enumerate(material.judged.laws):
        stress: Array = fit.law.uniaxial(s).nominal if state == "uniaxial" else nominal(fit.law, s, STATES[state](s))
        least, most = fit.holds or (1.0, 1.0)
        inside = (s >= least) & (s <= most)
        colour, width = COLOURS[number % len(COLOURS)], 2.2 if not number else 1.2
        axes.plot(s[inside], stress[inside], color=colour, lw=width, label=fit.name)
        axes.plot(s[~inside], np.where(inside, np.nan, stress)[~inside], ":", color=colour, lw=0.8)
    best = material.judged.laws[0]
    if state != "uniaxial":
        top = float(nominal(best.law, np.array([high]), np.array([high]))[0])
        axes.set_ylim(0, 2 * top)


def _limit(axes: Any, material: Material, title: str, ends: tuple[float, float] | None) -> None:
    """Axes that end where measured points end, though laws go on."""
    points = material.points
    most = max(FAR * material.options.need.reach, *(fit.holds[1] for fit in material.judged.laws if fit.holds), 1.0)
    low, high = ends or (float(points.stretch[0]), min(float(points.stretch[-1]), most))
    shown = points.stress[(points.stretch >= low) & (points.stretch <= high)]
    top, bottom = (float(shown.max()), float(shown.min())) if len(shown) else (1.0, 0.0)
    margin = 0.05 * (max(top, 0.0) - min(bottom, 0.0))
    axes.set(title=title, xlabel="stretch", ylabel="nominal stress (MPa)")
    axes.set(xlim=(min(low, 0.97), high), ylim=(min(bottom, 0.0) - margin, max(top, 0.0) + margin))
