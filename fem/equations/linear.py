"""Factorizations of a symmetric matrix given by its upper triangle (the only door to pypardiso)."""

import ctypes
import importlib.util
import math
import os
import weakref
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cache
from importlib import metadata
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple, final

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, gmres, splu

from geometry.arrays import Array


class SingularMatrix(ArithmeticError):
    """The factorization met a zero pivot or produced numbers that are not finite."""


#: a pivot below ten to this power times the largest entry counts as zero
ZERO_PIVOT_EXPONENT = -12
#: orderings of PARDISO: minimum degree is faster for slender bodies, which have small separators, up to about 50 000
#: unknowns (docs/performance.md)
MINIMUM_DEGREE, NESTED_DISSECTION = 0, 3
LARGE = 50_000
#: index in PARDISO's iparm: 1 takes the two-level factorization, which is faster with nested dissection only
TWO_LEVEL = 24
#: index in PARDISO's iparm: 0 takes single pivots from the diagonal, 1 also pairs (Bunch and Kaufman). Single pivots
#: are as accurate for the tangents here, mixed ones included, and faster; pairs are the second attempt
PIVOTING = 21
#: residual over right-hand side to which a solution is refined, in at most so many rounds of so many GMRES iterations
REFINED_RESIDUAL = 1e-9
REFINEMENTS = 8
RESTART = 40
#: phases of PARDISO; the last one gives the factor back and keeps the analysis
ANALYSE, FACTORIZE, SOLVE, RELEASE_FACTOR = 11, 22, 33, 0
#: analyses that no solver uses are kept for later matrices of the same pattern: so many, of fewer unknowns than LARGE
KEPT = 4
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


class _Analysis(NamedTuple):
    """What PARDISO keeps of the symbolic analysis of a pattern, without a factor."""

    indptr: NDArray[Any]  #: (d + 1,)
    indices: NDArray[Any]  #: (nnz,)
    handle: NDArray[Any]
    parameters: NDArray[Any]


#: analyses that no solver of this process uses, the latest at the end
_unused: list[_Analysis] = []


@final
class Pardiso(LinearSolver):
    """PARDISO of the MKL for real symmetric indefinite matrices (mtype -2), phases 11, 22 and 33 apart.

    The analysis of a solver that was closed serves the next one with a matrix of the same pattern.

    A factor that would not fit into `memory` (bytes; by default what the machine has to spare when the matrix is
    analysed) is made in single precision, half as large; solutions then come from GMRES in double precision with that
    factor as its preconditioner, to the same accuracy.
    """

    def __init__(self, memory: float | None = None, large: int = LARGE) -> None:
        """large: number of unknowns from which on nested dissection and two levels are taken."""
        if library := _runtime():  # before the import, which makes a solver of its own
            os.environ.setdefault("PYPARDISO_MKL_RT", library)
        from pypardiso import PyPardisoSolver

        self._solver = PyPardisoSolver(mtype=-2)
        self._finalizer = weakref.finalize(self, _release, self._solver)
        # position 35: row starts and columns count from zero, so that PARDISO reads them where they are
        for position, value in {1: 1, 8: 0, 10: -ZERO_PIVOT_EXPONENT, 11: 0, 13: 0, 35: 1}.items():
            self._solver.set_iparm(position, value)
        self._memory, self._large = memory, large
        self._matrix = sp.csr_matrix((0, 0))
        self._data = np.empty(0)
        self._failed = False  #: whether PARDISO has reported an error since the last analysis began
        self.times = LinearTimes()
        self.generation = 0

    def _call(self, phase: int, right: Array) -> Array:
        """One phase on the present matrix. pypardiso's own call would copy row starts and columns twice each time."""
        solver, matrix = self._solver, self._matrix
        right = np.asfortranarray(right, dtype=matrix.dtype)
        solution, error = np.zeros_like(right), np.zeros(1, dtype=np.int32)
        triangle = (matrix.shape[0], matrix.data, matrix.indptr, matrix.indices)
        sides = 1 if right.ndim == 1 else right.shape[1]
        values = (solver.pt, 1, 1, solver.mtype, phase, *triangle, solver.perm, sides, solver.iparm, 0)
        pardiso = solver._mkl_pardiso
        arguments = zip((*values, right, solution, error), pardiso.argtypes, strict=True)
        pardiso(*(_pointer(value, kind) for value, kind in arguments))
        self._failed |= bool(error[0])
        if error[0] == -2:
            raise MemoryError("PARDISO: the factor does not fit into memory; choose a coarser mesh")
        if error[0]:
            raise SingularMatrix(f"PARDISO stopped with error {error[0]}")
        return np.ascontiguousarray(solution)

    @property
    def single(self) -> bool:
        """Whether the factor is kept in single precision."""
        return bool(self._matrix.dtype == np.float32)

    @property
    def factor_bytes(self) -> int:
        """Memory of the factor as the symbolic analysis foresees it."""
        return 1024 * int(max(self._solver.get_iparm(15), self._solver.get_iparm(16) + self._solver.get_iparm(17)))

    def analyse(self, indptr: NDArray[Any], indices: NDArray[Any]) -> None:
        start = perf_counter()
        self.close()
        spare = spare_memory() if self._memory is None else self._memory
        size = indptr.shape[0] - 1
        is_large, self._failed = size >= self._large, False
        self.times.analyses += 1
        if not is_large and self._take(indptr, indices, spare):
            self.times.analysis += perf_counter() - start
            return
        self._solver.set_iparm(2, NESTED_DISSECTION if is_large else MINIMUM_DEGREE)
        self._solver.set_iparm(TWO_LEVEL, int(is_large))
        for kind, precision in ((np.float64, 0), (np.float32, 1)):
            self._solver.set_iparm(28, precision)
            self._matrix = sp.csr_matrix((np.ones(indices.shape[0], kind), indices, indptr), shape=(size, size))
            self._call(ANALYSE, np.zeros(size))
            if self.factor_bytes < spare or self.single:
                break
            _release(self._solver)
        self.times.analysis += perf_counter() - start

    def _take(self, indptr: NDArray[Any], indices: NDArray[Any], spare: float) -> bool:
        """Use a kept analysis of this pattern whose factor fits into `spare` bytes; whether there is one."""
        for position, kept in enumerate(_unused):
            if np.array_equal(kept.indptr, indptr) and np.array_equal(kept.indices, indices):
                del _unused[position]
                self._solver.pt[:], self._solver.iparm[:] = kept.handle, kept.parameters
                if self.factor_bytes < spare:
                    size = indptr.shape[0] - 1
                    self._matrix = sp.csr_matrix((np.ones(indices.shape[0]), indices, indptr), shape=(size, size))
                    return True
                _release(self._solver)
                break
        return False

    def _keep(self) -> None:
        """Give the factor back and leave the analysis to later solvers."""
        solver = self._solver
        self._call(RELEASE_FACTOR, np.zeros(self._matrix.shape[0]))
        matrix = self._matrix
        _unused.append(_Analysis(matrix.indptr, matrix.indices, solver.pt.copy(), solver.iparm.copy()))
        solver.pt[:] = 0
        if len(_unused) > KEPT:
            solver.pt[:] = _unused.pop(0).handle
            _release(solver)

    def factorize(self, data: Array) -> None:
        self.generation += 1
        _check_finite(data)
        start = perf_counter()
        self._data = data
        self._matrix.data = data.astype(self._matrix.dtype, copy=False)
        for pairs in (0, 1):
            self._solver.set_iparm(PIVOTING, pairs)
            self._call(FACTORIZE, np.zeros(self._matrix.shape[0]))
            if not self._replaced_pivots:
                break
        self.times.factorization += perf_counter() - start
        self.times.factorizations += 1
        if self._replaced_pivots:
            raise SingularMatrix(SINGULAR)

    @property
    def _replaced_pivots(self) -> bool:
        """Whether pivots were too small: PARDISO replaces them and goes on."""
        return int(self._solver.get_iparm(14)) > 0

    def solve(self, right: Array) -> Array:
        start = perf_counter()
        solution = self._refined(right) if self.single else self._call(SOLVE, np.asfortranarray(right))
        self.times.solve += perf_counter() - start
        if not np.isfinite(solution).all():
            raise SingularMatrix("the linear system has no finite solution")
        return solution

    def _refined(self, right: Array) -> Array:
        """The solution for right (d,) or (d, k) by GMRES with the single-precision factor."""
        if right.ndim == 2:
            return np.column_stack([self._refined(column) for column in right.T])
        upper = sp.csr_matrix((self._data, self._matrix.indices, self._matrix.indptr), shape=self._matrix.shape)
        diagonal = upper.diagonal()
        operators = (
            LinearOperator(upper.shape, lambda x: upper @ x + upper.T @ x - diagonal * x, dtype=float),
            LinearOperator(upper.shape, lambda x: self._call(SOLVE, x.ravel()).astype(float), dtype=float),
        )
        solution, residual = np.zeros_like(right), right
        for _ in range(REFINEMENTS):  # rounding to single precision is no linear operator: GMRES alone would stall
            step, _ = gmres(operators[0], residual, M=operators[1], rtol=1e-5, restart=RESTART, maxiter=1)
            solution = solution + step
            residual = right - operators[0] @ solution
            if np.linalg.norm(residual) <= REFINED_RESIDUAL * np.linalg.norm(right):
                return solution
        raise SingularMatrix(f"{SINGULAR}; or the factor needs the double precision that memory does not allow here")

    @property
    def negative_pivots(self) -> int:
        return int(self._solver.get_iparm(23))

    def close(self) -> None:
        self.generation += 1
        is_sound = self._solver.pt.any() and not self._failed
        if is_sound and not self.single and self._matrix.shape[0] < self._large:
            self._keep()
        else:
            _release(self._solver)
        self._matrix, self._data = sp.csr_matrix((0, 0)), np.empty(0)


@cache
def _runtime() -> str | None:
    """Path of the MKL's library, as its package declares it.

    Without it pypardiso searches the environment's folders for every solver, which takes as long as two factorizations
    of a coarse mesh. None where the MKL comes from another package manager: pypardiso then searches.
    """
    try:
        files = metadata.files("mkl") or []
    except metadata.PackageNotFoundError:
        return None
    libraries = (file for file in files if "mkl_rt" in file.name and file.suffix != ".lib")
    return next((str(Path(str(file.locate())).resolve()) for file in libraries), None)


def spare_memory() -> float:
    """Bytes that the machine can give without swapping; all of its memory where the system does not say."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        return 1024.0 * next(int(line.split()[1]) for line in lines if line.startswith("MemAvailable"))
    except (OSError, StopIteration):
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))


def _pointer(value: Any, kind: Any) -> Any:
    """An array or an integer as an argument of the type `kind` for a function that takes all by reference."""
    return value.ctypes.data_as(kind) if isinstance(value, np.ndarray) else ctypes.byref(ctypes.c_int32(value))


def _check_finite(data: Array) -> None:
    # a sum that is finite has finite terms only, and needs no array of its own
    if not (math.isfinite(float(data.sum())) or np.isfinite(data).all()):
        raise SingularMatrix("an entry of the matrix is not a finite number")


def _release(solver: Any) -> None:
    """Give PARDISO's own memory back; pypardiso leaves that to its caller."""
    if solver.pt.any():
        solver.set_phase(-1)
        solver._call_pardiso(sp.csr_matrix((0, 0)), np.zeros(0))


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
        _check_finite(data)  # SuperLU ends the process on them
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


def available_solver() -> type[LinearSolver]:
    """PARDISO where its package is installed, SuperLU elsewhere (ARM has no MKL wheel)."""
    return Pardiso if importlib.util.find_spec("pypardiso") else SuperLU
