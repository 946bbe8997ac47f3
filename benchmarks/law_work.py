"""What `pneurod cell` does, by purpose: equilibria, Newton iterations, factorizations and processor seconds.

    python -m benchmarks.law_work configs/pneunet_coarse.yaml ...

Each arm is measured in this process, into a new folder. An attempt is a start of Newton's method; those that fail cost
iterations too. Factorizations are those of iterations, slopes, shear and derivatives. Seconds of the last three columns
are within those of the purpose.
"""

import argparse
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any
from unittest.mock import patch

import fem.cell.piece
import pipeline.law.cells
import pipeline.law.piece.measure
import pipeline.law.piece.measure_clamp
import pipeline.law.piece.point
import pipeline.law.piece.tasks
from benchmarks.markdown import table
from fem.equations.pardiso import available_solver
from fem.path.newton import StepFailed
from pipeline.config.load import load_config
from pipeline.law.study import measure_law
from pipeline.store.progress import PassedOn

#: purposes by the task that serves them
PURPOSES = {
    "first_state": "first numbers",
    "bend_of": "cells",
    "cell_at": "cells",
    "miss_between": "checks between",
    "half_cells_of": "length of the ends",
    "solve_numbers": "finer meshes",
}
#: functions whose seconds stand in a column of their own: where they are called, and their names
PARTS = (
    ("slopes", (pipeline.law.piece.point, "slopes")),
    ("shear", (pipeline.law.piece.measure, "shear_rigidity")),
    ("derivatives", (pipeline.law.cells, "cell_rates")),
    ("derivatives", (pipeline.law.piece.measure_clamp, "clamp_rates")),
    ("air", (pipeline.law.piece.point, "air_volumes")),
)
#: head, what is counted, digits
COLUMNS = (
    ("attempts", "attempts", 0),
    ("failed", "failed", 0),
    ("iterations", "iterations", 0),
    ("slopes", "slopes calls", 0),
    ("factorizations", "factorize", 0),
    ("solutions", "solve", 0),
    ("CPU s", "seconds", 1),
    ("slopes s", "slopes", 1),
    ("shear s", "shear", 1),
    ("derivatives s", "derivatives", 1),
    ("air s", "air", 1),
)
Work = dict[str, float]


class Counted:
    """Work by purpose while `counting`; what no task does counts for "meshes and files"."""

    def __init__(self) -> None:
        self.work: dict[str, Work] = defaultdict(lambda: defaultdict(float))
        self._purpose = "meshes and files"

    @contextmanager
    def counting(self) -> Iterator[None]:
        """Within this block all is counted."""
        solver: Any = available_solver()
        with ExitStack() as stack:
            stack.enter_context(
                patch.object(pipeline.law.piece.tasks, "_on_pieces", self._task(pipeline.law.piece.tasks._on_pieces))
            )
            stack.enter_context(patch.object(fem.cell.piece, "solve", self._newton(fem.cell.piece.solve)))
            for name, where in PARTS:
                stack.enter_context(patch.object(*where, self._timed(name, getattr(*where))))
            for name in ("factorize", "solve"):
                stack.enter_context(patch.object(solver, name, self._called(name, getattr(solver, name))))
            begin = process_time()
            yield
            known = sum(work["seconds"] for work in self.work.values())
            self._of()["seconds"] += process_time() - begin - known

    def _of(self) -> Work:
        return self.work[self._purpose]

    def _task(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def on_pieces(
            context: Any, pieces: Any, store: Any, task: Callable[..., Any], *args: Any, **kwargs: Any
        ) -> Any:
            before, self._purpose = self._purpose, PURPOSES.get(task.__name__) or args[0].name
            begin = process_time()
            try:
                return original(context, pieces, store, task, *args, **kwargs)
            finally:
                self._of()["seconds"] += process_time() - begin
                self._purpose = before

        return on_pieces

    def _newton(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def solve(start: Any, control: Any, options: Any, watch: Any, *rest: Any) -> Any:
            def counted(iteration: int, residual: float) -> None:
                self._of()["iterations"] += iteration > 0
                watch(iteration, residual)

            self._of()["attempts"] += 1
            try:
                return original(start, control, options, counted, *rest)
            except StepFailed:
                self._of()["failed"] += 1
                raise

        return solve

    def _timed(self, name: str, original: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*args: Any, **kwargs: Any) -> Any:
            begin = process_time()
            try:
                return original(*args, **kwargs)
            finally:
                self._of()[name] += process_time() - begin
                self._of()[f"{name} calls"] += 1

        return timed

    def _called(self, name: str, original: Callable[..., Any]) -> Callable[..., Any]:
        def called(*args: Any) -> Any:
            self._of()[name] += 1
            return original(*args)

        return called

    def table(self) -> str:
        """One row per purpose, and their sum, in Markdown."""
        total: Work = defaultdict(float)
        for work in self.work.values():
            for name, value in work.items():
                total[name] += value
        rows = [
            (purpose, *(f"{work[name]:.{digits}f}" for _, name, digits in COLUMNS))
            for purpose, work in (*self.work.items(), ("all", total))
        ]
        return table(("purpose", *(head for head, _, _ in COLUMNS)), rows)


def main() -> None:
    """Print a table for each arm."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("configs", nargs="+", type=Path)
    parser.add_argument("--set", action="append", default=[], dest="values", help="a value of the configuration")
    parser.add_argument("--out", type=Path, help="where the results of the arms are kept")
    given = parser.parse_args()
    for path in given.configs:
        counted = Counted()
        with TemporaryDirectory() as folder, counted.counting():
            out = (given.out or Path(folder)) / path.stem
            measure_law(load_config(path, given.values), out, 1, True, PassedOn(lambda message: None))
        sys.stdout.write(f"\n{path.stem}\n\n{counted.table()}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
