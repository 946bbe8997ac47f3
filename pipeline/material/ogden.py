"""Ogden's law as it is fitted to tensile tests.

It is fitted with one, two and three terms by nonlinear least squares, which begin at the best of all combinations of
exponents from a grid, so that they do not end at a minimum that is only local.

Terms with mu_i alpha_i > 0 make the law stable at every strain. They are taken unless terms of both signs leave less
than half of the root mean square.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import final

import numpy as np

from fem.materials import Material, Ogden
from geometry.arrays import Array
from pipeline.material.form import LARGEST_ERROR, Form, relative_error
from pipeline.material.regression import TooFewPoints

#: exponents of the grid; those of the terms that are published for rubbers and gels lie within it
EXPONENTS = np.array(
    [-12, -9, -7, -5, -4, -3, -2, -1.5, -1, -0.5, 0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 9, 11, 14, 18, 25]
)
#: largest exponent, relative accuracy of the search, and number of evaluations after which its best is taken
LARGEST_EXPONENT, ACCURACY, MOST_EVALUATIONS = 50.0, 1e-12, 100
#: a term is not determined if its exponent differs from another one by less, or it has a smaller part of the stress
CLOSEST, SMALLEST = 0.1, 1e-4
#: relative decrease of the sum of squares below which another term is not taken
LEAST_GAIN = 0.01
#: sum of squares that terms of both signs leave, over that of terms with mu alpha > 0, below which they are taken
MUCH_CLOSER = 0.25


@final
@dataclass(frozen=True)
class OgdenForm(Form):
    """Ogden's law with a number of terms; its constants are mu1, alpha1, mu2, ..., the largest product first."""

    terms: int

    law = "ogden"
    ranges = 25

    @property
    def name(self) -> str:  # type: ignore[override]
        return f"ogden {self.terms}"

    @property
    def constants(self) -> tuple[str, ...]:  # type: ignore[override]
        return tuple(f"{name}{number}" for number in range(1, self.terms + 1) for name in ("mu", "alpha"))

    def _best_fit(self, stretch: Array, stress: Array) -> Array:
        best = _best(_Points.of(stretch, stress), self.terms)
        part = np.abs(best.products) * np.linalg.norm(_basis(stretch, best.exponents), axis=0)
        apart = np.diff(np.sort(best.exponents))
        if (part < SMALLEST * part.max()).any() or (apart < CLOSEST).any():
            raise TooFewPoints(self._undetermined)
        order = np.argsort(-np.abs(best.products))
        return np.column_stack([best.products / best.exponents, best.exponents])[order].ravel()

    @property
    def _undetermined(self) -> str:
        return f"the data do not determine {'one term' if self.terms == 1 else f'{self.terms} terms'}"

    def undetermined(self, constants: Array, covariance: Array, stretch: Array, stress: Array) -> str:
        """Also terms whose exponent, or whose stress where it is largest, has a large error, and terms too many.

        The modulus of a term is not judged: it may be tiny beside a large exponent, and the two vary together.
        """
        term, points = OgdenForm(1), _Points.of(stretch, stress)
        left = float(np.sum((self.nominal(constants, stretch) - stress) ** 2))
        if self.terms > 1 and left > (1 - LEAST_GAIN) * _best(points, self.terms - 1).left:
            return f"{self.terms} terms are no closer to the data than {self.terms - 1}"
        for number in range(0, len(constants), 2):
            part, both = slice(number, number + 2), constants[number : number + 2]
            alpha, alpha_error = both[1], np.sqrt(covariance[number + 1, number + 1])
            most = stretch[[np.argmax(np.abs(term.nominal(both, stretch)))]]
            error = relative_error(term.nominal(both, most), term.slopes(both, most), covariance[part, part])
            if error > LARGEST_ERROR or alpha_error > LARGEST_ERROR * max(abs(alpha), 1):
                return (
                    f"{self._undetermined}: one has alpha {alpha:.2g} ± {alpha_error:.1g} and a stress with a standard "
                    f"error of {100 * error:.2g} %"
                )
        return super().undetermined(constants, covariance, stretch, stress)

    def nominal(self, constants: Array, stretch: Array) -> Array:
        mu, alpha = constants.reshape(-1, 2).T
        return np.asarray(_basis(stretch, alpha) @ (mu * alpha))

    def slopes(self, constants: Array, stretch: Array) -> Array:
        log, columns = np.log(stretch)[:, None], []
        for mu, alpha in constants.reshape(-1, 2):
            along, across = stretch[:, None] ** (alpha - 1), stretch[:, None] ** (-alpha / 2 - 1)
            columns += [along - across, mu * log * (along + across / 2)]
        return np.hstack(columns)

    def solved(self, constants: Array, nu: float) -> Material:
        mu, alpha = constants.reshape(-1, 2).T
        terms: Mapping[str, tuple[float, ...]] = {"mu": tuple(mu.tolist()), "alpha": tuple(alpha.tolist())}
        return Ogden.from_uniaxial(terms, nu)


def _basis(stretch: Array, exponents: Array) -> Array:
    """(n, k) nominal stress of the incompressible bar per unit of mu alpha."""
    s = stretch[:, None]
    return np.asarray((s ** (exponents - 1) - s ** (-exponents / 2 - 1)) / exponents)


@dataclass(frozen=True)
class _Points:
    """The mean stress at each stretch, which gives the same least-squares problem as all points."""

    stretch: Array  #: (m,)
    stress: Array  #: (m,) MPa
    weight: Array  #: (m,) square root of the number of points
    scatter: float  #: sum of squares of all points about these means, MPa2

    @classmethod
    def of(cls, stretch: Array, stress: Array) -> "_Points":
        """From single points (n,)."""
        unique, group, count = np.unique(np.round(stretch, 9), return_inverse=True, return_counts=True)
        mean = np.bincount(group, stress) / count
        return cls(unique, mean, np.sqrt(count), float(np.sum((stress - mean[group]) ** 2)))

    def matrix(self, exponents: Array) -> Array:
        """(m, k) weighted basis."""
        return self.weight[:, None] * _basis(self.stretch, exponents)

    @property
    def right(self) -> Array:
        """(m,) weighted stress."""
        return self.weight * self.stress


@dataclass(frozen=True)
class _Terms:
    """Exponents (k,) with their products mu alpha (k,), MPa, and the sum of squares that they leave."""

    exponents: Array
    products: Array
    left: float


def _best(points: _Points, terms: int) -> _Terms:
    """Terms that are stable at every strain, or of both signs where these are much closer."""
    stable = _searched(points, terms, positive=True)
    if terms == 1:
        return stable
    free = _searched(points, terms, positive=False)
    return free if free.left < MUCH_CLOSER * stable.left and free.products.sum() > 0 else stable


def _searched(points: _Points, terms: int, *, positive: bool) -> _Terms:
    """The best terms, with products that are not negative where `positive`."""
    from scipy.optimize import least_squares as minimised

    def residuals(x: Array) -> Array:
        return np.asarray(points.matrix(x[terms:]) @ x[:terms] - points.right)

    def derivatives(x: Array) -> Array:
        exponents, log = x[terms:], np.log(points.stretch)[:, None]
        matrix, s = points.matrix(exponents), points.stretch[:, None]
        rates = points.weight[:, None] * log * (s ** (exponents - 1) + s ** (-exponents / 2 - 1) / 2) - matrix
        return np.hstack([matrix, x[:terms] * rates / exponents])

    start = _start(points, terms, positive=positive)
    low = np.repeat([0.0 if positive else -np.inf, -LARGEST_EXPONENT], terms)
    high = np.repeat([np.inf, LARGEST_EXPONENT], terms)
    solution = minimised(
        residuals, np.maximum(start, low + 1e-9), derivatives, (low, high), x_scale="jac", xtol=ACCURACY,
        ftol=ACCURACY, gtol=ACCURACY, max_nfev=MOST_EVALUATIONS,
    )  # fmt: skip
    return _Terms(solution.x[terms:], solution.x[:terms], float(2 * solution.cost) + points.scatter)


def _start(points: _Points, terms: int, *, positive: bool) -> Array:
    """Products and exponents (2 k,) of the combination from the grid that fits best."""
    matrix = points.matrix(EXPONENTS)
    size = np.linalg.norm(matrix, axis=0)
    gram, right = (matrix / size).T @ (matrix / size), (matrix / size).T @ points.right
    chosen = np.array(list(combinations(range(len(EXPONENTS)), terms)))
    local = gram[chosen[:, :, None], chosen[:, None, :]] + 1e-12 * np.eye(terms)
    products = np.linalg.solve(local, right[chosen][..., None])[..., 0]
    gain = np.sum(products * right[chosen], axis=1)
    allowed = (products > 0).all(axis=1)
    if positive and allowed.any():  # otherwise fewer terms are as good, which the sum of squares tells
        gain = np.where(allowed, gain, -np.inf)
    best = int(np.argmax(gain))
    return np.concatenate([products[best] / size[chosen[best]], EXPONENTS[chosen[best]]])
