"""The tensile tests and the laws in one figure: all strains, and the strains at which arms work."""

import numpy as np

from pipeline.drawing.plots import INK, Panel, Stroke, series_colour, standalone_page, two_panels
from pipeline.material.fits import Fits
from pipeline.material.law_fit import LawFit

#: largest strain of the second panel; soft arms reach stretches of 1.2 to 1.35 (docs/materials.md)
WORKING_STRAIN = 0.5
#: points of a drawn line
POINTS_OF_A_LINE = 400
_MEASURED = {"color": "#9aa5b1", "size": 4, "opacity": 0.6}


def tensile_page(fits: Fits) -> str:
    """An HTML page that opens offline: measured points, E_L and E_H, and each law, solid within its range of validity
    and dotted outside."""
    largest = max(abs(float(np.log(end))) for end in (fits.curve.nodes[0], fits.curve.nodes[-1]))
    working = min(WORKING_STRAIN, float(np.exp(largest)) - 1)
    panels = two_panels(("all strains", f"strains up to {100 * working:g} %"), "nominal strain", "nominal stress (MPa)")
    for panel, limit in zip(panels, (np.inf, working), strict=True):
        _points(panel, fits)
        _modulus_lines(panel, fits)
        for number, (law, fit) in enumerate(fits.usable.items()):
            _law(
                panel,
                fits,
                fit,
                f"{law}, holds to stretch {(fit.valid_range or (1.0, 1.0))[1]:.3g}",
                series_colour(number),
            )
        _fit_axes(panel, fits, limit)
    figure = panels[0].figure
    figure.update_xaxes(tickformat=".0%")
    figure.update_layout(height=560, title={"text": "Tensile tests and laws", "font": {"size": 15}}, margin={"t": 80})
    return standalone_page(figure)


def _points(panel: Panel, fits: Fits) -> None:
    for number, test in enumerate(fits.tests):
        panel.figure.add_scattergl(
            x=test.strain, y=test.stress, mode="markers", marker=_MEASURED, name="measured", legendgroup="measured",
            showlegend=panel.column == 1 and number == 0, hovertemplate=f"{test.name}<br>%{{x:.1%}}, %{{y:.4g}} MPa",
            row=1, col=panel.column,
        )  # fmt: skip


def _modulus_lines(panel: Panel, fits: Fits) -> None:
    """E_L from rest to the break strain, E_H beyond it."""
    moduli, last = fits.moduli, float(fits.curve.nodes[-1]) - 1
    lines = (
        ("E_L", moduli.low, 0.0, 0.0, min(moduli.break_strain, last)),
        ("E_H", moduli.high, moduli.high_at_rest, moduli.break_strain, last),
    )
    for name, slope, height, begin, end in lines:
        if np.isfinite(slope) and end > begin:
            x = np.array([begin, end])
            title = f"{name} = {slope:.3g} MPa"
            panel.line(x, slope * x + height, Stroke(INK, "dash", 1.5), title, legend=panel.column == 1)


def _law(panel: Panel, fits: Fits, fit: LawFit, title: str, colour: str) -> None:
    """The law as the solver has it."""
    low_end, high_end = (float(fits.curve.nodes[end]) for end in (0, -1))
    stretch = np.geomspace(min(low_end, 1.0), max(high_end, 1.0), POINTS_OF_A_LINE)
    nominal = fit.solved.uniaxial(stretch).nominal
    low, high = fit.valid_range or (1.0, 1.0)
    valid = (stretch >= low) & (stretch <= high)
    inside, outside = np.where(valid, nominal, np.nan), np.where(valid, np.nan, nominal)
    panel.line(stretch - 1, inside, Stroke(colour, width=2.5), title, legend=panel.column == 1)
    panel.line(stretch - 1, outside, Stroke(colour, "dot", 1.2), title)


def _fit_axes(panel: Panel, fits: Fits, largest_strain: float) -> None:
    """Axes that end where the measured points of this panel end, though laws go on."""
    strain, stress = fits.curve.stretch - 1, fits.curve.stress
    shown = np.abs(strain) <= largest_strain
    if not shown.any():
        return
    for update, values in ((panel.figure.update_xaxes, strain[shown]), (panel.figure.update_yaxes, stress[shown])):
        margin = 0.05 * float(np.ptp(values))
        update(range=[float(values.min()) - margin, float(values.max()) + margin], row=1, col=panel.column)
