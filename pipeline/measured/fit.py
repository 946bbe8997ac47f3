"""The unknowns of an arm fitted to what was measured on it, by Gauss-Newton steps on its rod."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares

from geometry.arrays import Array
from pipeline.errors import InputError
from pipeline.measured.gaussian import Effects, Observed, Posterior, Spread, choose_spread
from pipeline.measured.predicted import Numbers, Setup
from pipeline.measured.unknowns import MODULUS, BuiltArm
from rod.arm_law.law import ArmLaw
from rod.errors import RodError
from rod.mechanics.equilibrium import Rod

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
#: residual of a trial that has no rod, over the scatter
NO_ROD = 1e3


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Fitted:
    """Where the fit ended."""

    observed: Observed
    posterior: Posterior
    at_limit: bool  #: whether a softer arm would leave the pressures of the law

    @property
    def changes(self) -> Array:
        """(k,) of the unknowns."""
        return self.observed.changes


def numbers_of(arm: BuiltArm, numbers: Numbers, changes: Array, more: Setup | None = None) -> Array:
    """(n,) the numbers by the rod of an arm with changes (k,) of its unknowns.

    Raises InputError, with the line, where it has none.
    """
    try:
        law = arm.changed_law(changes)
    except RodError as failure:
        raise InputError(str(failure)) from None
    setup = arm.changed_setup(changes)
    return numbers.predicted(LawRods(law), setup if more is None else setup + more)


@final
@dataclass(frozen=True, eq=False)
class LawRods:
    """The rods of a law; a pressure that the offset of a gauge moves off the range of the law is that at its end."""

    law: ArmLaw

    def __call__(self, pressure_kPa: float) -> Rod:
        low, high = self.law.pressures[0], self.law.pressures[-1]
        return Rod(self.law.length, law=self.law.at(min(max(pressure_kPa, low), high)))


def effects_on(arm: BuiltArm, numbers: Numbers, changes: Array) -> Effects:
    """How numbers change at some changes (k,) of the unknowns, by differences. Raises InputError."""

    def by(unknown: int) -> Array:
        step = np.zeros(len(changes))
        step[unknown] = PART * arm.unknowns[unknown].std
        return _slope(lambda part: numbers_of(arm, numbers, changes + part * step)) / step[unknown]

    columns = [by(k) for k in range(len(arm.unknowns))]

    def stiffer(part: float) -> Array:
        return numbers_of(arm, numbers, changes, Setup(stiffness=math.exp(part * STIFFER)))

    by_modulus = columns[[unknown.name for unknown in arm.unknowns].index(MODULUS)]
    by_model = np.column_stack([by_modulus, OF_STIFFNESS * _slope(stiffer) / STIFFER])
    return Effects(np.column_stack(columns), by_model, numbers.pressures)


def _slope(numbers_at: Callable[[float], Array]) -> Array:
    """(n,) change of numbers per step, from the parts -1 and 1 of it, or from that which has a rod and from 0."""
    found = []
    for part in (-1.0, 1.0, 0.0):
        try:
            found.append((part, numbers_at(part)))
        except InputError:
            if part == 0.0:
                raise
        if len(found) == 2:
            break
    (first, less), (second, more) = found
    return np.asarray((more - less) / (second - first))


def fit(arm: BuiltArm, numbers: Numbers) -> Fitted:
    """The unknowns that agree best with numbers, and with what was known of them.

    Raises InputError, with the line, for a state that the rod of the arm has not.
    """
    stds = np.array([unknown.std for unknown in arm.unknowns])
    lowest = np.full(len(stds), -np.inf)
    modulus = [unknown.name for unknown in arm.unknowns].index(MODULUS)
    lowest[modulus] = math.log(max(float(numbers.pressures.max()), 1e-9) / arm.law.pressures[-1])
    changes = _start(arm, numbers, modulus, max(0.0, lowest[modulus] + 0.5 * PART))
    usual = _usual(arm, numbers)
    for _ in range(ROUNDS):
        observed = _observed(arm, numbers, changes, stds)
        spread = choose_spread(observed, usual)
        before, changes = changes, _improved(arm, numbers, observed, spread, lowest)
        if np.abs((changes - before) / stds).max() < SETTLED:
            break
    observed = _observed(arm, numbers, changes, stds)
    posterior = Posterior.of(observed, choose_spread(observed, usual))
    return Fitted(observed, posterior, bool(changes[modulus] < lowest[modulus] + 0.1 * PART))


def _start(arm: BuiltArm, numbers: Numbers, modulus: int, first: float) -> Array:
    """(k,) changes from which the fit begins: a modulus at which the rod has every state."""
    failures = []
    for more in STARTS:
        changes = np.zeros(len(arm.unknowns))
        changes[modulus] = first + more
        try:
            numbers_of(arm, numbers, changes)
        except InputError as failure:
            failures.append(failure)
        else:
            return changes
    raise failures[0]


def _observed(arm: BuiltArm, numbers: Numbers, changes: Array, stds: Array) -> Observed:
    residual = numbers.values - numbers_of(arm, numbers, changes)
    return Observed(effects_on(arm, numbers, changes), residual, numbers.units, changes, stds)


def _usual(arm: BuiltArm, numbers: Numbers) -> dict[str, float]:
    reactions = [abs(value) for value, unit in zip(numbers.values, numbers.units, strict=True) if unit == "N"]
    largest = max(reactions, default=1.0) or 1.0
    return {"mm": OF_POSITIONS * arm.law.length, "deg": OF_ANGLES, "N": OF_REACTIONS * largest}


def _improved(arm: BuiltArm, numbers: Numbers, observed: Observed, spread: Spread, lowest: Array) -> Array:
    """(k,) the changes of least squares with a spread, of the numbers and of what was known before."""
    factor, stds = cholesky(observed.noise(spread), lower=True), observed.stds

    def residual(changes: Array) -> Array:
        try:
            off = numbers.values - numbers_of(arm, numbers, changes)
        except InputError:
            return np.full(len(numbers.values) + len(stds), NO_ROD)
        return np.concatenate([solve_triangular(factor, off, lower=True), changes / stds])

    def slopes(changes: Array) -> Array:
        by_unknown = observed.effects.by_unknown
        if not np.array_equal(changes, observed.changes):
            by_unknown = effects_on(arm, numbers, changes).by_unknown
        return np.vstack([-solve_triangular(factor, by_unknown, lower=True), np.diag(1.0 / stds)])

    bounds = lowest, np.full(len(stds), np.inf)
    return np.asarray(
        least_squares(residual, observed.changes, slopes, bounds, x_scale=stds, xtol=1e-3, ftol=1e-4, max_nfev=6).x
    )
