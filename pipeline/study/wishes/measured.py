"""The wanted numbers of a design: on a mesh that moves with it, and as the law has them that a run delivers."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from hashlib import sha256

import numpy as np

from fem.cell.piece import PieceFailed
from geometry import DesignError
from geometry.arrays import Array
from pipeline.config.config import Config
from pipeline.law.build import correction_of, fine_pieces
from pipeline.law.cells import bend_of, cell_at, near_cell
from pipeline.law.ends import CLAMP, HALF_CELLS, TIP, end_at
from pipeline.law.mesh_limit import corrected
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.piece.pieces import ArmPieces, NoArmLaw
from pipeline.law.piece.point import KeptCurve
from pipeline.law.piece.rates import law_rates
from pipeline.law.piece.tasks import ArmTasks, PieceCurves
from pipeline.simulate.scene import Scene
from pipeline.store.context import RunContext
from pipeline.store.state_key import NUMBER_SOURCES, STATE_SOURCES, result_key
from pipeline.store.store import Store
from pipeline.study.wishes.wish import PRESSURE, Wishes, WishFile
from pipeline.values.errors import InputError, RunFailed, WorkerLost
from pipeline.values.pressure import in_MPa
from rod import Rod, RodError
from rod.arm_law.curves import CellCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.quantities import QuantityAt, jacobian
from rod.arm_law.rates import CellRate, ClampRate, LawRate
from rod.load import Loading

#: by how much a cell is bent for its law under no load or a small one, over 1/length of the arm
NEAR = 0.4
#: relative change of a dimension beyond which the cell is meshed anew
FARTHEST = 0.25
#: part by which walls are stiffer for a derivative
STIFFER = 1e-3
#: the folder of the designs that were tried
POINTS = "points"


class NotBorne(Exception):
    """A design has no numbers; one sentence tells why."""


@dataclass(frozen=True, eq=False)  # arrays inside
class Response:
    """The wanted numbers of a design, and what else depends on its law."""

    values: Array  #: (m,) of all wishes, one after the other
    rates: Array  #: (m, n) by the logarithms of what is free
    by_stiffness: Array  #: (m,) by the logarithm of all moduli
    stretch: float  #: largest one of a cell without moment at the highest pressure; NaN: not asked for
    stretch_rates: Array  #: (n,) by the logarithms
    curves: Mapping[str, Array]  #: (k, 2) mm, the arm by pressure and load in words


@contextmanager
def raise_not_borne() -> Iterator[None]:
    """Any reason why a design has no numbers becomes a `NotBorne`."""
    try:
        yield
    except WorkerLost:
        raise
    except (PieceFailed, RodError, InputError, RunFailed, NoArmLaw, DesignError) as failure:
        raise NotBorne(str(failure).rstrip(".")) from None


@dataclass(frozen=True, eq=False)
class MovedMesh:
    """Measures designs near one that is meshed, whose mesh is moved."""

    file: WishFile
    meshed: ArmPieces
    context: RunContext
    is_fine: bool  #: whether on the mesh on which the delivered law is measured, or on that of the configuration

    @staticmethod
    def of(file: WishFile, point: Array, context: RunContext, *, is_fine: bool) -> "MovedMesh":
        """Mesh the design of a point. Raises `NotBorne`."""
        with raise_not_borne():
            pieces = ArmPieces.of(Scene.meshed(file.config(point)))
            return MovedMesh(file, fine_pieces(pieces) if is_fine else pieces, context, is_fine)

    def reaches(self, point: Array) -> bool:
        """Whether no dimension of a point (n,) differs from the meshed one by more than FARTHEST. Raises `NotBorne`."""
        with raise_not_borne():
            known, new = self.meshed.design.dimensions, self.file.config(point).design.dimensions
        return all(abs(value / known[name] - 1.0) <= FARTHEST for name, value in new.items())

    def numbers(self, point: Array) -> Response:
        """Numbers of the design at a point (n,). Raises `NotBorne`."""
        wishes, values = self.file.wishes, self.file.wishes.values(point)
        with raise_not_borne():
            config = replace(self.file.config(point), mesh=self.meshed.config.mesh)
            by = wishes.dimensions or ("",)
            pieces = ArmPieces(config, self.meshed.dhat, self.meshed.outer, True, by, self.meshed.config)
            context = replace(self.context, store=store_of(self.context.store, config, self.meshed.config, by))
            law, _ = _near_law(self.file, pieces, point, context, ("force",))
            every = values | {f"{PRESSURE}at {pressure!r} kPa": pressure for pressure in law.pressures}
            law = with_pressures(law, every)
            asked = [one.of for one in _asked(law, wishes, every)]
            rates = jacobian(law.rods_after(list(every)), asked, [*map(law.step, every)])
            rates = rates * np.array([*every.values()])
            stretch, by_stretch = np.nan, np.zeros(len(point))
            if wishes.limits.largest_stretch is not None:
                stretch = ArmTasks(pieces, context).submit(largest_stretch, law.pressures[-1]).result()
                by_stretch = np.array([float(law.rates[key].cells[-1].largest_stretch) for key in values]) * point
            found, (own, by_pressure) = numbers_of(law, wishes, values), np.split(rates, [len(values)], axis=1)
            # stiffer walls are the same walls at lower pressures, with larger forces
            is_force = [wish.quantity in ("force", "stiffness") for wish in wishes.wishes for _ in wish.target]
            by_stiffness = np.where(is_force, found, 0.0) - by_pressure.sum(axis=1)
            if any(wish.load for wish in wishes.wishes):
                stiffer = replace(wishes, wishes=tuple(wish.stiffer(1.0 + STIFFER) for wish in wishes.wishes))
                by_stiffness += (numbers_of(law, stiffer, values) - found) / STIFFER
            curves = _curves(law, wishes, values)
            return Response(found, own, by_stiffness, stretch, by_stretch, curves)


def delivered(file: WishFile, point: Array, context: RunContext) -> tuple[Array, float]:
    """All wanted numbers (m,) of the law that a run delivers for a design, and the largest stretch, if it is limited.

    Raises `NotBorne`. The law of a run is measured over more moments and pressures; states at the pressures of the
    wishes are the same.
    """
    with raise_not_borne():
        config = file.config(point)
        of_run, own = (replace(context, store=store_of(context.store, config, mesh)) for mesh in (None, config))
        pieces = ArmPieces.of(Scene.meshed(config))
        fine = fine_pieces(pieces) if file.is_fine else pieces
        law, cells = _near_law(file, fine, point, own, ("force", "stiffness"))
        if file.is_fine:
            law = corrected(law, correction_of(pieces, [cell.curve for cell in cells], of_run))
        stretch = np.nan
        if file.wishes.limits.largest_stretch is not None:
            stretch = ArmTasks(fine, own).submit(largest_stretch, law.pressures[-1]).result()
        return numbers_of(law, file.wishes, file.wishes.values(point)), stretch


def _near_law(
    file: WishFile, pieces: ArmPieces, point: Array, context: RunContext, loaded: tuple[str, ...]
) -> tuple[ArmLaw, list[KeptCurve[CellCurve]]]:
    """A law for the states that wishes need, and its cells: near no moment at their pressures, and the ends beside
    them; with derivatives where the pieces have some.

    loaded: quantities at whose pressures the whole curve of the cell is needed. Raises `PieceFailed` and `RodError`
    where a cell or an end does not bear a pressure.
    """
    wishes, tasks = file.wishes, ArmTasks(pieces, context)
    values, pressures = wishes.values(point), wishes.pressures_kPa(point)
    whole = {wish.pressure(values) for wish in wishes.wishes if wish.quantity in loaded or wish.load}
    begun = [tasks.submit(_cell, pressure, pressure in whole) for pressure in pressures]
    if wishes.limits.bears is not None:
        tasks.submit(bend_of, wishes.limits.bears * pressures[-1]).result()
    cells = [one.result() for one in begun]
    clamped = [tasks.submit(end_at, CLAMP, cell.curve, HALF_CELLS) for cell in cells]
    tips = [tasks.submit(end_at, TIP, cell.curve, HALF_CELLS) for cell in cells]
    clamps, free = [end.result() for end in clamped], [end.result().curve for end in tips]
    law = pieces.law([cell.curve for cell in cells], [clamp.curve for clamp in clamps], free)
    if pieces.derivatives:
        law = replace(law, rates=law_rates(pieces.config, pieces.repetition, pieces.movements, cells, clamps))
    return law, cells


def _cell(curves: PieceCurves, pressure: float, is_whole: bool) -> KeptCurve[CellCurve]:
    """A cell for the loads of the wishes; a task."""
    if is_whole:
        return cell_at(curves, pressure, bend_of(curves, pressure).curve)
    return near_cell(curves, pressure, NEAR / curves.pieces.design.length)


def _curves(law: ArmLaw, wishes: Wishes, values: Mapping[str, float]) -> dict[str, Array]:
    """By pressure and load in words; without those that have no equilibrium."""
    at = {wish.pressure(values): Loading() for wish in wishes.wishes}
    cases = [(pressure, load, "") for pressure, load in sorted(at.items())]
    cases += [(wish.pressure(values), wish.under, f", {wish.load}") for wish in wishes.wishes if wish.load]
    found = dict[str, Array]()
    for pressure, loading, words in cases:
        with suppress(RodError):
            found[f"{pressure:g} kPa{words}"] = np.asarray(Rod(law.length, law=law.at(pressure)).bear(loading).curve)
    return found


def largest_stretch(curves: PieceCurves, pressure: float) -> float:
    """Largest principal stretch of a cell without moment at a pressure in kPa; a task. Raises `PieceFailed`."""

    def measure() -> float:
        return cell_without_moment(curves.pieces.cell, in_MPa(pressure)).state.extremes.max_stretch

    return curves.number(float, "stretch", pressure, measure)


def store_of(store: Store, config: Config, mesh_of: Config | None = None, by: tuple[str, ...] = ()) -> Store:
    """Where the curves of one design are kept, below the folder of all; without a mesh that is moved, they are those of
    a run of the design. by: parameters of their derivatives."""
    identity = config.hash if mesh_of is None else f"{config.hash}|{mesh_of.hash}|{','.join(by)}"
    keys = (result_key(identity, sources) for sources in (STATE_SOURCES, NUMBER_SOURCES))
    return Store(store.directory / POINTS / sha256(identity.encode()).hexdigest()[:16], *keys)


def numbers_of(law: ArmLaw, wishes: Wishes, values: Mapping[str, float]) -> Array:
    """(m,) all numbers of the wishes, one after the other; values: of what is free, by key.

    Raises `RodError` where the arm has no equilibrium.
    """
    return np.concatenate([one.of(law.at) for one in _asked(law, wishes, values)])


def _asked(law: ArmLaw, wishes: Wishes, values: Mapping[str, float]) -> list[QuantityAt]:
    pairs = [(wish, wish.pressure(values)) for wish in wishes.wishes]
    return [QuantityAt(wish.quantity, p, law.at(p), wish.given, wish.under) for wish, p in pairs]


def with_pressures(law: ArmLaw, values: Mapping[str, float]) -> ArmLaw:
    """The law with derivatives by the free pressures as well, which its curves have: of the curve at that pressure
    alone, which then is that of a higher one. values: of what is free, by key."""
    rates = dict(law.rates)
    for key, at in values.items():
        if key.startswith(PRESSURE):
            cells = tuple(_by_pressure(cell, float(cell.pressure == at)) for cell in law.cells)
            clamps = tuple(
                ClampRate(float(clamp.pressure == at) * clamp.rotation_by_pressure, np.zeros_like(clamp.offset))
                for clamp in law.clamps
            )
            rates[key] = LawRate(at, "kPa", 0.0, 0.0, 0.0, cells, clamps)
    return replace(law, rates=rates)


def _by_pressure(cell: CellCurve, part: float) -> CellRate:
    ripple = np.zeros((len(cell.moment), 2, 2))
    return CellRate(part * cell.moment_by_pressure, part * cell.stretch_by_pressure, ripple, np.zeros(()))
