"""Sentences on the states that a run has reached."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import inf, isfinite, isinf
from typing import NamedTuple

import numpy as np

from fem.elements import ELEMENTS, Volumetric
from geometry import position_text
from geometry.arrays import Index
from pipeline.config.config import Config, Material
from pipeline.identification.parameters import Parameters
from pipeline.plausibility.before import HARDLY_BENT
from pipeline.simulation.contact_check import BESIDE, NOTHING, PATH_DEPENDENT, path_dependence
from pipeline.simulation.outcome import Outcomes, Record
from rod import Interval

#: Poisson's ratio from which on a material keeps its volume, and the largest change of volume that is not mentioned
KEEPS_ITS_VOLUME, VOLUME_CHANGE = 0.49, 0.3
#: error of a Poisson ratio that follows from kappa
ROUNDING = 1e-9
#: distance of the material curve from its plane over the length that is not mentioned: as much as a rod is wrong
OUT_OF_PLANE = 1e-3
#: pressures from which on it can be tested whether parameters are linear in the pressure
SEVERAL = 3
#: largest ratio of the ends of the 95 % interval of a rigidity that counts as determined
DETERMINED = 4.0
#: R² of a single line below which it is mentioned; its rigidity over that of an inner cell was then between these
#: (seven arms of `make unseen` with seeds 7 and 131; with a larger R² 0.84 to 1.04 on 18 others, 1.27 on one)
POORLY_DESCRIBED, OVER_THAT_OF_A_CELL = 0.5, (0.47, 0.91)


class Valid(NamedTuple):
    """Up to where a law describes rubber."""

    stretches: tuple[float, float]  #: the smallest and the largest that are not mentioned
    sentence: str


#: for the rubber of the tensile test in examples/ (docs/how_to/choose_law.md); Hencky between 0.7 and 1.3 also by
#: L. Anand, J. Appl. Mech. 46 (1979) 78. The other laws are as good as their fit
VALID = {
    "svk": Valid(
        (1 / 1.1, 1.1),
        "St. Venant-Kirchhoff (svk) is a law for small strains: for the silicone Elastosil M 4601 it holds up to a "
        "stretch of 1.08",
    ),
    "hencky": Valid((0.7, 1.3), "Hencky's law describes rubber between stretches of about 0.7 and 1.3"),
    "neo_hooke": Valid((0.0, 1.5), "the law of neo-Hooke describes rubber up to a stretch of about 1.5"),
    "mooney_rivlin": Valid((0.0, 1.7), "the law of Mooney and Rivlin describes rubber up to a stretch of about 1.7"),
}


@dataclass(frozen=True)
class Solved:
    """A run as far as its experiments and its identification went."""

    config: Config
    outcomes: Outcomes
    parameters: tuple[Parameters, ...]
    regions: Mapping[str, Index] = field(default_factory=dict)  #: rows of the elements of another material, by name


def after_solving(solved: Solved) -> tuple[str, ...]:
    """The sentences on the states that were reached."""
    if not solved.outcomes.records:
        return ()
    return tuple(filter(None, (rule(solved) for rule in AFTER)))


def _volume_change(solved: Solved) -> str:
    """Elements with one point for the volumetric part change their volume where it should be kept, and those with a
    pressure of their own do where they are too large for how the body deforms."""
    element, law = ELEMENTS[solved.config.mesh.formulation], solved.config.material.built()
    worst = min((record.summary for record in solved.outcomes.records), key=lambda summary: summary.extremes.min_J)
    lost = 1.0 - worst.extremes.min_J
    if law.poisson_ratio < KEEPS_ITS_VOLUME - ROUNDING or lost < VOLUME_CHANGE:
        return ""
    remedy = "a smaller mesh.size, because the elements there are too large for the deformation"
    if element.volumetric is not Volumetric.PRESSURE:
        remedy = "mesh.formulation: mixed, or with a smaller mesh.size"
    return (
        f"the material loses up to {100 * lost:.0f} % of its volume at {position_text(worst.extremes.min_J_at)} "
        f"({worst.experiment}, {worst.pressure_kPa:g} kPa), although a Poisson ratio of {law.poisson_ratio:.4g} keeps "
        f"it nearly; compare with {remedy}"
    )


def _large_strain(solved: Solved) -> str:
    """Strains beyond those for which the laws of the solid and of its regions describe rubber."""
    of_regions = [
        _beyond_law(solved, material, f" of the region {name}", solved.regions.get(name))
        for name, material in solved.config.materials.items()
    ]
    return "; ".join(filter(None, (_beyond_law(solved, solved.config.material, "", _others(solved)), *of_regions)))


def _others(solved: Solved) -> Index | None:
    """Rows of the elements outside of all regions; None where there are no regions."""
    if not solved.regions:
        return None
    count = len(solved.outcomes.records[0].fields["stretch"])
    return np.setdiff1d(np.arange(count), np.concatenate(list(solved.regions.values())))


class _Range(NamedTuple):
    """Stretches in a part of a body in one state."""

    smallest: float
    largest: float
    pressure_kPa: float

    @classmethod
    def of(cls, record: Record, elements: Index | None) -> "_Range":
        """Of some of the elements, or of all."""
        extremes, pressure = record.summary.extremes, record.summary.pressure_kPa
        if elements is None:
            return cls(extremes.min_stretch, extremes.max_stretch, pressure)
        low, high = (record.fields[name][elements] for name in ("smallest_stretch", "stretch"))
        return cls(float(low.min()), float(high.max()), pressure)


def _valid(material: Material) -> Valid | None:
    """Up to where a law describes the solid: as its configuration says, else as is known of rubber."""
    if (given := material.holds_between) is None:
        return VALID.get(material.law)
    low, high = given
    return Valid(given, f"the law {material.law} holds from {low:g} to {high:g} (holds_between in the configuration)")


def _beyond_law(solved: Solved, material: Material, of_part: str, elements: Index | None) -> str:
    """The sentence on the stretches in a part of one material; empty where its law describes rubber up to them."""
    states = [_Range.of(record, elements) for record in solved.outcomes.records]
    low, high = min(state.smallest for state in states), max(states, key=lambda state: state.largest)
    valid, (least, most) = _valid(material), material.built().stretch_limits
    is_valid = valid is None or (low >= valid.stretches[0] and high.largest <= valid.stretches[1])
    clauses = [] if valid is None or is_valid else [valid.sentence]
    ends = [f"below {least:.2f} (compressed)"] if low < least else []
    ends += [f"beyond {most:.2f}"] if high.largest > most else []
    if ends:
        law = "it" if clauses else f"the law {material.law} with these constants"
        clauses.append(f"{law} is not stable {' and '.join(ends)}")
    if not clauses:
        return ""
    return (
        f"stretches in the walls{of_part} go from {low:.2f} (compressed) to {high.largest:.2f} (at "
        f"{high.pressure_kPa:g} kPa), and {', and '.join(clauses)}; fit another law to a tensile test with pneurod "
        "material"
    )


def _out_of_plane(solved: Solved) -> str:
    """The rod is a planar curve."""
    worst = max((record.summary for record in solved.outcomes.records), key=lambda summary: summary.curve_z_mm)
    part = worst.curve_z_mm / solved.config.design.length
    if part < OUT_OF_PLANE:
        return ""
    return (
        f"the arm leaves the plane z = 0 by up to {worst.curve_z_mm:.3g} mm ({worst.experiment}, "
        f"{worst.pressure_kPa:g} kPa), {100 * part:.3g} % of its length; the rods are planar, and the errors given for "
        "them do not contain that"
    )


def _hardly_bent(solved: Solved) -> str:
    bent = _bends(solved)
    if not bent or max(bent.values()) >= HARDLY_BENT or not solved.config.effects.pressure.acts:
        return ""
    highest = max(bent)
    return (
        f"the arm hardly bends: at {highest:g} kPa its curvature adds up to {bent[highest]:.2g} rad over the length, "
        "so that the mesh, rounding and what the pressure does to the cross-section of its end matter more than usual; "
        "give higher pressures or thinner walls, or displace the end farther in experiment III (end.y)"
    )


def largest_bend_rad(solved: Solved) -> float:
    """Of II at the pressures that were reached; infinite where it is not known."""
    return max(_bends(solved).values(), default=inf)


def _bends(solved: Solved) -> dict[float, float]:
    """Curvature in the middle of the length in II times the length, rad, by pressure; of arms that are too short for
    five parameters too."""
    if solved.parameters:
        return {p.pressure_kPa: abs(p.kappa_0_middle) * p.kappa_0.length for p in solved.parameters}
    design = solved.config.design
    of_states = {
        record.pressure_kPa: record.kappa_middle(design.pitch)
        for record in solved.outcomes.records
        if record.experiment == "II"
    }
    return {pressure: abs(kappa) * design.length for pressure, kappa in of_states.items() if kappa is not None}


def _few_reached(solved: Solved) -> str:
    """Fewer pressures with five parameters than were given, and too few to test how these change."""
    count, given = len(solved.parameters), len(solved.config.pressures_kPa)
    if not 0 < count < SEVERAL <= given:
        return ""
    known, what = ("one pressure", "how they change") if count == 1 else ("two pressures", "whether they are linear")
    end = solved.outcomes.lowest_end_kPa()
    return (
        f"five parameters are known at {known} alone, of {given} that were given, which cannot tell {what} in the "
        f"pressure; give more pressures{f' below {end:.3g} kPa' if isfinite(end) else ''}"
    )


def _not_determined(solved: Solved) -> str:
    """The data of an arm that hardly bends, or whose curvature no line describes, leave the rigidity open."""
    wide = [
        f"{symbol} at {p.pressure_kPa:g} kPa from {spread.low:.3g} to {spread.high:.3g} N mm²"
        for p in solved.parameters
        for symbol, spread in _rigidities(p.numbers)
        if spread.high > DETERMINED * spread.low
    ]
    if not wide:
        return ""
    return (
        f"the experiments do not determine the rigidity of the rod with five parameters: 95 % interval of "
        f"{', of '.join(wide)}; give higher pressures, or use the arm's own law if it has one"
    )


def _poorly_described(solved: Solved) -> str:
    """A single line that explains little of the curvature along the arm, so that its rigidity is a mean of parts that
    differ."""
    poor = {
        p.pressure_kPa: p.by_cells.single_line.r2
        for p in solved.parameters
        if not p.two_lines and p.by_cells.single_line.r2 < POORLY_DESCRIBED
    }
    if not poor:
        return ""
    low, high = (f"{100 * end:.0f}" for end in (min(poor.values()), max(poor.values())))
    part = low if low == high else f"{low} to {high}"
    below, above = OVER_THAT_OF_A_CELL
    return (
        f"at {', '.join(f'{pressure:g}' for pressure in poor)} kPa the line of the rod with five parameters describes "
        f"only {part} % of the variance of the change of curvature (R²): its α is a mean over parts of the arm that "
        "differ, such as the ends, and may be far from the rigidity of the inner part, beyond its interval (in seven "
        f"arms drawn at random with such an R² it was {below:g} to {above:g} times as large); the arm's own law, where "
        "it has one, has that of the inner part"
    )


def _one_line_or_two(solved: Solved) -> str:
    """The data hardly decide between one line and two, or decide otherwise on a coarser mesh."""
    unclear = [_choice(p) for p in solved.parameters if _is_open(p)]
    if not unclear:
        return ""
    return (
        "the data of the five parameters do not decide clearly between a single line and two, so that α₂ is less "
        f"certain than its interval says: {'; '.join(unclear)}"
    )


def _is_open(p: Parameters) -> bool:
    return not p.choice_is_clear or _is_other_on_coarser(p)


def _choice(p: Parameters) -> str:
    lines = p.by_cells
    alpha2 = {"a single line": lines.single_line.alpha.value, "two lines": lines.alpha2.value}
    other, chosen = alpha2 if p.two_lines else reversed(alpha2)
    elsewhere = f"; on the coarser mesh {other} would be taken" if _is_other_on_coarser(p) else ""
    return (
        f"at {p.pressure_kPa:g} kPa {alpha2[chosen]:.3g} N mm² with {chosen}, as reported, and {alpha2[other]:.3g} "
        f"N mm² with {other} (difference of the Bayesian information criterion {abs(p.evidence):.2g}"
        f"{elsewhere})"
    )


def _is_other_on_coarser(p: Parameters) -> bool:
    return p.two_lines_on_coarser not in (None, p.two_lines)


def _rigidities(numbers: Mapping[str, Interval]) -> list[tuple[str, Interval]]:
    """Symbols and values of the two rigidities, once where they are the same."""
    first, second = numbers["alpha1"], numbers["alpha2"]
    return [("α₁ = α₂", first)] if first == second else [("α₁", first), ("α₂", second)]


def _approximate_contact(solved: Solved) -> str:
    """Contact whose distances were compared with exact ones: the largest difference, and where none is known."""
    checks = [
        (check, f"{record.summary.experiment} at {record.summary.pressure_kPa:g} kPa")
        for record in solved.outcomes.records
        if (check := record.summary.contact_check)
    ]
    unknown = [state for check, state in checks if check.end_mm is None]
    parts = []
    for name, unit in (("end_mm", "mm"), ("end_N", "N")):
        largest, state = max(((getattr(check, name) or 0.0, state) for check, state in checks), default=(0.0, ""))
        if largest > NOTHING:
            quantity = "the end is displaced" if unit == "mm" else "the force on the end differs"
            parts.append(f"{quantity} by at most {largest:.2g} {unit} ({state})")
    if parts:
        parts[0] = f"with exact distances between them {parts[0]}"
    if unknown:
        parts.append(f"by how much is not known in {', '.join(unknown)}, where the comparison failed")
    return f"{BESIDE}: {'; '.join(parts)}" if parts else ""


def _path_dependent(solved: Solved) -> str:
    """Contact in creases that may depend on the load increments: where, and the largest difference that is known."""
    summaries = [record.summary for record in solved.outcomes.records if record.summary.path_dependence]
    parts = []
    for unknown in (False, True):
        here = [summary for summary in summaries if isinf(summary.path_dependence) == unknown]
        states = ", ".join(f"{summary.experiment} at {summary.pressure_kPa:g} kPa" for summary in here)
        if here:
            parts.append(f"in {states} {path_dependence(*(summary.path_dependence for summary in here))}")
    return f"{PATH_DEPENDENT}: {'; '.join(parts)}; the states of the increments are reported" if parts else ""


#: the rules
AFTER: tuple[Callable[[Solved], str], ...] = (
    _volume_change,
    _large_strain,
    _out_of_plane,
    _hardly_bent,
    _few_reached,
    _not_determined,
    _poorly_described,
    _one_line_or_two,
    _approximate_contact,
    _path_dependent,
)
