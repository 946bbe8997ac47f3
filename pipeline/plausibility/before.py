"""Sentences on a design, known from its configuration alone."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isinf

from pipeline.config.automatic_mesh import two_digits_down
from pipeline.config.config import Config
from pipeline.identification.too_short import too_short
from pipeline.plausibility.body import of_edges
from rod import too_few_pitches

#: p V_air / (E V_solid), about half the strain of a wall under the pressure p: the arms of the paper have 0.003 to
#: 0.03, arms in the hard cases reach a limit between 0.02 and 0.06. BORNE_LOAD: the largest that is suggested for an
#: arm that hardly bends
LARGEST_LOAD, BORNE_LOAD, SMALLEST_LOAD = 0.1, 0.02, 3e-4
#: the same at the highest pressure that is suggested where the given ones hardly bend the arm
USUAL_LOAD = 30.0 * SMALLEST_LOAD
#: kPa; no higher pressure is suggested, because no arm of rubber needs it
HIGHEST_PRESSURE = 1000.0
RUBBERS = "rubbers have a Young's modulus of 0.05 to 10 MPa"
#: the highest pressure that is suggested, over the one at which an experiment has ended: the others may end earlier
#: (III of the coarse pneu-net at 0.69 times the limit of II), and I is not followed beyond the end of II
WELL_BELOW = 0.6
#: rotation of the end in II (kappa_0 at half of the length times the length) below which an arm hardly bends, and the
#: one for which pressures are suggested then, rad
HARDLY_BENT, BENT = 0.05, 0.1
SMALLEST_BEND = 1e-9


@dataclass(frozen=True)
class Borne:
    """What is known of an arm after a run: the pressures that it bears, and how far it bends."""

    end_kPa: float = inf  #: the lowest pressure at which an experiment has ended; infinite where none has
    reached_kPa: float = 0.0  #: the highest one that II and III have both reached
    bend_rad: float = inf  #: the largest rotation of the end in II; infinite where it is not known

    def suggested(self, pressure_kPa: float) -> float:
        """A pressure to suggest, or a lower one where the arm may not bear it, kPa."""
        likely = _two_digits(min(pressure_kPa, WELL_BELOW * self.end_kPa))
        solved = min(pressure_kPa, self.reached_kPa)
        return max(likely, two_digits_down(solved)) if solved > 0.0 else likely


#: before a run
UNKNOWN = Borne()


def before_solving(config: Config, borne: Borne = UNKNOWN) -> tuple[str, ...]:
    """The sentences on a design, known from its configuration; borne: what is known of it after a run."""
    of_pressures = (rule(config, borne) for rule in ON_PRESSURES)
    return tuple(filter(None, (*of_pressures, *(rule(config) for rule in ON_DESIGN))))


def _load(config: Config) -> tuple[float, str]:
    """The largest pressure as p V_air / (E V_solid), and the beginning of a sentence about it."""
    modulus, design, pressure = config.material.built().young_modulus, config.design, config.pressures_kPa[-1]
    air = design.cavity_volume / design.solid_volume
    beginning = (
        f"{pressure:g} kPa on walls with a Young's modulus of {modulus:.3g} MPa and {air:.2g} times as much air as "
        "material"
    )
    return pressure / (1000.0 * modulus) * air, beginning


def _strong_pressure(config: Config, borne: Borne) -> str:
    load, beginning = _load(config)
    if config.effects.pressure.off or load <= LARGEST_LOAD:
        return ""
    estimate = _two_digits(config.pressures_kPa[-1] * LARGEST_LOAD / load)
    limit = (
        f"stay well below {estimate:g} kPa, an estimate from stiffness and volumes alone"
        if isinf(borne.end_kPa)
        else f"stay below {borne.suggested(inf):g} kPa, because an experiment ended at {borne.end_kPa:.3g} kPa"
    )
    return (
        f"{beginning} are {load / LARGEST_LOAD:.2g} times what such an arm usually bears before its walls inflate like "
        f"balloons; check the units (kPa, MPa), or {limit}"
    )


def _weak_pressure(config: Config, borne: Borne) -> str:
    load, beginning = _load(config)
    if config.effects.pressure.off or load >= SMALLEST_LOAD:
        return ""
    suggested = borne.suggested(config.pressures_kPa[-1] * USUAL_LOAD / load)
    remedy = (
        f"; check the units (kPa, MPa, GPa), or give pressures up to {suggested:g} kPa"
        if suggested <= HIGHEST_PRESSURE
        else f"; check the units of material and pressures (kPa, MPa, GPa): {RUBBERS}"
    )
    return f"{beginning} will hardly bend the arm{remedy}"


def _unequal_cells(config: Config) -> str:
    design = config.design
    if config.law == "cell" or design.has_equal_cells or too_short(config):
        return ""
    return (
        f"the chambers or gaps are not equal: curvatures are means over the mean pitch of {design.pitch:.3g} mm, and "
        "the five parameters, which describe an arm of equal cells, are a rough model; the report has their errors"
    )


def _long_cells(config: Config) -> str:
    """Cavities that follow one another at larger distances than the curvature is averaged over."""
    design, between = config.design, config.design.cavity_pitch
    wanted = config.law != "cell" and config.identification.d_mm is None
    if not wanted or not design.averages_within_cavities or too_short(config):
        return ""
    is_long = not too_few_pitches(design.length, between)
    how = f"; give geometry.cell: {between:.4g} mm, or" if is_long else ";"
    return (
        f"curvatures are means over {design.pitch:.3g} mm, and the middles of the cavities are up to {between:.3g} mm "
        f"apart: two lines would describe the cavities and the walls between them, so that a single line is taken{how} "
        "identification.d asks for two"
    )


def _pressure_of_run_unused(config: Config) -> str:
    pressure = config.effects.pressure
    if pressure.acts:
        return ""
    if pressure.off:
        several = "effects.pressure is off, so that the states at all pressures are the same; switch it on, or give one"
        return several if len(config.pressures_kPa) + config.added_pressures > 1 else ""
    name = next(iter(pressure.cavities), "cavity")
    return (
        "no cavity follows the pressure of the run, because each has a constant pressure or none, so that the states "
        f"at all pressures are the same; give one a fraction, for example effects.pressure: {{cavities: {{{name}: 1}}}}"
    )


def _few_pressures(config: Config, borne: Borne) -> str:
    count = len(config.pressures_kPa) + config.added_pressures
    if count > 2 or config.law == "cell" or too_short(config) or not config.effects.pressure.acts:
        return ""
    untested = "how the parameters change" if count == 1 else "whether the parameters are linear in the pressure"
    load, _ = _load(config)
    part = USUAL_LOAD / load if load < SMALLEST_LOAD else min(1.0, LARGEST_LOAD / load)
    if hardly_bends := load >= SMALLEST_LOAD and borne.bend_rad < HARDLY_BENT:
        part = max(part, min(BENT / max(borne.bend_rad, SMALLEST_BEND), BORNE_LOAD / load))
    number = "one pressure" if count == 1 else "two pressures"
    sentence = f"{number} cannot tell {untested}; give three or more"
    given, high = config.pressures_kPa, borne.suggested(config.pressures_kPa[-1] * part)
    if (load < SMALLEST_LOAD and high > HIGHEST_PRESSURE) or (
        hardly_bends and not given[-1] < high <= HIGHEST_PRESSURE
    ):
        return sentence
    values = [_two_digits(fraction * high) for fraction in (0.25, 0.5, 0.75, 1.0)]
    if high == _two_digits(given[-1]):  # the given ones stay
        between = [_between(*given)] if len(given) == 2 else values[:-1]
        values = sorted({*between, *given})
    suggested = ", ".join(f"{value:g} kPa" for value in values)
    return f"{sentence}, for example pressures: [{suggested}]"


def _between(low: float, high: float) -> float:
    """The middle in as few digits, from two on, as keep it between the two."""
    middle = (low + high) / 2
    return next(value for digits in range(2, 18) if low < (value := float(f"{middle:.{digits}g}")) < high)


def _turned_gravity(config: Config) -> str:
    gravity, design = config.effects.gravity, config.design
    x, _, z = gravity.acceleration_mm_s2
    if not gravity.on or (x == 0.0 and z == 0.0) or not design.is_turned:
        return ""
    return (
        "gravity is in the frame of the arm, whose x runs from the clamp to the tip, and so against the x in which "
        "geometry.clamp is given, as does its z; give effects.gravity.acceleration in this frame"
    )


def _two_digits(value: float) -> float:
    return float(f"{value:.2g}")


def of_load(config: Config) -> tuple[str, ...]:
    """The sentences on pressures, known from the configuration, that hold without a run too."""
    rules = (_strong_pressure(config, UNKNOWN), _weak_pressure(config, UNKNOWN), _pressure_of_run_unused(config))
    return tuple(filter(None, rules))


#: the rules on the pressures, given where an experiment has ended, and those on the rest of the configuration
ON_PRESSURES: tuple[Callable[[Config, Borne], str], ...] = (_strong_pressure, _weak_pressure, _few_pressures)
ON_DESIGN: tuple[Callable[[Config], str], ...] = (
    too_short,
    _unequal_cells,
    _long_cells,
    _pressure_of_run_unused,
    _turned_gravity,
    of_edges,
)
