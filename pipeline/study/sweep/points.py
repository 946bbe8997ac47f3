"""A point of a study: its values, its configuration and its folder; and how the work on it ended.

Small, for a worker reads it before the numerical libraries are loaded.
"""

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from pipeline.config.config import Config
from pipeline.store.kept import KeptFile
from pipeline.store.result_folder import ResultFolder
from pipeline.store.state_key import program_key
from pipeline.values.json_values import Json, Written

#: the folder of the points, and the file in the folder of each that keeps its result
POINTS, FILE = "points", "sweep_point.json"
#: how a point ended: everything was reached; something was not; nothing was; its configuration is refused
FINISHED, INCOMPLETE, FAILED, REFUSED = "finished", "incomplete", "failed", "refused"
#: of a point that has not ended yet, or whose work was ended from outside; the same command does it
WAITING = "waiting"
#: characters of the values in the name of a folder
LONGEST_NAME = 60

#: the values of some keys at one point, by dotted key
Setting: TypeAlias = Mapping[str, Written]
#: the numbers of a point at one pressure by column
Row = dict[str, Json]


def switch_as_word(value: Written) -> Written:
    """on or off for a switch, as it is written in a file, which YAML reads as true or false; else the value itself."""
    return {True: "on", False: "off"}[value] if isinstance(value, bool) else value


@dataclass(frozen=True)
class PointResult:
    """How the work on a point ended, as in sweep.json."""

    status: str  #: one of the words above
    reason: str = ""  #: why not everything was reached, one sentence; empty where it was
    rows: tuple[Row, ...] = field(default=(), repr=False)  #: one per pressure
    seconds: float = 0.0  #: wall time on its worker
    number: int = 0  #: of the point
    folder: str = ""  #: relative to that of the study; empty for a refused point
    values: Setting = field(default_factory=dict)  #: of the point


@dataclass(frozen=True)
class Point:
    """A design of a study and what is to be done on it. It is sent to a worker."""

    number: int  #: from 1 on, in the order of the axes
    setting: Setting  #: the values of the axes
    config: Config
    run: tuple[str, ...]  #: as in the file of the sweep
    out: Path  #: folder of the study, absolute, on a file system that all workers see
    #: sha256 of the sources and packages, which the worker compares with its own
    program: str = field(default_factory=program_key)

    @property
    def name(self) -> str:
        """The name of its folder: its values, and a part of the hash of its configuration.

        It does not depend on the other points, so that a sweep with more points keeps the folders of the earlier ones.
        """
        values = "_".join(f"{key.rpartition('.')[2]}={switch_as_word(value)}" for key, value in self.setting.items())
        readable = re.sub(r"[^A-Za-z0-9.=+_-]", "", values)[:LONGEST_NAME]
        return f"{readable}_{self.config.hash[:8]}"

    @property
    def folder(self) -> Path:
        """Where its files are."""
        return self.out / POINTS / self.name

    @property
    def kept(self) -> KeptFile[PointResult]:
        """Where its result is kept, with what decides it: sources and packages, configuration, and what is run."""
        decides = "|".join((self.program, self.config.hash, *["draft"] * self.config.draft, *self.run))
        return KeptFile(ResultFolder(self.folder), FILE, PointResult, hashlib.sha256(decides.encode()).hexdigest())
