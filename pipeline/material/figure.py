"""The tensile tests and the laws in one figure: all strains, and the strains at which arms work."""

import numpy as np

from geometry.arrays import Array
from pipeline.material.fits import Fits
from pipeline.material.law_fit import LawFit
from pipeline.plots import COLOURS, GREY, INK, Line, Panel, figure, standalone_page

#: largest strain of the second panel; soft arms reach stretches of 1.2 to 1.35 (docs/materials.md)
WORKING_STRAIN = 0.5
#: points of a drawn line
POINTS_OF_A_LINE = 400


def tensile_page(fits: Fits) -> str:
    """An HTML page that opens offline: measured points, E_L and E_H, and each law, solid within its range of validity
    and dotted outside."""
    largest = max(abs(float(np.log(end))) for end in (fits.curve.nodes[0], fits.curve.nodes[-1]))
    working = min(WORKING_STRAIN, float(np.exp(largest)) - 1)
    lines = [*_points(fits), *_modulus_lines(fits)]
    for number, (law, fit) in enumerate(fits.usable.items()):
        lines += _law(
            fits,
            fit,
            f"{law}, holds to stretch {(fit.valid_range or (1.0, 1.0))[1]:.3g}",
            COLOURS[number % len(COLOURS)],
        )
    panels = [
        _panel(fits, title, limit, tuple(lines))
        for title, limit in (("All strains", np.inf), (f"Strains up to {100 * working:g} %", working))
    ]
    return standalone_page("Tensile tests and laws", figure(panels))


def _points(fits: Fits) -> list[Line]:
    return [
        Line(test.strain, test.stress, f"measured, {test.name}", GREY, dash="", marker="circle", marker_size=4.0,
             opacity=0.6, entry="measured")
        for test in fits.tests
    ]  # fmt: skip


def _modulus_lines(fits: Fits) -> list[Line]:
    """E_L from rest to the break strain, E_H beyond it."""
    moduli, last = fits.moduli, float(fits.curve.nodes[-1]) - 1
    lines = (
        ("E_L", moduli.low, 0.0, 0.0, min(moduli.break_strain, last)),
        ("E_H", moduli.high, moduli.high_at_rest, moduli.break_strain, last),
    )
    return [
        Line(np.array([begin, end]), slope * np.array([begin, end]) + height, f"{name} = {slope:.3g} MPa", INK, "dash")
        for name, slope, height, begin, end in lines
        if np.isfinite(slope) and end > begin
    ]


def _law(fits: Fits, fit: LawFit, title: str, colour: str) -> list[Line]:
    """The law as the solver has it."""
    low_end, high_end = (float(fits.curve.nodes[end]) for end in (0, -1))
    stretch = np.geomspace(min(low_end, 1.0), max(high_end, 1.0), POINTS_OF_A_LINE)
    nominal = fit.solved.uniaxial(stretch).nominal
    low, high = fit.valid_range or (1.0, 1.0)
    valid = (stretch >= low) & (stretch <= high)
    inside, outside = np.where(valid, nominal, np.nan), np.where(valid, np.nan, nominal)
    return [
        Line(stretch - 1, inside, title, colour, width=2.5),
        Line(stretch - 1, outside, title, colour, "dot", width=1.2),
    ]


def _panel(fits: Fits, title: str, largest_strain: float, lines: tuple[Line, ...]) -> Panel:
    """Axes that end where the measured points of this panel end, though laws go on."""
    strain, stress = fits.curve.stretch - 1, fits.curve.stress
    shown = np.abs(strain) <= largest_strain
    x_range, y_range = (_with_margin(values[shown]) if shown.any() else None for values in (strain, stress))
    axes = ("nominal strain", "nominal stress (MPa)")
    return Panel(title, *axes, lines, percent_x=True, x_range=x_range, y_range=y_range)


def _with_margin(values: Array) -> tuple[float, float]:
    margin = 0.05 * float(np.ptp(values))
    return float(values.min()) - margin, float(values.max()) + margin
