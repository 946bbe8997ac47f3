"""The result directory of a run: it belongs to one configuration, and finished states are stored in it.

Converged states stand under `states/` with a key made of the configuration, of the sources that computed them and of
the packages these use; a state with another key is never used again.
"""

import io
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from filelock import FileLock, Timeout
from numpy.typing import ArrayLike, NDArray

from pipeline.store.atomic_file import remove_parts, write_atomic
from pipeline.store.owner import RUN, claim
from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.store.state_key import NUMBER_SOURCES, STATE_SOURCES, result_key
from pipeline.values.errors import InputError, argument
from pipeline.values.json_values import JsonObject
from pipeline.values.pressure import name_of_state

_LOCK = ".pneurod-lock"  #: there while a run is at work, and after one that was killed, whose lock the system releases


class Configuration(Protocol):
    """What a result directory belongs to."""

    @property
    def hash(self) -> str:
        """Equal for configurations with equal results."""
        ...

    def record(self) -> JsonObject:
        """Everything that decides the results."""
        ...


@dataclass(frozen=True)
class Store(ResultFolder):
    """A result directory that belongs to one configuration. It may be sent to worker processes."""

    key: str  #: sha256 of the configuration, of the sources that decide a state, and of the packages' versions
    numbers_key: str  #: the same with the sources that decide the numbers computed from states

    def save_state(self, experiment: str, pressure_kPa: float, **arrays: ArrayLike) -> None:
        """Store a converged state: numbers, texts and arrays of numbers by name."""
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **{"state_key": np.array(self.key), **arrays})
        write_atomic(self.path(_state_file(experiment, pressure_kPa)), buffer.getvalue())

    def load_state(self, experiment: str, pressure_kPa: float) -> dict[str, NDArray[Any]] | None:
        """The arrays of a stored state, or None where there is none for this configuration and these sources."""
        try:
            path = self.directory / _state_file(experiment, pressure_kPa)
            with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
                arrays = {name: stored[name] for name in stored.files}
        except (OSError, ValueError, EOFError, zipfile.BadZipFile):
            return None
        return arrays if str(arrays.pop("state_key", "")) == self.key else None


@contextmanager
def open_store(directory: Path | str, config: Configuration, *, fresh: bool | None = False) -> Iterator[Store]:
    """The result directory for `config`, made if it is missing and locked against other runs until the block ends.

    fresh: as in `claim`. Raises InputError as `claim` does, and where another run is at work in it.
    """
    folder = open_folder(directory).directory
    with locked(folder):
        own = [folder, *(folder / name for name in RUN.folders)]  # others below may belong to other runs
        remove_parts(own)  # a worker of a killed run may still be ending
        claim(folder, RUN, {"config_hash": config.hash}, fresh=fresh)
        keys = (result_key(config.hash, sources) for sources in (STATE_SOURCES, NUMBER_SOURCES))
        store = Store(folder, *keys)
        store.save_json(RUN.mark, {"config_hash": config.hash, "config": config.record()})
        try:
            yield store
        finally:
            with suppress(OSError):
                remove_parts(own)  # of workers that were ended while they wrote


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder until the block ends. Raises InputError where one is at work in it."""
    lock = FileLock(folder / _LOCK, blocking=False)
    try:
        lock.acquire()
    except Timeout:
        remedy = f"wait for it or give another {argument('out')}"
        raise InputError(f"{argument('out', folder)}: another run is at work in it; {remedy}") from None
    try:
        yield
    finally:
        with suppress(OSError):  # Windows keeps a file that is open
            (folder / _LOCK).unlink()
        lock.release()


def _state_file(experiment: str, pressure_kPa: float) -> str:
    return f"states/{name_of_state(experiment, pressure_kPa)}.npz"
