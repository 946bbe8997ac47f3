"""The unknowns of an arm fitted to what was measured on it, by Gauss-Newton steps on its rod."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares

from geometry.arrays import Array
from pipeline.answers.measured.gaussian import Effects, Gaussian
from pipeline.answers.measured.predicted import Numbers, Setup
from pipeline.answers.measured.unknowns import BuiltArm
from pipeline.store.time_left import TimeLeft
from pipeline.values.errors import InputError
from rod.arm_law.law import ArmLaw
from rod.arm_law.quantities import jacobian
from rod.errors import RodError

#: rounds of spread and unknowns in turn, and the change over the deviation with which they end
ROUNDS, SETTLED = 4, 0.05
#: change of an unknown in difference quotients, over its deviation; of the stiffness
PART, STIFFER = 0.1, 0.02
#: error of the model in the stiffness against loads over that in the modulus
OF_STIFFNESS = 2.0
#: changes of ln(modulus) with which the fit begins, the first at which the rod has every state
STARTS = (0.0, 0.25, 0.5, -0.25, 0.75)
#: scatter that is expected: of positions over the length, of angles in degrees, of reactions over the largest one
OF_POSITIONS, OF_ANGLES, OF_REACTIONS = 0.003, 0.5, 0.03
#: the same of frequencies and of damping ratios, over the largest one
OF_VIBRATIONS = {"Hz": 0.01, "1": 0.1}
#: logarithm by which the rows are to be foretold better with another frame of the places, before that is taken
OTHER = 2.0
#: part of the deviation of the end of the law by which this may lie below the highest row
LIMIT = 0.25
#: part of the highest pressure of a law by which a pressure may leave it by rounding
ROUNDING = 1e-9
#: part of the work at which one who waits is told to be, however much more it is
ALMOST = 0.95
#: residual of a trial that has no rod, over the scatter
NO_ROD = 1e3


def off_range(law: ArmLaw, numbers: Numbers, setup: Setup) -> tuple[str, ...]:
    """A sentence on the rows whose pressure, with the offset of the gauge, leaves the law; empty where none does."""
    low, high = law.pressures[0], law.pressures[-1]
    pressures = {row.state.pressure_kPa + setup.gauge_kPa for row in numbers.rows}
    farthest = max(pressures, key=lambda pressure: max(low - pressure, pressure - high))
    if low - ROUNDING * high <= farthest <= (1.0 + ROUNDING) * high:
        return ()
    sentence = (
        f"With the offset of the gauge a row is at {farthest:.4g} kPa, but the law goes from {low:.4g} to {high:.4g} "
        "kPa; that row is compared with the rod at the end of the law."
    )
    return (sentence,)


def numbers_of(arm: BuiltArm, numbers: Numbers, changes: Array, stiffness: float = 1.0) -> Array:
    """(n,) the numbers by the rod of an arm with changes (k,) of its unknowns; stiffness: as of `Setup`.

    Raises InputError, with the line, where it has none.
    """
    try:
        rods = arm.changed_rods(changes)
    except RodError as failure:
        raise InputError(str(failure)) from None
    found = numbers.predicted(rods, replace(arm.changed_setup(changes), stiffness=stiffness))
    arm.told(len(found))
    return found


def telling(remark: Callable[[str], object], unknowns: int, numbers: int) -> Callable[[int], None]:
    """Tells one who waits how many numbers were found, of about as many as effects of unknowns on these take."""
    left, parts = TimeLeft({}), [0.0]

    def told(count: int) -> None:
        parts.append(min(parts.pop() + 0.5 * count / (unknowns + 1) / numbers, ALMOST))
        left.tell(remark, f"{100 * parts[0]:.0f} % of the numbers by the rod are found", parts[0])

    return told


def effects_on(arm: BuiltArm, numbers: Numbers, changes: Array | None = None) -> Effects:
    """How numbers change at some changes (k,) of the unknowns, none by default, by differences. Raises InputError."""
    at = np.zeros(len(arm.unknowns)) if changes is None else changes

    def of(more: Array) -> Array:
        highest = min(numbers.pressures.max(), arm.end_kPa(at))
        if arm.end_kPa(at + more[:-1]) < (1.0 - ROUNDING) * highest:  # the other side of the quotient is taken
            raise InputError(f"{numbers.measurements.file}: {highest:g} kPa is beyond the law of so soft an arm")
        return numbers_of(arm, numbers, at + more[:-1], math.exp(more[-1]))

    steps = [*(PART * unknown.std_before for unknown in arm.unknowns), STIFFER]
    by = jacobian(lambda more: more, [of], steps, InputError)
    return Effects(by[:, :-1], np.column_stack([by[:, 0], OF_STIFFNESS * by[:, -1]]), numbers.pressures)


def fit(arm: BuiltArm, numbers: Numbers) -> Gaussian:
    """The unknowns that agree best with numbers, and with what was known of them.

    Raises InputError, with the line, for a state that the rod of the arm has not.
    """
    lowest, usual = _lowest(arm, numbers), usual_scatter(arm.law.length, numbers)
    changes = _start(arm, numbers, max(0.0, lowest))
    for _ in range(ROUNDS):
        fitted = _fitted_at(arm, numbers, changes, usual)
        before, changes = changes, _improved(arm, numbers, fitted, lowest)
        if np.abs((changes - before) / fitted.stds_before).max() < SETTLED:
            break
    return _fitted_at(arm, numbers, changes, usual)


def is_at_limit(arm: BuiltArm, numbers: Numbers, fitted: Gaussian) -> bool:
    """Whether numbers are of an arm so soft that its law ends below their highest pressure."""
    return bool(fitted.mean[0] < _lowest(arm, numbers) - LIMIT * fitted.stds[0])


def _lowest(arm: BuiltArm, numbers: Numbers) -> float:
    """Of the logarithm of the modulus, at which the law ends at the highest pressure of the numbers."""
    return math.log(max(float(numbers.pressures.max()), 1e-9) / arm.law.pressures[-1])


def _start(arm: BuiltArm, numbers: Numbers, first: float) -> Array:
    """(k,) changes from which the fit begins: a modulus at which the rod has every state."""
    failures = []
    for more in STARTS:
        changes = np.zeros(len(arm.unknowns))
        changes[0] = first + more
        try:
            numbers_of(arm, numbers, changes)
        except InputError as failure:
            failures.append(failure)
        else:
            return changes
    raise failures[0]


def _fitted_at(arm: BuiltArm, numbers: Numbers, changes: Array, usual: dict[str, float]) -> Gaussian:
    """The numbers beside the rod at changes (k,), in a frame as of the file or in another one, which may be far off.

    Another one is taken where rows are foretold far better with it. usual: scatter by unit.
    """
    residual, effects = numbers.values - numbers_of(arm, numbers, changes), effects_on(arm, numbers, changes)
    stds, *others = arm.stds_by_frame(is_aligned=numbers.measurements.is_aligned)
    found = Gaussian.of(effects, residual, numbers.units, changes, stds, usual)
    for far in (replace(found, stds_before=one) for one in others):
        if far.left_out_density > found.left_out_density + OTHER:
            return far.with_spread(usual)
    return found


def usual_scatter(length_mm: float, numbers: Numbers) -> dict[str, float]:
    """Scatter that is expected of numbers, by unit."""
    usual = {"mm": OF_POSITIONS * length_mm, "deg": OF_ANGLES}
    for unit, part in {"N": OF_REACTIONS, **OF_VIBRATIONS}.items():
        pairs = zip(numbers.values.tolist(), numbers.units, strict=True)
        usual[unit] = part * (max((abs(value) for value, of in pairs if of == unit), default=1.0) or 1.0)
    return usual


def _improved(arm: BuiltArm, numbers: Numbers, fitted: Gaussian, lowest: float) -> Array:
    """(k,) the changes of least squares with its spread, of the numbers and of what was known before."""
    factor, stds = cholesky(fitted.noise, lower=True), fitted.stds_before

    def residual(changes: Array) -> Array:
        try:
            off = numbers.values - numbers_of(arm, numbers, changes)
        except InputError:
            return np.full(len(numbers.values) + len(stds), NO_ROD)
        return np.concatenate([solve_triangular(factor, off, lower=True), changes / stds])

    def slopes(changes: Array) -> Array:
        by_unknown = effects_on(arm, numbers, changes).by_unknown
        return np.vstack([-solve_triangular(factor, by_unknown, lower=True), np.diag(1.0 / stds)])

    start = np.array(fitted.changes)
    start[0] = max(start[0], lowest)
    least, most = (_bound(arm, start, side) for side in (-1.0, 1.0))
    least[0] = lowest
    how = {"method": "dogbox", "xtol": 1e-3, "ftol": 1e-4, "max_nfev": 6}  # "trf" does not leave a bound at the start
    return least_squares(residual, start, slopes, (least, most), x_scale=stds, **how).x


def _bound(arm: BuiltArm, changes: Array, side: float) -> Array:
    """(k,) how far the unknowns may go to a side: not on where the arm then has no law, as one that becomes too short.

    Asked where difference quotients are taken, whose arms are kept.
    """
    bound = np.full(len(changes), side * np.inf)
    for k, unknown in enumerate(arm.unknowns):
        beside = changes.copy()
        beside[k] += side * PART * unknown.std_before
        try:
            arm.changed_rods(beside)(arm.law.pressures[0])
        except RodError:
            bound[k] = changes[k]
    return bound
