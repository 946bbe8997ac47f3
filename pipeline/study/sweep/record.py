"""What is sent to a worker for one point, and what remains of it: how it ended, why, and its numbers.

Small, for a worker reads it before the numerical libraries are loaded.
"""

from dataclasses import dataclass, field
from pathlib import Path

from pipeline.config.config import Config
from pipeline.store.kept import KeptFile
from pipeline.store.result_folder import ResultFolder
from pipeline.values.json_values import Json

FILE = "sweep_point.json"
#: how a point ended: everything was reached; something was not; nothing was; its configuration is refused
FINISHED, INCOMPLETE, FAILED, REFUSED = "finished", "incomplete", "failed", "refused"
#: of a point that has not ended yet, or whose work was ended from outside; the same command does it
WAITING = "waiting"

#: the numbers of a point at one pressure by column
Row = dict[str, Json]


@dataclass(frozen=True)
class PointTask:
    """One point and what is to be done on it."""

    folder: Path  #: absolute, on a file system that all workers see
    config: Config
    run: tuple[str, ...]  #: as in the file of the sweep
    key: str  #: sha256 of everything that decides the result
    sources_key: str  #: sha256 of the sources and packages alone, which the worker compares with its own

    @property
    def kept(self) -> "KeptFile[PointRecord]":
        """Where its record is kept."""
        return KeptFile(ResultFolder(self.folder), FILE, PointRecord, self.key)


@dataclass(frozen=True)
class PointRecord:
    """The end of the work on a point."""

    status: str  #: one of the words above
    reason: str  #: why not everything was reached, one sentence; empty where it was
    rows: tuple[Row, ...] = field(default=(), repr=False)  #: one per pressure
    seconds: float = 0.0  #: wall time on its worker
