"""PARDISO of the MKL (the only door to pypardiso)."""

import ctypes
import importlib.util
import os
import weakref
from functools import cache
from importlib import metadata
from pathlib import Path
from time import perf_counter
from typing import Any, final

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, gmres

from fem.equations.linear import (
    SINGULAR,
    ZERO_PIVOT_EXPONENT,
    LinearSolver,
    LinearTimes,
    SingularMatrix,
    SuperLU,
    check_finite,
)
from geometry.arrays import Array

#: orderings of PARDISO: minimum degree is as fast as nested dissection or faster for slender bodies, which have small
#: separators, of up to about so many entries of the upper triangle (studies/solver.md)
MINIMUM_DEGREE, NESTED_DISSECTION = 0, 3
LARGE = 2_100_000
#: entries of the factor by minimum degree over those of the matrix beyond which nested dissection is taken
FILLED = 6.5
#: index in PARDISO's iparm: -1 has the analysis count the entries of the factor, and it holds their number after that
ENTRIES = 18
#: index in PARDISO's iparm: 1 takes the two-level factorization, which is faster with nested dissection only
TWO_LEVEL = 24
#: index in PARDISO's iparm: 0 takes single pivots from the diagonal, 1 also pairs (Bunch and Kaufman). Single pivots
#: are as accurate for the tangents here, mixed ones included, and faster; pairs are the second attempt
PIVOTING = 21
#: residual over right-hand side to which a solution is refined, in at most so many rounds of so many GMRES iterations
REFINED_RESIDUAL = 1e-9
REFINEMENTS = 8
RESTART = 40
#: phases of PARDISO
ANALYSE, FACTORIZE, SOLVE = 11, 22, 33


@final
class Pardiso(LinearSolver):
    """PARDISO of the MKL for real symmetric indefinite matrices (mtype -2), phases 11, 22 and 33 apart.

    The ordering follows from the entries of the matrix and of its factor (LARGE, FILLED).

    A factor that would not fit into `memory` (bytes; by default what the machine has to spare when the matrix is
    analysed) is made in single precision, half as large; solutions then come from GMRES in double precision with that
    factor as its preconditioner, to the same accuracy.
    """

    def __init__(self, memory: float | None = None, large: int = LARGE) -> None:
        """large: number of entries from which on nested dissection and two levels are taken."""
        self._solver = _new_solver()
        weakref.finalize(self, _release, self._solver)
        self._memory, self._large = memory, large
        self._matrix = sp.csr_matrix((0, 0))
        self._data = np.empty(0)
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
        is_large = indices.shape[0] >= self._large
        self._order(NESTED_DISSECTION if is_large else MINIMUM_DEGREE, indptr, indices, spare)
        if not is_large and self._solver.get_iparm(ENTRIES) > FILLED * indices.shape[0]:
            _release(self._solver)
            self._order(NESTED_DISSECTION, indptr, indices, spare)
        self.times.analysis += perf_counter() - start
        self.times.analyses += 1

    def _order(self, ordering: int, indptr: NDArray[Any], indices: NDArray[Any], spare: float) -> None:
        """Analyse a pattern with an ordering, in single precision if its factor does not fit into `spare` bytes."""
        size = indptr.shape[0] - 1
        self._solver.set_iparm(2, ordering)
        self._solver.set_iparm(TWO_LEVEL, int(ordering == NESTED_DISSECTION))
        for kind, precision in ((np.float64, 0), (np.float32, 1)):
            self._solver.set_iparm(28, precision)
            self._solver.set_iparm(ENTRIES, -1)
            self._matrix = sp.csr_matrix((np.ones(indices.shape[0], kind), indices, indptr), shape=(size, size))
            self._call(ANALYSE, np.zeros(size))
            if self.single or self.factor_bytes < spare:
                break
            _release(self._solver)

    def factorize(self, data: Array) -> None:
        self.generation += 1
        check_finite(data)
        start = perf_counter()
        self._data = data
        self._matrix.data = data.astype(self._matrix.dtype, copy=False)
        for pairs in (0, 1):
            self._solver.set_iparm(PIVOTING, pairs)
            self._call(FACTORIZE, np.zeros(self._matrix.shape[0]))
            replaced = int(self._solver.get_iparm(14))  # pivots that were too small: PARDISO goes on with others
            if not replaced:
                break
        self.times.factorization += perf_counter() - start
        self.times.factorizations += 1
        if replaced:
            raise SingularMatrix(SINGULAR)

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
        _release(self._solver)
        self._matrix, self._data = sp.csr_matrix((0, 0)), np.empty(0)


def available_solver() -> type[LinearSolver]:
    """PARDISO where its package is installed, SuperLU elsewhere (ARM has no MKL wheel)."""
    return Pardiso if importlib.util.find_spec("pypardiso") else SuperLU


def _new_solver() -> Any:
    """pypardiso's solver with the options for all matrices here."""
    if library := _runtime():  # before the import, which makes a solver of its own
        os.environ.setdefault("PYPARDISO_MKL_RT", library)
    from pypardiso import PyPardisoSolver

    solver = PyPardisoSolver(mtype=-2)
    # position 35: row starts and columns count from zero, so that PARDISO reads them where they are
    for position, value in {1: 1, 8: 0, 10: -ZERO_PIVOT_EXPONENT, 11: 0, 13: 0, 35: 1}.items():
        solver.set_iparm(position, value)
    return solver


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


def _release(solver: Any) -> None:
    """Give PARDISO's own memory back; pypardiso leaves that to its caller."""
    if solver.pt.any():
        solver.set_phase(-1)
        solver._call_pardiso(sp.csr_matrix((0, 0)), np.zeros(0))
