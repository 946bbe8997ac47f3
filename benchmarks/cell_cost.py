"""What the arm's own law costs beside experiments I, II and III of the whole arm on the same kind of mesh.

    OMP_NUM_THREADS=1 python benchmarks/cell_cost.py [ROUNDS]

Processor time in one process with compiled kernels loaded; a round solves the three experiments, the cell at four
pressures, and both ends, one after the other. Renews the table "cost" of docs/cell.md with the medians of the rounds.
Two minutes for three rounds.
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

# the rooms stand beside this folder
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

import fem.equations.pardiso  # noqa: E402
from benchmarks.arguments import count, parser_of  # noqa: E402
from benchmarks.cell import ARMS, Arm, Case, Cost, Pieces, renew, report, solve_whole, table_of  # noqa: E402
from fem.cell.piece import BendingPiece  # noqa: E402
from pipeline.cell.measure_clamp import clamp_curve  # noqa: E402
from pipeline.cell.measure_tip import tip_curve  # noqa: E402


def costs(arm: Arm) -> tuple[Cost, Cost, Cost, int]:
    """Of the whole arm, of the cell and of both ends; and the number of states of the cell."""
    begin = process_time()
    whole = [solve_whole(arm, Case(name, name), arm.pressures)[1] for name in ("I", "II", "III")]
    total = Cost(
        process_time() - begin,
        sum(cost.factorization for cost in whole),
        sum(cost.factorizations for cost in whole),
    )
    begin = process_time()
    pieces = Pieces(arm)
    sweeps = pieces.sweep()
    cell = _cost(begin, [pieces.cell])
    begin = process_time()
    clamp, free = (pieces.end_piece(start) for start in ("clamp", "free"))
    for sweep in sweeps:
        curve = sweep.curve(pieces.cell.body.length)
        clamp_curve(clamp, curve)
        tip_curve(free, curve)
    return total, cell, _cost(begin, [clamp, free]), sum(len(sweep.points) for sweep in sweeps)


def _cost(begin: float, pieces: Sequence[BendingPiece]) -> Cost:
    times = [spent for piece in pieces for spent in piece.solver_times]
    return Cost(
        process_time() - begin, sum(time.factorization for time in times), sum(time.factorizations for time in times)
    )


def main() -> None:
    """Renew the table after every round."""
    parser = parser_of(__doc__)
    parser.add_argument("rounds", nargs="?", type=count, default=3)
    rounds = parser.parse_args().rounds
    arm = ARMS[0]
    pardiso: Any = fem.equations.pardiso
    pardiso.perf_counter = process_time  # what other programs take does not count
    solve_whole(arm, Case("II", "II"), arm.pressures[:1])  # loads the kernels
    measured: list[tuple[Cost, Cost, Cost]] = []
    for _ in range(rounds):
        *parts, states = costs(arm)
        measured.append((parts[0], parts[1], parts[2]))
        names = {
            "I, II, III of the whole arm": (0,),
            f"cell, {len(arm.pressures)} pressures, {states} curvatures": (1,),
            "both ends": (2,),
            "cell and both ends": (1, 2),
        }
        rows = [row_of(name, measured, numbers) for name, numbers in names.items()]
        report("; ".join(" ".join(row) for row in rows))
        columns = ["part", "factorizations", "factorization, s", "all, s", "part of the first", "of all"]
        renew("cost", table_of(rows, columns))


def row_of(name: str, measured: Sequence[tuple[Cost, Cost, Cost]], numbers: Sequence[int]) -> list[str]:
    """Medians over the rounds of the sums of the parts with these numbers, and of their ratios to the first part."""

    def middle(value: Callable[[Cost], float], over: Callable[[Cost], float] | None = None) -> float:
        return median(
            sum(value(parts[k]) for k in numbers) / (1.0 if over is None else over(parts[0])) for parts in measured
        )

    def factorization(cost: Cost) -> float:
        return cost.factorization

    def seconds(cost: Cost) -> float:
        return cost.seconds

    return [
        name,
        f"{middle(lambda cost: cost.factorizations):.0f}",
        f"{middle(factorization):.2f}",
        f"{middle(seconds):.1f}",
        f"{middle(factorization, factorization):.3f}",
        f"{middle(seconds, seconds):.3f}",
    ]


if __name__ == "__main__":
    main()
