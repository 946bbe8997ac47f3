"""What is measured on an arm as built: finite elements of the whole arm, kept in its folder."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import degrees, hypot
from pathlib import Path
from resource import RUSAGE_SELF, getrusage

from benchmarks.virtual_arms.designs import VirtualArm
from pipeline.config.config import End
from pipeline.config.load import load_config
from pipeline.simulate.loadcase import LoadCase, schedule
from pipeline.simulate.outcome import Outcome, Record
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.store.atomic_file import write_atomic
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from pipeline.values.reasons import render_all

FILE = "measured.json"
#: by what part of the length the dead force would move the end of an arm as rigid as between II and III
MOVED = 0.1


@dataclass(frozen=True)
class Row:
    """A state of an arm as built, without noise; its origin is the clamped end of the material curve."""

    experiment: str  #: II, III or dead
    pressure_kPa: float
    tip_mm: tuple[float, float]
    angle_deg: float  #: of the end of the material curve
    force_N: tuple[float, float]  #: on the end; in III that of the support


@dataclass(frozen=True)
class Measurement:
    """All states of an arm as built."""

    rows: tuple[Row, ...]
    failures: tuple[str, ...]  #: why states were not reached
    cpu_seconds: float

    def of(self, experiment: str, pressures_kPa: Sequence[float]) -> tuple[Row, ...]:
        """The states of an experiment at these pressures."""
        return tuple(row for row in self.rows if row.experiment == experiment and row.pressure_kPa in pressures_kPa)


def measured(arm: VirtualArm, folder: Path) -> Measurement:
    """The states in the folder of the arm, or those that are solved now.

    A measurement is used again whatever has changed in the program since, as one on a bench would be.
    """
    kept = _kept(arm, folder / FILE)
    if kept is None:
        kept = _solved(arm, folder)
        content = {"built": arm.built, "direction": arm.direction, **asdict(kept)}
        write_atomic(folder / FILE, (json.dumps(content, indent=1) + "\n").encode())
    return kept


def _kept(arm: VirtualArm, file: Path) -> Measurement | None:
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if content["built"] != arm.built or content["direction"] != list(arm.direction):
        return None
    rows = (Row(**{**row, "tip_mm": tuple(row["tip_mm"]), "force_N": tuple(row["force_N"])}) for row in content["rows"])
    return Measurement(tuple(rows), tuple(content["failures"]), content["cpu_seconds"])


def _solved(arm: VirtualArm, folder: Path) -> Measurement:
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "built.yaml"
    file.write_text(json.dumps(arm.built, indent=1) + "\n", encoding="utf-8")  # JSON is YAML
    config, begin = load_config(file), _cpu_seconds()
    loaded = schedule(config, (arm.loaded_kPa,))
    with open_store(folder / "built", config) as store:
        context, scene = RunContext.alone(store, Silent()), Scene.meshed(config)

        def solve(case: LoadCase) -> Outcome:
            return simulate(scene, context, [case])[case.name]

        free = solve(LoadCase("II", "II", schedule(config), End()))
        held = solve(LoadCase("III", "III", loaded, End(y_mm=0.0)))
        outcomes = [free, held]
        unloaded = free.at(arm.loaded_kPa)
        if held.records and unloaded:
            force = _force(_row(unloaded), _row(held.records[0]), config.design.length, arm.direction)
            outcomes.append(solve(LoadCase("dead", "dead", loaded, End(None, None, force))))
    rows = tuple(_row(record) for outcome in outcomes for record in outcome.records)
    failures = tuple(render_all(outcome.failure.reasons) for outcome in outcomes if outcome.failure)
    return Measurement(rows, failures, _cpu_seconds() - begin)


def _force(free: Row, held: Row, length: float, direction: tuple[float, float]) -> tuple[float, float]:
    """N, three digits: what moves the end by a part of the length, if it is as stiff as from II to III."""
    moved = hypot(*(a - b for a, b in zip(free.tip_mm, held.tip_mm, strict=True)))
    force = MOVED * length * hypot(*held.force_N) / moved
    x, y = (float(f"{force * component:.3g}") for component in direction)
    return x, y


def _row(record: Record) -> Row:
    curve, force = record.centreline, record.load.force
    tip = float(curve.x[-1] - curve.x[0]), float(curve.y[-1] - curve.y[0])
    return Row(
        record.experiment, record.pressure_kPa, tip, degrees(curve.end_angle), (float(force[0]), float(force[1]))
    )


def _cpu_seconds() -> float:
    used = getrusage(RUSAGE_SELF)
    return used.ru_utime + used.ru_stime
