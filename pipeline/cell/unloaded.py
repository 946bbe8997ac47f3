"""What the arm's own law says of the arm without a load: the first numbers of a run."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from fem.cell.piece import PieceFailed
from geometry.arrays import Array
from pipeline.cell.measure import straight_curve
from pipeline.cell.measure_clamp import clamp_without_moment
from pipeline.cell.measure_tip import tip_curve
from pipeline.cell.reach import LARGEST
from pipeline.cell.tasks import ArmTasks, PieceCurves
from pipeline.parallel import Pending
from pipeline.pressure import name_of_state
from pipeline.results.law import Unloaded
from pipeline.results.values import bending_deg
from pipeline.store.kept import kept
from rod.arm_law.curves import ClampCurve
from rod.arm_law.law import ArmLaw
from rod.errors import RodError
from rod.mechanics.equilibrium import Rod

#: half cells of the ends from which the first numbers come
HALF_CELLS = 1


def begin_first_states(tasks: ArmTasks, pressures_kPa: Sequence[float]) -> list[Pending[Unloaded]]:
    """The arm without a load at each pressure, from single states of its pieces; see `reached_states`."""
    return [tasks.submit(first_state, pressure) for pressure in pressures_kPa]


def reached_states(begun: Sequence[Pending[Unloaded]]) -> tuple[Unloaded, ...]:
    """Those of the states that the pieces bear."""
    states: list[Unloaded] = []
    for pending in begun:
        with suppress(PieceFailed, RodError):
            states.append(pending.result())
    return tuple(states)


def first_state(curves: PieceCurves, pressure: float) -> Unloaded:
    """The arm without a load at a pressure in kPa, from one state of each of its pieces; a task.

    The cell is known to first order about that state, which a weight needs. Raises `PieceFailed` and `RodError`.
    """
    pieces = curves.pieces

    def solve() -> Unloaded:
        turn = LARGEST / pieces.design.length * pieces.cell.body.length
        cell = straight_curve(pieces.cell, pressure, turn)
        clamp = clamp_without_moment(pieces.end(HALF_CELLS, "clamp"), cell)
        tip, _ = tip_curve(pieces.end(HALF_CELLS, "free"), cell)
        law = pieces.law([cell], [_straight_clamp(clamp, cell.moment)], [tip.curve])
        return _unloaded(law, pressure)

    return kept(curves.store, curves.file(name_of_state("unloaded", pressure)), Unloaded, solve)


def _straight_clamp(clamp: ClampCurve, moments: Array) -> ClampCurve:
    """A clamped end of which one state is known, to first order at moments (k,) in N mm."""
    change = moments - clamp.moment[0]
    rows: dict[str, Any] = {"moment": moments, "rotation": clamp.rotation + clamp.rotation_by_moment * change}
    rows["offset"] = clamp.offset + clamp.offset_by_moment * change[:, None]
    for name in ("rotation_by_moment", "rotation_by_pressure", "offset_by_moment", "beside"):
        rows[name] = np.repeat(getattr(clamp, name), len(moments), axis=0)
    return replace(clamp, **rows)


def unloaded_states(law: ArmLaw, pressures_kPa: Sequence[float]) -> tuple[Unloaded, ...]:
    """The clamped arm without a load at those of the pressures that the law has; without one that has no rod."""
    states: list[Unloaded] = []
    for pressure in (p for p in pressures_kPa if law.pressures[0] <= p <= law.pressures[-1]):
        with suppress(RodError):
            states.append(_unloaded(law, pressure))
    return tuple(states)


def _unloaded(law: ArmLaw, pressure: float) -> Unloaded:
    """At a pressure of the law in kPa. Raises `RodError`."""
    at = law.at(pressure)
    shape = Rod(law.length, law=at).solve()
    rigidity = 1.0 / float(np.interp(0.0, at.section.moment, at.section.kappa_slope))
    return Unloaded(pressure, at.section.kappa_0, rigidity, bending_deg(shape.end), shape.end)
