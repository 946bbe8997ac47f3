"""Moment over curvature at every pressure, stretch, curvature without moment, and rigidities, on an HTML page."""

from pipeline.values.page import figure_page
from pipeline.values.plots import INK, Line, Panel, ordered_colour
from rod.arm_law.law import ArmLaw


def law_page(name: str, law: ArmLaw) -> str:
    """The figure alone on a page that opens offline."""
    at_rest = Line(law.pressures, [cell.at(0.0)[0] for cell in law.cells], "κ₀", INK, marker="square-open")
    panels = (
        Panel("Moment over curvature", "κ (1/mm)", "M (N mm)", (*_curves(law, "moment"), *_touching(law))),
        Panel("Stretch of the axis", "κ (1/mm)", "λ", _curves(law, "stretch")),
        Panel("Curvature without moment", "p (kPa)", "κ₀ (1/mm)", (at_rest,)),
        Panel("Rigidity against bending", "κ (1/mm)", "dM/dκ (N mm²)", _curves(law, "rigidity"), log_y=True),
    )
    return figure_page(f"{name}: the arm's own law", panels)


def _curves(law: ArmLaw, quantity: str) -> tuple[Line, ...]:
    """A quantity over the curvature, one line per pressure."""
    lines = []
    for number, cell in enumerate(law.cells):
        colour, name = ordered_colour(number, len(law.cells)), f"{cell.pressure:g} kPa"
        lines.append(Line(cell.kappa, getattr(cell, quantity), name, colour, entry="", frame=name))
    return tuple(lines)


def _touching(law: ArmLaw) -> tuple[Line, ...]:
    """The states in which walls touch."""
    return tuple(
        Line(cell.kappa[there], cell.moment[there], "walls touch", INK, "", "x", frame=f"{cell.pressure:g} kPa")
        for cell in law.cells
        if (there := cell.contact).any()
    )
