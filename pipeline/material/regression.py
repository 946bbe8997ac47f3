"""Least squares for what is linear in its numbers, with standard errors that know of several tests.

Points of one specimen share its error (its thickness, its cure), so from three tests on the errors come from leaving
out one test at a time (the jackknife: B. Efron, C. Stein, Ann. Statist. 9 (1981) 586). With fewer they come from the
scatter of the points, as if each erred for itself, which is all that one specimen can tell.
"""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Index

#: tests from which on the differences between them are an estimate of the error
ENOUGH_TESTS = 3


class TooFewPoints(ValueError):
    """The points do not determine the numbers."""


@dataclass(frozen=True)
class Regression:
    """values = columns @ numbers + error."""

    numbers: Array  #: (k,)
    errors: Array  #: (k,) standard errors
    by_tests: bool  #: the errors come from the differences between tests, not from the scatter of points
    rms: float  #: root mean square of what is left


def regress(columns: Array, values: Array, groups: Index) -> Regression:
    """The numbers (k,) for columns (n, k) and values (n,); groups (n,) says to which test a point belongs.

    Raises `TooFewPoints`.
    """
    numbers = solve(columns, values)
    left = values - columns @ numbers
    rms = float(np.sqrt(np.mean(left**2)))
    tests = np.unique(groups)
    if len(tests) >= ENOUGH_TESTS:
        without = np.array([solve(columns[groups != test], values[groups != test]) for test in tests])
        spread = np.sum((without - without.mean(axis=0)) ** 2, axis=0)
        return Regression(numbers, np.sqrt((len(tests) - 1) / len(tests) * spread), True, rms)
    variance = np.sum(left**2) / (len(values) - len(numbers))
    triangle = np.linalg.qr(columns, mode="r")
    return Regression(numbers, np.sqrt(variance * np.sum(np.linalg.inv(triangle) ** 2, axis=1)), False, rms)


def solve(columns: Array, values: Array) -> Array:
    """The numbers (k,) alone. Raises `TooFewPoints`."""
    size = np.linalg.norm(columns, axis=0)
    if len(values) <= columns.shape[1] or not size.all():
        raise TooFewPoints(f"{len(values)} points do not determine {columns.shape[1]} numbers")
    numbers, _, rank, _ = np.linalg.lstsq(columns / size, values)
    if rank < columns.shape[1]:
        raise TooFewPoints(f"the strains differ too little to determine {columns.shape[1]} numbers")
    return np.asarray(numbers / size)
