"""Cost of a Newton iteration from the coarse arm to a million unknowns.

    python benchmarks/size.py [mesh size in mm ...]

Experiment II of the gapped pneu-net (`PneuNet`) at 5 kPa, without contact, in one increment from rest; each size in a
separate process, so that peak memories do not mix. Seconds are processor seconds of one thread. `--single` computes the
factor in single precision whatever memory is free.
"""

import json
import os
import resource
import subprocess
import sys
from pathlib import Path
from time import perf_counter, process_time

# the rooms stand beside this folder
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from benchmarks.arguments import parser_of, size

SIZES = (5.0, 4.0, 3.0, 2.5, 2.0, 1.5, 1.2, 1.0)


def measured(mesh_size: float, single: bool) -> dict[str, float]:
    """One size, in this process."""
    from functools import partial

    from fem import Experiment, PathOptions, Pressure, StVenantKirchhoff, compile_kernels, follow
    from fem.equations.pardiso import Pardiso
    from geometry import PneuNet

    compile_kernels()
    begin = process_time()
    body = PneuNet().body(mesh_size)
    meshed = process_time() - begin
    experiment = Experiment.of("II", body, 0.0)
    model = experiment.model(StVenantKirchhoff(1.2, 0.495), [Pressure("cavity", 0.005)], "p2p0")
    solvers: list[Pardiso] = []

    def solver() -> Pardiso:
        solvers.append(Pardiso(memory=0.0) if single else Pardiso())
        return solvers[-1]

    begin, start = process_time(), perf_counter()
    solution = follow(model, [1.0], PathOptions(solver=partial(solver)))
    total = process_time() - begin
    spent, count, busy = solution.seconds, solution.factorizations, total / (perf_counter() - start)
    return {
        "size_mm": mesh_size,
        "single": single,
        "degrees_of_freedom": solution.degrees_of_freedom,
        "iterations": count,
        "end_y_mm": float(experiment.end(solution.steps[0])[1]),
        "mesh": meshed,
        "set_up": busy * spent.set_up,
        "analysis": busy * spent.analysis,
        "assembly": busy * (spent.assembly + sum(spent.effects.values())) / count,
        "factorization": busy * spent.factorization / count,
        "solve": busy * spent.solve / count,
        "total": total,
        "memory_GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }


def main() -> None:
    """Print one table and the exponents between its first and last row."""
    parser = parser_of(__doc__)
    parser.add_argument("sizes", nargs="*", type=size, default=SIZES, metavar="SIZE", help="of the mesh, mm")
    parser.add_argument("--single", action="store_true", help="the factor in single precision")
    parser.add_argument("--one", action="store_true", help="one size in this process, as JSON")
    given = parser.parse_args()
    if given.one:
        sys.stdout.write(json.dumps(measured(given.sizes[0], given.single)))
        return
    threads = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
    head = ("dofs", "iterations", "end mm", "assembly", "factor", "solve", "rest/all", "total s", "GB")
    sys.stdout.write("".join(f"{name:>11s}" for name in head) + "\n")
    rows = []
    for mm in given.sizes:
        command = [sys.executable, __file__, "--one", str(mm), *(["--single"] if given.single else [])]
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **threads}, check=False)
        if done.returncode:
            sys.stdout.write(f"{mm:g} mm: {done.stderr.strip().splitlines()[-1]}\n")
            continue
        row = json.loads(done.stdout)
        rows.append(row)
        linear = row["factorization"] + row["solve"]
        numbers = (row["end_y_mm"], row["assembly"], row["factorization"], row["solve"])
        line = f"{row['degrees_of_freedom']:11d}{row['iterations']:11d}" + "".join(f"{x:11.4g}" for x in numbers)
        fraction = 1 - linear / (linear + row["assembly"])
        sys.stdout.write(f"{line}{fraction:11.0%}{row['total']:11.1f}{row['memory_GB']:11.2f}\n")
        sys.stdout.flush()
    if len(rows) > 1:
        from math import log

        first, last = rows[0], rows[-1]
        growth = log(last["degrees_of_freedom"] / first["degrees_of_freedom"])
        for name in ("assembly", "factorization", "solve", "memory_GB"):
            sys.stdout.write(f"{name} ~ dofs^{log(last[name] / first[name]) / growth:.2f}\n")


if __name__ == "__main__":
    main()
