"""The limit of the pressure of an arm's cell, at which chambers swell at once, and that at which they shrink back."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf

import numpy as np

from fem.cell.inflation import extreme_pressures
from fem.elements import MOST_ACCURATE
from geometry import Reason
from pipeline.law.cells import CellMeasurer, measure_bends
from pipeline.law.mesh_limit import INFLATED
from pipeline.law.meshes import SOFT
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.tasks import ArmTasks, Log, PieceCurves
from pipeline.values.pressure import in_kPa, in_MPa
from pipeline.values.richardson import extrapolate_all
from rod.arm_law.law import ArmLaw

#: the highest pressure over that of the configuration up to which a limit is looked for
BEYOND = 1.05
#: size of a mesh over that of the next finer one on which a limit is found, and how many these are
RATIO, MESHES = 1.4, 3
#: parts of the limit pressure at which the last curves lie, the last of which ends need not bear, and of that at which
#: chambers shrink back, at which the first one of the form after the snap lies
BELOW, ABOVE = (0.95, 0.98), 1.02
#: relative difference of limits of two kinds of elements that is not told
ALIKE = 0.01
#: the two pressures of a snap
LIMIT, RETURN = "limit_kPa", "return_kPa"


@dataclass(frozen=True)
class Snap:
    """The extreme pressures of a cell without moment on one mesh; none where the pressure only rises."""

    pressures: Mapping[str, float]  #: kPa, LIMIT and, where the cell has a form beyond, RETURN
    rates: Mapping[str, Mapping[str, float]]  #: of these by parameter, kPa per unit of it
    way_kPa: Sequence[float]  #: states from the one to the other, or as far as they were followed
    way_kappa: Sequence[float]  #: 1/mm


@dataclass(frozen=True)
class SnapLimits:
    """Both pressures of a snap with their standard deviations, kPa."""

    snap: Snap | None = None  #: on the mesh of the law
    found: Mapping[str, tuple[float, float | None]] = field(default_factory=dict)  #: by LIMIT and RETURN

    @classmethod
    def of(cls, snap: Snap, on_meshes: Mapping[float, Snap]) -> "SnapLimits":
        """From one mesh, and by the sizes in mm of others on which all its pressures are known."""
        numbers = {size: other.pressures for size, other in on_meshes.items()}
        known = {size: one for size, one in numbers.items() if one.keys() == snap.pressures.keys()}
        if len(known) < 2:
            return cls(snap, {name: (value, None) for name, value in snap.pressures.items()})
        limits = extrapolate_all(known)
        return cls(snap, {name: (one.limit, INFLATED * one.limit_std) for name, one in limits.items()})

    @property
    def limit(self) -> float | None:
        """kPa; None where there is none."""
        return self.found[LIMIT][0] if LIMIT in self.found else None

    def on(self, law: ArmLaw, log: Log, asked_kPa: Sequence[float]) -> ArmLaw:
        """The law with its limits. Ends may fail closely below them, at pressures that nobody asked for."""
        if not self.snap or not self.limit:
            return law
        if not any(law.pressures[-1] < p < self.limit for p in asked_kPa):
            log.limits.extend(log.failures[1:])
            del log.failures[1:]
        way = np.array(self.snap.way_kPa), np.array(self.snap.way_kappa)
        for name, (value, std) in self.found.items():
            of_limit = name == LIMIT
            law = law.with_limit(of_limit, value, std, self.snap.rates.get(name, {}), *(way if of_limit else ()))
        return law


def measurer_of_form(
    tasks: ArmTasks, log: Log, pressures_kPa: Sequence[float], highest_kPa: Callable[[], float] | None = None
) -> tuple[CellMeasurer, SnapLimits]:
    """For the pressures of the form of the pieces alone, and its limits."""
    bends = measure_bends(tasks, log, pressures_kPa, highest_kPa)
    if tasks.pieces.after_snap or not log.swelling:
        return CellMeasurer(tasks, log, bends), SnapLimits()
    limits = find_snap(tasks, max(pressures_kPa))
    log.limits.extend(elements_differ(tasks, limits.limit, max(pressures_kPa)))
    rising = rising_pressures(pressures_kPa, limits)
    if rising != [*pressures_kPa]:
        bends = measure_bends(tasks, log, rising, None)
    return CellMeasurer(tasks, log, bends), limits


def find_snap(tasks: ArmTasks, highest_kPa: float) -> SnapLimits:
    """The limits of a cell on its mesh, and but for a draft in the limit of finer ones, up to a pressure in kPa."""
    pieces = tasks.pieces
    snap = tasks.submit(snap_of, highest_kPa).result()
    if not snap.pressures or pieces.config.draft:
        return SnapLimits.of(snap, {})
    sizes = [pieces.config.mesh.size_mm / RATIO**k for k in range(MESHES)]
    finer = [ArmTasks(pieces.with_mesh_size(size), tasks.context).submit(snap_of, highest_kPa) for size in sizes[1:]]
    return SnapLimits.of(snap, dict(zip(sizes, [snap, *(one.result() for one in finer)], strict=True)))


def elements_differ(tasks: ArmTasks, limit: float | None, highest_kPa: float) -> list[Reason]:
    """A reason where SOFT elements, taken by hand, have another limit in kPa than mixed ones up to a pressure."""
    mesh = tasks.pieces.config.mesh
    if mesh.formulation != SOFT:
        return []
    mixed = ArmTasks(tasks.pieces.with_mesh(replace(mesh, formulation=MOST_ACCURATE)), tasks.context)
    known = limit or inf, mixed.submit(snap_of, highest_kPa).result().pressures.get(LIMIT, inf)
    if known[0] == known[1] or abs(known[0] / known[1] - 1.0) < ALIKE:
        return []
    soft, accurate = (f"{one:.4g} kPa" if one < inf else f"above {highest_kPa:.4g} kPa" for one in known)
    return [Reason("elements_limit", {"soft": soft, "mixed": accurate})]


def snap_of(curves: PieceCurves, highest_kPa: float) -> Snap:
    """The extreme pressures of the cell up to a pressure in kPa; a task."""

    def follow() -> Snap:
        piece = curves.pieces.cell
        found, way = extreme_pressures(piece, in_MPa(BEYOND * highest_kPa))
        named = dict(zip((LIMIT, RETURN), found, strict=False))
        rates = {
            name: {key: in_kPa(one.limit_rate(piece, at.state, at.rate)) for key, one in piece.changes.items()}
            for name, at in named.items()
        }
        kappas = [(point.state.angle + point.lack) / piece.body.length for point in way]
        pressures = {name: in_kPa(point.pressure) for name, point in named.items()}
        return Snap(pressures, rates, [in_kPa(point.pressure) for point in way], kappas)

    return curves.number(Snap, "snap_rates" if curves.pieces.derivatives else "snap", highest_kPa, follow)


def rising_pressures(pressures_kPa: Sequence[float], limits: SnapLimits) -> list[float]:
    """The pressures of the form from rest: below the limit, and closely below it where there are some beyond."""
    if limits.limit is None or max(pressures_kPa) < BELOW[-1] * limits.limit:
        return [*pressures_kPa]
    close = [float(f"{part * limits.limit:.4g}") for part in BELOW]
    return sorted({*close, *(p for p in pressures_kPa if p < close[-1])})


def swollen_pieces(pieces: ArmPieces, law: ArmLaw) -> ArmPieces | None:
    """The pieces of the form after the snap of a law, at its pressures; None where there is none."""
    if law.limit is None or law.back is None:
        return None
    first, at_limit = ABOVE * law.back.value, ABOVE * law.limit.value
    asked = {p for p in pieces.config.pressures_kPa if p > first}
    pressures_kPa = tuple(sorted({float(f"{p:.4g}") for p in (first, at_limit)} | asked))
    config = replace(pieces.config, pressures_kPa=pressures_kPa)
    return replace(pieces, config=config, after_snap=in_MPa(law.limit.value))
