"""The command that measures the arm's own law: law.json, and the record of the run."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from time import perf_counter
from typing import Generic, TypeVar

import numpy as np

from fem.cell.any_plane import moment_beside
from fem.cell.inflation import inflated
from fem.cell.piece import PieceFailed
from geometry.told import Printable
from pipeline.config.config import Config
from pipeline.law.build import MeasuredLaw, deliver_law
from pipeline.law.effort import expected_of
from pipeline.law.in_space.measure import MeasuredInSpace, measure_in_space
from pipeline.law.piece.pieces import ArmPieces, NoArmLaw
from pipeline.law.rows import RowSpec, rows_of
from pipeline.law.table import space_sentences
from pipeline.results.files import LAW, read_results, replace_draft
from pipeline.results.laws import law_record
from pipeline.results.unloaded import delivered_numbers, unloaded_states
from pipeline.results.verdict import verdict_of
from pipeline.simulate.meshed import save_body
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import begin_loading
from pipeline.store.context import RunContext, run_context
from pipeline.store.progress import Progress
from pipeline.store.provenance import provenance
from pipeline.store.store import Store, open_store
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.formats import FORMAT
from pipeline.values.json_values import JsonObject
from pipeline.values.law import DeliveredLaw, LawMetadata
from pipeline.values.pressure import in_MPa
from pipeline.values.reasons import render, render_all
from rod.errors import RodError

Measured = TypeVar("Measured", MeasuredLaw, MeasuredInSpace)

#: moment out of the plane of a straight cell over that within, up to which it bends in the plane
IN_PLANE = 0.01
#: moment over the pressure times the volume of the cell that is rounding
NOTHING = 1e-6


@dataclass(frozen=True, eq=False)  # arrays inside
class LawReport(Printable, Generic[Measured]):
    """The law of an arm as it was measured; the same numbers stand in the files of `directory`."""

    directory: Path
    config: Config
    measured: Measured
    seconds: float  #: wall time of this call

    @property
    def lines(self) -> Sequence[str]:
        """The verdict as of a run: how far the arm bends, its tip, errors, and how to use the rod."""
        return verdict_of(read_results(self.directory)).lines

    def raise_if_failed(self) -> None:
        """Raise RunFailed where a pressure was not reached."""
        if self.measured.failures:
            known = f"the law goes up to {max(map(max, self.measured.law.rows)):g} kPa"
            sentence = f"{render_all(self.measured.failures)}; {known}; what was reached is in {self.directory}"
            raise RunFailed(sentence, directory=self.directory)


def check_plane(pieces: ArmPieces) -> None:
    """Raise `NoArmLaw` for cells that the lowest pressure of the configuration bends out of the plane."""
    if leaves_plane(pieces):
        raise NoArmLaw("its cells bend out of the plane z = 0; `pneurod cell` measures its law in space")


def leaves_plane(pieces: ArmPieces) -> bool:
    """Whether the lowest pressure of the configuration bends the cells out of the plane; False where it fails."""
    if not pieces.design.halves_differ:
        return False
    try:
        state = inflated(pieces.cell, in_MPa(pieces.config.pressures_kPa[0]), 0.0)
    except PieceFailed:
        return False  # the law will say so
    moments = np.array([moment_beside(pieces.cell, state), state.moment])
    rounding = NOTHING * state.pressure * pieces.cell.body.volume
    return bool(abs(moments[0]) > max(IN_PLANE * float(np.linalg.norm(moments)), rounding))


def measure_law(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> LawReport[MeasuredLaw]:
    """From a configuration to `out`/law.json; curves that `out` already holds are not measured again.

    The mesh of the configuration is that of the arm; with an accuracy the law comes from finer ones of the cell
    (`pipeline.law.build`).

    A pressure that is not reached is named in the report; the law of those below it is in `out` then. Raises InputError
    for an arm without such a law, a body that cannot be meshed and a folder that cannot be used, and RunFailed where
    not even the lowest pressure is borne.
    """
    with _begun(config, out, jobs, fresh, progress) as (pieces, context, begin, head):
        check_plane(pieces)
        return _in_plane(pieces, context, begin, head)


def measure_any_law(
    given: Config | RowSpec, out: Path, jobs: int, fresh: bool, progress: Progress
) -> LawReport[MeasuredLaw] | LawReport[MeasuredInSpace]:
    """Measure a law as `measure_law`, in space for rows of pressures and for an arm that leaves its plane.

    Raises InputError for effects that a law in space lacks, and RunFailed for rows that its cell does not bear.
    """
    spec = given if isinstance(given, RowSpec) else rows_of(given)
    if spec is given:
        _refuse_effects(spec.config)
    with _begun(spec.config, out, jobs, fresh, progress) as (pieces, context, begin, head):
        if spec is given or leaves_plane(pieces):
            return _in_space(pieces, spec, context, begin, head)
        return _in_plane(pieces, context, begin, head)


@contextmanager
def _begun(
    config: Config, out: Path, jobs: int, fresh: bool, progress: Progress
) -> Iterator[tuple[ArmPieces, RunContext, float, JsonObject]]:
    """The pieces of an arm, the surroundings of its run, when it was begun, and the head of run.json.

    The mesh of the whole arm is written. Raises InputError.
    """
    begin = perf_counter()
    with open_store(out, config, fresh=fresh) as store, run_context(store, jobs, progress) as context:
        replace_draft(store, draft=config.draft)
        loading = begin_loading(context, config)
        progress.stage("mesh")
        try:
            scene = Scene.meshed(config)
            pieces = ArmPieces.of(scene)
            progress.stage("kernels (compiled once)")
            for pending in loading:
                pending.result()
            progress.stage("cell and ends")
            progress.expect(expected_of(replace(config, law="cell")))
            save_body(store, scene.body)
            record = {"format": FORMAT, "config": config.record(), "config_hash": config.hash, **provenance()}
            yield pieces, context, begin, {**record, "mesh": asdict(scene.mesh_record)}
        except NoArmLaw as refusal:
            raise InputError(f"{config.source}: {refusal}") from None


def _in_plane(pieces: ArmPieces, context: RunContext, begin: float, head: JsonObject) -> LawReport[MeasuredLaw]:
    config, store = pieces.config, context.store
    report = LawReport(store.directory, config, measured := deliver_law(pieces, context), perf_counter() - begin)
    law = save_law(store, measured, config.pressures_kPa)
    if law.unloaded:
        context.progress.remark(delivered_numbers(law))
    failure = render_all(measured.failures)
    record = {
        **head,
        "seconds": {**measured.seconds, "this call": report.seconds},
        "factorizations": measured.factorizations,
        "degrees_of_freedom": measured.unknowns,
        **({"failure": failure} if failure else {}),
    }
    store.save_json("run.json", record)
    return report


def _in_space(
    pieces: ArmPieces, spec: RowSpec, context: RunContext, begin: float, head: JsonObject
) -> LawReport[MeasuredInSpace]:
    _refuse_effects(spec.config)
    try:
        measured = measure_in_space(pieces, spec.rows, context)
    except (PieceFailed, RodError) as failure:
        sentence = str(failure).rstrip(".")
        raise RunFailed(f"the arm has no law in space at these pressures: {sentence}; give lower ones") from None
    report = LawReport(context.store.directory, spec.config, measured, perf_counter() - begin)
    notes, around = space_sentences(measured), DeliveredLaw(law=measured.law).towards()
    beside = LawMetadata(measured.mesh_error, (), notes, directions_deg=around)
    context.store.save_json(LAW, {**law_record(measured.law), **asdict(beside)})
    record = {**head, "rows_kPa": spec.rows, "seconds": {"this call": report.seconds}}
    context.store.save_json("run.json", record)
    return report


def _refuse_effects(config: Config) -> None:
    """Raise InputError for effects that the law in space does not have, and for a draft."""
    if config.draft:
        raise InputError(f"{config.source}: draft: this arm has a law in space, which has no draft; leave it out")
    if config.effects.gravity.on:
        remedy = "add it with `pneurod rod --orientation`"
        raise InputError(f"{config.source}: effects.gravity must be off: the law in space excludes weight; {remedy}")
    if config.effects.strain_limiting_layer.on:
        raise InputError(f"{config.source}: effects.strain_limiting_layer: the law in space has no layer; leave it out")


def save_law(store: Store, measured: MeasuredLaw, pressures_kPa: Sequence[float]) -> MeasuredLaw:
    """Write law.json, the law, its errors and where it ends, and return it with the arm without a load.

    pressures_kPa: of the configuration, at which the arm without a load is told.
    """
    measured = replace(measured, unloaded=unloaded_states(measured.law, pressures_kPa))
    content = {
        **law_record(measured.law),
        **{one.name: getattr(measured, one.name) for one in fields(LawMetadata) if one.name != "draft"},
        **({"draft": True} if measured.draft else {}),
        "added_pressures_kPa": measured.added_kPa,
        "end_half_cells": measured.half_cells,
        "accuracy": measured.limit and measured.limit.record(),
        "limits": [*map(render, measured.limits)],
        "failures": [*map(render, measured.failures)],
        "factorizations": measured.factorizations,
        "seconds": measured.seconds,
        "degrees_of_freedom": measured.unknowns,
    }
    store.save_json(LAW, content)
    return measured
