"""The tensile tests and the laws in one figure: all of it, and the strains at which arms work."""

from typing import Any

import numpy as np
from plotly.colors import qualitative

import fem
from geometry.arrays import Array
from pipeline.material.fits import Fits
from pipeline.material.law_fit import LawFit
from pipeline.material.moduli import Moduli
from pipeline.report.figures import side_by_side

#: largest strain of the second panel; the four arms of the paper reach stretches of 1.22 to 1.33 (docs/materials.md)
NEAR = 0.5
#: points of a drawn line
FINE = 400
_INK, _GREY = "#1f2933", "#9aa5b1"


def tensile_page(fits: Fits) -> str:
    """An HTML page that opens offline: points, E_L and E_H, and each law, solid as far as it holds and then dotted."""
    far = max(abs(float(np.log(end))) for end in (fits.curve.nodes[0], fits.curve.nodes[-1]))
    near = min(NEAR, float(np.exp(far)) - 1)
    figure = side_by_side(("all strains", f"strains up to {100 * near:g} %"), "strain", "nominal stress (MPa)")
    for column in (1, 2):
        _points(figure, fits, column)
        _lines(figure, fits.moduli, fits, column)
        for place, (law, fit) in enumerate(fits.usable.items()):
            _law(figure, fits, fit, law, qualitative.Safe[place % len(qualitative.Safe)], column)
    figure.update_xaxes(tickformat=".0%")
    for column, reach in ((1, np.inf), (2, near)):
        _cut(figure, fits, reach, column)
    figure.update_layout(height=560, title={"text": "Tensile tests and laws", "font": {"size": 15}}, margin={"t": 80})
    page: str = figure.to_html(full_html=True, include_plotlyjs=True, config={"displaylogo": False})
    return page


def _points(figure: Any, fits: Fits, column: int) -> None:
    marker = {"color": _GREY, "size": 4, "opacity": 0.6}
    for place, test in enumerate(fits.tests):
        figure.add_scattergl(
            x=test.strain, y=test.stress, mode="markers", marker=marker, name="measured", legendgroup="measured",
            showlegend=column == 1 and place == 0, hovertemplate=f"{test.name}<br>%{{x:.1%}}, %{{y:.4g}} MPa",
            row=1, col=column,
        )  # fmt: skip


def _lines(figure: Any, found: Moduli, fits: Fits, column: int) -> None:
    """E_L from rest to the break, E_H beyond it."""
    last = float(fits.curve.nodes[-1]) - 1
    ends = {"E_L": (0.0, min(found.break_strain, last)), "E_H": (found.break_strain, last)}
    heights = {"E_L": (found.low, 0.0), "E_H": (found.high, found.high_at_rest)}
    for name, (begin, end) in ends.items():
        slope, height = heights[name]
        if np.isfinite(slope) and end > begin:
            x = np.array([begin, end])
            title = f"{name} = {slope:.3g} MPa"
            _add(
                figure, x, slope * x + height, {"color": _INK, "width": 1.5, "dash": "dash"}, title, column, column == 1
            )


def _law(figure: Any, fits: Fits, fit: LawFit, law: str, colour: str, column: int) -> None:
    """The law as the solver has it."""
    reach = (float(fits.curve.nodes[0]), float(fits.curve.nodes[-1]))
    stretch = np.geomspace(min(reach[0], 1.0), max(reach[1], 1.0), FINE)
    nominal = fem.uniaxial(fit.solved, stretch).nominal
    low, high = fit.holds or (1.0, 1.0)
    inside = (stretch >= low) & (stretch <= high)
    title = f"{law}, holds to stretch {high:.3g}"
    stroke = {"color": colour, "width": 2.5}
    _add(figure, stretch - 1, np.where(inside, nominal, np.nan), stroke, title, column, column == 1)
    beyond = {"color": colour, "width": 1.2, "dash": "dot"}
    _add(figure, stretch - 1, np.where(inside, np.nan, nominal), beyond, title, column, False)


def _add(figure: Any, x: Array, y: Array, stroke: dict[str, Any], title: str, column: int, legend: bool) -> None:
    figure.add_scatter(
        x=x, y=y, mode="lines", line=stroke, name=title, legendgroup=title, showlegend=legend, row=1, col=column
    )


def _cut(figure: Any, fits: Fits, reach: float, column: int) -> None:
    """Axes that end where the points of this panel end, though laws go on."""
    stretch, stress = fits.curve.stretch, fits.curve.stress
    seen = np.abs(stretch - 1) <= reach
    if not seen.any():
        return
    for update, values in ((figure.update_xaxes, stretch[seen] - 1), (figure.update_yaxes, stress[seen])):
        margin = 0.05 * float(np.ptp(values))
        update(range=[float(values.min()) - margin, float(values.max()) + margin], row=1, col=column)
