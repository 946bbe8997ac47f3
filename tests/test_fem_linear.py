"""The two linear solvers against dense algebra, and what they say of matrices that have no inverse."""

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.linear import LinearSolver, Pardiso, SingularMatrix, SuperLU, available_solver

Array = NDArray[np.float64]

SOLVERS = [
    pytest.param(Pardiso, marks=pytest.mark.skipif(available_solver() is not Pardiso, reason="no PARDISO here")),
    SuperLU,
]


def upper(matrix: Array) -> sp.csr_matrix:
    """The upper triangle in CSR, a diagonal of zeros included."""
    kept = np.triu(matrix != 0) | np.eye(matrix.shape[0], dtype=bool)
    rows, columns = np.nonzero(kept)
    starts = np.concatenate([[0], np.cumsum(kept.sum(axis=1))])
    return sp.csr_matrix((matrix[rows, columns], columns, starts), shape=matrix.shape)


def factorized(kind: type[LinearSolver], matrix: Array) -> LinearSolver:
    solver, triangle = kind(), upper(matrix)
    solver.analyse(triangle.indptr, triangle.indices)
    solver.factorize(triangle.data)
    return solver


def indefinite(size: int, negative: int, seed: int) -> Array:
    """A sparse symmetric matrix with the given number of negative eigenvalues: a congruence of a diagonal one."""
    generator = np.random.default_rng(seed)
    lower = np.eye(size) + np.tril(generator.normal(size=(size, size)) * (generator.random((size, size)) < 0.1), -1)
    signs = np.where(generator.permutation(size) < negative, -1.0, 1.0)
    return lower @ np.diag(signs * generator.uniform(1.0, 3.0, size)) @ lower.T


@pytest.mark.parametrize("kind", SOLVERS)
@pytest.mark.parametrize(("size", "negative"), [(1, 0), (1, 1), (40, 0), (40, 3), (40, 40), (120, 7)])
def test_solution_and_inertia(kind: type[LinearSolver], size: int, negative: int) -> None:
    matrix = indefinite(size, negative, seed=size + negative)
    assert np.count_nonzero(np.linalg.eigvalsh(matrix) < 0) == negative
    solver = factorized(kind, matrix)
    right = np.random.default_rng(0).normal(size=(size, 2))
    np.testing.assert_allclose(solver.solve(right), np.linalg.solve(matrix, right), rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(solver.solve(right[:, 0].copy()), np.linalg.solve(matrix, right[:, 0]), 1e-7, 1e-9)
    assert solver.negative_pivots == negative


@pytest.mark.parametrize("kind", SOLVERS)
def test_one_analysis_serves_many_values(kind: type[LinearSolver]) -> None:
    matrix = indefinite(30, 2, seed=1)
    solver, triangle = factorized(kind, matrix), upper(matrix)
    solver.factorize(3.0 * triangle.data)
    right = np.arange(30.0)
    np.testing.assert_allclose(solver.solve(right), np.linalg.solve(3 * matrix, right), rtol=1e-8, atol=1e-9)
    assert solver.times.analyses == 1
    assert solver.times.factorizations == 2


@pytest.mark.parametrize("kind", SOLVERS)
@pytest.mark.parametrize(
    "matrix",
    [
        np.zeros((3, 3)),
        np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]]),
        indefinite(20, 0, 1) @ np.diag([0.0] + [1.0] * 19) @ indefinite(20, 0, 1),
    ],
    ids=["zeros", "chain without a support", "dense, of rank 19"],
)
def test_singular_matrix_is_refused(kind: type[LinearSolver], matrix: Array) -> None:
    with pytest.raises(SingularMatrix, match="a part of the body is not held"):
        factorized(kind, matrix)


@pytest.mark.parametrize("kind", SOLVERS)
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_values_that_are_not_finite_are_refused(kind: type[LinearSolver], value: float) -> None:
    with pytest.raises(SingularMatrix, match="not a finite number"):
        factorized(kind, np.array([[1.0, value], [value, 1.0]]))


def test_both_solvers_agree_on_an_indefinite_matrix() -> None:
    if available_solver() is not Pardiso:
        pytest.skip("no PARDISO here")
    matrix, right = indefinite(80, 11, seed=4), np.linspace(-1.0, 1.0, 80)
    one, two = factorized(Pardiso, matrix), factorized(SuperLU, matrix)
    np.testing.assert_allclose(one.solve(right), two.solve(right), rtol=1e-6, atol=1e-8)
    assert one.negative_pivots == two.negative_pivots == 11


def test_pardiso_gives_its_memory_back() -> None:
    if available_solver() is not Pardiso:
        pytest.skip("no PARDISO here")
    solver = factorized(Pardiso, indefinite(30, 2, seed=1))
    solver.close()
    solver.close()
    assert not solver._solver.pt.any()
