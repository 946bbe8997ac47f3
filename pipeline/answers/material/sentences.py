"""What tensile tests tell, in sentences, and a law as a configuration takes it."""

from collections.abc import Iterator

import numpy as np

from fem.materials import LAWS, Constant
from pipeline.answers.material.judged import NEAREST, WITHIN, Judged, LawFit, Need, end_of, parting
from pipeline.answers.material.laws import Points
from pipeline.answers.material.loading import TensileTest
from pipeline.config import units

NOT_IN_LAWS = "Creep, rate and the softening of later cycles are in none of these laws."
#: Young's moduli of rubbers and gels from which arms are made, MPa, and the largest strain that they bear
SOFTEST, STIFFEST, LARGEST_STRAIN = 0.01, 100.0, 15.0
#: Poisson ratios of rubbers; their densities in g/cm3, with a tenth more on each side; part by which moduli of one
#: batch differ at most
OF_RUBBER, LIGHTEST, HEAVIEST, OF_ONE_BATCH = (0.45, 0.5), 0.8, 1.4, 0.2
#: strain below which a test of rubber is no test, and the largest over which stresses are above those of a rubber
SMALLEST_STRAIN = 0.02
#: part of the stretch with the invariant of what is needed in two directions that a test should reach
ENOUGH = 0.95
#: factor from which one stretch or slope is larger than another; stretch before which a law stiffens, or does not
FURTHER, FAR = 1.02, 4.0
#: the least stretch of a column of strains that has stretches, and the stress there over the largest one
STRETCH_AT_REST, STRESS_AT_REST = (1.95, 2.05), 0.1


def yaml_line(fit: LawFit, density: str | None) -> str:
    """The section `material` of a configuration with this law, and the stretches between which it holds."""
    entries = [f"{name}: {_value(fit, name, kind)}" for name, kind in LAWS[fit.form.law].constants().items()]
    entries += [f"density: {density}"] if density else []
    if fit.holds:
        low, high = fit.holds  # inwards, so that no stretch beyond is written as one within
        entries.append(f"holds_between: [{np.ceil(low * 100) / 100:.3g}, {np.floor(high * 100) / 100:.3g}]")
    return f"material: {{law: {fit.form.law}, {', '.join(entries)}}}"


def _value(fit: LawFit, name: str, kind: Constant) -> str:
    """A constant as a configuration takes it."""
    value = getattr(fit.law, name)
    if isinstance(value, tuple):
        return f"[{', '.join(f'{entry:.4g}{kind.unit}' for entry in value)}]"
    return f"{value:.4g}{kind.unit}"


def constants(fit: LawFit) -> str:
    """The constants as a table shows them."""
    return ", ".join(f"{name} {value:.4g}" for name, value in zip(fit.form.constants, fit.constants, strict=True))


def stretches(fit: LawFit) -> str:
    """The principal stretches over which a law can be used."""
    return "-" if fit.holds is None else f"{fit.holds[0]:.2f} to {fit.holds[1]:.2f}"


def recommendation(judged: Judged, points: Points, need: Need) -> list[str]:
    """Which law to take, in words."""
    best = judged.laws[0]
    if best.holds is None:
        return [f"No law can be used: {best.name}, which comes closest, is {best.why}."]
    misfit = f"on average {100 * best.misfit:.2g} % off the tests, at most {100 * best.largest:.2g} %"
    end = f"up to a stretch of {best.holds[1]:.3g}"
    sentences = [f"Take {best.name}: {end} it can be used, and is {misfit}."]
    if best.why == NEAREST and best.largest > WITHIN:
        none = f"No law is within {100 * WITHIN:g} % of the tests."
        sentences = [f"{none} {best.name} comes closest: {end} it is {misfit}."]
    if best.holds[1] < 0.98 * need.high:
        ends = f"ends at a stretch of {best.holds[1]:.3g}"
        end = f"the test {ends}" if end_of(points) <= best.holds[1] * 1.02 else f"what it describes {ends}"
        sentences.append(f"An arm may need {need.low:.3g} to {need.high:.3g}, but {end}.")
    if "equibiaxial" not in points.state:
        sentences += _beside(judged, min(need.high, best.holds[1]))
    if end_of(points) < ENOUGH * need.reach and set(points.state) == {"uniaxial"}:
        sentences.append(f"A test up to a stretch of {need.reach:.2g} would tell more about two directions.")
    return [*sentences, *_beyond(judged, points)]


def beyond(judged: Judged) -> LawFit | None:
    """The law beside that to take where walls stretch further: the one that goes further, or else another one that
    stiffens where it does not; None where there is none."""
    best, *others = [fit for fit in judged.usable if fit.high >= 0.98 * judged.usable[0].high] or judged.laws[:1]
    found = max(others, key=lambda fit: fit.high, default=best)
    if found.high > FURTHER * best.high:
        return found
    return next((fit for fit in others if _stiffens(fit) is not _stiffens(best)), None)


def _beyond(judged: Judged, points: Points) -> Iterator[str]:
    """What the tests leave open where walls stretch further."""
    best, other = judged.laws[0], beyond(judged)
    if other is None:
        return
    if other.high > FURTHER * best.high:
        yield f"Where walls stretch further take {other.name}, which can be used up to {other.high:.3g}."
    if _stiffens(best) is not _stiffens(other):
        stiff, soft = (best, other) if _stiffens(best) else (other, best)
        yield (
            f"The tests decide up to a stretch of {min(other.high, end_of(points)):.3g}. Beyond it {stiff.name} "
            f"stiffens and {soft.name} does not, which decides whether an arm has a limit pressure: run both."
        )


def _stiffens(fit: LawFit) -> bool:
    """Whether the slope of the nominal stress of a bar grows again before a stretch of `FAR`."""
    stretch = np.linspace(1.0, FAR, 61)
    slope = np.diff(fit.law.incompressible(stretch, stretch**-0.5))
    return bool(slope[-1] > FURTHER * slope.min())


def _beside(judged: Judged, high: float) -> Iterator[str]:
    """How far the usable laws part where walls are pulled in two directions."""
    best, *others = judged.usable
    ratios = [parting(other.law, best.law, high)[2] for other in others if other.high >= 0.98 * high]
    if not ratios:
        ends = [other.high for other in others if other.holds]
        beyond = f"Beyond a stretch of {max(ends, default=1.0):.3g} the fitted laws disagree in biaxial tension"
        yield from [f"{beyond}, which these tests do not measure."] if ends else []
        return
    least, most = min(ratios), max(ratios)
    between = f"{least:.2g} to {most:.2g}" if f"{least:.2g}" != f"{most:.2g}" else f"{least:.2g}"
    yield (
        "A tensile test does not pull in two directions, as pressure pulls a wall: there the other usable laws have "
        f"{between} times its stress at a stretch of {high:.3g}."
    )


def facts(judged: Judged, points: Points) -> list[str]:
    """Numbers to compare with a data sheet."""
    modulus = judged.laws[0].law.young_modulus
    bar = points.state == ("uniaxial" if "uniaxial" in points.state else points.state[0])
    doubled = f", stress at 100 % strain {np.interp(2.0, points.stretch[bar], points.stress[bar]):.3g} MPa"
    spread = f", the specimens differ by {100 * points.spread:.2g} %" if np.isfinite(points.spread) else ""
    return [
        f"Young's modulus at rest {modulus:.3g} MPa{doubled if points.stretch[bar][-1] >= 2 else ''}{spread}.",
    ]


def doubts(tests: tuple[TensileTest, ...], points: Points) -> Iterator[str]:
    """What is most likely wrong with the data."""
    strain, stress = float(np.abs(points.stretch - 1).max()), float(np.abs(points.stress).max())
    first, low = points.stretch[0], abs(float(points.stress[0]))
    if strain < SMALLEST_STRAIN:
        yield f"strains reach {100 * strain:.3g} % only: check the unit of the strain, % or 1"
    elif strain > LARGEST_STRAIN:
        limit = f"rubbers break below {100 * LARGEST_STRAIN:g} %"
        yield f"strains reach {100 * strain:.3g} %, and {limit}: is the strain in % where the title says 1?"
    elif STRETCH_AT_REST[0] <= first <= STRETCH_AT_REST[1] and low <= STRESS_AT_REST * stress:
        at = f"begin at {100 * (first - 1):.4g} % with a stress of {low:.3g} MPa"
        yield f"strains {at}: if these are stretches, call the column 'stretch'"
    else:
        yield from _of_modulus(3 * points.modulus)
    yield from (note for test in tests for note in test.notes)


def doubts_of_given(nu: float, density: str | None, spread: float) -> Iterator[str]:
    """What is given, or differs between specimens, and is that of no rubber."""
    if nu < OF_RUBBER[0]:
        yield f"a Poisson ratio of {nu:.3g} is given, and rubbers have {OF_RUBBER[0]:g} to {OF_RUBBER[1]:g}"
    of_water = 1.0 if density is None else 1e9 * units.convert(density, units.DENSITY)
    if not LIGHTEST <= of_water <= HEAVIEST:
        yield f"a density of {density} is given, and rubbers have {1e3 * LIGHTEST:g} to {1e3 * HEAVIEST:g} kg/m^3"
    if spread > OF_ONE_BATCH:
        yield f"the specimens differ by {100 * spread:.2g} %; those of one batch by less than {100 * OF_ONE_BATCH:g} %"


def _of_modulus(modulus: float) -> Iterator[str]:
    """A Young's modulus, MPa, that no rubber has."""
    if not modulus > 0 or SOFTEST <= modulus <= STIFFEST:
        return
    meant, other = (modulus / 1000, "kPa, not MPa") if modulus > STIFFEST else (1000 * modulus, "MPa, not kPa")
    likely = f": is the stress in {other}? It would be {meant:.3g} MPa" if SOFTEST <= meant <= STIFFEST else ""
    yield f"Young's modulus is {modulus:.3g} MPa, and rubbers have {SOFTEST:g} to {STIFFEST:g} MPa{likely}"
