"""The rod of an arm calibrated to what was measured on it: values, and the computation from a result folder."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from geometry import Reason
from pipeline.answers.material.hold import LARGEST_LOSS
from pipeline.answers.material.sentences import OF_RUBBER
from pipeline.answers.measured.doubtful import check_numbers, doubts_of, failure_of
from pipeline.answers.measured.fit import (
    OF_POSITIONS,
    effects_on,
    fit,
    is_at_limit,
    numbers_of,
    off_range,
    telling,
    usual_scatter,
)
from pipeline.answers.measured.gaussian import Effects, Gaussian
from pipeline.answers.measured.predicted import Compared, Curves, LawRods, Numbers, Setup
from pipeline.answers.measured.rows import Measurements, Row, State
from pipeline.answers.measured.unknowns import LOSS, BuiltArm, Unknown, unknowns_in_time, unknowns_of
from pipeline.answers.rods.choice import plane_of, refuse_draft, refuse_out_of_plane
from pipeline.answers.rods.in_time import KEYS
from pipeline.values.errors import InputError
from pipeline.values.run import Run
from rod.arm_law.law import ArmLaw

#: pressures over the highest one, and the forces across the end over the rigidity / length^2
PRESSURES, FORCES = (0.2, 0.4, 0.6, 0.8, 0.95), (0.0, 0.1, -0.1)
#: part of the deviation that a measurement leaves of an unknown, from which on it was not determined; correlation from
#: which on only a combination of two was
LEFT, TOGETHER = 0.8, 0.9
#: relative change of a dimension beyond which derivatives are doubtful
DOUBTFUL = 0.15
#: change of an unknown over its deviation before, from which on it is named
FAR = 2.0
#: times that the effects on the numbers of a file are found, as fits take them; numbers of the next measurement
USUAL, STATES = 12, 2 * len(PRESSURES) * len(FORCES)


@dataclass(frozen=True)
class NextMeasurement:
    """A state in which the tip is worth measuring, and what it is worth."""

    pressure_kPa: float
    force_y_N: float  #: dead force on the end
    tip_std_mm: float  #: root mean square over pressures and loads, now
    tip_std_then_mm: float  #: after this measurement

    @property
    def text(self) -> str:
        """The load in words."""
        at = f"tip at {self.pressure_kPa:.3g} kPa"
        tip = f"{at} under {self.force_y_N:.3g} N in y" if self.force_y_N else f"unloaded {at}"
        return (
            f"Best next measurement: the {tip}. It lowers the tip's standard deviation from "
            f"{self.tip_std_mm:.2g} to {self.tip_std_then_mm:.2g} mm."
        )


@dataclass(frozen=True, eq=False)  # arrays inside
class Calibration:
    """An arm after its measurement."""

    estimates: tuple[Unknown, ...]
    law: ArmLaw = field(repr=False)  #: of the calibrated arm
    setup: Setup  #: offset of the gauge, angle of the clamp
    posterior: Gaussian = field(repr=False)
    predictions: tuple[Compared, ...] = field(repr=False)  #: what is allowed holds nine of ten measurements
    curves: Curves = field(repr=False)  #: of the calibrated rod
    undetermined: tuple[str, ...]  #: what the numbers do not tell, a sentence each
    notes: tuple[str, ...]
    next_measurement: NextMeasurement
    rubber: Mapping[str, Any]  #: of the material of a configuration; empty where nothing was measured in time
    missed: Reason | None = None  #: why this is no calibration

    def __getitem__(self, name: str) -> Unknown:
        return next(estimate for estimate in self.estimates if estimate.name == name)


def law_to_calibrate(run: Run) -> ArmLaw:
    """The arm's own law of a run. Raises InputError for a run without one."""
    refuse_out_of_plane(run)
    if run.law is None:
        raise InputError(f"{run.directory}: has no law.json, the arm's own law; measure it with pneurod cell")
    refuse_draft(run, "a calibration")
    return plane_of(run, "a calibration")


def calibrated(
    law: ArmLaw,
    config: Mapping[str, Any],
    measurements: Measurements,
    free: Sequence[str] = (),
    drawn_mm: float | None = None,
    tell: Callable[[str], object] = str,
) -> Calibration:
    """An arm calibrated to measurements.

    config: as run.json has it, for its tolerances. free: dimensions; by default those whose tolerances move the tip
    most. drawn_mm: length in the drawing, where the law has another one. tell: is told the time left. Raises
    InputError, with file, line and column.
    """
    in_time, material = unknowns_in_time(measurements, config.get("material") or {})
    unknowns = unknowns_of(law, config, free, max(measurements.pressures_kPa) or law.pressures[-1])
    numbers, setup = Numbers.of(measurements), Setup(drawn_mm=drawn_mm or law.length)
    every = (*unknowns, *BuiltArm.origin_of(measurements, law.length), *in_time)
    told = telling(tell, len(every), USUAL * len(numbers.values) + STATES)
    arm = BuiltArm(law, every, setup, material, told)
    if (count := len(numbers.values)) <= len(free):
        raise InputError(f"{measurements.file}: holds {count} numbers for {1 + len(free)} unknowns; measure more")
    low, high = law.pressures[0], law.pressures[-1]
    likely = high * math.exp(2.0 * unknowns[0].std_before)
    measurements.check_pressures(low, likely, f"the law, which goes from {low:g} to {high:g} kPa")
    _check(arm, numbers)
    numbers, fitted = _fitted(arm, numbers)
    changed, setup = arm.changed_law(fitted.changes, with_derivatives=True), arm.changed_setup(fitted.changes)
    rubber = arm.changed_material(fitted.changes) if in_time else {}
    allowed = fitted.quantile * fitted.deviations(fitted.effects, numbers.units)
    predictions = numbers.beside(numbers.values - fitted.residual, allowed)
    rows = zip(every, fitted.changes.tolist(), fitted.stds.tolist(), strict=True)
    return Calibration(
        estimates=tuple(unknown.after(change, std) for unknown, change, std in rows),
        law=changed,
        setup=setup,
        posterior=fitted,
        predictions=predictions,
        curves=numbers.curves(LawRods(changed, rubber), setup),
        undetermined=tuple(_undetermined(arm, fitted)),
        notes=(
            *_left_out(measurements, numbers, changed),
            *off_range(changed, numbers, setup),
            *_doubts(arm, fitted),
            *doubts_of(measurements, numbers, fitted.residual),
        ),
        next_measurement=next_measurement(arm, fitted, changed),
        rubber={key: value for key, value in rubber.items() if key in KEYS},
        missed=failure_of(numbers, predictions, usual_scatter(law.length, numbers), law.length, fitted.step),
    )


def _fitted(arm: BuiltArm, numbers: Numbers) -> tuple[Numbers, Gaussian]:
    """The numbers at pressures that the law of the arm reaches, and their fit. Raises InputError where it has none."""
    fitted = fit(arm, numbers)
    while is_at_limit(arm, numbers, fitted):
        *lower, highest = numbers.measurements.pressures_kPa
        if not lower:
            raise InputError(
                f"{numbers.measurements.file}: the arm is so soft that its law, scaled, ends below {highest:g} kPa; "
                f"measure it beyond {arm.law.pressures[-1]:g} kPa with pneurod cell"
            )
        numbers = Numbers.of(numbers.measurements.up_to(lower[-1]))
        fitted = fit(arm, numbers)
    return numbers, fitted


def _left_out(measurements: Measurements, numbers: Numbers, law: ArmLaw) -> list[str]:
    left = [row.state.pressure_kPa for row in measurements.rows if row not in numbers.measurements.rows]
    if not left:
        return []
    rows = f"1 row at {left[0]:g} kPa is" if len(left) == 1 else f"{len(left)} rows from {min(left):g} kPa on are"
    return [
        f"{rows} left out: the arm is so soft that its law, which ends at {law.pressures[-1]:.4g} kPa, does not reach "
        f"there; measure the law at higher pressures. {law.snap}".strip()
    ]


def _check(arm: BuiltArm, numbers: Numbers) -> None:
    """Raise InputError for numbers that cannot be of the arm, where the drawn one has all states."""
    try:
        predicted = numbers_of(arm, numbers, np.zeros(len(arm.unknowns)))
    except InputError:
        return
    check_numbers(numbers, predicted, arm.law.length)


def _undetermined(arm: BuiltArm, fitted: Gaussian) -> list[str]:
    sentences, left = [], fitted.stds / fitted.stds_before
    for unknown, part in zip(arm.unknowns, left.tolist(), strict=True):
        if part > LEFT:
            sentences.append(f"{unknown.name}: not determined; its deviation is {100 * part:.0f} % of that before.")
    for i, j in zip(*np.triu_indices(len(left), 1), strict=True):
        together = float(fitted.correlation[i, j])
        if abs(together) > TOGETHER:
            both = f"{arm.unknowns[i].name} and {arm.unknowns[j].name}"
            sentences.append(f"{both}: only a combination is determined (correlation {together:.2f}).")
    return sentences


def _doubts(arm: BuiltArm, fitted: Gaussian) -> list[str]:
    sentences = []
    for unknown, change in zip(arm.unknowns, fitted.changes.tolist(), strict=True):
        if unknown.is_of_law and unknown.drawn and abs(change / unknown.drawn) > DOUBTFUL:
            percent, times = 100.0 * change / unknown.drawn, abs(change) / unknown.std_before
            sentences.append(
                f"{unknown.name} changes by {percent:.0f} %, {times:.1f} times its tolerance, for which derivatives "
                "are doubtful; check the scale of the numbers, or measure the law again with it."
            )
        elif (times := abs(change) / unknown.std_before) > FAR:
            sentences.append(
                f"{unknown.name} is {times:.1f} times its deviation before ({unknown.source}) from its value before; "
                "check origin, scale and pressures of the numbers."
            )
        if unknown.name.endswith(".nu") and not OF_RUBBER[0] <= unknown.value(change) < OF_RUBBER[1]:
            sentences.append(
                f"{unknown.name} comes out as {unknown.value(change):.3g}, which no rubber has (it has "
                f"{OF_RUBBER[0]:g} to {OF_RUBBER[1]:g}); free dimensions in its place."
            )
        if unknown.name == LOSS and unknown.value(change) > LARGEST_LOSS:
            sentences.append(
                f"{unknown.name} comes out as {unknown.value(change):.2g}, and rubbers have less than "
                f"{LARGEST_LOSS:g}; something else damps the arm."
            )
    return sentences


def next_measurement(arm: BuiltArm, fitted: Gaussian, law: ArmLaw) -> NextMeasurement:
    """The measurement of the tip that leaves the least variance of the tip in all states, to first order.

    law: of the calibrated arm.
    """
    rigidity = 1.0 / float(np.interp(0.0, (known := law.at(law.pressures[-1]).section).moment, known.kappa_slope))
    unit = rigidity / law.length**2
    states = [State(part * law.pressures[-1], (0.0, force * unit)) for part in PRESSURES for force in FORCES]
    reached, effects = [], []
    for state in states:
        row = Row(0, state, {"tip_x": 0.0, "tip_y": 0.0})
        try:
            effects.append(effects_on(arm, Numbers.of(Measurements("", (row,))), fitted.changes))
            reached.append(state)
        except InputError:  # no rod there
            continue
    targets = Effects.joined(effects)
    now = _deviation(fitted, targets)
    then = [_deviation(_after(fitted, one, law.length), targets) for one in effects]
    best = int(np.argmin(then))
    return NextMeasurement(reached[best].pressure_kPa, reached[best].force_N[1], now, then[best])


def _deviation(fitted: Gaussian, targets: Effects) -> float:
    """mm, root mean square of the distance of the tip."""
    return float(np.sqrt(2.0 * np.diag(fitted.error_covariance(targets)).mean()))


def _after(fitted: Gaussian, effects: Effects, length: float) -> Gaussian:
    """With two numbers more, whose values do not matter."""
    scatter = {"mm": OF_POSITIONS * length} | dict(fitted.spread.scatter)
    return replace(
        fitted,
        effects=Effects.joined([fitted.effects, effects]),
        residual=np.append(fitted.residual, np.zeros(2)),
        units=(*fitted.units, "mm", "mm"),
        spread=replace(fitted.spread, scatter=scatter),
    )
