"""Factorizations of a symmetric matrix given by its upper triangle."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, final

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from geometry.arrays import Array


class SingularMatrix(ArithmeticError):
    """The factorization met a zero pivot or produced numbers that are not finite."""


#: a pivot below ten to this power times the largest entry counts as zero
ZERO_PIVOT_EXPONENT = -12
SINGULAR = "a pivot is zero: a part of the body is not held, or the equilibrium is at a limit point"


@dataclass
class LinearTimes:
    """Seconds and calls, summed over the life of a solver."""

    analysis: float = 0.0
    factorization: float = 0.0
    solve: float = 0.0
    analyses: int = 0
    factorizations: int = 0


class LinearSolver(ABC):
    """A direct solver that keeps its symbolic analysis while the pattern stays the same."""

    times: LinearTimes
    generation: int  #: grows with every analysis, factorization and closing: a factor belongs to one generation

    @abstractmethod
    def analyse(self, indptr: NDArray[Any], indices: NDArray[Any]) -> None:
        """Symbolic analysis of an upper triangular pattern, indptr (d + 1,) and indices (nnz,) in compressed rows.

        Its rows are sorted and its diagonal is full.
        """

    @abstractmethod
    def factorize(self, data: Array) -> None:
        """Numeric factorization of the values data (nnz,); raises `SingularMatrix`."""

    @abstractmethod
    def solve(self, right: Array) -> Array:
        """Solution (d,) or (d, k) for right-hand sides of that shape with the matrix of the last `factorize`.

        Raises `SingularMatrix` where it is not finite.
        """

    @property
    @abstractmethod
    def negative_pivots(self) -> int:
        """Number of negative pivots of the last factorization (the inertia, by Sylvester's law)."""

    @abstractmethod
    def close(self) -> None:
        """Give the memory of the factor back."""


def check_finite(data: Array) -> None:
    # a sum that is finite has finite terms only, and needs no array of its own
    if not (math.isfinite(float(data.sum())) or np.isfinite(data).all()):
        raise SingularMatrix("an entry of the matrix is not a finite number")


@final
@dataclass
class SuperLU(LinearSolver):
    """SciPy's SuperLU on the full matrix: runs everywhere, several times slower; keeps no symbolic analysis."""

    times: LinearTimes = field(default_factory=LinearTimes)
    generation: int = 0
    _pattern: sp.csr_matrix = field(default_factory=lambda: sp.csr_matrix((0, 0)))
    _factor: Any = None
    _pivots: Array = field(default_factory=lambda: np.empty(0))

    def analyse(self, indptr: NDArray[Any], indices: NDArray[Any]) -> None:
        self.close()
        size = indptr.shape[0] - 1
        self._pattern = sp.csr_matrix((np.ones(indices.shape[0]), indices, indptr), shape=(size, size))
        self.times.analyses += 1

    def factorize(self, data: Array) -> None:
        self.generation += 1
        check_finite(data)  # SuperLU ends the process on them
        start = perf_counter()
        self._pattern.data = data
        full = self._pattern + sp.triu(self._pattern, 1).T
        try:
            # diagonal pivots keep the factor symmetric, so the signs of U's diagonal are the inertia
            self._factor = splu(
                full.tocsc(),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError:
            raise SingularMatrix(SINGULAR) from None
        self._pivots = self._factor.U.diagonal()
        self.times.factorization += perf_counter() - start
        self.times.factorizations += 1
        if np.abs(self._pivots).min() < 10.0**ZERO_PIVOT_EXPONENT * np.abs(data).max():
            raise SingularMatrix(SINGULAR)

    def solve(self, right: Array) -> Array:
        start = perf_counter()
        solution = self._factor.solve(right)
        self.times.solve += perf_counter() - start
        if not np.isfinite(solution).all():
            raise SingularMatrix("the linear system has no finite solution")
        return np.asarray(solution)

    @property
    def negative_pivots(self) -> int:
        return int(np.count_nonzero(self._pivots < 0))

    def close(self) -> None:
        self.generation += 1
        self._factor = None
