"""What the tests say, in sentences, and each law as a configuration takes it."""

import math

import numpy as np

from pipeline.config.config import LAWS
from pipeline.material.fits import Fits
from pipeline.material.law_fit import LawFit
from pipeline.material.moduli import PAPER, choice

#: distance from rest, as a stretch, below which it need not be said that the points scatter
NEAR_REST = 0.02


def with_error(value: float, error: float) -> str:
    """0.1094 ± 0.002: one digit of the standard error, and the value to the digit after it, six digits at most."""
    if not (math.isfinite(error) and error > 0 and value):
        return f"{value:.6g}"
    digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 2
    return f"{value:.{min(max(digits, 1), 6)}g} ± {error:.1g}"


def block(fit: LawFit, density: str) -> str:
    """The section of a configuration in which the solid has this law."""
    values = {name: getattr(fit.solved, name) for name in LAWS[fit.law][1]}
    shown = [f"{name}: {value:g}" if name == "nu" else f"{name}: {value:.6g} MPa" for name, value in values.items()]
    return f"material: {{law: {fit.law}, {', '.join(shown)}, density: {density}}}"


def about_moduli(fits: Fits) -> list[str]:
    """E_L and E_H with their standard errors, each with how its line is placed."""
    found, at = fits.moduli, f"{100 * fits.moduli.break_strain:g} %"
    if not np.isfinite(found.low):
        return [f"E_L: too few points in tension up to {at}"]
    said = [f"E_L = {with_error(found.low, found.low_error)} MPa: the line from rest, strains up to {at}"]
    if not np.isfinite(found.high):
        return [*said, f"E_H: too few points beyond {at}"]
    return [
        *said,
        f"E_H = {with_error(found.high, found.high_error)} MPa: the slope of the line through strains beyond {at}",
        f"(begun where the first line ends {found.high_joined:.4g}, drawn from rest {found.high_from_rest:.4g} MPa)",
    ]


def sentences(fits: Fits) -> list[str]:
    """What must be known before a law is chosen."""
    return [*_about_the_choice(fits), *_about_kappa(fits), *_about_scatter(fits), *_about_compression(fits)]


def _about_the_choice(fits: Fits) -> list[str]:
    found, (low, high, _) = fits.moduli, PAPER
    own, papers = choice(found.low, found.high, fits.asked.nu), choice(*PAPER)
    named = {"these E_L and E_H": own, f"the paper's E_L = {low:g} and E_H = {high:g} MPa": papers}
    return [
        f"With {name} a St. Venant-Kirchhoff bar of E = E_H carries {at.svk:.3g} MPa at stretch {at.stretch:g}, "
        f"{at.svk / at.line:.1f} times the measured line E_L times strain; "
        f"a Hencky bar {at.hencky / at.line:.1f} times."
        for name, at in named.items()
        if at is not None
    ]


def _about_kappa(fits: Fits) -> list[str]:
    ended = [law for law, fit in fits.usable.items() if fit.ends == "kappa"]
    if not ended:
        return []
    return [
        f"What ends {' and '.join(ended)} is kappa, which nu = {fits.asked.nu:g} gives: incompressible the same "
        "constants reach further; see --nu."
    ]


def _about_scatter(fits: Fits) -> list[str]:
    curve, share = fits.curve, f"{100 * fits.asked.within:g} %"
    told = curve.nodes[curve.tells(fits.asked.within)]
    if not len(told):
        return [f"The points scatter too much to tell {share} of the stress at any stretch."]
    nearest = told[np.argmin(np.abs(np.log(told)))]
    if abs(nearest - 1) <= NEAR_REST:
        return []
    return [
        f"Nearer to rest than stretch {nearest:.3g} the points scatter too much to tell {share} of the stress; "
        "no law is refused there."
    ]


def _about_compression(fits: Fits) -> list[str]:
    if fits.curve.nodes[0] < 1:
        return []
    return ["These tests pull only: how the laws do in compression, down to where they are stable, is not known."]
