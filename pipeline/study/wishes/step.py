"""What a design is worth, and the next one: the best near a known design, by a model of its numbers there.

The logarithms of curvature, force and stiffness, and the place and angle of the tip, are linear in the logarithms of
dimensions and pressures. Such a model is exact for numbers that are products of powers.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice, product
from typing import Any

import numpy as np
from scipy.optimize import minimize

from geometry import DesignError
from geometry.arrays import Array
from pipeline.study.wishes.measured import Response
from pipeline.study.wishes.wish import PRESSURE, WishFile, exact_limits
from pipeline.values.errors import InputError

#: part of its tolerance within which a wish counts as met in the model, and of a limit
MET, KEPT = 0.7, 0.995
#: change of the logarithm of a dimension in difference quotients of mass and wall
STEP = 1e-4
#: corners of the bounds that are looked at
MOST_CORNERS = 64
#: excess over a limit, over it, that is rounding
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)  # arrays inside
class Worth:
    """How near a design comes to what is wanted."""

    misses: Array  #: (w,) of each wish, over its tolerance
    limits: Array  #: over 1 where one is exceeded
    objective: float  #: what is made small; NaN where wishes are met as nearly as possible

    def is_within(self, part: float) -> bool:
        """Whether it misses no wish by more than this part of its tolerance, and keeps every limit."""
        return bool(np.all(self.misses <= part) and np.all(self.limits <= 1.0))

    @property
    def merit(self) -> float:
        """What a step has to make smaller."""
        over = 1e4 * float(np.sum(np.maximum(self.limits - 1.0, 0.0) ** 2))
        if np.isnan(self.objective):
            return float(np.sum(self.misses**2)) + over
        return self.objective + 10.0 * (float(np.sum(np.maximum(self.misses - 1.0, 0.0))) + over)


@dataclass(frozen=True, eq=False)  # arrays inside
class Model:
    """The numbers near a known point, over the logarithms of what is free."""

    file: WishFile
    point: Array  #: (n,) the known one
    numbers: Response

    def residuals(self, u: Array) -> tuple[Array, Array]:
        """Distances from the targets over what is allowed (m,) at logarithms u (n,), with their rates (m, n).

        Those of powers are of their logarithms, unless the number has another sign than its target.
        """
        wishes, numbers = self.file.wishes, self.numbers
        is_power = wishes.powers & (wishes.targets * numbers.values > 0.0)
        values = np.where(is_power, numbers.values, 1.0)
        targets = np.where(is_power, wishes.targets, 1.0)
        away = np.where(is_power, targets * np.log(values / targets), numbers.values - wishes.targets)
        rates = np.where(is_power, targets / values, 1.0)[:, None] * numbers.rates / wishes.within[:, None]
        return away / wishes.within + rates @ (u - np.log(self.point)), rates

    def misses(self, u: Array) -> tuple[Array, Array]:
        """Squares of the misses of each wish (w,) and their derivatives (w, n)."""
        pairs = list(zip(*map(self.file.wishes.parts, self.residuals(u)), strict=True))
        return np.array([part @ part for part, _ in pairs]), np.array([2.0 * part @ rate for part, rate in pairs])

    def worth(self, u: Array) -> Worth:
        """At logarithms u (n,), by the model."""
        return Worth(np.sqrt(self.misses(u)[0]), self.limits(u), self.objective(u))

    def limits(self, u: Array) -> Array:
        """Values over their limits, each not above 1 where it is kept."""
        found, largest = exact_ratios(self.file, u), self.file.wishes.limits.largest_stretch
        if largest is None:
            return found
        stretch = self.numbers.stretch + self.numbers.stretch_rates @ (u - np.log(self.point))
        return np.append(found, (stretch - 1.0) / (largest - 1.0))

    def objective(self, u: Array) -> float:
        """What is made small: mass and pressure over those at the start; NaN where nothing is."""
        wishes, point = self.file.wishes, np.exp(u)
        if wishes.minimize == "mass":
            return (self.file.drawn(point).mass_tonne or 0.0) / (self.file.start.mass_tonne or 1.0)
        if wishes.minimize == "pressure":
            is_pressure = np.array([one.key.startswith(PRESSURE) for one in wishes.free])
            return float(np.mean((point / wishes.start)[is_pressure]))
        return np.nan


def exact_ratios(file: WishFile, u: Array) -> Array:
    """Mass and wall over their limits at logarithms u (n,). Raises `DesignError`."""
    if file.wishes.limits.mass_g is None and file.wishes.limits.smallest_wall_mm is None:
        return np.zeros(0)
    return np.array([ratio for ratio, _ in exact_limits(file.wishes, file.drawn(np.exp(u))).values()])


def propose(model: Model, radius: float) -> Array:
    """The best point (n,) within a change `radius` of each logarithm, by the model.

    Wishes are met as nearly as possible; where all are met, what is to be small is made so within their tolerances.
    """
    known, bounds = np.log(model.point), np.log(model.file.wishes.bounds)
    low, high = np.minimum(known, bounds[:, 0]), np.maximum(known, bounds[:, 1])  # a start may have been rounded
    box = np.column_stack([np.maximum(low, known - radius), np.minimum(high, known + radius)])
    kept = {"type": "ineq", "fun": lambda u: KEPT - model.limits(u)}
    constraints = [kept] if model.limits(known).size else []

    def distance(u: Array) -> tuple[float, Array]:
        squares, rates = model.misses(u)
        return float(squares.sum()), rates.sum(axis=0)

    best = solved(distance, known, box, constraints, jac=True)
    if model.file.wishes.minimize and np.all(model.misses(best)[0] <= 1.0):
        met = {"type": "ineq", "fun": lambda u: MET**2 - model.misses(u)[0], "jac": lambda u: -model.misses(u)[1]}
        best = solved(model.objective, best, box, [*constraints, met])
    return np.exp(best)


def solved(
    function: Callable[[Array], Any], start: Array, box: Array, constraints: Any = (), jac: bool | None = None
) -> Array:
    """The least value of a function by SLSQP; the start where a point between is no body.

    jac: whether the function gives its derivatives too.
    """
    options = {"maxiter": 200, "ftol": 1e-10, "eps": STEP}
    try:
        found = minimize(
            function, start, jac=jac, method="SLSQP", bounds=box, constraints=constraints, options=options
        ).x
    except (InputError, DesignError):
        return start
    return np.clip(found, box[:, 0], box[:, 1]) if np.all(np.isfinite(found)) else start


def check_feasible(file: WishFile) -> None:
    """Raise InputError where no design within the bounds has a mass and walls within their limits."""

    def excess(u: Array) -> float:
        return float(np.sum(np.maximum(exact_ratios(file, u) - 1.0, 0.0)))

    box, ends = np.log(file.wishes.bounds), list[tuple[float, int, Array]]()
    corners = islice(product(*box), MOST_CORNERS)
    for number, u in enumerate((np.log(file.wishes.start), *map(np.array, corners))):
        with suppress(InputError, DesignError):  # a corner may be no body
            ends.append((excess(u), number, u))
    least, _, best = min(ends)
    if least > ROUNDING:
        best = solved(excess, best, box)
    if excess(best) > ROUNDING:
        found = exact_limits(file.wishes, file.drawn(np.exp(best)))
        name = max(found, key=lambda key: found[key][0])
        has = f"{found[name][1]:.4g} {'g' if name == 'mass' else 'mm'}"
        raise InputError(
            f"{file.source}: limits.{name}: no design within the bounds of free keeps it; the nearest has {has}"
        )
