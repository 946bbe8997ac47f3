"""The work on one design in a process of its own: the run, its checks, the confirmation of its limits, a finer mesh.

Its record is kept in its folder after each of these stages, so that none is done twice; the run itself keeps its
states. A stage that needs more CPU time than it may is ended and recorded as too slow.
"""

import faulthandler
import json
import resource
import signal
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
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
from pipeline.store.kept import KeptFile
from pipeline.store.processes import Processes
from pipeline.store.progress import Silent
from pipeline.store.provenance import provenance
from pipeline.store.result_folder import ResultFolder
from pipeline.store.state_key import ALL_SOURCES, result_key
from pipeline.study.study import Study
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.reasons import render_all

Record = dict[str, Any]

#: CPU seconds of the run, and of each of the other stages
LIMIT = 600.0
#: wall seconds over all CPU seconds after which a process ends that does not use any, and the file that says where
PATIENCE, HUNG = 15.0, "hung.txt"
#: the record of a design: complete, and while it is worked on
FILE, STAGES = "outcome.json", "stages.json"
#: how the run of a design ended
RAN, REFUSED, FAILED, ERROR, SLOW = "ran", "refused", "failed", "error", "too slow"


class _TooSlow(BaseException):
    """The CPU time of a stage is used up; no handler of the program catches it."""


@dataclass(frozen=True)
class Work:
    """What is to be done for a design."""

    design: Drawn
    folder: Path
    limit: float  #: CPU seconds of each stage
    finer: bool  #: whether it is solved on a finer mesh too

    @property
    def kept(self) -> KeptFile[Record]:
        """Where its complete record is kept."""
        return self._file(FILE, "finer" if self.finer else "")

    @property
    def stages(self) -> KeptFile[Record]:
        """Where the record of its finished stages is kept."""
        return self._file(STAGES, "")

    def _file(self, name: str, which: str) -> KeptFile[Record]:
        """A file with a key of what decides the record besides this program."""
        decides = json.dumps([self.design.document, which], sort_keys=True)
        return KeptFile(ResultFolder(self.folder), name, Record, result_key(decides, ALL_SOURCES))


def outcome_of(work: Work) -> Record:
    """The record of a design: that in its folder, or that of the work on it in another process."""
    return next(outcomes_of([work], 1))


def outcomes_of(works: Sequence[Work], jobs: int) -> Iterator[Record]:
    """The records of designs, each as soon as it is complete; `jobs` are worked on at the same time, each in a process
    of its own with one thread. Those that are complete in their folders are not worked on."""
    with Processes(jobs, is_fresh=True) as processes:
        study = Study(works, work_on, processes, lambda work: work.kept)
        yield from (record for _, record in study.kept)
        yield from (record for _, record in study.solve(lambda _: None, lambda *_: "", lost))


def lost(work: Work, failure: Exception) -> Record:
    """The record of a design whose process was ended."""
    hung = work.folder / HUNG
    ended = SLOW if hung.is_file() and hung.stat().st_size else ERROR
    record = (work.stages.read() or _begun(work.design)) | {"ended": ended, "reason": str(failure)}
    work.kept.save(record)
    return record


def _begun(design: Drawn) -> Record:
    return {
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
        "seconds": {},
        "states": [],
        "checks": [],
        "limits": [],
        "slow": [],
    }


def work_on(work: Work) -> Record:
    """The record after all stages that are not finished in the folder; runs in the process of the design."""
    with (ResultFolder(work.folder).path(HUNG)).open("w") as hung:
        faulthandler.dump_traceback_later(PATIENCE * work.limit, exit=True, file=hung)
        return _worked(work)


def _worked(work: Work) -> Record:
    design, folder, limit = work.design, work.folder, work.limit
    record = work.stages.read() or _begun(design)
    document = json.dumps(design.document, indent=1) + "\n"  # JSON is YAML
    ResultFolder(folder).save_text("drawn.yaml", document)
    solved: SolvedRun | None = None
    try:
        with _timed(record, "run", limit):
            config = load_config(folder / "drawn.yaml")
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
    work.stages.save(record)
    if solved is not None:
        _stages_after(record, solved, work)
    work.kept.save(record)
    return record


def _stages_after(record: Record, solved: SolvedRun, work: Work) -> None:
    """Checks, limits and the finer mesh, each within its own time."""
    config, outcomes, folder, limit = solved.config, solved.outcomes, work.folder, work.limit
    ended = [outcome for outcome in outcomes if outcome.failure]
    if not record["checks"]:
        reached = outcomes["II"].records, outcomes["III"].records
        _stage(record, "checks", limit, lambda: [asdict(c) for c in checks_of(config, *reached, folder)])
        work.stages.save(record)
    if ended and not record["limits"]:
        # the limit of II says most about the others (`fem` searches it first), so it is confirmed if there is one
        first = next((outcome for outcome in ended if outcome.name == "II"), ended[0])
        _stage(record, "limits", limit, lambda: [asdict(confirmed(config, first, folder))])
        work.stages.save(record)
    if work.finer and "finer" not in record:
        record["finer"] = {"failure": "not finished"}
        _stage(record, "finer", 2.0 * limit, lambda: against_finer_mesh(solved))
        work.stages.save(record)


def _stage(record: Record, name: str, limit: float, work: Callable[[], Any]) -> None:
    """Do a part of the work, and note what stops it."""
    try:
        with _timed(record, name, limit):
            made = work()
            json.dumps(made, allow_nan=False)  # raises ValueError where a number is none
            record[name] = made
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
        "turn_rad": first.kappa_0.middle * config.design.length if first else None,
        "estimated": dict(first.mesh_errors) if first else {},
    }
