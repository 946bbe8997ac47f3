"""Whether a design and its results are plausible: sentences with a suggestion, for what is possible but unusual.

What is impossible is refused by `pipeline.config`. A rule looks at a configuration before anything is solved, or at the
states that were reached, and gives a sentence, empty where nothing is unusual.
"""

from collections.abc import Callable
from dataclasses import dataclass

import fem
from fem.elements import ELEMENTS, Volumetric
from geometry import Body, CadFile, Mesh, PneuNet
from pipeline.config.config import AUTO, Config
from pipeline.identification.parameters import Parameters
from pipeline.simulation.outcome import Outcomes, StateSummary
from rod import too_few_pitches

#: p V_air / (E V_solid), about half the strain of a wall under the pressure p: the arms of the paper have 0.003 to
#: 0.03, arms in the hard cases reach a limit between 0.02 and 0.06
LARGEST_LOAD, SMALLEST_LOAD = 0.1, 3e-4
#: Poisson's ratio from which on a material keeps its volume, and the largest change of volume that is not mentioned
NEARLY_INCOMPRESSIBLE, VOLUME_CHANGE = 0.49, 0.3
#: largest stretch or its reciprocal up to which the law for small strains is not mentioned
SMALL_STRAIN = 1.1
#: rotation of the end in II (kappa_0 at half of the length times the length) below which an arm hardly bends, rad
HARDLY_BENT = 0.05
#: smallest radius ratio of an element that is not mentioned: meshes of the families have 0.1 to 0.3, and below this one
#: a mesh of a CAD file is optimized once more
FLAT_ELEMENT = 0.05
#: length of an edge of a CAD file, over the size of the elements, below which it is mentioned
SMALL_EDGE = 1 / 3
#: distance of a cavity from the plane of symmetry, over the length of the arm, that is more than rounding
APART = 1e-5


@dataclass(frozen=True)
class Solved:
    """A run as far as its experiments and its identification went."""

    config: Config
    outcomes: Outcomes
    parameters: tuple[Parameters, ...]


def before_solving(config: Config) -> tuple[str, ...]:
    """The sentences on a design, known from its configuration alone."""
    return tuple(filter(None, (rule(config) for rule in BEFORE)))


def of_half(body: Body) -> str:
    """The sentence on cavities that have a mirror image apart from themselves in a half that is meshed; else empty."""
    if not body.half:
        return ""
    points, faces = body.mesh.points, body.mesh.faces
    away = [name for name in body.cavities if points[faces[name], 2].min() > APART * body.length]
    if not away:
        return ""
    names, verb, them = ", ".join(away), "does" if len(away) == 1 else "do", "it" if len(away) == 1 else "them"
    return (
        f"of the half z >= 0 of the body, {names} {verb} not reach the plane z = 0: the whole body has a mirror image "
        f"of {them} at z < 0, with the same pressure; write geometry.symmetric: false if it has not"
    )


def of_edges(config: Config) -> str:
    """The sentence on edges of a CAD file that are short for the size of the elements, known before meshing; else
    empty."""
    design = config.design
    if not isinstance(design, CadFile) or config.mesh.size_mm is AUTO:
        return ""
    size = config.mesh.element_size_mm
    small = [edge for edge in design.edges if edge[0] < SMALL_EDGE * size]
    if not small:
        return ""
    length, where = small[0]
    return (
        f"{len(small)} of the {len(design.edges)} edges in the CAD file are shorter than a third of mesh.size, "
        f"{size:g} mm, the shortest {length:.2g} mm near {where}: elements there are as small, and meshing may take "
        "minutes; remove small fillets, steps and letters in the CAD program if they do not matter"
    )


def of_mesh(mesh: Mesh) -> tuple[str, ...]:
    """The sentences on a mesh, known before anything is solved."""
    quality = mesh.quality
    if quality.minimum >= FLAT_ELEMENT:
        return ()
    where = ", ".join(f"{coordinate:.3g}" for coordinate in quality.position)
    return (
        f"the flattest of the {quality.count} elements has a radius ratio of {quality.minimum:.2g} (a regular one "
        f"has 1), near ({where}) mm, where stresses may be inaccurate and large deformation may end early; look for a "
        "small edge or a thin gap of the body there, or mesh it with another size",
    )


def after_solving(solved: Solved) -> tuple[str, ...]:
    """The sentences on the states that were reached."""
    if not solved.outcomes.records:
        return ()
    return tuple(filter(None, (rule(solved) for rule in AFTER)))


def _load(config: Config) -> tuple[float, str]:
    """The largest pressure as p V_air / (E V_solid), and the beginning of a sentence about it."""
    law, design, pressure = config.material.built(), config.design, config.pressures_kPa[-1]
    modulus = 2.0 * law.shear_modulus * (1.0 + law.poisson_ratio)
    air = design.cavity_volume / design.solid_volume
    beginning = (
        f"{pressure:g} kPa on walls with a Young's modulus of {modulus:.3g} MPa and {air:.2g} times as much air as "
        "material"
    )
    return pressure / (1000.0 * modulus) * air, beginning


def _strong_pressure(config: Config) -> str:
    load, beginning = _load(config)
    if config.effects.pressure.off or load <= LARGEST_LOAD:
        return ""
    pressure = config.pressures_kPa[-1]
    return (
        f"{beginning} are {load / LARGEST_LOAD:.2g} times what such an arm usually bears before its walls inflate like "
        f"balloons; check the units (kPa, MPa), or stay well below {_two_digits(pressure * LARGEST_LOAD / load):g} kPa"
    )


def _weak_pressure(config: Config) -> str:
    load, beginning = _load(config)
    if config.effects.pressure.off or load >= SMALLEST_LOAD:
        return ""
    pressure = config.pressures_kPa[-1]
    return (
        f"{beginning} will hardly bend the arm; check the units (kPa, MPa, GPa), or give pressures up to "
        f"{_two_digits(30.0 * pressure * SMALLEST_LOAD / load):g} kPa"
    )


def _few_cells(config: Config) -> str:
    if config.law == "cell" or not (sentence := too_few_pitches(config.design.length, config.design.pitch)):
        return ""
    remedies = {"chambers": "more geometry.chambers", "cell": "a smaller geometry.cell"}
    remedy = next((text for key, text in remedies.items() if hasattr(config.design, key)), "a larger geometry.length")
    return f"{sentence.removesuffix('.')}; give {remedy}, or law: cell for the arm's own law alone"


def _unequal_cells(config: Config) -> str:
    design = config.design
    if config.law == "cell" or not isinstance(design, PneuNet) or design.equal:
        return ""
    return (
        f"the chambers or gaps are not equal: curvatures are means over the mean pitch of {design.pitch:.3g} mm, and "
        "the five parameters, which describe an arm of equal cells, are a rough model; the report has their errors"
    )


def _few_pressures(config: Config) -> str:
    count = len(config.pressures_kPa) + config.added_pressures
    if count > 2 or config.law == "cell":
        return ""
    untested = "how the parameters change" if count == 1 else "whether the parameters are linear in the pressure"
    load, _ = _load(config)
    high = config.pressures_kPa[-1] * min(1.0, LARGEST_LOAD / load)
    suggested = ", ".join(f"{_two_digits(fraction * high):g} kPa" for fraction in (0.25, 0.5, 0.75, 1.0))
    number = "one pressure" if count == 1 else "two pressures"
    return f"{number} cannot tell {untested}; give three or more, for example pressures: [{suggested}]"


def _volume_change(solved: Solved) -> str:
    """Elements with one point for the volumetric part change their volume where it should be kept."""
    element, law = ELEMENTS[solved.config.mesh.formulation], solved.config.material.built()
    worst = min((record.summary for record in solved.outcomes.records), key=lambda summary: summary.extremes.min_J)
    lost = 1.0 - worst.extremes.min_J
    if element.volumetric is Volumetric.PRESSURE or law.poisson_ratio < NEARLY_INCOMPRESSIBLE or lost < VOLUME_CHANGE:
        return ""
    return (
        f"the material loses up to {100 * lost:.0f} % of its volume at {fem.position_text(worst.extremes.min_J_at)} "
        f"({worst.experiment}, {worst.pressure_kPa:g} kPa), although a Poisson ratio of {law.poisson_ratio:.4g} keeps "
        "it nearly; compare with mesh.formulation: mixed, or with a smaller mesh.size"
    )


def _large_strain(solved: Solved) -> str:
    """St. Venant-Kirchhoff is a law for small strains."""
    if solved.config.material.law != "svk":
        return ""
    states = [record.summary for record in solved.outcomes.records]
    low, high = (choose(states, key=key) for choose, key in ((min, _smallest_stretch), (max, _largest_stretch)))
    if max(high.extremes.max_stretch, 1.0 / low.extremes.min_stretch) <= SMALL_STRAIN:
        return ""
    return (
        f"stretches in the walls go from {low.extremes.min_stretch:.2f} (compressed) to "
        f"{high.extremes.max_stretch:.2f} (at {high.pressure_kPa:g} kPa), and St. Venant-Kirchhoff (svk) is a law for "
        "small strains: for the silicone Elastosil M 4601 it holds up to a stretch of 1.08; fit another law to a "
        "tensile test with pneurod material"
    )


def _hardly_bent(solved: Solved) -> str:
    bent = [abs(p.kappa_0_middle) * p.kappa_0.length for p in solved.parameters]
    if not bent or max(bent) >= HARDLY_BENT:
        return ""
    return (
        f"the arm hardly bends: at {solved.parameters[-1].pressure_kPa:g} kPa its curvature adds up to {bent[-1]:.2g} "
        "rad over the length, so that mesh and rounding matter more than usual; give higher pressures or thinner walls"
    )


def _smallest_stretch(summary: StateSummary) -> float:
    return summary.extremes.min_stretch


def _largest_stretch(summary: StateSummary) -> float:
    return summary.extremes.max_stretch


def _two_digits(value: float) -> float:
    return float(f"{value:.2g}")


#: the rules on a configuration, and those on the states that were reached
BEFORE: tuple[Callable[[Config], str], ...] = (
    *(_strong_pressure, _weak_pressure, _few_cells),
    *(_unequal_cells, _few_pressures, of_edges),
)
AFTER: tuple[Callable[[Solved], str], ...] = (_volume_change, _large_strain, _hardly_bent)
