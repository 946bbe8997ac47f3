"""The command that measures the law of an arm that bends in space: law.json and the record of the run."""

from dataclasses import asdict, dataclass
from math import degrees
from pathlib import Path
from time import perf_counter

import numpy as np

from fem.cell.piece import PieceFailed
from pipeline.config.config import Config
from pipeline.law.in_space.measure import FINER, MeasuredInSpace, measure_in_space
from pipeline.law.in_space.rows import RowSpec
from pipeline.law.pieces import ArmPieces, NoArmLaw
from pipeline.law.plane import OUT_OF_PLANE, check_plane
from pipeline.results.files import LAW
from pipeline.simulate.scene import Scene
from pipeline.store.context import run_context
from pipeline.store.progress import Progress
from pipeline.store.provenance import provenance
from pipeline.store.store import open_store
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.formats import FORMAT
from pipeline.values.formatting import percent
from pipeline.values.law import BesideLaw
from pipeline.values.table import Table
from rod.arm_law.kinds import law_record
from rod.arm_law.space_law import SpaceRod
from rod.errors import RodError
from rod.spatial import SpatialLoad


@dataclass(frozen=True, eq=False)  # arrays inside
class SpaceLawReport:
    """The law of an arm that bends in space, as it was measured; the same numbers stand in the files of `directory`."""

    directory: Path
    spec: RowSpec
    measured: MeasuredInSpace

    @property
    def sentences(self) -> tuple[str, ...]:
        """How far the law may be trusted, and what could not be solved."""
        measured, law = self.measured, self.measured.law
        lines = [
            f"The law interpolates {measured.states} states of a half cell; its moments are right to "
            f"{percent(law.error)} of the largest.",
            f"It is known within {1e3 * law.reach:.3g} 1/m of the curvature without load.",
        ]
        if measured.changes is not None:
            curvature, rigidity = map(percent, measured.changes)
            size = f"{100.0 * FINER:.0f} % of the size"
            lines.append(f"On a mesh of {size} its curvature changes by {curvature} and its rigidity by {rigidity}.")
        if measured.left:
            lines.append(f"{len(measured.left)} states have no equilibrium, the first: {measured.left[0]}.")
        return tuple(lines)

    @property
    def table(self) -> Table:
        """One row per row of pressures: the arm without load."""
        law = self.measured.law
        rows = tuple(_row(law.at(pressures)) for pressures in law.pressures.tolist())
        heads = ("p (kPa)", "κ_y, κ_z (1/m)", "end (mm)", "bends by", "rigidities (N mm²)", "GJ (N mm²)", "EA (N)")
        return Table(heads, rows, f"pressures of {', '.join(law.cavities)}; the arm without load")


def _row(rod: SpaceRod) -> tuple[str, ...]:
    end = np.array(rod.solve_in_space(SpatialLoad()).end)
    bent = degrees(2.0 * np.arctan2(np.linalg.norm(end[1:]), end[0]))
    least, most = rod.section.rigidities
    return (
        ", ".join(f"{pressure:g}" for pressure in rod.pressures),
        ", ".join(f"{1e3 * value:.3f}" for value in rod.kappa_0),
        ", ".join(f"{value:.2f}" for value in end),
        f"{bent:.1f}°",
        f"{least:.4g}, {most:.4g}",
        f"{1.0 / rod.section.compliance[0, 0]:.4g}",
        f"{rod.section.EA:.3g}",
    )


def leaves_plane(config: Config) -> bool:
    """Whether the cells of an arm bend out of its plane. Raises InputError for an arm without cells."""
    if not config.design.halves_differ:
        return False
    try:
        check_plane(ArmPieces.of(Scene.meshed(config)))
    except NoArmLaw as refusal:
        if refusal.args[0] == OUT_OF_PLANE:
            return True
        raise InputError(f"{config.source}: {refusal}") from None
    return False


def measure_space_law(spec: RowSpec, out: Path, jobs: int, fresh: bool, progress: Progress) -> SpaceLawReport:
    """From a configuration to `out`/law.json; states that `out` already holds are not solved again.

    Raises InputError for an arm without such a law, and RunFailed for pressures that its cell does not bear.
    """
    begin, config = perf_counter(), spec.config
    refuse_effects(spec)
    with open_store(out, config, fresh=fresh) as store, run_context(store, jobs, progress) as context:
        progress.stage("mesh")
        try:
            measured = measure_in_space(ArmPieces.of(Scene.meshed(config)), spec.rows, context)
        except NoArmLaw as refusal:
            raise InputError(f"{config.source}: {refusal}") from None
        except (PieceFailed, RodError) as failure:
            sentence = str(failure).rstrip(".")
            raise RunFailed(f"the arm has no law in space at these pressures: {sentence}; give lower ones") from None
        report = SpaceLawReport(out, spec, measured)
        beside = BesideLaw(measured.mesh_error, (), report.sentences)
        store.save_json(LAW, {**law_record(measured.law), **asdict(beside)})
        record = {"format": FORMAT, "config": config.record(), "config_hash": config.hash, **provenance()}
        store.save_json("run.json", {**record, "rows_kPa": spec.rows, "seconds": {"this call": perf_counter() - begin}})
    return report


def refuse_effects(spec: RowSpec) -> None:
    """Raise InputError for effects that the law in space does not have."""
    effects, source = spec.config.effects, spec.config.source
    if effects.gravity.on:
        remedy = "leave it out; `pneurod rod` takes --orientation"
        raise InputError(f"{source}: effects.gravity: the law in space has no weight in it; {remedy}")
    if effects.strain_limiting_layer.on:
        raise InputError(f"{source}: effects.strain_limiting_layer: the law in space has no layer; leave it out")
