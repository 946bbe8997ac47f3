"""The next design: the best one near a known design, by a model of its numbers there.

The logarithms of curvature, force and stiffness, and the place and angle of the tip, are linear in the logarithms of
dimensions and pressures. Such a model is exact for numbers that are products of powers.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize

from geometry import DesignError
from geometry.arrays import Array, Mask
from pipeline.errors import InputError
from pipeline.wishes.measured import Numbers
from pipeline.wishes.wish import PRESSURE, Wishes, exact_limits
from pipeline.wishes.wish_file import WishFile

#: part of its tolerance within which a wish counts as met in the model, and of a limit
MET, KEPT = 0.7, 0.995
#: change of the logarithm of a dimension in difference quotients of mass and wall
STEP = 1e-4
#: of SLSQP
ITERATIONS, PRECISION = 200, 1e-10


@dataclass(frozen=True, eq=False)  # arrays inside
class Straight:
    """The numbers of a design in the form that is nearly linear in the logarithms of what is free."""

    values: Array  #: (m,) logarithms of curvature, force and stiffness, and the other numbers themselves
    slopes: Array  #: (m, n) by the logarithms
    is_power: Mask  #: (m,) whether a value is a logarithm

    @staticmethod
    def of(wishes: Wishes, numbers: Numbers, point: Array) -> "Straight":
        """A number with another sign than its target is no power."""
        targets = np.concatenate([wish.target for wish in wishes.wishes])
        powers = np.concatenate([[wish.is_power] * len(wish.target) for wish in wishes.wishes])
        is_power = powers & (targets * numbers.values > 0.0)
        safe = np.where(is_power, numbers.values, 1.0)
        slopes = numbers.rates * point / safe[:, None]
        return Straight(np.where(is_power, np.log(np.abs(safe)), numbers.values), slopes, is_power)


def missing_slopes(wishes: Wishes, before: tuple[Array, Numbers], after: tuple[Array, Numbers], known: Array) -> Array:
    """What the slopes of numbers lack (m, n) after a step between two designs, points (n,) with their numbers.

    Derivatives of a law leave out that of the tip beside the axis and of the rigidities against stretching and shear.
    By the trapezoidal rule exact slopes miss a step by its third order only; what they miss more is missing along the
    step (Broyden's update). known: what they lacked before.
    """
    first, second = (Straight.of(wishes, numbers, point) for point, numbers in (before, after))
    step = np.log(after[0] / before[0])
    same = first.is_power == second.is_power
    left = second.values - first.values - (0.5 * (first.slopes + second.slopes) + known) @ step
    update = np.where(same, left, 0.0)[:, None] * step / (step @ step)
    return known + update


@dataclass(frozen=True, eq=False)  # arrays inside
class Model:
    """The numbers near a known point, over the logarithms of what is free."""

    file: WishFile
    point: Array  #: (n,) the known one
    numbers: Numbers  #: there, corrected to those of the delivered law
    sensitivity: tuple[float, Array]  #: at the point, and its rates by the logarithms
    missing: Array  #: (m, n) what the slopes of `Straight` lack, as steps before have shown

    @property
    def wishes(self) -> Wishes:
        """Of the file."""
        return self.file.wishes

    def values(self, u: Array) -> tuple[Array, Array]:
        """Numbers (m,) and their derivatives (m, n) at logarithms u (n,)."""
        straight = Straight.of(self.wishes, self.numbers, self.point)
        slopes = straight.slopes + self.missing
        values = straight.values + slopes @ (u - np.log(self.point))
        powers = np.where(straight.is_power, np.exp(np.where(straight.is_power, values, 0.0)), 1.0)
        values = np.where(straight.is_power, np.sign(self.numbers.values) * powers, values)
        return values, np.where(straight.is_power, values, 1.0)[:, None] * slopes

    def residuals(self, u: Array) -> tuple[Array, Array]:
        """Distances from the targets over what is allowed (m,), and their derivatives (m, n)."""
        values, rates = self.values(u)
        target = np.concatenate([wish.target for wish in self.wishes.wishes])
        within = np.concatenate([[wish.within] * len(wish.target) for wish in self.wishes.wishes])
        return (values - target) / within, rates / within[:, None]

    def misses(self, u: Array) -> tuple[Array, Array]:
        """Squares of the misses of each wish (w,) and their derivatives (w, n)."""
        residuals, rates = self.residuals(u)
        parts = self.wishes.parts(residuals), self.wishes.parts(rates)
        pairs = list(zip(*parts, strict=True))
        return np.array([part @ part for part, _ in pairs]), np.array([2.0 * part @ rate for part, rate in pairs])

    def limits(self, u: Array) -> Array:
        """Values over their limits, each not above 1 where it is kept."""
        found = list(exact_ratios(self.file, u))
        largest = self.wishes.limits.largest_stretch
        if largest is not None:
            by_log = self.numbers.stretch_rates * self.point
            stretch = self.numbers.stretch + by_log @ (u - np.log(self.point))
            found.append((stretch - 1.0) / (largest - 1.0))
        return np.array(found)

    def objective(self, u: Array) -> float:
        """What is made small, over its value at the start."""
        if self.wishes.minimize == "sensitivity":
            value, rates = self.sensitivity
            return float(value + rates @ (u - np.log(self.point)))
        return exact_objective(self.file, u)


def exact_ratios(file: WishFile, u: Array) -> Array:
    """Mass and wall over their limits at logarithms u (n,)."""
    if file.wishes.limits.mass_g is None and file.wishes.limits.smallest_wall_mm is None:
        return np.zeros(0)
    return np.array([ratio for ratio, _ in exact_limits(file.wishes, file.drawn(np.exp(u))).values()])


def exact_objective(file: WishFile, u: Array) -> float:
    """Mass or pressure, over that at the start; zero where neither is made small."""
    wishes = file.wishes
    if wishes.minimize == "mass":
        masses = [config.mass_tonne or 0.0 for config in (file.drawn(np.exp(u)), file.start)]
        return masses[0] / masses[1]
    if wishes.minimize == "pressure":
        is_pressure = np.array([one.key.startswith(PRESSURE) for one in wishes.free])
        return float(np.mean(np.exp(u)[is_pressure] / wishes.start[is_pressure]))
    return 0.0


@dataclass(frozen=True, eq=False)  # arrays inside
class Proposal:
    """A point near a known one, and what the model expects there."""

    point: Array  #: (n,)
    misses: Array  #: (w,)
    limits: Array  #: over 1 where one is exceeded
    objective: float

    @property
    def merit(self) -> float:
        """As `merit_of`."""
        return merit_of(self.misses, self.limits, self.objective)


def merit_of(misses: Array, limits: Array, objective: float) -> float:
    """What a step has to make smaller. objective: NaN where wishes are met as nearly as possible."""
    over = 1e4 * float(np.sum(np.maximum(limits - 1.0, 0.0) ** 2))
    if np.isnan(objective):
        return float(np.sum(misses**2)) + over
    return objective + 10.0 * (float(np.sum(np.maximum(misses - 1.0, 0.0))) + over)


def propose(model: Model, radius: float) -> Proposal:
    """The best point within a change `radius` of each logarithm, by the model.

    Wishes are met as nearly as possible; where all are met, what is to be small is made so within their tolerances.
    """
    known, bounds = np.log(model.point), np.log(model.wishes.bounds)
    box = np.column_stack([np.maximum(bounds[:, 0], known - radius), np.minimum(bounds[:, 1], known + radius)])
    box[:, 0] = np.minimum(box[:, 0], known)  # a start that was rounded
    box[:, 1] = np.maximum(box[:, 1], known)
    kept = {"type": "ineq", "fun": lambda u: KEPT - model.limits(u)}
    constraints = [kept] if model.limits(known).size else []

    def distance(u: Array) -> tuple[float, Array]:
        squares, rates = model.misses(u)
        return float(squares.sum()), rates.sum(axis=0)

    best = _solved(distance, known, box, constraints)
    if model.wishes.minimize and np.all(model.misses(best)[0] <= 1.0):
        met = {
            "type": "ineq",
            "fun": lambda u: MET**2 - model.misses(u)[0],
            "jac": lambda u: -model.misses(u)[1],
        }
        best = _solved(lambda u: _with_rates(model.objective, u), best, box, [*constraints, met])
    misses, limits = np.sqrt(model.misses(best)[0]), model.limits(best)
    return Proposal(np.exp(best), misses, limits, model.objective(best) if model.wishes.minimize else np.nan)


def _with_rates(function: Callable[[Array], float], u: Array) -> tuple[float, Array]:
    steps = STEP * np.eye(len(u))
    return function(u), np.array([(function(u + step) - function(u - step)) / (2.0 * STEP) for step in steps])


def _solved(
    function: Callable[[Array], tuple[float, Array]], start: Array, box: Array, constraints: list[Any]
) -> Array:
    """By SLSQP; the start where it finds nothing that keeps the constraints better."""
    try:
        options = {"maxiter": ITERATIONS, "ftol": PRECISION}
        found = minimize(
            function, start, jac=True, method="SLSQP", bounds=box, constraints=constraints, options=options
        )
    except (InputError, DesignError):  # a point between is no body
        return start
    return np.clip(found.x, box[:, 0], box[:, 1]) if np.all(np.isfinite(found.x)) else start
