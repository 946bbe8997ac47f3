"""What is sent to a worker for one point, and what remains of it: how it ended, why, and its numbers.

Small, for a worker reads it before the numerical libraries are loaded.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from pipeline.config.config import Config
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


@dataclass(frozen=True)
class PointRecord:
    """The end of the work on a point."""

    status: str  #: one of the words above
    reason: str  #: why not everything was reached, one sentence; empty where it was
    rows: tuple[dict[str, Any], ...] = field(default=(), repr=False)  #: `Row`, one per pressure
    seconds: float = 0.0  #: wall time on its worker

    def save(self, folder: ResultFolder, key: str) -> None:
        """Keep it in the folder of the point. Raises OSError."""
        folder.save_json(FILE, {"key": key, **asdict(self)})


_RECORD = TypeAdapter(PointRecord)


def kept_record(folder: ResultFolder, key: str) -> PointRecord | None:
    """The record of the same work that is kept in a folder; None where there is none, or one that cannot be read."""
    try:
        content = folder.read_json(FILE)
        is_kept = isinstance(content, Mapping) and content.get("key") == key
        return _RECORD.validate_python(content) if is_kept else None
    except (OSError, ValueError):
        return None
