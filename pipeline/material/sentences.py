"""What tensile tests tell, in sentences, and each fitted law as a configuration takes it."""

import math

import numpy as np

from fem.materials import LAWS, Constant, Ogden
from pipeline.formatting import listed
from pipeline.material.fits import Fits
from pipeline.material.law_fit import LawFit
from pipeline.material.moduli import check_high_modulus

#: |stretch - 1| below which large scatter needs no sentence
NEAR_REST = 0.02


def with_error(value: float, error: float) -> str:
    """0.1094 ± 0.002: one digit of the standard error, and the value to the digit after it, six digits at most."""
    if not (math.isfinite(error) and error > 0 and value):
        return f"{value:.6g}"
    digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 2
    return f"{value:.{min(max(digits, 1), 6)}g} ± {error:.1g}"


def yaml_block(fit: LawFit, density: str | None) -> str:
    """The section `material` of a configuration with this law, the density where one is given, and the stretches
    between which it holds."""
    entries = [f"{name}: {_value(fit, name, kind)}" for name, kind in LAWS[fit.law].constants().items()]
    entries += [] if density is None else [f"density: {density}"]
    if fit.valid_range:
        entries.append(f"holds_between: [{', '.join(f'{end:.3g}' for end in _between(fit.valid_range))}]")
    return f"material: {{law: {fit.law}, {', '.join(entries)}}}"


def _between(valid_range: tuple[float, float]) -> tuple[float, float]:
    """The smallest and the largest stretch in a bar that is stretched over this range, across the bar too.

    A bar that keeps its volume and is stretched to s becomes s**-0.5 times as wide.
    """
    low, high = valid_range
    return min(low, high**-0.5), max(high, low**-0.5)


def configuration_line(fit: LawFit, density: str | None) -> str:
    """The section `material` of a configuration, and as a comment of it what it was fitted to."""
    low, high = fit.fitted_range
    return f"{yaml_block(fit, density)}  # from {fit.points} points, stretches {low:.3g} to {high:.3g}"


def _value(fit: LawFit, name: str, kind: Constant) -> str:
    """A constant as a configuration takes it."""
    value = getattr(fit.solved, name)
    if isinstance(value, tuple):
        return f"[{', '.join(f'{entry:.6g}{kind.unit}' for entry in value)}]"
    return f"{value:{'g' if kind is Constant.POISSON_RATIO else '.6g'}}{kind.unit}"


def moduli_sentences(fits: Fits) -> list[str]:
    """E_L and E_H with their standard errors, and which line each is the slope of."""
    moduli, at = fits.moduli, f"{100 * fits.moduli.break_strain:g} %"
    if not np.isfinite(moduli.low):
        return [f"E_L: too few points in tension up to {at}"]
    low = f"E_L = {with_error(moduli.low, moduli.low_error)} MPa: slope of the line through rest, strains up to {at}"
    if not np.isfinite(moduli.high):
        return [low, f"E_H: too few points beyond {at}"]
    return [
        low,
        f"E_H = {with_error(moduli.high, moduli.high_error)} MPa: slope of the best line, strains beyond {at}",
        f"(joined to the end of the first line {moduli.high_joined:.4g}, through rest {moduli.high_from_rest:.4g} MPa)",
    ]


def none_usable(fits: Fits) -> str:
    """Why there is no law for a configuration."""
    likely = "; ".join(fits.notes) or "look at the points in material.html for scatter, offsets and mistakes in units"
    return f"no law describes these data from rest on within {100 * fits.options.within:g} %: {likely}"


def caveats(fits: Fits) -> list[str]:
    """What to know before choosing a law."""
    return [*_high_modulus(fits), *_kappa(fits), *_stability(fits), *_scatter(fits), *_compression(fits)]


def _high_modulus(fits: Fits) -> list[str]:
    moduli = fits.moduli
    check = check_high_modulus(moduli.low, moduli.high, fits.options.nu)
    if check is None:
        return []
    return [
        f"With these E_L and E_H a St. Venant-Kirchhoff bar of E = E_H carries {check.svk:.3g} MPa at stretch "
        f"{check.stretch:g}, {check.svk / check.line:.1f} times the measured line E_L times strain; "
        f"a Hencky bar {check.hencky / check.line:.1f} times."
    ]


def _kappa(fits: Fits) -> list[str]:
    limited = [law for law, fit in fits.usable.items() if fit.limited_by == "kappa"]
    if not limited:
        return []
    return [
        f"The range of {listed(limited)} is limited by kappa, which follows from nu = {fits.options.nu:g}: "
        "the same constants in an incompressible law reach further; a larger --nu extends the range."
    ]


def _stability(fits: Fits) -> list[str]:
    """Drucker's stability of Ogden's law."""
    fitted = {fit.name: fit.solved for fit in fits.usable.values() if isinstance(fit.solved, Ogden)}
    stable = [name for name, law in fitted.items() if law.always_stable]
    sentences = []
    for name, law in fitted.items():
        if name not in stable:
            limits = [f"{low:.3g} and {high:.3g} in {test}" for test, (low, high) in law.drucker_limits().items()]
            sentences.append(
                f"{name} is stable in Drucker's sense (more stress for more strain) between stretches "
                f"{', '.join(limits).replace('inf', '∞')}; elsewhere not, because mu alpha < 0 in one of its terms."
            )
    if stable:
        sentences.append(
            f"{listed(stable)}: stable in Drucker's sense (more stress for more strain) at every strain, because "
            "mu alpha > 0 in every term."
        )
    return sentences


def _scatter(fits: Fits) -> list[str]:
    curve, tolerance = fits.curve, f"{100 * fits.options.within:g} %"
    resolved = curve.nodes[curve.resolves(fits.options.within)]
    if not len(resolved):
        return [f"The scatter of the points exceeds {tolerance} of the stress at every stretch."]
    nearest = resolved[np.argmin(np.abs(np.log(resolved)))]
    if abs(nearest - 1) <= NEAR_REST:
        return []
    return [
        f"Between rest and stretch {nearest:.3g} the scatter of the points exceeds {tolerance} of the stress; "
        "no law is rejected there."
    ]


def _compression(fits: Fits) -> list[str]:
    compressed, pulled = fits.curve.nodes[0] < 1, fits.curve.nodes[-1] > 1
    if compressed and pulled:
        return []
    if compressed:
        return [
            "These are tests in compression only: they do not tell how well a law describes tension, in which the "
            "walls of an inflated arm are."
        ]
    return ["These are tests in tension only: they do not tell how well a law describes compression."]
