"""Sentences on numbers of a configuration that no arm has, most likely because of their unit."""

from collections.abc import Callable, Iterator
from math import hypot, isfinite

from pipeline.config.config import Config, Material
from pipeline.simulation.scene import Scene

#: kg/m^3, from foams to rubbers with heavy fillers; a region with a material of its own may be of metal, up to copper
LIGHTEST, HEAVIEST, HEAVIEST_REGION = 20.0, 3000.0, 9000.0
#: largest displacement of the end across the arm, over its length: that of an arc is (1 - cos t) / t, t its angle,
#: and that is 0.725 at most
HIGHEST_END = 0.72
#: smallest one that is not taken for zero
LOWEST_END = 5e-4
#: largest displacement of the end towards the clamp, over the length of the arm: that of an arc is 1 - sin t / t
FARTHEST_BACK = 1.22
#: force on the end over E I / l^2, with I of the box around the section: 0.08 to 0.3 in the configurations of the
#: paper's arms, whose walls have 0.03 to 0.06 of this rigidity
LARGEST_FORCE, SMALLEST_FORCE = 3.0, 1e-4
#: strain of the arm under a force or a displacement that pulls along it
LARGEST_PULL = 0.5
#: activation distance of contact over the smallest gap: errors of kappa_0 are 1 % with 0.02, 4 % with 0.08
#: (docs/accuracy.md), and 0.0025 is the smallest with which an arm was solved
LARGEST_PART, SMALLEST_PART = 0.1, 1e-3
#: MPa, Young's moduli of foams and of tool steel
SOFTEST, STIFFEST = 1e-3, 3e5
#: thickness of a strain-limiting layer over the height of the arm, and the smallest one, mm
LARGEST_LAYER, THINNEST_LAYER = 0.1, 1e-3
#: Poisson ratio below which a bulk modulus is likely in another unit than the shear modulus
LEAST_POISSON = 0.2
#: m/s2, of gravity
LEAST_GRAVITY, MOST_GRAVITY = 0.1, 100.0
#: activation distance of contact over the thinnest wall
LARGEST_PART_OF_WALL = 0.25


def of_units(config: Config) -> tuple[str, ...]:
    """The sentences on densities, and on heights of the end and forces on it, known before the body is meshed."""
    return tuple(sentence for rule in RULES for sentence in rule(config))


def of_contact(scene: Scene) -> str:
    """The sentence on the activation distance of contact, known from the meshed body; else empty."""
    dhat = scene.config.effects.self_contact.dhat_mm
    if dhat is None or not isfinite(gap := scene.smallest_gap):
        return ""
    wall = scene.config.design.thinnest_wall
    largest = min(LARGEST_PART * gap, LARGEST_PART_OF_WALL * wall)
    if SMALLEST_PART * gap <= dhat <= largest:
        return ""
    what = (
        "keeps walls in contact so far apart that the results change by more than a few per cent"
        if dhat > largest
        else "is smaller than any with which an arm was solved, and may need very many iterations"
    )
    return (
        f"effects.self_contact.dhat, {dhat:g} mm with a smallest gap of {gap:.3g} mm and a thinnest wall of "
        f"{wall:.3g} mm, {what}; check its unit, leave it out, or give {0.005 * gap:.2g} to {largest:.2g} mm"
    )


def _densities(config: Config) -> Iterator[str]:
    yield from _density("material", config.material, HEAVIEST, "rubbers and foams")
    for region, material in config.materials.items():
        yield from _density(f"materials.{region}", material, HEAVIEST_REGION, "foams, rubbers and metals")


def _density(key: str, material: Material, heaviest: float, substances: str) -> Iterator[str]:
    if material.density_tonne_mm3 is None:
        return
    density = 1e12 * material.density_tonne_mm3
    if LIGHTEST <= density <= heaviest:
        return
    likely = {f"{density:g} g/cm^3": 1e3 * density, f"{1e-3 * density:g} kg/m^3": 1e-3 * density}
    meant = [f"perhaps {text} is meant" for text, value in likely.items() if LIGHTEST <= value <= heaviest]
    yield (
        f"{key}.density is {density:.4g} kg/m^3, and {substances} have {LIGHTEST:g} to {heaviest:g} kg/m^3; "
        f"{' '.join(meant) or 'check its unit (kg/m^3, g/cm^3)'}"
    )


def _poisson_ratios(config: Config) -> Iterator[str]:
    for region, material in {"": config.material, **config.materials}.items():
        ratio = material.built().poisson_ratio
        if ratio < LEAST_POISSON and "nu" not in material.constants:
            key = f"materials.{region}" if region else "material"
            yield (
                f"{key}: its bulk and shear moduli mean a Poisson ratio of {ratio:.2g}, and rubbers have 0.45 to "
                "0.4999; check the unit of kappa (kPa, MPa), or give nu: 0.495 instead"
            )


def _moduli(config: Config) -> Iterator[str]:
    """Of regions of another material and of the layer; that of the arm is compared with its pressures."""
    moduli = {f"materials.{name}": material.built().young_modulus for name, material in config.materials.items()}
    layer = config.effects.strain_limiting_layer
    if layer.on:
        moduli["effects.strain_limiting_layer"] = layer.E_MPa
    for key, modulus in moduli.items():
        if not SOFTEST <= modulus <= STIFFEST:
            yield (
                f"{key}: Young's modulus is {modulus:.3g} MPa, and foams, rubbers, papers and metals have "
                f"{SOFTEST:g} to {STIFFEST:g} MPa; check its unit (kPa, MPa, GPa)"
            )
    rubber = config.material.built().young_modulus
    if layer.on and SOFTEST <= layer.E_MPa < rubber:
        yield (
            f"effects.strain_limiting_layer: Young's modulus is {layer.E_MPa:.3g} MPa, less than that of the arm, "
            f"{rubber:.3g} MPa, so that it limits no strain; check its unit (MPa, GPa)"
        )


def _layer(config: Config) -> Iterator[str]:
    layer, height = config.effects.strain_limiting_layer, config.design.extent[1]
    if layer.on and not THINNEST_LAYER <= layer.thickness_mm <= LARGEST_LAYER * height:
        yield (
            f"effects.strain_limiting_layer.thickness is {layer.thickness_mm:g} mm, and the arm is {height:.3g} mm "
            "high; the layer is a sheet without bending stiffness, such as 0.1 mm of paper: check its unit (mm, um)"
        )


def _fractions(config: Config) -> Iterator[str]:
    for name, cavity in config.effects.pressure.cavities.items():
        if abs(cavity.fraction) > 1.0:
            yield (
                f"effects.pressure.cavities.{name}: {cavity.fraction:g} without a unit is {cavity.fraction:g} times "
                f"the pressure of the run, {cavity.fraction * config.pressures_kPa[-1]:g} kPa at most; write "
                f"'{cavity.fraction:g} kPa' if a pressure is meant"
            )


def _gravity(config: Config) -> Iterator[str]:
    gravity = config.effects.gravity
    size = hypot(*gravity.acceleration_mm_s2) / 1000.0
    if gravity.on and not LEAST_GRAVITY <= size <= MOST_GRAVITY:
        yield (
            f"effects.gravity.acceleration is {size:g} m/s2 in all, and that of the earth is 9.81 m/s2; check its unit "
            "(m/s^2, mm/s^2)"
        )


def _heights(config: Config) -> Iterator[str]:
    """Of the end in experiment III and in the loads that a user has given."""
    given = {"end.y": [config.end.y_mm or 0.0]}
    if config.validation.with_experiments:
        given["validation.end_y"] = list(config.validation.end_y_mm)
    length = config.design.length
    for key, heights in given.items():
        for height in heights:
            part = abs(height) / length
            if part > HIGHEST_END:
                yield (
                    f"{key} moves the end by {height:g} mm, {part:.2g} times the length of the arm, and an arm that is "
                    f"bent to an arc moves it by {HIGHEST_END:g} times its length at most; check the unit (mm, cm, m), "
                    f"or give less than {HIGHEST_END * length:.3g} mm"
                )
            elif 0.0 < part < LOWEST_END:
                yield (
                    f"{key} moves the end by {height:g} mm, {part:.2g} times the length of the arm, which is hardly "
                    "different from 0 mm; check the unit (mm, cm, m)"
                )


def _pull(config: Config) -> Iterator[str]:
    """The displacement of the end along the arm in experiment III."""
    length, along = config.design.length, config.end.x_mm or 0.0
    moves = f"end.x moves the end by {along:g} mm, {abs(along) / length:.2g} times the length of the arm"
    if along > LARGEST_PULL * length:
        yield (
            f"{moves}, a mean strain of {along / length:.2g} in an arm that is straight; check the unit (mm, cm, m), "
            f"or give less than {LARGEST_PULL * length:.3g} mm"
        )
    elif along < -FARTHEST_BACK * length:
        yield (
            f"{moves}, towards the clamp, and an arm that is bent to an arc moves it by {FARTHEST_BACK:g} times its "
            f"length at most; check the unit (mm, cm, m), or give more than {-FARTHEST_BACK * length:.3g} mm"
        )


def _forces(config: Config) -> Iterator[str]:
    """On the end in experiment III and in the loads that a user has given."""
    design = config.design
    length, height, width = design.extent
    moduli = [material.built().young_modulus for material in (config.material, *config.materials.values())]
    stiff, soft = max(moduli), min(moduli)
    bends, pulls = stiff * width * height**3 / 12.0 / length**2, stiff * design.solid_volume / length
    softly = soft / stiff * bends  # a stiff region may be a thin part of the section
    for key, forces in {"end": [config.end.force_N], "validation.forces": config.validation.forces_N}.items():
        for along, across in forces:
            largest = max(hypot(min(along, 0.0), across) / (LARGEST_FORCE * bends), along / (LARGEST_PULL * pulls))
            size = hypot(along, across)
            if largest > 1.0:
                what = f"{largest:.2g} times what would fold or tear a bar of this material without cavities"
            elif 0.0 < size < SMALLEST_FORCE * softly:
                what = "too small to move the arm"
            else:
                continue
            yield (
                f"{key}: a force of {size:.3g} N on the end is {what}; check its unit (N, mN), or give "
                f"{0.01 * softly:.2g} to {0.3 * softly:.2g} N"
            )


#: the rules on a configuration
RULES: tuple[Callable[[Config], Iterator[str]], ...] = (
    _densities,
    _poisson_ratios,
    _moduli,
    _layer,
    _fractions,
    _gravity,
    _heights,
    _pull,
    _forces,
)
