"""An arm with some dimensions and its wanted numbers: on a coarse mesh that moves with them, and as it is delivered."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import Any

import numpy as np

from fem.cell.piece import PieceFailed
from geometry.arrays import Array
from pipeline.cell.limit import deliver_law, fine_pieces
from pipeline.cell.measure import cell_without_moment
from pipeline.cell.pieces import ArmPieces, NoArmLaw
from pipeline.cell.point import Measured
from pipeline.cell.rates import law_rates
from pipeline.cell.tasks import CLAMP, TIP, ArmTasks, EndCurves, PieceCurves
from pipeline.config.config import Config
from pipeline.context import RunContext
from pipeline.errors import InputError, RunFailed, WorkerLost
from pipeline.notes import render
from pipeline.parallel import Pending
from pipeline.pressure import in_MPa, name_of_state
from pipeline.simulation.mass import mass_along, weight_per_length
from pipeline.simulation.scene import Scene
from pipeline.store.kept import kept
from pipeline.store.state_key import NUMBER_SOURCES, STATE_SOURCES, result_key
from pipeline.store.store import Store
from pipeline.wishes.numbers import numbers_of, rates_of, tip_at, with_pressures
from pipeline.wishes.wish import Wishes
from pipeline.wishes.wish_file import WALL, WishFile, rounded
from rod import RodError
from rod.arm_law.curves import CellCurve
from rod.arm_law.law import ArmLaw

#: by how much a cell is bent for its law under no load or a small one, over 1/length of the arm
NEAR = 0.4
#: half cells of the ends on the coarse mesh
HALF_CELLS = 1
#: change of what is free, over it, in difference quotients of a sensitivity
CHANGE = 0.02
#: the folder of the designs that were tried
POINTS = "points"


class NotBorne(Exception):
    """A design has no numbers; one sentence tells why."""


@dataclass(frozen=True, eq=False)  # arrays inside
class Numbers:
    """The wanted numbers of a design."""

    values: Array  #: (m,) of all wishes, one after the other
    rates: Array  #: (m, n) by what is free, per mm or kPa; empty of a delivered law
    stretch: float  #: largest principal stretch of a cell without moment at the highest pressure; NaN: not asked for
    stretch_rates: Array  #: (n,)
    tips: Array  #: (w, 2) mm, of the arm without load at the pressure of each wish


@dataclass(frozen=True, eq=False)
class Coarse:
    """Measures designs near a reference, whose mesh is moved."""

    file: WishFile
    reference: Config  #: the design that is meshed
    scene: ArmPieces  #: of the reference
    context: RunContext

    @staticmethod
    def of(file: WishFile, point: Array, context: RunContext, *, is_fine: bool = False) -> "Coarse":
        """Mesh the design of a point. Raises InputError and `NoArmLaw`.

        is_fine: on the mesh on which its delivered law is measured, instead of the one of the configuration.
        """
        pieces = ArmPieces.of(Scene.meshed(file.config(point)))
        pieces = fine_pieces(pieces) if is_fine and pieces.config.accuracy is not None else pieces
        return Coarse(file, pieces.config, pieces, context)

    def reaches(self, config: Config, farthest: float) -> bool:
        """Whether no dimension differs by more than a part of itself from that of the reference."""
        known = self.reference.design.dimensions
        return all(abs(value / known[name] - 1.0) <= farthest for name, value in config.design.dimensions.items())

    def numbers(self, point: Array) -> Numbers:
        """Of the design of a point (n,). Raises `NotBorne`."""
        wishes = self.file.wishes
        try:
            config = replace(self.file.config(point), mesh=self.reference.mesh)
            pieces = ArmPieces(
                config, self.scene.dhat, self.scene.outer, True, wishes.dimensions or ("",), self.reference
            )
            values = wishes.values(point)
            law, stretch, by_stretch = self._law(pieces, point)
            law = with_pressures(law, wishes, values)
            rates = rates_of(law, wishes, values)
            return Numbers(numbers_of(law, wishes, values), rates, stretch, by_stretch, free_tips(law, wishes, point))
        except (PieceFailed, RodError, InputError, RunFailed, NoArmLaw) as failure:
            if isinstance(failure, WorkerLost):
                raise
            raise NotBorne(str(failure).rstrip(".")) from None

    def sensitivity(self, point: Array) -> tuple[float, Array]:
        """Change of kappa_0 at the highest pressure by the wall, over both, and its rates (n,) by the logarithms of
        what is free; nothing where that is not made small. Raises `NotBorne` and InputError."""
        if self.file.wishes.minimize != "sensitivity":
            return 0.0, np.zeros(len(point))
        value = self._by_wall(point)
        steps = 1.0 + CHANGE * np.eye(len(point))
        return value, np.array([(self._by_wall(rounded(point * step)) - value) / CHANGE for step in steps])

    def _by_wall(self, point: Array) -> float:
        config = replace(self.file.config(point), mesh=self.reference.mesh)
        pieces = ArmPieces(config, self.scene.dhat, self.scene.outer, True, (WALL,), self.reference)
        context = replace(self.context, store=store_of(self.context.store, config, self.reference, WALL))
        pressure = self.file.wishes.pressures_kPa(point)[-1]
        try:
            cell = ArmTasks(pieces, context).submit(_cell, pressure, False).result()
        except (PieceFailed, RodError) as failure:
            raise NotBorne(str(failure).rstrip(".")) from None
        moment, wall = cell.rates[WALL]["moment"][1], pieces.design.dimensions[WALL.partition(".")[2]]
        return abs(moment * wall / (cell.curve.rigidity[1] * cell.curve.kappa[1]))

    def _law(self, pieces: ArmPieces, point: Array) -> tuple[ArmLaw, float, Array]:
        """With the largest stretch of a cell without moment and its rates."""
        wishes, config = self.file.wishes, pieces.config
        context = replace(self.context, store=store_of(self.context.store, config, pieces.mesh_of))
        tasks, held = ArmTasks(pieces, context), _held(wishes, point)
        pressures, bears = wishes.pressures_kPa(point), wishes.limits.bears
        pending = [tasks.submit(_cell, pressure, pressure in held) for pressure in pressures]
        beyond = [tasks.submit(PieceCurves.bend, wishes.highest_kPa(point))] if bears else []
        cells = [one.result() for one in pending]
        for one in beyond:
            one.result()
        ends = [_ends(tasks, [cell.curve]) for cell in cells]
        clamps, tips = ([_measured(pair[side]) for pair in ends] for side in (0, 1))
        repetition = pieces.repetition
        mass = mass_along(pieces.design.of_pieces(repetition), config)
        law = ArmLaw(
            2.0 * repetition.half_pitch,
            repetition.middle,
            pieces.design.length,
            tuple(cell.curve for cell in cells),
            tuple(clamp.curve for clamp in clamps),
            tuple(tip.curve for tip in tips),
            mass,
            weight_per_length(mass, config),
        )
        law = replace(law, rates=law_rates(config, repetition, pieces.movements, cells, clamps))
        stretch, rates = np.nan, np.zeros(len(wishes.free))
        if wishes.limits.largest_stretch is not None:
            stretch = tasks.submit(largest_stretch, pressures[-1]).result()
            known = [law.rates[one.key].cells[-1] if one.key in law.rates else None for one in wishes.free]
            rates = np.array([0.0 if rate is None else float(rate.largest_stretch) for rate in known])
        return law, stretch, rates


def delivered(file: WishFile, point: Array, context: RunContext) -> Numbers:
    """Of the law that a run delivers for the design of a point (n,). Raises `NotBorne`."""
    wishes = file.wishes
    try:
        config = file.config(point)
        own = replace(context, store=store_of(context.store, config))
        pieces = ArmPieces.of(Scene.meshed(config))
        law = deliver_law(pieces, own).law
        values, stretch = wishes.values(point), np.nan
        if wishes.limits.largest_stretch is not None:
            tasks = ArmTasks(fine_pieces(pieces), own)
            stretch = tasks.submit(largest_stretch, wishes.pressures_kPa(point)[-1]).result()
        nothing = np.zeros((0, 0)), stretch, np.zeros(0)
        return Numbers(numbers_of(law, wishes, values), *nothing, free_tips(law, wishes, point))
    except (PieceFailed, RodError, InputError, RunFailed, NoArmLaw) as failure:
        if isinstance(failure, WorkerLost):
            raise
        raise NotBorne(str(failure).rstrip(".")) from None


def free_tips(law: ArmLaw, wishes: Wishes, point: Array) -> Array:
    """(w, 2) mm. Raises `RodError`."""
    values = wishes.values(point)
    return np.array([tip_at(law, wish.pressure(values)) for wish in wishes.wishes])


def store_of(store: Store, config: Config, mesh_of: Config | None = None, by: str = "") -> Store:
    """Where the curves of one design are kept, below the folder of all; without a mesh that is moved, they are those of
    a run of the design."""
    identity = config.hash if mesh_of is None else f"{config.hash}|{mesh_of.hash}|{by}"
    keys = (result_key(identity, sources) for sources in (STATE_SOURCES, NUMBER_SOURCES))
    return Store(store.directory / POINTS / sha256(identity.encode()).hexdigest()[:16], *keys)


def _held(wishes: Wishes, point: Array) -> set[float]:
    """Pressures (kPa) at which the end is held."""
    values = wishes.values(point)
    return {wish.pressure(values) for wish in wishes.wishes if wish.quantity == "force"}


def _cell(curves: PieceCurves, pressure: float, is_held: bool) -> Measured[CellCurve]:
    """A cell for the loads of the wishes; a task."""
    if is_held:
        return curves.cell(pressure, curves.bend(pressure).curve)
    return curves.near(pressure, NEAR / curves.pieces.design.length)


def largest_stretch(curves: PieceCurves, pressure: float) -> float:
    """Largest principal stretch of a cell without moment at a pressure in kPa; a task. Raises `PieceFailed`."""

    def measure() -> float:
        return cell_without_moment(curves.pieces.cell, in_MPa(pressure)).state.extremes.max_stretch

    return kept(curves.store, curves.file(name_of_state("stretch", pressure)), float, measure)


def _ends(tasks: ArmTasks, cells: Sequence[CellCurve]) -> tuple[Pending[EndCurves[Any]], Pending[EndCurves[Any]]]:
    clamped = tasks.submit(PieceCurves.ends, CLAMP, cells, HALF_CELLS)
    return clamped, tasks.submit(PieceCurves.ends, TIP, cells, HALF_CELLS)


def _measured(pending: Pending[EndCurves[Any]]) -> Measured[Any]:
    found = pending.result()
    if found.failure:
        raise RunFailed(render(found.failure))
    return found.measured[0]
