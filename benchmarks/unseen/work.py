"""The work on one design in a process of its own: the run, its checks, the confirmation of its limits, a finer mesh.

Its record is kept in its folder after each of these stages, so that none is done twice; the run itself keeps its
states. A stage that needs more CPU time than it may is ended and recorded as too slow.
"""

import json
import resource
import signal
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from multiprocessing.connection import wait
from multiprocessing.context import SpawnProcess
from pathlib import Path
from time import monotonic
from types import FrameType
from typing import Any

from benchmarks.unseen.checks import checks_of
from benchmarks.unseen.confirm import confirmed
from benchmarks.unseen.designs import Drawn
from benchmarks.unseen.finer import against_finer_mesh
from pipeline.config.load import load_config
from pipeline.results.rod_errors import rod_errors
from pipeline.run import run
from pipeline.stages import SolvedRun
from pipeline.store.atomic_file import write_atomic
from pipeline.store.processes import SPAWN, end_with_main_process
from pipeline.store.progress import Silent
from pipeline.store.provenance import provenance
from pipeline.store.state_key import ALL_SOURCES, result_key
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.reasons import render_all

Record = dict[str, Any]

#: CPU seconds of the run, and of each of the other stages
LIMIT = 600.0
#: wall seconds over all CPU seconds after which a process is ended that does not use any
PATIENCE = 15.0
#: seconds after which processes are looked at that have not ended
PAUSE = 1.0
FILE = "outcome.json"
#: how the run of a design ended
RAN, REFUSED, FAILED, ERROR, SLOW = "ran", "refused", "failed", "error", "too slow"


class _TooSlow(BaseException):
    """The CPU time of a stage is used up; no handler of the program catches it."""


def outcome_of(design: Drawn, folder: Path, limit: float, finer: bool) -> Record:
    """The record of a design: that in its folder, or that of the work on it in another process.

    limit: CPU seconds of each stage.
    """
    return next(outcomes_of([Work(design, folder, limit, finer)], 1))


@dataclass(frozen=True)
class Work:
    """What is to be done for a design."""

    design: Drawn
    folder: Path
    limit: float  #: CPU seconds of each stage
    finer: bool  #: whether it is solved on a finer mesh too

    def complete_record(self) -> Record | None:
        """The record in its folder if nothing is left to do, else None."""
        record = kept(self.folder, _key(self.design))
        if record is None or not record["finished"]:
            return None
        return None if self.finer and "finer" not in record and record["ended"] == RAN else record

    def started(self) -> SpawnProcess:
        """The process that does it."""
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / "design.yaml"
        path.write_text(json.dumps(self.design.document, indent=1) + "\n", encoding="utf-8")  # JSON is YAML
        process = SPAWN.Process(target=_work, args=(self.design, self.folder, self.limit, self.finer))
        process.start()
        return process

    def record(self, ended_badly: Mapping[str, str]) -> Record:
        """That in its folder; where its process left none that is complete, one with how the process ended."""
        record = kept(self.folder, _key(self.design)) or _begun(self.design)
        if not record["finished"]:
            record |= {**ended_badly, "finished": True}
            _keep(self.folder, record)
        return record


@dataclass(frozen=True)
class _Running:
    work: Work
    process: SpawnProcess
    deadline: float  #: of `monotonic`

    @property
    def is_over(self) -> bool:
        return not self.process.is_alive() or monotonic() > self.deadline

    def ended(self) -> Record:
        """The record after its process has ended, which is killed where it has not."""
        hung = self.process.is_alive()
        if hung:
            self.process.kill()
        self.process.join()
        if hung:
            return self.work.record({"ended": SLOW, "reason": "did not end"})
        return self.work.record({"ended": ERROR, "reason": f"its process ended with status {self.process.exitcode}"})


def outcomes_of(works: Sequence[Work], jobs: int) -> Iterator[Record]:
    """The records of designs, each as soon as it is complete; `jobs` are worked on at the same time, each in a process
    of its own with one thread. Those that are complete in their folders are not worked on."""
    waiting, running = deque(works), list[_Running]()
    while waiting or running:
        while waiting and len(running) < jobs:
            work = waiting.popleft()
            if (record := work.complete_record()) is not None:
                yield record
            else:
                running.append(_Running(work, work.started(), monotonic() + PATIENCE * work.limit))
        wait([entry.process.sentinel for entry in running], PAUSE)
        for entry in [entry for entry in running if entry.is_over]:
            running.remove(entry)
            yield entry.ended()


def _key(design: Drawn) -> str:
    """Of what decides the record besides this program."""
    return result_key(json.dumps(design.document, sort_keys=True), ALL_SOURCES)


def kept(folder: Path, key: str | None = None) -> Record | None:
    """The record in a folder; None where there is none, or one with another key."""
    try:
        record: Record = json.loads((folder / FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return record if key in (None, record.get("key")) else None


def _keep(folder: Path, record: Mapping[str, Any]) -> None:
    write_atomic(folder / FILE, (json.dumps(record, indent=1) + "\n").encode())


def _begun(design: Drawn) -> Record:
    return {
        "key": _key(design),
        "seed": design.seed,
        "number": design.number,
        "family": design.family,
        "law": design.law,
        "words": design.words,
        "sources": provenance()["commit"],
        "load": design.load,
        "pressures_kPa": list(design.pressures_kPa),
        "ended": "",
        "reason": "",
        "finished": False,
        "seconds": {},
        "states": [],
        "checks": [],
        "limits": [],
        "slow": [],
    }


def _work(design: Drawn, folder: Path, limit: float, finer: bool) -> None:
    """All stages that the record in the folder lacks; in the process of the design, which ends with the campaign."""
    end_with_main_process()
    record = kept(folder, _key(design)) or _begun(design)
    solved: SolvedRun | None = None
    try:
        with _timed(record, "run", limit):
            config = load_config(folder / "design.yaml")
            solved = run(config, folder, 1, False, Silent())
            record |= {"ended": RAN, **_of_report(solved)}
    except _TooSlow:
        record |= {"ended": SLOW, "reason": f"the run needed more than {limit:g} s of CPU time"}
    except InputError as refused:
        record |= {"ended": REFUSED, "reason": "; ".join(refused.sentences)}
    except RunFailed as failed:
        record |= {"ended": FAILED, "reason": str(failed)}
    except Exception as error:
        record |= {"ended": ERROR, "reason": f"{type(error).__name__}: {error}"}
        (folder / "error.txt").write_text(traceback.format_exc(), encoding="utf-8")
    _keep(folder, record)
    if solved is not None:
        _stages_after(record, solved, folder, limit, finer)
    record["finished"] = True
    _keep(folder, record)


def _stages_after(record: Record, solved: SolvedRun, folder: Path, limit: float, finer: bool) -> None:
    """Checks, limits and the finer mesh, each within its own time."""
    config, outcomes = solved.config, solved.outcomes
    ended = [outcome for outcome in outcomes if outcome.failure]
    if not record["checks"]:
        reached = outcomes["II"].records, outcomes["III"].records
        _stage(record, "checks", limit, lambda: [asdict(c) for c in checks_of(config, *reached, folder)])
        _keep(folder, record)
    if ended and not record["limits"]:
        # the limit of II says most about the others (`fem` searches it first), so it is confirmed if there is one
        first = next((outcome for outcome in ended if outcome.name == "II"), ended[0])
        _stage(record, "limits", limit, lambda: [asdict(confirmed(config, first, folder))])
        _keep(folder, record)
    if finer and "finer" not in record:
        record["finer"] = {"failure": "not finished"}
        _stage(record, "finer", 2.0 * limit, lambda: against_finer_mesh(solved))


def _stage(record: Record, name: str, limit: float, work: Callable[[], Any]) -> None:
    """Do a part of the work, and note what stops it."""
    try:
        with _timed(record, name, limit):
            record[name] = work()
    except _TooSlow:
        record["slow"] = sorted({*record["slow"], name})
    except Exception as error:
        record.setdefault("broken", {})[name] = f"{type(error).__name__}: {error}"


@contextmanager
def _timed(record: Record, stage: str, limit: float) -> Iterator[None]:
    """Count the CPU seconds of a stage, and end it by `_TooSlow` after `limit` of them."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise _TooSlow

    signal.signal(signal.SIGPROF, stop)
    begin = _cpu_seconds()
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        # a run that is repeated for a stage after it finds its states, and takes less than the first time
        record["seconds"][stage] = max(_cpu_seconds() - begin, record["seconds"].get(stage, 0.0))


def _cpu_seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def _of_report(solved: SolvedRun) -> Record:
    """What the sorting and the table need of a run."""
    config, outcomes = solved.config, solved.outcomes
    states = [
        {"experiment": outcome.name, "pressure_kPa": pressure, "reached": outcome.at(pressure) is not None}
        for outcome in outcomes
        for pressure in config.pressures_kPa
    ]
    reasons = {outcome.name: outcome.failure.codes for outcome in outcomes if outcome.failure}
    errors = rod_errors(solved.results)
    first = solved.parameters[0] if solved.parameters else None
    return {
        "elements": config.mesh.formulation,
        "size_mm": config.mesh.size_mm,
        "unknowns": outcomes.degrees_of_freedom,
        "states": states,
        "reasons": reasons,
        "other_failures": [why.text for why in solved.results.failures if why.code != "stopped"],
        "five_at_kPa": [parameters.pressure_kPa for parameters in solved.parameters],
        "has_arm_law": solved.arm.law is not None,
        "why_no_arm_law": "" if solved.arm.law is not None else render_all(solved.arm.reasons),
        "remarks": [remark.text for remark in solved.results.remarks],
        "rod": asdict(errors[0]) if errors else None,
        "turn_rad": first.kappa_0_middle * config.design.length if first else None,
        "estimated": dict(first.mesh_errors) if first else {},
    }
