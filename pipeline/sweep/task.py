"""What is sent to a worker for one point. Small: the numerical libraries are loaded on the worker, with one thread."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.config.config import Config
from pipeline.processes import THREADS

if TYPE_CHECKING:
    from pipeline.sweep.record import PointRecord


@dataclass(frozen=True)
class PointTask:
    """One point and what is to be done on it."""

    folder: Path  #: absolute, on a file system that all workers see
    config: Config
    run: tuple[str, ...]  #: as in the file of the sweep
    key: str  #: sha256 of everything that decides the result
    sources_key: str  #: the same of the sources and packages alone, which the worker compares with its own


def solve(task: PointTask) -> "PointRecord":
    """The record of a point; runs on a worker. Raises OSError where the folder cannot be written."""
    os.environ.update(dict.fromkeys(THREADS, "1"))  # read by the libraries when they are loaded

    from pipeline.sweep.work import work_on

    return work_on(task)
