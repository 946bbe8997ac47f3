"""What remains of a point: how it ended, why, and its numbers; kept in its folder as sweep_point.json."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pipeline.store.json_values import JsonObject
from pipeline.store.result_folder import ResultFolder
from pipeline.sweep.numbers import Row

FILE = "sweep_point.json"
#: how a point ended: everything was reached; something was not; nothing was; its configuration is refused; its work
#: was ended from outside and is done again by the same command
FINISHED, INCOMPLETE, FAILED, REFUSED, INTERRUPTED = "finished", "incomplete", "failed", "refused", "interrupted"
#: of a point that has not ended yet
WAITING = "waiting"


@dataclass(frozen=True)
class PointRecord:
    """The end of the work on a point."""

    status: str  #: one of the words above
    reason: str  #: why not everything was reached, one sentence; empty where it was
    rows: tuple[Row, ...] = field(default=(), repr=False)  #: one per pressure
    seconds: float = 0.0  #: wall time on its worker

    @property
    def is_final(self) -> bool:
        """Whether the same work would end in the same way again, so that it is not repeated."""
        return self.status in (FINISHED, INCOMPLETE, FAILED)

    def save(self, folder: ResultFolder, key: str) -> None:
        """Keep it in the folder of the point. Raises OSError."""
        content: JsonObject = {
            "key": key,
            "status": self.status,
            "reason": self.reason,
            "seconds": self.seconds,
            "rows": self.rows,
        }
        folder.save_json(FILE, content)


def kept_record(folder: ResultFolder, key: str) -> PointRecord | None:
    """The record of the same work that is kept in a folder; None where there is none, or one that cannot be read."""
    try:
        content = folder.read_json(FILE)
    except (OSError, ValueError):
        return None
    if not isinstance(content, Mapping) or content.get("key") != key:
        return None
    return _record(content)


def _record(content: Mapping[str, Any]) -> PointRecord:
    return PointRecord(content["status"], content["reason"], tuple(content["rows"]), content["seconds"])
