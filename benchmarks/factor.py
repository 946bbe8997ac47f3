"""Alternatives to one factorization per Newton iteration, on the tangents of a real path.

    python benchmarks/factor.py [mesh size in mm]

Experiment II of the gapped pneu-net (`PneuNet`) in one increment to 17 kPa without contact. Every tangent of that path
is stored and solved by each method to a residual of 1e-9 of the right-hand side, which is sufficient for Newton's
method. Processor seconds, one thread.
"""

import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from time import process_time
from typing import TypeVar

os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"))
sys.path[0] = str(Path(__file__).resolve().parent.parent)

import numpy as np  # noqa: E402  (the number of threads comes first)
import scipy.sparse as sp  # noqa: E402
from scipy.sparse.linalg import LinearOperator, gmres  # noqa: E402

from benchmarks.arguments import parser_of, size  # noqa: E402
from fem import Experiment, Pressure, StVenantKirchhoff  # noqa: E402
from fem.equations.pardiso import LARGE, Pardiso, forget_unused_analyses  # noqa: E402
from fem.path import newton  # noqa: E402
from fem.path.control import LoadControl  # noqa: E402
from geometry import PneuNet  # noqa: E402
from geometry.arrays import Array  # noqa: E402

TOLERANCE = 1e-9
Value = TypeVar("Value")
#: values of a tangent and its right-hand side, by iteration
Systems = Sequence[tuple[Array, Array]]


def tangents(mesh_size: float) -> tuple[np.ndarray, np.ndarray, list[tuple[np.ndarray, np.ndarray]]]:
    """Pattern (indptr, indices) and the values and right-hand sides of every iteration."""
    experiment = Experiment.of("II", PneuNet().body(mesh_size), 0.0)
    model = experiment.model(StVenantKirchhoff(1.2, 0.495), [Pressure("cavity", 0.017)], "p2p0")
    system, linear_systems = model.system(), []
    factorize, solve = system.solver.factorize, system.solver.solve
    values: list[np.ndarray] = []

    def keep_values(data: np.ndarray) -> None:
        values.append(data.copy())
        factorize(data)

    def keep_right(right: np.ndarray) -> np.ndarray:
        linear_systems.append((values[-1], right.copy()))
        return solve(right)

    system.solver.factorize, system.solver.solve = keep_values, keep_right  # type: ignore[method-assign]
    control, start = LoadControl.of(system).target(1.0, 1.0), newton.Start(system.rest_state(), system.terms)
    newton.solve(start, control, newton.NewtonOptions(), lambda *arguments: None)
    return system.storage.pattern.indptr, system.storage.pattern.indices, linear_systems


def product(indptr: np.ndarray, indices: np.ndarray, data: np.ndarray) -> LinearOperator:
    """The whole symmetric matrix from its upper triangle."""
    upper = sp.csr_matrix((data, indices, indptr), shape=(len(indptr) - 1,) * 2)
    diagonal = upper.diagonal()
    return LinearOperator(upper.shape, lambda x: upper @ x + upper.T @ x - diagonal * x, dtype=float)


def iterated(matrix: LinearOperator, right: np.ndarray, solver: Pardiso, patience: int) -> int:
    """GMRES iterations with the factor that `solver` holds; one more than `patience` where that does not suffice."""
    count = 0

    def one_more(residual: float) -> None:
        nonlocal count
        count += 1

    before = LinearOperator(matrix.shape, lambda x: solver.solve(x.ravel()), dtype=float)
    _, missed = gmres(
        matrix, right, M=before, rtol=TOLERANCE, restart=patience, maxiter=1, callback=one_more, callback_type="pr_norm"
    )
    return patience + 1 if missed else count


def timed(call: Callable[[], Value]) -> tuple[Value, float]:
    """What a call gives, and its processor seconds."""
    start = process_time()
    result = call()
    return result, process_time() - start


def fresh_factor(
    indptr: Array, indices: Array, systems: Systems, large: int, memory: float | None
) -> tuple[float, float, str]:
    """Seconds for all iterations with a new factor in each, of the analysis, and a remark."""
    forget_unused_analyses()
    solver = Pardiso(memory, large)
    _, analysis = timed(lambda: solver.analyse(indptr, indices))
    seconds = 0.0
    for data, right in systems:
        seconds += timed(partial(solver.factorize, data))[1]
        seconds += timed(partial(solver.solve, right))[1]
    megabytes = solver.factor_bytes / 1e6
    solver.close()
    return seconds, analysis, f"factor {megabytes:.0f} MB"


def stale_factor(indptr: Array, indices: Array, systems: Systems, patience: int) -> tuple[float, float, str]:
    """The factor is kept as a preconditioner until an iteration needs more than `patience` products."""
    forget_unused_analyses()
    solver = Pardiso()
    _, analysis = timed(lambda: solver.analyse(indptr, indices))
    seconds, fresh, counts = 0.0, True, []
    for data, right in systems:
        if not fresh:
            matrix = product(indptr, indices, data)
            count, spent = timed(partial(iterated, matrix, right, solver, patience))
            seconds += spent
            counts.append(count)
            fresh = count > patience
        if fresh:
            seconds += timed(partial(solver.factorize, data))[1]
            seconds += timed(partial(solver.solve, right))[1]
            fresh = False
    factors = solver.times.factorizations
    solver.close()
    return seconds, analysis, f"{factors} factors; products per iteration {counts}"


def main() -> None:
    """Print one table."""
    parser = parser_of(__doc__)
    parser.add_argument("size", nargs="?", type=size, default=4.0, help="of the mesh, mm")
    indptr, indices, systems = tangents(parser.parse_args().size)
    sys.stdout.write(f"{len(indptr) - 1} unknowns, {len(indices)} entries, {len(systems)} iterations\n")
    ways = {
        "new factor each time, nested dissection": lambda: fresh_factor(indptr, indices, systems, 0, None),
        "new factor each time, minimum degree": lambda: fresh_factor(indptr, indices, systems, 10**9, None),
        "single precision, refined": lambda: fresh_factor(indptr, indices, systems, LARGE, 0.0),
        "stale factor, up to 8 products": lambda: stale_factor(indptr, indices, systems, 8),
        "stale factor, up to 25 products": lambda: stale_factor(indptr, indices, systems, 25),
    }
    base = None
    for name, way in ways.items():
        seconds, analysis, remark = way()
        base = base or seconds
        sys.stdout.write(f"{name:42s}{seconds:9.2f} s{seconds / base:7.2f}  analysis {analysis:.2f} s  {remark}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
