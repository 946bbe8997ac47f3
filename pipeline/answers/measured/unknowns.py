"""What is unknown of an arm that was built, and what is known of it before it is measured."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.answers.measured.predicted import AS_WRITTEN, LawRods, Setup
from pipeline.answers.measured.rows import VIBRATION, Measurements
from pipeline.answers.rods.budget import make_budgets
from pipeline.answers.rods.in_time import BAND
from pipeline.config.material import LOSS_FACTOR
from pipeline.config.section import not_known
from pipeline.config.tolerances import STIFFNESS, Tolerance, Tolerances
from pipeline.values.errors import InputError, argument
from rod.arm_law.law import ArmLaw

#: names of what is unknown beside dimensions
MODULUS, TREND, GAUGE, CLAMP = "modulus_factor", "modulus_trend", "gauge_offset_kPa", "clamp_angle_deg"
ORIGIN = "origin_x_mm", "origin_y_mm"
#: bend and stretch of another law of the rubber in the second order of the strain
BEND, STRETCH = "second_order_bend", "second_order_stretch"
#: of the rubber in time: a loss factor over the frequencies that were measured, and a slow branch
LOSS, SHARE, SLOW = "loss_factor", "relaxation_g", "relaxation_tau_s"
#: standard deviations: of ln(modulus) at the highest pressure of the law for constants of a data sheet or of another
#: batch; of how much it grows from rest up to there
OF_DATA_SHEET, OF_TREND = 0.4, 0.2
#: of the frame of the places, its origin over the length of the arm and the angle of the clamp in degrees; how many
#: times these are where the rows say that the frame is another one
OF_ORIGIN, OF_CLAMP, OTHER_FRAME = 0.01, 0.5, 5.0
#: the share of a slow branch before anything is known; standard deviations of the logarithms of what the rubber has in
#: time
USUAL_SHARE, OF_RUBBER_IN_TIME = 0.05, 1.0
#: the same of bend and stretch in the second order, found on four arms of `benchmarks/virtual_arms`
OF_BEND, OF_STRETCH = 1.5, 0.7
#: dimensions that are freed by themselves at most
MOST_DIMENSIONS = 4


@dataclass(frozen=True)
class Unknown:
    """One number of an arm or of its measurement, normally distributed."""

    name: str  #: MODULUS, GAUGE, CLAMP, or the key of a parameter of the law
    unit: str
    drawn: float  #: value in the drawing; 1 of the factor of all moduli
    std_before: float  #: before the measurement; of a factor that of its logarithm
    source: str  #: of this deviation
    mean: float = math.nan  #: after the measurement
    std: float = math.nan  #: the same

    @property
    def is_factor(self) -> bool:
        """Whether it changes by a factor, whose logarithm is normally distributed."""
        return self.name in (MODULUS, LOSS, SHARE, SLOW)

    @property
    def is_of_law(self) -> bool:
        """Whether it is a parameter by which the law has derivatives."""
        return self.moves_law and self.name not in (MODULUS, TREND, BEND, STRETCH)

    @property
    def moves_law(self) -> bool:
        """Whether the law changes with it: it is not of the measurement, nor of the rubber in time."""
        return self.name not in (GAUGE, CLAMP, *ORIGIN, LOSS, SHARE, SLOW)

    def value(self, change: float) -> float:
        """The number after a change, of a factor of its logarithm."""
        return self.drawn * math.exp(change) if self.is_factor else self.drawn + change

    def after(self, change: float, std: float) -> "Unknown":
        """This unknown after a measurement, with the mean and the deviation of the change."""
        mean = self.value(change)
        return replace(self, mean=mean, std=std * mean if self.is_factor else std)


@dataclass(frozen=True, eq=False)  # arrays inside
class BuiltArm:
    """The law of an arm and the setup of its measurement, as functions of changes of what is unknown."""

    law: ArmLaw
    unknowns: tuple[Unknown, ...]  #: the first one is MODULUS
    setup: Setup = AS_WRITTEN  #: without changes
    material: Mapping[str, Any] = field(default_factory=dict)  #: without changes, as files have it
    told: Callable[[int], None] = lambda _: None  #: is told how many more numbers were found

    @staticmethod
    def origin_of(measurements: Measurements, length_mm: float) -> tuple[Unknown, ...]:
        """The origin of places whose frame is not known to be that of the rod."""
        axes = {name[-1] for name in measurements.places if not measurements.is_aligned}
        std, told = OF_ORIGIN * length_mm, f"± {100.0 * OF_ORIGIN:g} % of the length"
        named = [name for name, axis in zip(ORIGIN, "xy", strict=True) if axis in axes]
        return tuple(Unknown(name, "mm", 0.0, std, told) for name in named)

    def stds_by_frame(self, *, is_aligned: bool) -> list[Array]:
        """(k,) deviations in the frame of the file, and unless that is aligned, in another one."""
        stds = np.array([unknown.std_before for unknown in self.unknowns])
        is_of_frame = np.isin([unknown.name for unknown in self.unknowns], (*ORIGIN, CLAMP))
        return [stds] if is_aligned else [stds, np.where(is_of_frame, OTHER_FRAME * stds, stds)]

    def changed_rods(self, changes: Array) -> LawRods:
        """The rods of the law after changes (k,). Raises `RodError` where none is left."""
        pairs = zip(self.unknowns, changes.tolist(), strict=True)
        elastic = self._elastic(tuple(change if unknown.moves_law else 0.0 for unknown, change in pairs))
        return LawRods(elastic.law, self.changed_material(changes), elastic)

    @cached_property
    def _elastic(self) -> Callable[[tuple[float, ...]], LawRods]:
        """By changes of the law alone; as many are kept as a round of difference quotients takes."""
        return lru_cache(1 + 2 * len(self.unknowns))(lambda changes: LawRods(self.changed_law(np.array(changes))))

    def changed_material(self, changes: Array) -> dict[str, Any]:
        """The material after changes (k,) of its rubber in time."""
        pairs = zip(self.unknowns, changes.tolist(), strict=True)
        values = {unknown.name: unknown.value(change) for unknown, change in pairs}
        slow = {name: (values[name],) for name in (SHARE, SLOW) if name in values}
        return {**self.material, **slow, **({LOSS: values[LOSS]} if LOSS in values else {})}

    def changed_law(self, changes: Array, *, with_derivatives: bool = False) -> ArmLaw:
        """The law after changes (k,). Raises `RodError` where none is left."""
        of_law = {
            unknown.name: float(change)
            for unknown, change in zip(self.unknowns, changes, strict=True)
            if unknown.is_of_law and change
        }
        law = self.law.with_second_order(self._of(BEND, changes), self._of(STRETCH, changes))
        change = law.carried if with_derivatives else law.with_changes
        law = change(of_law) if of_law else law
        trend = self._of(TREND, changes)
        law = law.stiffened(trend) if trend else law
        factor = changes[0] - trend  # of the moduli at rest
        return law.scaled(math.exp(factor)) if factor else law

    def end_kPa(self, changes: Array) -> float:
        """Highest pressure of the law after changes (k,)."""
        return self.law.pressures[-1] * math.exp(changes[0])

    def changed_setup(self, changes: Array) -> Setup:
        """The setup after changes (k,)."""
        gauge, clamp, *shift = (self._of(name, changes) for name in (GAUGE, CLAMP, *ORIGIN))
        before, (x, y) = self.setup, self.setup.origin_mm
        origin = x + shift[0], y + shift[1]
        return replace(before, gauge_kPa=before.gauge_kPa + gauge, clamp_deg=before.clamp_deg + clamp, origin_mm=origin)

    def _of(self, name: str, changes: Array) -> float:
        pairs = zip(self.unknowns, changes, strict=True)
        return next((float(change) for unknown, change in pairs if unknown.name == name), 0.0)


def unknowns_of(law: ArmLaw, config: Mapping[str, Any], free: Sequence[str], highest_kPa: float) -> tuple[Unknown, ...]:
    """What is freed: all moduli, gauge and clamp, and dimensions.

    config: as run.json has it, for its tolerances. free: their keys; those whose tolerances move the tip most where
    none is given. highest_kPa: of the measurement. Raises InputError.
    """
    tolerances, known = _tolerances(law, config), _dimensions(law)
    for key in free:
        if key not in known:
            raise InputError(f"{argument('free', key)}: {not_known(key, known)}")
        if key not in tolerances:
            raise InputError(
                f"{argument('free', key)}: has no tolerance; give one in the section tolerances of the configuration"
            )
    chosen = list(dict.fromkeys(free))
    if not free and known:
        pressure = min(highest_kPa, law.pressures[-1])
        (budget,) = make_budgets(law, Tolerances.from_record(config.get("tolerances")), [pressure], None)
        chosen = [row.parameter for row in budget.rows if row.parameter in known][:MOST_DIMENSIONS]
    stds = {TREND: OF_TREND, BEND: OF_BEND, STRETCH: OF_STRETCH}
    trend, *second = (Unknown(name, "1", 0.0, std, "another law of the rubber") for name, std in stds.items())
    clamp = Unknown(CLAMP, "deg", 0.0, OF_CLAMP, f"± {OF_CLAMP:g}°")
    named = [_of_law(law, key, tolerances) for key in chosen]
    given = {key: one for key, one in tolerances.items() if not one.is_default}
    return (_modulus(law, given), trend, *named, _gauge(tolerances, highest_kPa), clamp, *second)


def unknowns_in_time(
    measurements: Measurements, material: Mapping[str, Any]
) -> tuple[tuple[Unknown, ...], Mapping[str, Any]]:
    """What is freed of the rubber by what was measured in time, and its material with what these stand for.

    A loss factor, the same at all frequencies that were measured and at a tenfold of them at least; and a slow branch
    in place of those of the material.
    """
    found, in_time = [], dict(material)
    told = f"another rubber: a factor of e^±{OF_RUBBER_IN_TIME:g}"
    if hz := [row.values[VIBRATION[0]] for row in measurements.rows if VIBRATION[0] in row.values]:
        middle = math.sqrt(min(hz) * max(hz))
        in_time["loss_between_Hz"] = min(min(hz), BAND[0] * middle), max(max(hz), BAND[1] * middle)
        found.append(Unknown(LOSS, "1", material.get(LOSS, LOSS_FACTOR), OF_RUBBER_IN_TIME, told))
    if times := [row.state.t_s for row in measurements.rows if row.state.t_s is not None]:
        found.append(Unknown(SHARE, "1", USUAL_SHARE, OF_RUBBER_IN_TIME, told))
        found.append(Unknown(SLOW, "s", math.sqrt(min(times) * max(times)), OF_RUBBER_IN_TIME, told))
    return tuple(found), in_time


def tolerance_unknowns(law: ArmLaw, config: Mapping[str, Any], highest_kPa: float) -> tuple[Unknown, ...]:
    """Everything that has a tolerance, each with it as its deviation; parameters as of `unknowns_of`."""
    tolerances = _tolerances(law, config)
    named = [_of_law(law, key, tolerances) for key in _dimensions(law) if key in tolerances]
    return (_modulus(law, tolerances), *named, _gauge(tolerances, highest_kPa))


def _tolerances(law: ArmLaw, config: Mapping[str, Any]) -> dict[str, Tolerance]:
    return Tolerances.from_record(config.get("tolerances")).all(law.dimensions)


def _dimensions(law: ArmLaw) -> list[str]:
    return [name for name in law.rates if name not in law.moduli]


def _modulus(law: ArmLaw, tolerances: Mapping[str, Tolerance]) -> Unknown:
    """Known as well as these tolerances say, as after a tensile test of one's own batch; else as of a data sheet."""
    parts = [tolerances[STIFFNESS].amount] if STIFFNESS in tolerances else []
    for name, value in law.moduli.items():
        if value and name in tolerances:
            parts.append(tolerances[name].of(value) / abs(value))
    if not parts:
        return Unknown(MODULUS, "1", 1.0, OF_DATA_SHEET, f"another batch: a factor of e^±{OF_DATA_SHEET:g}")
    return Unknown(MODULUS, "1", 1.0, math.log1p(max(parts)), f"tolerance ± {100.0 * max(parts):g} %")


def _gauge(tolerances: Mapping[str, Tolerance], highest_kPa: float) -> Unknown:
    given = tolerances["pressure"]
    return Unknown(GAUGE, "kPa", 0.0, given.of(highest_kPa), f"tolerance ± {given.text('kPa')} at {highest_kPa:g} kPa")


def _of_law(law: ArmLaw, key: str, tolerances: Mapping[str, Tolerance]) -> Unknown:
    rate, tolerance = law.rates[key], tolerances[key]
    return Unknown(key, rate.unit, rate.value, tolerance.of(rate.value), f"tolerance ± {tolerance.text(rate.unit)}")
