"""Linear least squares with standard errors that account for differences between specimens.

All points of one specimen have an error in common (its thickness, its cure). With three tests or more the standard
errors therefore come from leaving out one test at a time (the jackknife: B. Efron, C. Stein, Ann. Statist. 9 (1981)
586). With fewer tests they come from the scatter of the points, taken as independent.
"""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Index

#: number of tests from which the jackknife is used
JACKKNIFE_TESTS = 3


class TooFewPoints(ValueError):
    """The points do not determine the coefficients."""


@dataclass(frozen=True)
class Regression:
    """values = matrix @ coefficients + error."""

    coefficients: Array  #: (k,)
    covariance: Array  #: (k, k) of the coefficients
    by_tests: bool  #: the errors come from the differences between tests, not from the scatter of points
    rms: float  #: root mean square of the residuals

    @property
    def errors(self) -> Array:
        """(k,) standard errors of the coefficients."""
        return np.sqrt(np.diag(self.covariance))


def regress(matrix: Array, values: Array, groups: Index) -> Regression:
    """Fit matrix (n, k) @ coefficients (k,) to values (n,); groups (n,) holds the number of the test of each point.

    Raises `TooFewPoints`.
    """
    coefficients = least_squares(matrix, values)
    residuals = values - matrix @ coefficients
    rms = float(np.sqrt(np.mean(residuals**2)))
    tests = np.unique(groups)
    if len(tests) >= JACKKNIFE_TESTS:
        without = np.array([least_squares(matrix[groups != test], values[groups != test]) for test in tests])
        apart = without - without.mean(axis=0)
        return Regression(coefficients, (len(tests) - 1) / len(tests) * apart.T @ apart, True, rms)
    variance = np.sum(residuals**2) / (len(values) - len(coefficients))
    inverse = np.linalg.inv(np.linalg.qr(matrix, mode="r"))
    return Regression(coefficients, variance * inverse @ inverse.T, False, rms)


def least_squares(matrix: Array, values: Array) -> Array:
    """The coefficients (k,) that fit best, without errors. Raises `TooFewPoints`."""
    size = np.linalg.norm(matrix, axis=0)
    if len(values) <= matrix.shape[1] or not size.all():
        raise TooFewPoints(f"{len(values)} points do not determine {matrix.shape[1]} coefficients")
    coefficients, _, rank, _ = np.linalg.lstsq(matrix / size, values)
    if rank < matrix.shape[1]:
        raise TooFewPoints(f"the strains differ too little to determine {matrix.shape[1]} coefficients")
    return np.asarray(coefficients / size)
