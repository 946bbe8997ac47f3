"""What threads and sheets do: the arm without a load with and without them, the force of a thread, and what bulges."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from fem import Hoops
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.effects.membrane import LayerTerm
from geometry import position_text
from pipeline.config.effects import HOOPS, LAYER
from pipeline.law.cells import bend_of
from pipeline.law.ends import HALF_CELLS
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.piece.measure_clamp import straight_point
from pipeline.law.piece.measure_tip import tip_state
from pipeline.law.piece.tasks import ArmTasks, PieceCurves
from pipeline.law.unloaded import solve_first
from pipeline.values.law import Layers
from pipeline.values.pressure import in_MPa
from rod.errors import RodError


def measure_layers(tasks: ArmTasks, pressures: Sequence[float]) -> Layers | None:
    """At the highest of the pressures (kPa) that all pieces bear.

    None for an arm without thread and sheet, and for one that swells, which takes minutes without its sheet.
    """
    effects = tasks.pieces.config.effects
    names = [name for name in (HOOPS, LAYER) if effects.requested[name].on]
    if not names:
        return None
    for pressure in reversed(pressures[1:]):
        with suppress(PieceFailed, RodError):
            if tasks.submit(bend_of, pressure).result().limits:
                return None
            found = tasks.submit(_with_all, pressure).result()
            begun = {name: tasks.submit(_without, name, pressure) for name in names}
            return replace(found, without_deg={name: pending.result() for name, pending in begun.items()})
    return None


def _without(curves: PieceCurves, name: str, pressure: float) -> float | None:
    """How far the arm bends without one of its layers, degrees; None without equilibrium; a task."""
    pieces = curves.pieces
    effects = pieces.config.effects
    off: Any = {name: replace(getattr(effects, name), state="off")}
    bare = replace(pieces.with_mesh(pieces.config.mesh), config=replace(pieces.config, effects=replace(effects, **off)))

    def solve() -> dict[str, float | None]:
        with suppress(PieceFailed, RodError):
            return {"bending_deg": solve_first(bare, pressure)[0].bending_deg}
        return {"bending_deg": None}

    return curves.number(dict[str, float | None], f"without_{name}", pressure, solve)["bending_deg"]


def _with_all(curves: PieceCurves, pressure: float) -> Layers:
    """The arm with its layers; a task. Raises `PieceFailed` and `RodError`."""
    return curves.number(Layers, "layers", pressure, lambda: _seen(curves, pressure))


def _seen(curves: PieceCurves, pressure: float) -> Layers:
    pieces = curves.pieces
    unloaded, curve = solve_first(pieces, pressure)
    cell, clamp, tip = pieces.cell, pieces.end(HALF_CELLS, "clamp"), pieces.end(HALF_CELLS, "free")
    middle = cell_without_moment(cell, in_MPa(pressure)).state
    parts = {
        "the middle of a cell": (cell, middle),
        "the clamp": (clamp, straight_point(clamp, curve).state),
        "its end": (tip, tip_state(tip, pressure)[0]),  # mirrored: its x counts from the end
    }
    pulls, stretches = list[tuple[float, str]](), list[tuple[float, str]]()
    for name, (piece, state) in parts.items():
        pulls += [(pull, _place(name, piece, at)) for pull, at in largest_pull(piece, state)]
        stretches.append((state.extremes.max_stretch, _place(name, piece, state.extremes.max_stretch_at)))
    (pull, pull_at), (stretch, stretch_at) = max(pulls, default=(math.nan, "")), max(stretches)
    threads = pieces.config.effects.hoops.threads
    pull_N = math.nan if threads is None else pull * threads.pitch_mm
    growth = growth_of(cell, middle)
    return Layers(pressure, unloaded.bending_deg, {}, *growth, pull_N, pull, pull_at, stretch, stretch_at)


def _place(name: str, piece: BendingPiece, at: Sequence[float]) -> str:
    return f"{at[0] - piece.space.points[:, 0].min():.1f} mm from {name} at (y, z) = {position_text(at[1:])}"


def largest_pull(piece: BendingPiece, state: PieceState) -> Iterator[tuple[float, Sequence[float]]]:
    """The largest force of threads per length of the arm, N/mm, and where, mm; none without thread."""
    points = piece.space.points
    for term in state.terms:
        if isinstance(term, LayerTerm) and isinstance(term.sheet, Hoops):
            stretch = term.sheet.stretches(term.stress(points + state.state.displacement))
            pull = term.sheet.E * term.sheet.thickness * 0.5 * (stretch**2 - 1.0) * stretch
            face = int(np.argmax(pull.max(axis=1)))
            yield float(pull.max()), points[term.arrays.nodes[face]].mean(axis=0).tolist()


def growth_of(cell: BendingPiece, state: PieceState) -> tuple[float, float]:
    """Height and width of the section in the middle of a cell, over those at rest."""
    rest = cell.space.points
    on = rest[:, 0] < rest[:, 0].min() + 1e-6 * np.ptp(rest[:, 0])
    height, width = np.ptp((rest + state.state.displacement)[on], axis=0)[1:] / np.ptp(rest[on], axis=0)[1:]
    return float(height), float(width)
