"""The rod of an arm calibrated to what was measured on it: values, and the computation from a result folder."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.stats import multivariate_t, t

from geometry.arrays import Array
from pipeline.cell.saved import SavedLaw
from pipeline.errors import InputError
from pipeline.measured.aligned import check_degrees
from pipeline.measured.fit import Fitted, effects_on, fit, numbers_of
from pipeline.measured.gaussian import Posterior
from pipeline.measured.next_measurement import NextMeasurement, next_measurement
from pipeline.measured.predicted import Numbers, Setup, without
from pipeline.measured.rows import Measurements
from pipeline.measured.unknowns import BuiltArm, unknowns_of
from pipeline.results.values import Run
from pipeline.rods.choice import refuse_out_of_plane
from rod.arm_law.law import ArmLaw
from rod.errors import RodError

#: part of the deviation that a measurement leaves of an unknown, from which on it was not determined; correlation from
#: which on only a combination of two was
LEFT, TOGETHER = 0.8, 0.9
#: relative change of a dimension beyond which derivatives are doubtful
DOUBTFUL = 0.15
#: part of all measurements within an interval; degrees of freedom of Student's distribution that samples are of
WITHIN, OF_SAMPLES = 0.90, 5.0


@dataclass(frozen=True)
class Estimate:
    """One unknown before and after the measurement."""

    name: str
    unit: str
    mean: float
    std: float
    drawn: float  #: in the drawing
    std_before: float  #: of the modulus that of its logarithm
    source: str  #: of the deviation before


@dataclass(frozen=True)
class Prediction:
    """One measured number beside that of the calibrated rod."""

    line: int
    pressure_kPa: float
    load: str
    quantity: str  #: with its unit, as in the titles of the file
    measured: float
    predicted: float
    low: float  #: of the interval in which nine of ten measurements are
    high: float


@dataclass(frozen=True)
class Sampled:
    """Mean and deviation of the unknowns by sampling, without a linear approximation of the rod."""

    samples: int
    effective: float  #: number of equally weighted samples that are worth as much
    mean: tuple[float, ...]
    std: tuple[float, ...]


@dataclass(frozen=True, eq=False)  # arrays inside
class Calibration:
    """An arm after its measurement."""

    estimates: tuple[Estimate, ...]
    law: ArmLaw = field(repr=False)  #: of the calibrated arm
    setup: Setup  #: offset of the gauge, angle of the clamp
    posterior: Posterior = field(repr=False)
    predictions: tuple[Prediction, ...] = field(repr=False)
    undetermined: tuple[str, ...]  #: what the numbers do not tell, a sentence each
    notes: tuple[str, ...]
    next_measurement: NextMeasurement
    sampled: Sampled | None = None  #: None where no samples were requested

    @property
    def correlation(self) -> Array:
        """(k, k) of the unknowns."""
        return self.posterior.correlation

    def __getitem__(self, name: str) -> Estimate:
        return next(estimate for estimate in self.estimates if estimate.name == name)


def quantile_of(posterior: Posterior) -> float:
    """Half the width of an interval over the deviation: by Student's distribution, with a degree for each pressure, as
    the error of the model is known from as many errors."""
    pressures = len(np.unique(posterior.effects.pressures))
    return float(t.ppf(0.5 + 0.5 * WITHIN, max(1, pressures)))


def law_to_calibrate(run: Run) -> ArmLaw:
    """The arm's own law of a run. Raises InputError for a run without one."""
    refuse_out_of_plane(run)
    path = run.directory / "law.json"
    if run.law is None:
        raise InputError(f"{run.directory}: has no law.json, the arm's own law; measure it with pneurod cell")
    return SavedLaw.read(path).law


def calibrated(
    law: ArmLaw, config: Mapping[str, Any], measurements: Measurements, free: Sequence[str] = (), samples: int = 0
) -> Calibration:
    """An arm calibrated to measurements.

    config: as run.json has it, for its tolerances. free: dimensions; by default those whose tolerances move the tip
    most. samples: drawn to check the result. Raises InputError, with file, line and column.
    """
    every = Numbers.of(measurements)
    unknowns = unknowns_of(law, config, free, max(measurements.pressures_kPa) or law.pressures[-1])
    named = 1 + len(free)
    if measurements.count < named:
        raise InputError(f"{measurements.file}: holds {measurements.count} numbers for {named} unknowns; measure more")
    _check_pressures(law, measurements, unknowns[0].std)
    arm = BuiltArm(law, unknowns)
    _check_angles(arm, every)
    numbers, notes = every, []
    fitted = fit(arm, numbers)
    while fitted.at_limit and len(numbers.measurements.pressures_kPa) > 1:
        highest = numbers.measurements.pressures_kPa[-2]
        numbers = Numbers.of(without(measurements, highest))
        fitted = fit(arm, numbers)
    changed = arm.changed_law(fitted.changes, with_derivatives=True)
    if numbers is not every:
        left = len(measurements.rows) - len(numbers.measurements.rows)
        notes.append(
            f"{left} rows above {changed.pressures[-1]:.4g} kPa are left out: the law of an arm as soft as this one "
            "ends there; measure the law at higher pressures."
        )
    elif fitted.at_limit:
        raise InputError(_softer(measurements, law))
    setup = arm.changed_setup(fitted.changes)
    return Calibration(
        estimates=_estimates(arm, fitted),
        law=changed,
        setup=setup,
        posterior=fitted.posterior,
        predictions=predictions(arm, numbers, fitted.changes, fitted.posterior),
        undetermined=tuple(_undetermined(arm, fitted)),
        notes=(*notes, *_doubts(arm, fitted)),
        next_measurement=next_measurement(arm, fitted, changed),
        sampled=_sampled(arm, numbers, fitted, samples) if samples else None,
    )


def _check_pressures(law: ArmLaw, measurements: Measurements, std: float) -> None:
    """Raise InputError for a pressure that the law has for no likely modulus."""
    low, high = law.pressures[0], law.pressures[-1]
    for row in measurements.rows:
        pressure = row.state.pressure_kPa
        if not low <= pressure <= high * float(np.exp(2.0 * std)):
            where = f"{measurements.file}: line {row.line}"
            raise InputError(f"{where}: {pressure:g} kPa is outside the law, which goes from {low:g} to {high:g} kPa")


def _check_angles(arm: BuiltArm, numbers: Numbers) -> None:
    """Raise InputError for angles that are as small as if they were in radians, where the drawn arm has all states."""
    try:
        predicted = numbers_of(arm, numbers, np.zeros(len(arm.unknowns)))
    except InputError:
        return
    check_degrees(numbers, predicted)


def _softer(measurements: Measurements, law: ArmLaw) -> str:
    pressure = measurements.pressures_kPa[0]
    return (
        f"{measurements.file}: the arm is so soft that its law, scaled, ends below {pressure:g} kPa; measure it beyond "
        f"{law.pressures[-1]:g} kPa with pneurod cell"
    )


def _estimates(arm: BuiltArm, fitted: Fitted) -> tuple[Estimate, ...]:
    rows = zip(arm.unknowns, fitted.changes.tolist(), fitted.posterior.stds.tolist(), strict=True)
    return tuple(
        Estimate(u.name, u.unit, u.value(change), u.std_of(change, std), u.drawn, u.std, u.source)
        for u, change, std in rows
    )


def predictions(arm: BuiltArm, numbers: Numbers, changes: Array, posterior: Posterior) -> tuple[Prediction, ...]:
    """Every number with that of the rod, and where nine of ten measurements in that state would be."""
    found, effects = numbers_of(arm, numbers, changes), effects_on(arm, numbers, changes)
    scatter = np.array([posterior.spread.scatter.get(unit, 0.0) for unit in numbers.units])
    deviations = np.sqrt(np.maximum(np.diag(posterior.error_covariance(effects)), 0.0) + scatter**2)
    half = quantile_of(posterior) * deviations
    columns = zip(numbers.rows, numbers.titles, numbers.values.tolist(), found.tolist(), half.tolist(), strict=True)
    return tuple(
        Prediction(row.line, row.state.pressure_kPa, row.state.load, title, value, rod, rod - wide, rod + wide)
        for row, title, value, rod, wide in columns
    )


def _undetermined(arm: BuiltArm, fitted: Fitted) -> list[str]:
    sentences, left = [], fitted.posterior.stds / fitted.observed.stds
    for unknown, part in zip(arm.unknowns, left.tolist(), strict=True):
        if part > LEFT:
            sentences.append(f"{unknown.name}: not determined; its deviation is {100 * part:.0f} % of that before.")
    for i, j in zip(*np.triu_indices(len(left), 1), strict=True):
        together = float(fitted.posterior.correlation[i, j])
        if abs(together) > TOGETHER:
            both = f"{arm.unknowns[i].name} and {arm.unknowns[j].name}"
            sentences.append(f"{both}: only a combination is determined (correlation {together:.2f}).")
    return sentences


def _doubts(arm: BuiltArm, fitted: Fitted) -> list[str]:
    sentences = []
    for unknown, change in zip(arm.unknowns, fitted.changes.tolist(), strict=True):
        if unknown.is_of_law and unknown.drawn and abs(change / unknown.drawn) > DOUBTFUL:
            sentences.append(
                f"{unknown.name} changes by {100 * change / unknown.drawn:.0f} %, for which derivatives are doubtful; "
                "measure the law again with the new dimension."
            )
    return sentences


def _sampled(arm: BuiltArm, numbers: Numbers, fitted: Fitted, samples: int) -> Sampled:
    """By importance sampling from Student's distribution with the covariance of the linear approximation."""
    posterior, observed = fitted.posterior, fitted.observed
    noise = np.linalg.inv(observed.noise(posterior.spread))
    drawn_from = multivariate_t(fitted.changes, posterior.covariance, OF_SAMPLES, seed=1, allow_singular=True)
    points = drawn_from.rvs(samples).reshape(samples, -1)
    logarithms = []
    for point in points:
        try:
            off = numbers.values - numbers_of(arm, numbers, point)
        except (InputError, RodError):
            logarithms.append(-np.inf)
            continue
        before = float(np.sum((point / observed.stds) ** 2))
        logarithms.append(-0.5 * (float(off @ noise @ off) + before) - float(drawn_from.logpdf(point)))
    logs = np.array(logarithms)
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    values = np.array([[u.value(c) for u, c in zip(arm.unknowns, point, strict=True)] for point in points.tolist()])
    mean = weights @ values
    std = np.sqrt(weights @ (values - mean) ** 2)
    return Sampled(samples, float(1.0 / np.sum(weights**2)), tuple(mean.tolist()), tuple(std.tolist()))
