"""Curves of several pressures measured at the same time, in processes; what they keep is read afterwards."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from fem.cell.piece import PieceFailed
from pipeline.cell.curves import PieceCurves
from pipeline.cell.pieces import ArmPieces
from pipeline.config.config import Config
from pipeline.context import RunContext
from pipeline.errors import RunFailed
from pipeline.processes import available_cores, process_pool
from pipeline.simulation.worker import connected, start_worker, worker_progress
from pipeline.store.store import Store
from rod import RodError
from rod.arm_law.curves import CellCurve

#: displacement components of the cell from which on processes gain more than they cost to start
WORTHWHILE = 6000


class _Worker:
    """The curves of this process. Set once, when the process starts."""

    curves: PieceCurves


def cells_ahead(curves: PieceCurves, context: RunContext, pressures: Sequence[float]) -> set[float]:
    """Measure cells at pressures in kPa, `context.jobs` at a time; those that were measured.

    Empty where processes do not pay. A cell that fails is left to the caller, who meets the same failure.
    """
    missing = [(pressure,) for pressure in pressures if not curves.has_cell(pressure)]
    return _ahead(curves.pieces, context, _cell, missing)


def ends_ahead(curves: PieceCurves, context: RunContext, cells: Sequence[tuple[CellCurve, int]]) -> set[float]:
    """The same for the ends beside cells, with the number of half cells in each."""
    missing = [case for case in cells if not curves.has_ends(*case)]
    return _ahead(curves.pieces, context, _ends, missing)


def _ahead(
    pieces: ArmPieces, context: RunContext, task: Callable[..., float | None], cases: Sequence[tuple[Any, ...]]
) -> set[float]:
    jobs = min(context.jobs, len(cases))
    if jobs < 2 or 3 * len(pieces.cell.space.points) < WORTHWHILE:
        return set()
    threads = max(1, available_cores() // jobs)
    try:
        with connected(context.progress) as queue:
            arguments = (queue, pieces.config, pieces.dhat, context.store)
            with process_pool(jobs, threads, initializer=_start, initargs=arguments) as pool:
                futures: list[Future[float | None]] = [pool.submit(task, *case) for case in cases]
                measured = [future.result() for future in futures]
    except BrokenProcessPool:
        raise RunFailed(
            "the process of a cell was ended from outside, as happens when memory runs out; finished curves are kept, "
            "and the same command continues from there, with --jobs 1 in less memory"
        ) from None
    return {pressure for pressure in measured if pressure is not None}


def _start(queue: Any, config: Config, dhat: float | None, store: Store) -> None:
    start_worker(queue)
    _Worker.curves = PieceCurves(ArmPieces(config, dhat), store)


def _cell(pressure: float) -> float | None:
    try:
        cell = _Worker.curves.cell(pressure)
    except (PieceFailed, RodError):
        return None
    return _reported("cell", pressure, cell.seconds, cell.is_stored)


def _ends(cell: CellCurve, half_cells: int) -> float | None:
    try:
        parts = _Worker.curves.ends(cell, half_cells)
    except (PieceFailed, RodError):
        return None
    stored = all(part.is_stored for part in parts)
    return _reported("ends", cell.pressure, sum(part.seconds for part in parts), stored)


def _reported(name: str, pressure: float, seconds: float, stored: bool) -> float:
    worker_progress().step_done(name, pressure, 0.0 if stored else seconds)
    return pressure
