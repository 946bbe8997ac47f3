"""The linear solvers against dense algebra, singular matrices, and a factorized tangent as a value."""

import ctypes
import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest
import scipy.sparse as sp

from fem import Fixed, Model, NewtonOptions, PathOptions, Pressure, StVenantKirchhoff, follow
from fem.effects.effect import Terms
from fem.equations import pardiso
from fem.equations.linear import LinearSolver, SingularMatrix, SuperLU
from fem.equations.linearised import Linearised, StaleFactorization
from fem.equations.pardiso import Pardiso, available_solver
from fem.equations.state import State
from fem.equations.system import System
from fem.memory import keep_freed_memory
from fem.path import newton
from fem.path.control import LoadControl
from fem.path.diagnosis import near_limit_point
from fem.path.modes import falling_mode
from fem.path.newton import Converged, Start
from fem.path.predictor import PathPoint
from geometry.arrays import Array
from tests.bodies import box, hollow_box

WITH_PARDISO = pytest.mark.skipif(available_solver() is not Pardiso, reason="no PARDISO here")


def in_single_precision() -> LinearSolver:
    """PARDISO without memory for a factor in double precision."""
    return Pardiso(memory=0.0)


def of_large_matrices() -> LinearSolver:
    """PARDISO as for large matrices: nested dissection, two levels."""
    return Pardiso(large=0)


SOLVERS = [
    pytest.param(Pardiso, marks=WITH_PARDISO),
    pytest.param(in_single_precision, marks=WITH_PARDISO),
    pytest.param(of_large_matrices, marks=WITH_PARDISO),
    SuperLU,
]


def upper(matrix: Array) -> sp.csr_matrix:
    """The upper triangle in CSR, a diagonal of zeros included."""
    kept = np.triu(matrix != 0) | np.eye(matrix.shape[0], dtype=bool)
    rows, columns = np.nonzero(kept)
    starts = np.concatenate([[0], np.cumsum(kept.sum(axis=1))])
    return sp.csr_matrix((matrix[rows, columns], columns, starts), shape=matrix.shape)


def factorized(kind: Callable[[], LinearSolver], matrix: Array) -> LinearSolver:
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
def test_solution_and_inertia(kind: Callable[[], LinearSolver], size: int, negative: int) -> None:
    matrix = indefinite(size, negative, seed=size + negative)
    assert np.count_nonzero(np.linalg.eigvalsh(matrix) < 0) == negative
    solver = factorized(kind, matrix)
    right = np.random.default_rng(0).normal(size=(size, 2))
    np.testing.assert_allclose(solver.solve(right), np.linalg.solve(matrix, right), rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(solver.solve(right[:, 0].copy()), np.linalg.solve(matrix, right[:, 0]), 1e-7, 1e-9)
    assert solver.negative_pivots == negative


@WITH_PARDISO
@pytest.mark.parametrize(
    ("cells", "ordering"),
    [((20, 20, 20), pardiso.NESTED_DISSECTION), ((2, 4, 1000), pardiso.MINIMUM_DEGREE)],
    ids=["stocky", "slender"],
)
def test_the_ordering_follows_from_the_entries_of_the_factor(cells: tuple[int, int, int], ordering: int) -> None:
    band = [sp.diags([-1.0, 2.1, -1.0], [-1, 0, 1], shape=(n, n)) for n in cells]
    near = [sp.diags([1.0, 1.0, 1.0], [-1, 0, 1], shape=(n, n)) for n in cells]
    matrix = sp.kron(sp.kron(band[0], near[1]), near[2]) + 30.0 * sp.eye(int(np.prod(cells)))
    triangle = sp.triu(matrix, format="csr")
    right = np.random.default_rng(0).normal(size=matrix.shape[0])
    for _ in range(2):  # the second time with the analysis that was kept
        solver = Pardiso()
        solver.analyse(triangle.indptr, triangle.indices)
        assert solver._solver.get_iparm(2) == ordering
        solver.factorize(triangle.data)
        assert np.linalg.norm(matrix @ solver.solve(right) - right) < 1e-9 * np.linalg.norm(right)
        solver.close()


@WITH_PARDISO
def test_a_matrix_with_a_zero_diagonal_is_factorized_with_pairs_of_pivots() -> None:
    """Single pivots from the diagonal, the first choice, do not exist here."""
    swap = np.array([[0.0, 1.0], [1.0, 0.0]])
    matrix = np.kron(np.eye(3), swap)
    solver = factorized(Pardiso, matrix)
    right = np.arange(1.0, 7.0)
    np.testing.assert_allclose(solver.solve(right), matrix @ right, rtol=1e-12)
    assert solver.negative_pivots == 3


@pytest.mark.parametrize("kind", SOLVERS)
def test_one_analysis_serves_many_values(kind: Callable[[], LinearSolver]) -> None:
    matrix = indefinite(30, 2, seed=1)
    solver, triangle = factorized(kind, matrix), upper(matrix)
    solver.factorize(3.0 * triangle.data)
    right = np.arange(30.0)
    np.testing.assert_allclose(solver.solve(right), np.linalg.solve(3 * matrix, right), rtol=1e-8, atol=1e-9)
    assert solver.times.analyses == 1
    assert solver.times.factorizations == 2


@pytest.mark.parametrize("kind", [SOLVERS[0], SOLVERS[2], SuperLU])
@pytest.mark.parametrize(
    "matrix",
    [
        np.zeros((3, 3)),
        np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]]),
        indefinite(20, 0, 1) @ np.diag([0.0] + [1.0] * 19) @ indefinite(20, 0, 1),
    ],
    ids=["zeros", "chain without a support", "dense, of rank 19"],
)
def test_singular_matrix_is_refused(kind: Callable[[], LinearSolver], matrix: Array) -> None:
    with pytest.raises(SingularMatrix, match="a part of the body is not held"):
        factorized(kind, matrix)


@pytest.mark.parametrize("kind", SOLVERS)
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_values_that_are_not_finite_are_refused(kind: Callable[[], LinearSolver], value: float) -> None:
    with pytest.raises(SingularMatrix, match="not a finite number"):
        factorized(kind, np.array([[1.0, value], [value, 1.0]]))


def test_both_solvers_agree_on_an_indefinite_matrix() -> None:
    if available_solver() is not Pardiso:
        pytest.skip("no PARDISO here")
    matrix, right = indefinite(80, 11, seed=4), np.linspace(-1.0, 1.0, 80)
    pardiso, superlu = factorized(Pardiso, matrix), factorized(SuperLU, matrix)
    np.testing.assert_allclose(pardiso.solve(right), superlu.solve(right), rtol=1e-6, atol=1e-8)
    assert pardiso.negative_pivots == superlu.negative_pivots == 11


def mkl_bytes() -> int:
    """What the MKL holds in this process besides its buffers."""
    library = Pardiso()._solver.libmkl
    library.mkl_free_buffers()
    library.mkl_mem_stat.restype = ctypes.c_int64
    return int(library.mkl_mem_stat(ctypes.byref(ctypes.c_int(0))))


@WITH_PARDISO
def test_a_closed_solver_has_released_its_memory() -> None:
    chain = 2 * np.eye(40) - np.eye(40, k=1) - np.eye(40, k=-1)
    matrix = np.kron(chain, np.eye(40)) + np.kron(np.eye(40), chain)
    before = mkl_bytes()
    for kind in (in_single_precision, of_large_matrices, Pardiso):
        solver = factorized(kind, matrix)
        held = mkl_bytes()
        solver.close()
        solver.close()
        assert not solver._solver.pt.any()
        assert mkl_bytes() < held
    assert mkl_bytes() == before


@WITH_PARDISO
def test_a_factor_that_does_not_fit_is_kept_in_single_precision() -> None:
    chain = 2 * np.eye(15) - np.eye(15, k=1) - np.eye(15, k=-1)
    matrix = np.kron(chain, np.eye(15)) + np.kron(np.eye(15), chain) - 0.1 * np.eye(225)  # one negative eigenvalue
    assert np.count_nonzero(np.linalg.eigvalsh(matrix) < 0) == 1
    double, single = factorized(Pardiso, matrix), factorized(in_single_precision, matrix)
    assert not double.single
    assert single.single
    assert single.factor_bytes < double.factor_bytes
    assert single.negative_pivots == double.negative_pivots == 1
    right = np.random.default_rng(1).normal(size=225)
    solution = single.solve(right)
    assert np.linalg.norm(matrix @ solution - right) < 1e-9 * np.linalg.norm(right)
    np.testing.assert_allclose(solution, double.solve(right), rtol=1e-6, atol=1e-7)


@WITH_PARDISO
@pytest.mark.parametrize("formulation", ["p2p0", "mixed"])
def test_a_path_has_the_same_steps_in_either_precision(formulation: str) -> None:
    supports, law = [Fixed("clamp"), Fixed("sym", "z")], StVenantKirchhoff(1.2, 0.4999)
    model = Model(hollow_box(half=True, parts=2), law, supports, [Pressure("cavity", 0.1)], formulation)
    double = follow(model, [1.0], PathOptions(NewtonOptions(tolerance=1e-9)))
    single = follow(model, [1.0], PathOptions(NewtonOptions(tolerance=1e-9), solver=in_single_precision))
    np.testing.assert_allclose(single.steps[0].displacement, double.steps[0].displacement, atol=1e-8)
    assert single.factorizations == double.factorizations


@WITH_PARDISO
def test_a_singular_matrix_in_single_precision_is_refused_by_its_solution() -> None:
    root = indefinite(20, 0, 1)
    with pytest.raises(SingularMatrix, match="a part of the body is not held"):
        factorized(in_single_precision, root @ np.diag([0.0] + [1.0] * 19) @ root).solve(np.arange(20.0))


@WITH_PARDISO
def test_the_mkl_is_not_searched_for() -> None:
    """pypardiso looks through all files of the environment with `glob`, when it is imported and for each solver."""
    forbidden = "import glob\ndef search(*arguments, **options): raise SystemExit('searched')\nglob.glob = search\n"
    command = f"{forbidden}from fem.equations.pardiso import Pardiso, _runtime\nprint(bool(_runtime()))\nPardiso()"
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=False)
    if done.stdout.strip() == "False":
        pytest.skip("the MKL does not come from its Python package")
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(not keep_freed_memory(), reason="the C library is not glibc")
def test_freed_arrays_are_used_again() -> None:
    """Each of these arrays has 2 048 pages, which are mapped once and not for each array."""
    command = (
        "import resource, numpy as np\n"
        "from fem.memory import keep_freed_memory\n"
        "keep_freed_memory()\n"
        "pages = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_minflt\n"
        "before = pages()\n"
        "for _ in range(20): array = np.ones(1 << 20); del array\n"
        "print(pages() - before)\n"
    )
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 3 * 2048


LAW = StVenantKirchhoff(E=1.0, nu=0.3)
BOTH_SOLVERS = [
    pytest.param(Pardiso, marks=pytest.mark.skipif(available_solver() is not Pardiso, reason="none")),
    SuperLU,
]


def bar(solver: Callable[[], LinearSolver]) -> System:
    return Model(box((2, 1, 1), (2.0, 1.0, 1.0)), LAW, [Fixed("left")], []).system(solver)


def at_rest(system: System) -> Linearised:
    rest = system.rest_state()
    return system.linearise(rest, system.assemble(rest, ()), ())


def force(system: System) -> Array:
    return np.random.default_rng(3).normal(size=system.space.points.shape)


@pytest.mark.parametrize("solver", BOTH_SOLVERS)
def test_it_solves_as_often_as_needed(solver: Callable[[], LinearSolver]) -> None:
    system = bar(solver)
    linearised, load = at_rest(system), force(system)
    change = linearised.solve(load)
    np.testing.assert_array_equal(linearised.solve(load).displacement, change.displacement)
    np.testing.assert_array_equal(change.displacement[system.constraints.constrained], 0.0)
    rest = system.rest_state()
    _, product = system.tangent(rest, system.assemble(rest, ()), (), change.displacement, convex=False)
    np.testing.assert_allclose(
        system.constraints.reduce(product.displacement), -system.constraints.reduce(load), atol=1e-10
    )


@pytest.mark.parametrize("solver", BOTH_SOLVERS)
@pytest.mark.parametrize("event", ["linearised again", "sparsity pattern analysed again", "solver closed"])
def test_a_factorization_that_was_overwritten_refuses(solver: Callable[[], LinearSolver], event: str) -> None:
    system = bar(solver)
    first = at_rest(system)
    if event == "linearised again":
        at_rest(system).solve(force(system))
    elif event == "sparsity pattern analysed again":
        system.solver.analyse(system.storage.pattern.indptr, system.storage.pattern.indices)
    else:
        system.solver.close()
    with pytest.raises(StaleFactorization, match="factorized again"):
        first.solve(force(system))
    assert first.negative_pivots == 0


def equilibrium(control: LoadControl, start: State, options: NewtonOptions) -> Converged:
    return newton.solve(Start(start, control.system.terms), control, options, lambda *arguments: None)


def near_limit(system: System, state: State, terms: Terms) -> str:
    return near_limit_point(system, PathPoint(1.0, 1.0, state, terms=terms))


def test_the_analysis_of_instability_leaves_no_usable_factor_behind() -> None:
    """`falling_mode` and `near_limit_point` factorize; what Newton returned before must not solve with theirs."""
    model = Model(hollow_box(half=True), LAW, [Fixed("clamp"), Fixed("sym", "z")], [Pressure("cavity", 0.05)])
    for analysis in (falling_mode, near_limit):
        system = model.system()
        converged = equilibrium(LoadControl.of(system).target(1.0, 1.0), system.rest_state(), NewtonOptions())
        converged.linearised.solve(force(system))
        analysis(system, converged.state, system.terms)
        with pytest.raises(StaleFactorization):
            converged.linearised.solve(force(system))


def test_the_rate_of_a_path_uses_the_last_tangent_of_newton() -> None:
    model = Model(hollow_box(half=True), LAW, [Fixed("clamp"), Fixed("sym", "z")], [Pressure("cavity", 0.05)])
    system = model.system()
    control = LoadControl.of(system).target(1.0, 1.0)
    options = NewtonOptions(tolerance=1e-9)
    converged = equilibrium(control, system.rest_state(), options)
    assert converged.negative_pivots == converged.linearised.negative_pivots == 0
    before = system.solver.times.factorizations
    rate = control.rate(converged.state, converged.assembly, converged.linearised, system.terms)
    assert system.solver.times.factorizations == before
    ahead = equilibrium(control.target(1.001, 1.0), converged.state, options)
    difference = (ahead.state.displacement - converged.state.displacement) / 0.001
    np.testing.assert_allclose(rate.displacement, difference, atol=0.01 * np.abs(difference).max())
