"""Polynomials in several variables, with their derivatives, as least squares find them from values and slopes."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Annotated, final

import numpy as np

from geometry.arrays import Array, Index


def exponents_up_to(degree: int, variables: int) -> Index:
    """(k, variables): those of all monomials up to a degree, in rising order."""
    every = product(range(degree + 1), repeat=variables)
    return np.array([powers for powers in every if sum(powers) <= degree], dtype=np.intp).reshape(-1, variables)


@dataclass(frozen=True, eq=False)  # arrays inside
class Basis:
    """Monomials of scaled variables."""

    exponents: Annotated[Index, "exponents", "k", "v"]
    scale: Annotated[Array, "scale", "v"]  #: by which variables are divided

    def values(self, x: Array, orders: Sequence[int] | Index = ()) -> Array:
        """(n, k) at (n, v); orders: how often each variable is differentiated."""
        result = np.ones((len(x), len(self.exponents)))
        for column, order in enumerate(orders if len(orders) else [0] * len(self.scale)):
            powers = self.exponents[:, column]
            factor = np.prod([powers - i for i in range(order)], axis=0) if order else 1.0
            base = (x[:, column] / self.scale[column])[:, None]
            result = result * factor * base ** np.maximum(powers - order, 0) / self.scale[column] ** order
        return result

    def gradients(self, x: Array, directions: Array) -> Array:
        """(n, k): derivatives at (n, v) along directions (n, v)."""
        unit = np.eye(len(self.scale), dtype=int)
        return np.asarray(sum(directions[:, [i]] * self.values(x, unit[i]) for i in range(len(unit))))

    def second(self, x: Array, first: Array, other: Array) -> Array:
        """(n, k): second derivatives at (n, v) along two directions (n, v)."""
        unit, size = np.eye(len(self.scale), dtype=int), len(self.scale)
        pairs = ((i, j) for i in range(size) for j in range(size))
        return np.asarray(
            sum((first[:, i] * other[:, j])[:, None] * self.values(x, unit[i] + unit[j]) for i, j in pairs)
        )

    def times(self, coefficients: Array) -> "Polynomial":
        """The polynomials with coefficients (k, c)."""
        return Polynomial(self.exponents, self.scale, coefficients)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Polynomial(Basis):
    """Several polynomials with the same monomials."""

    coefficients: Annotated[Array, "coefficients", "k", "c"]

    def __call__(self, x: Array) -> Array:
        """(n, c) at (n, v)."""
        return np.asarray(self.values(np.atleast_2d(x)) @ self.coefficients)

    def by(self, variable: int, basis: Basis) -> Array:
        """(k, c): coefficients of the derivative by a variable, in a basis of equal scale that has its monomials."""
        powers = self.exponents[:, variable]
        lowered = self.exponents - np.eye(self.exponents.shape[1], dtype=np.intp)[variable]
        is_same = (basis.exponents[:, None] == lowered).all(axis=2)
        return np.asarray(is_same @ (powers[:, None] / self.scale[variable] * self.coefficients))

    def at_last(self, values: Array) -> "Plane":
        """Coefficients as polynomials of the first two variables, with the others given (v - 2,)."""
        powers, scale = self.exponents, self.scale
        factor = np.prod((values / scale[2:]) ** powers[:, 2:], axis=1) / np.prod(scale[:2] ** powers[:, :2], axis=1)
        table = np.zeros((*(powers[:, :2].max(axis=0) + 1), self.coefficients.shape[1]))
        np.add.at(table, (powers[:, 0], powers[:, 1]), factor[:, None] * self.coefficients)
        return Plane(table)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Plane:
    """Several polynomials of two variables."""

    table: Array  #: (i, j, c), coefficients of x^i y^j

    def __call__(self, x: Array) -> Array:
        """(..., c) at (..., 2)."""
        first, second = (x[..., k, None] ** np.arange(size) for k, size in enumerate(self.table.shape[:2]))
        monomials = (first[..., :, None] * second[..., None, :]).reshape(*x.shape[:-1], -1)
        return np.asarray(monomials @ self.table.reshape(-1, self.table.shape[2]))

    def derivative(self, axis: int) -> "Plane":
        """Derivative by the first or the second variable."""
        return Plane(np.asarray(np.polynomial.polynomial.polyder(self.table, axis=axis)))

    @staticmethod
    def joined(planes: "Sequence[Plane]") -> "Plane":
        """The polynomials of all."""
        size = np.max([plane.table.shape[:2] for plane in planes], axis=0)
        padded = [
            np.pad(plane.table, [(0, size[0] - plane.table.shape[0]), (0, size[1] - plane.table.shape[1]), (0, 0)])
            for plane in planes
        ]
        return Plane(np.concatenate(padded, axis=2))
