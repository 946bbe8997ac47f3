"""Polynomials through the states of an arm that bends in space, by least squares of values and slopes.

Moments and the air in the cavities are derivatives of one potential w, which is fitted to both:

    M = dw/dkappa,   V_i = -dw/dp_i,   so that dM/dp_i = -dV_i/dkappa.

Pressures enter by their components in the space that the rows of pressures span, so that an arm whose pressures keep
one ratio has one variable for them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from geometry.arrays import Array
from pipeline.law.in_space.states import CellState
from pipeline.values.pressure import KPA_PER_MPA
from rod.arm_law.polynomial import Basis, Polynomial, exponents_up_to
from rod.errors import RodError

#: degrees of the potential that are tried, and the smallest number of equations over unknowns
DEGREES, EQUATIONS = range(3, 8), 1.8
#: weight of slopes over that of values, and that of the air
SLOPES, AIR = 0.3, 0.1
#: components of pressures over the largest below which they are rounding
SPANNED = 1e-9
#: groups of states that are left out in turn
FOLDS = 6


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Fit:
    """The potential of a cell, its stretch, and its air per rest length in mm2."""

    potential: Polynomial
    stretch: Polynomial
    volume: Polynomial
    error: float  #: of the moment of states that were left out, root of mean squares over the largest moment


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class PressureBasis:
    """What pressures of the cavities, in rows (r, m) in kPa, span."""

    rows: Array

    @cached_property
    def onto(self) -> Array:
        """(m, q): pressures times this are variables of polynomials."""
        _, sizes, directions = np.linalg.svd(self.rows, full_matrices=False)
        return np.asarray(directions[sizes > SPANNED * sizes[0]].T)

    @property
    def scale(self) -> Array:
        """(q,) largest variables."""
        return np.asarray(np.abs(self.rows @ self.onto).max(axis=0))


def fit_cell(states: Sequence[CellState], spanned: PressureBasis, kappa: float) -> Fit:
    """The potential with the degree that predicts left-out states best; kappa: 1/mm, by which curvatures are scaled."""
    scale = np.array([kappa, kappa, *spanned.scale])
    rows = _Rows.of(states, spanned, scale)
    candidates = []
    for degree in DEGREES:
        powers = exponents_up_to(degree, len(scale))
        # the air of straight cells is known at few pressures
        basis = Basis(powers[powers[:, :2].any(axis=1) | (powers.sum(axis=1) < degree)], scale)
        if EQUATIONS * len(basis.exponents) <= 6 * len(states):
            candidates.append((_left_out(rows, basis), degree, basis))
    if not candidates:
        raise RodError(f"Only {len(states)} states of the cell have an equilibrium, too few for a law.")
    error, degree, basis = min(candidates, key=lambda candidate: candidate[0])
    potential = basis.times(_solved(*rows.of_moment(basis))[:, None])
    lower = Basis(exponents_up_to(degree - 1, len(scale)), scale)
    stretch = lower.times(_solved(*rows.of_stretch(lower))[:, None])
    return Fit(potential, stretch, _air(rows, spanned, potential, lower), error)


def fit_values(x: Array, values: Array, basis: Basis) -> Polynomial:
    """Polynomials through values (n, c) at (n, v); the smallest coefficients where several fit."""
    return basis.times(np.asarray(np.linalg.lstsq(basis.values(x), values, rcond=1e-10)[0], float))


def _air(rows: "_Rows", spanned: PressureBasis, potential: Polynomial, basis: Basis) -> Polynomial:
    """Of the potential; pressures in fixed ratios leave a part to which it has no derivative, and that is fitted."""
    onto = spanned.onto
    known = -KPA_PER_MPA * np.hstack([potential.by(2 + k, basis) for k in range(onto.shape[1])]) @ onto.T
    left = (rows.column("volume") - basis.values(rows.x) @ known) @ (np.eye(len(onto)) - onto @ onto.T)
    return basis.times(known + fit_values(rows.x, left, basis).coefficients)


def _left_out(rows: "_Rows", basis: Basis) -> float:
    """Error of the moments of states, each predicted from the others, over the largest."""
    matrix, right = rows.of_moment(basis)
    count = len(rows.x)
    group = np.tile(np.arange(count) % FOLDS, len(right) // count)
    misses = []
    for fold in range(min(FOLDS, count)):
        solved = _solved(matrix[group != fold], right[group != fold])
        values = (matrix @ solved - right).reshape(-1, count)[:2]  # equations of moments come first
        misses.append(values[:, np.arange(count) % FOLDS == fold].ravel())
    return float(np.sqrt(np.mean(np.concatenate(misses) ** 2)))


def _solved(matrix: Array, right: Array) -> Array:
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-12)[0])


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class _Rows:
    """States as equations, scaled by the largest moment."""

    states: Sequence[CellState]
    x: Array  #: (n, v)
    onto: Array  #: (m, q) as of `PressureBasis`
    curved: tuple[Array, Array]  #: (n, v) directions across and along the curvature
    pressed: Array  #: (n, v) change of the variables per kPa of the largest pressure
    kappa: float
    pressure: float  #: kPa, largest

    @staticmethod
    def of(states: Sequence[CellState], spanned: PressureBasis, scale: Array) -> "_Rows":
        pressures = np.array([state.pressures for state in states])
        x = np.column_stack([[state.curvature for state in states], pressures @ spanned.onto])
        largest = np.abs(pressures).max(axis=1, keepdims=True)
        fractions = np.where(largest > 0.0, pressures / np.where(largest > 0.0, largest, 1.0), 1.0)
        none = np.zeros((len(states), x.shape[1] - 2))
        across, along = (
            np.column_stack([[getattr(state, name) for state in states], none]) for name in ("across", "along")
        )
        pressed = np.column_stack([np.zeros((len(states), 2)), fractions @ spanned.onto])
        # at rest pressures in equal parts may leave what the rows span
        pressed[largest[:, 0] == 0.0] *= np.allclose(spanned.onto @ spanned.onto.T, np.eye(len(spanned.onto)))
        return _Rows(states, x, spanned.onto, (across, along), pressed, float(scale[0]), float(np.abs(pressures).max()))

    @property
    def is_pressed(self) -> Array:
        """(n,) 1 where the slopes by the pressure are used, else 0."""
        return np.any(self.pressed != 0.0, axis=1).astype(float)

    def column(self, name: str, part: int | None = None) -> Array:
        """(n, ...): a number of all states, or a part of it."""
        values = [getattr(state, name) for state in self.states]
        return np.array(values if part is None else [value[part] for value in values])

    def of_moment(self, basis: Basis) -> tuple[Array, Array]:
        """Matrix and right-hand side: moments, their slopes by curvature and pressure, and the air."""
        along = self.curved[1]
        largest = float(np.abs(np.array([state.moment for state in self.states])).max())
        parts: list[tuple[Callable[[Array], Array], str, float]] = [
            (lambda at: basis.gradients(self.x, at), "moment", 1.0 / largest),
            (lambda at: basis.second(self.x, at, along), "by_curvature", SLOPES * self.kappa / largest),
            (lambda at: basis.second(self.x, at, self.pressed), "by_pressure", SLOPES * self.pressure / largest),
        ]
        matrix, right = [], []
        for made, name, weight in parts:
            known = weight * (self.is_pressed if name == "by_pressure" else np.ones(len(self.x)))
            for k, direction in enumerate(self.curved):
                matrix.append(known[:, None] * made(direction))
                right.append(known * self.column(name, k))
        weight, directions = AIR * self.pressure / (self.kappa * largest), np.eye(self.x.shape[1])[2:]
        for direction, air in zip(directions, (self.column("volume") @ self.onto).T, strict=True):
            matrix.append(weight * basis.gradients(self.x, np.tile(direction, (len(self.x), 1))))
            right.append(-weight / KPA_PER_MPA * air)
        return np.vstack(matrix), np.concatenate(right)

    def of_stretch(self, basis: Basis) -> tuple[Array, Array]:
        """Matrix and right-hand side: stretch, and its slopes along the curvature and by the pressure."""
        bent, pressed = SLOPES * self.kappa, SLOPES * self.pressure * self.is_pressed
        matrix = [
            basis.values(self.x),
            bent * basis.gradients(self.x, self.curved[1]),
            pressed[:, None] * basis.gradients(self.x, self.pressed),
        ]
        right = [
            self.column("stretch"),
            bent * self.column("stretch_by_curvature"),
            pressed * self.column("stretch_by_pressure"),
        ]
        return np.vstack(matrix), np.concatenate(right)
