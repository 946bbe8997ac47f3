"""Moment over curvature at every pressure, stretch, curvature without moment, and rigidities, on an HTML page."""

import numpy as np

from pipeline.plots import GREY, INK, Line, Panel, figure, ordered_colour, standalone_page
from rod.arm_law.curves import CellCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.section import section_at

#: points of a line between the states of a cell
POINTS = 200


def law_page(name: str, law: ArmLaw) -> str:
    """The figure alone on a page that opens offline."""
    panels = (
        Panel("Moment over curvature", "κ (1/mm)", "M (N mm)", (*_curves(law, "moment"), *_onsets(law))),
        Panel("Stretch of the axis", "κ (1/mm)", "λ", _curves(law, "stretch")),
        Panel("Curvature without moment", "p (kPa)", "κ₀ (1/mm)", _curvatures_at_rest(law)),
        Panel("Rigidity against bending", "κ (1/mm)", "dM/dκ (N mm²)", _curves(law, "rigidity"), log_y=True),
    )
    return standalone_page(f"{name}: the law of a cell", figure(panels))


def _curves(law: ArmLaw, quantity: str) -> tuple[Line, ...]:
    """A quantity over the curvature, one line per pressure."""
    lines = []
    for number, cell in enumerate(law.cells):
        moment = np.linspace(cell.moment[0], cell.moment[-1], POINTS)
        kappa, stretch = cell.on(moment)
        x, y = {
            "moment": (kappa, moment), "stretch": (kappa, stretch), "rigidity": (cell.kappa, cell.rigidity),
        }[quantity]  # fmt: skip
        name = f"{cell.pressure:g} kPa"
        lines.append(Line(x, y, name, ordered_colour(number, len(law.cells)), entry="", frame=name))
    return tuple(lines)


def _onsets(law: ArmLaw) -> tuple[Line, ...]:
    """The states at which walls begin to touch."""
    rows = [(cell, _first_contacts(cell)) for cell in law.cells]
    return tuple(
        Line(cell.kappa[first], cell.moment[first], "walls begin to touch", dash="", marker="circle-open",
             frame=f"{cell.pressure:g} kPa")
        for cell, first in rows if first
    )  # fmt: skip


def _first_contacts(cell: CellCurve) -> list[int]:
    """First states in contact next to states without."""
    changes = np.flatnonzero(np.diff(cell.contact.astype(int)))
    return [int(row) + 1 if cell.contact[row + 1] else int(row) for row in changes]


def _curvatures_at_rest(law: ArmLaw) -> tuple[Line, ...]:
    pressures = np.linspace(law.pressures[0], law.pressures[-1], 41)
    between = np.array([section_at(law.cells, float(pressure)).kappa_0 for pressure in pressures])
    measured = np.array([cell.at(0.0)[0] for cell in law.cells])
    return (
        Line(pressures, between, "κ₀", GREY),
        Line(np.array(law.pressures), measured, "κ₀ of a cell", INK, dash="", marker="square-open"),
    )
