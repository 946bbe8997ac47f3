"""Rules on a configuration, known before anything is meshed."""

from collections.abc import Iterator

from geometry import Reason
from pipeline.config.config import Config
from pipeline.simulate.too_short import too_short
from pipeline.values.pressure import in_MPa

#: p V_air / (E V_solid), about half the strain of a wall under the pressure p: the arms of the paper have 0.003 to
#: 0.03, arms in the hard cases reach a limit between 0.02 and 0.06
LARGEST_LOAD, SMALLEST_LOAD = 0.1, 3e-4
#: kg/m^3, from foams to copper in a region of another material
LIGHTEST, HEAVIEST = 20.0, 9000.0
#: length of an edge of a CAD file, over the size of the elements, below which it is mentioned
SHORT_EDGE = 1 / 3
#: length of a body from a file over the size of the elements above which it may be in another unit
LONG = 100.0
#: pressures from which on it can be tested whether parameters are linear in the pressure
SEVERAL = 3


def check_load(config: Config) -> tuple[Reason, ...]:
    """What is unusual about a configuration, whatever is made of it."""
    rules = (_pressure, _unused_pressure, _turned_gravity, _short_edges, _air_left_out, _batches)
    return (*filter(None, (rule(config) for rule in rules)), *_densities(config), *_of_file(config))


def check_design(config: Config) -> tuple[Reason, ...]:
    """What is unusual about a configuration from which five parameters are to be identified."""
    short = too_short(config)
    if config.draft:
        return check_load(config)
    if short or config.law == "cell":
        return (*check_load(config), *([short] if short else []))
    rules = (_unequal_cells, _few_pressures)
    return (*check_load(config), *filter(None, (rule(config) for rule in rules)))


def _pressure(config: Config) -> Reason | None:
    """Pressures that make walls inflate like balloons, or hardly bend them, most likely in another unit."""
    modulus, design, pressure = config.material.built().young_modulus, config.design, config.pressures_kPa[-1]
    load = in_MPa(pressure) / modulus * design.cavity_volume / design.solid_volume
    values = {"pressure_kPa": pressure, "modulus_MPa": modulus, "load": load}
    if config.effects.pressure.off or SMALLEST_LOAD <= load <= LARGEST_LOAD:
        return None
    if load < SMALLEST_LOAD:
        return Reason("weak_pressure", values)
    ratio = load / LARGEST_LOAD
    return Reason("strong_pressure", values | {"ratio": ratio, "bearable_kPa": float(f"{pressure / ratio:.2g}")})


def _unused_pressure(config: Config) -> Reason | None:
    pressure, count = config.effects.pressure, len(config.pressures_kPa)
    unused = not pressure.acts and (count > 1 or not pressure.off)
    return Reason("pressure_unused", {"count": count}) if unused else None


def _turned_gravity(config: Config) -> Reason | None:
    gravity = config.effects.gravity
    x, _, z = gravity.acceleration_mm_s2
    return Reason("turned_gravity") if gravity.on and config.design.is_turned and (x or z) else None


def _short_edges(config: Config) -> Reason | None:
    """Edges of a CAD file where elements are as small, so that meshing may take minutes."""
    limit = SHORT_EDGE * config.mesh.size_mm
    short = [edge for edge in config.design.edges if edge[0] < limit]
    if not short:
        return None
    length, where = short[0]
    return Reason("short_edges", {"count": len(short), "shortest_mm": length, "limit_mm": limit, "near": where})


def _air_left_out(config: Config) -> Reason | None:
    return Reason("air_left_out", {"around": config.design.left_out}) if config.design.left_out else None


def _of_file(config: Config) -> Iterator[Reason]:
    names = list(config.design.region_volumes) if config.design.is_from_file and not config.materials else []
    if len(names) > 1:
        yield Reason("one_material", {"names": names})
    times = config.design.length / config.mesh.size_mm
    if config.design.is_from_file and times > LONG:
        yield Reason("large_body", {"length_mm": config.design.length, "times": times})


def _densities(config: Config) -> Iterator[Reason]:
    for key, law in {"material": config.material, **{f"materials.{k}": v for k, v in config.materials.items()}}.items():
        density = 1e12 * (law.density_tonne_mm3 or 0.0)
        if law.density_tonne_mm3 is not None and not LIGHTEST <= density <= HEAVIEST:
            yield Reason("density", {"key": key, "density_kg_m3": density})


def _batches(config: Config) -> Reason | None:
    """A rubber by name has constants of one batch that somebody else has tested."""
    laws = (config.material, *config.materials.values())
    names = list(dict.fromkeys(law.name for law in laws if law.name))
    return Reason("named_rubber", {"names": names}) if names else None


def _unequal_cells(config: Config) -> Reason | None:
    design = config.design
    return None if design.has_equal_cells else Reason("unequal_cells", {"averaging_mm": design.pitch})


def _few_pressures(config: Config) -> Reason | None:
    count = len(config.pressures_kPa)
    few = count < SEVERAL and config.effects.pressure.acts
    return Reason("few_pressures", {"count": count}) if few else None
