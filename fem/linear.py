"""Factorizations of a symmetric matrix given by its upper triangle (the only door to pypardiso)."""

import importlib.util
import weakref
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, final

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]


class SingularMatrix(ArithmeticError):
    """The factorization met a zero pivot or produced numbers that are not finite."""


#: a pivot below ten to this power times the largest entry counts as zero
ZERO_PIVOT = -12
LOOSE = "a pivot is zero: a part of the body is not held, or the equilibrium is at a limit point"


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

    @abstractmethod
    def analyse(self, indptr: NDArray[Any], indices: NDArray[Any]) -> None:
        """Symbolic analysis of an upper triangular CSR pattern with sorted rows and a full diagonal."""

    @abstractmethod
    def factorize(self, data: Array) -> None:
        """Numeric factorization of the values data (nnz,); raises `SingularMatrix`."""

    @abstractmethod
    def solve(self, right: Array) -> Array:
        """Solution (d,) or (d, k) for the last factorized matrix; raises `SingularMatrix`."""

    @property
    @abstractmethod
    def negative_pivots(self) -> int:
        """Number of negative pivots of the last factorization (the inertia, by Sylvester's law)."""

    @abstractmethod
    def close(self) -> None:
        """Give the memory of the factor back."""


@final
class Pardiso(LinearSolver):
    """PARDISO of the MKL for real symmetric indefinite matrices (mtype -2), phases 11, 22 and 33 apart."""

    def __init__(self) -> None:
        from pypardiso import PyPardisoSolver
        from pypardiso.pardiso_wrapper import PyPardisoError

        self._solver = PyPardisoSolver(mtype=-2)
        self._error = PyPardisoError
        self._finalizer = weakref.finalize(self, _release, self._solver)
        for place, value in {1: 1, 2: 3, 8: 1, 10: -ZERO_PIVOT, 11: 0, 13: 0, 21: 1, 24: 0}.items():
            self._solver.set_iparm(place, value)
        self._matrix = sp.csr_matrix((0, 0))
        self.times = LinearTimes()

    def _call(self, phase: int, right: Array) -> Array:
        self._solver.set_phase(phase)
        try:
            return self._solver._call_pardiso(self._matrix, right)
        except self._error as error:
            if error.value == -2:
                raise MemoryError("PARDISO: the factor does not fit into memory; choose a coarser mesh") from None
            raise SingularMatrix(f"PARDISO stopped with error {error.value}") from None

    def analyse(self, indptr: NDArray[Any], indices: NDArray[Any]) -> None:
        start = perf_counter()
        self.close()
        size = indptr.shape[0] - 1
        self._matrix = sp.csr_matrix((np.ones(indices.shape[0]), indices, indptr), shape=(size, size))
        self._call(11, np.zeros(size))
        self.times.analysis += perf_counter() - start
        self.times.analyses += 1

    def factorize(self, data: Array) -> None:
        _check_finite(data)
        start = perf_counter()
        self._matrix.data = data
        self._call(22, np.zeros(self._matrix.shape[0]))
        self.times.factorization += perf_counter() - start
        self.times.factorizations += 1
        if self._solver.get_iparm(14) > 0:  # PARDISO replaces pivots that are too small and goes on
            raise SingularMatrix(LOOSE)

    def solve(self, right: Array) -> Array:
        start = perf_counter()
        solution = self._call(33, np.asfortranarray(right))
        self.times.solve += perf_counter() - start
        if not np.isfinite(solution).all():
            raise SingularMatrix("the linear system has no finite solution")
        return solution

    @property
    def negative_pivots(self) -> int:
        return int(self._solver.get_iparm(23))

    def close(self) -> None:
        _release(self._solver)
        self._matrix = sp.csr_matrix((0, 0))


def _check_finite(data: Array) -> None:
    if not np.isfinite(data).all():
        raise SingularMatrix("an entry of the matrix is not a finite number")


def _release(solver: Any) -> None:
    """Give PARDISO's own memory back; pypardiso leaves that to its caller."""
    if solver.pt.any():
        solver.set_phase(-1)
        solver._call_pardiso(sp.csr_matrix((0, 0)), np.zeros(0))


@final
@dataclass
class SuperLU(LinearSolver):
    """SciPy's SuperLU on the whole matrix: works everywhere, several times slower; the analysis is not kept."""

    times: LinearTimes = field(default_factory=LinearTimes)
    _pattern: sp.csr_matrix = field(default_factory=lambda: sp.csr_matrix((0, 0)))
    _factor: Any = None
    _pivots: Array = field(default_factory=lambda: np.empty(0))

    def analyse(self, indptr: NDArray[Any], indices: NDArray[Any]) -> None:
        size = indptr.shape[0] - 1
        self._pattern = sp.csr_matrix((np.ones(indices.shape[0]), indices, indptr), shape=(size, size))
        self.times.analyses += 1

    def factorize(self, data: Array) -> None:
        _check_finite(data)  # SuperLU ends the process on them
        start = perf_counter()
        self._pattern.data = data
        whole = self._pattern + sp.triu(self._pattern, 1).T
        try:
            # diagonal pivots keep the factor symmetric, so the signs of U's diagonal are the inertia
            self._factor = splu(
                whole.tocsc(),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError:
            raise SingularMatrix(LOOSE) from None
        self._pivots = self._factor.U.diagonal()
        self.times.factorization += perf_counter() - start
        self.times.factorizations += 1
        if np.abs(self._pivots).min() < 10.0**ZERO_PIVOT * np.abs(data).max():
            raise SingularMatrix(LOOSE)

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
        self._factor = None


def available_solver() -> type[LinearSolver]:
    """PARDISO where its package is installed, SuperLU elsewhere (ARM has no MKL wheel)."""
    return Pardiso if importlib.util.find_spec("pypardiso") else SuperLU
