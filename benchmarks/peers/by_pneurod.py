"""pneurod: the project's own solver, as its experiments call it.

python -m benchmarks.peers.by_pneurod four out.json
"""

from collections.abc import Callable, Sequence
from importlib.metadata import version

import fem
from benchmarks.peers.problem import KPA, MESH, NU, TOLERANCE, E, PathResult, load_pardiso, report
from geometry import Mesh


def set_up() -> Callable[[Sequence[float]], PathResult]:
    """Mesh read, elements made, kernels and MKL loaded; the pattern and PARDISO's analysis belong to the path.

    The load factor is the pressure in kPa.
    """
    fem.compile_kernels()
    load_pardiso()
    law, supports = fem.StVenantKirchhoff(E, NU), [fem.Fixed("clamp"), fem.Fixed("sym", "z")]
    model = fem.Model(Mesh.read(MESH), law, supports, [fem.Pressure("cavity", KPA)], "p2")
    _ = model.space  # computed once, at its first use

    def walk(pressures: Sequence[float]) -> PathResult:
        options = fem.PathOptions(newton=fem.NewtonOptions(tolerance=TOLERANCE))
        solution = fem.follow(model, pressures, options)
        answers = {}
        for pressure, step in zip(pressures, solution.steps, strict=True):
            tip = step.displacement[step.space.surface("tip").unique_nodes].mean(axis=0)
            answers[pressure] = (float(tip[0]), float(tip[1]), step.cavity_volume("cavity"))
        failed = sum(step.cutbacks for step in solution.steps)
        return PathResult(answers, len(solution.steps) + failed, failed, solution.factorizations)

    return walk


if __name__ == "__main__":
    report(f"pneurod {version('pneurod')}", f"PARDISO (pypardiso {version('pypardiso')})", set_up)
