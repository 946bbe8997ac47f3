"""The result directory of a run: it belongs to one configuration, and finished states are stored in it.

Converged states stand under `states/` with a key made of the configuration, of the sources that computed them and of
the packages these use; a state with another key is never used again.
"""

import io
import json
import shutil
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
from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.store.state_key import NUMBER_SOURCES, STATE_SOURCES, result_key
from pipeline.values.errors import InputError, argument
from pipeline.values.formats import PAIRS_PAGE
from pipeline.values.json_values import JsonObject
from pipeline.values.pressure import name_of_state

_IDENTITY = "states/configuration.json"
_LOCK = ".pneurod-lock"  #: there while a run is at work, and after one that was killed, whose lock the system releases
_FOLDERS = ("states", "pictures", "fields", "rungs", "law", "law_in_space")
_FILES = (
    *("parameters.json", "experiments.json", "validation.json", "effects.json", "run.json"),
    *("curves.csv", "validation_curves.csv", "mesh.vtu", "report.html", "I.pvd", "II.pvd", "III.pvd"),
    *("accuracy.json", "accuracy.html", "law.json", "law_on_mesh_of_arm.json", "effects_table.json"),
)


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
def open_store(directory: Path | str, config: Configuration, *, fresh: bool = False) -> Iterator[Store]:
    """The result directory for `config`, made if it is missing and locked against other runs until the block ends.

    `fresh` first removes what earlier runs left in it. Raises InputError with one sentence
    when the directory cannot be written, when another run is at work in it, or when it holds the results of another
    configuration.
    """
    folder = open_folder(directory).directory
    with locked(folder):
        own = [folder, *(folder / name for name in _FOLDERS)]  # others below may belong to other runs
        remove_parts(own)  # a worker of a killed run may still be ending
        if fresh:
            clear(folder)
        if (folder / PAIRS_PAGE).is_file():
            raise InputError(
                f"{argument('out', folder)}: holds runs at pairs of pressures; give another {argument('out')}"
            )
        check_owner(folder, config, f"give another {argument('out')}, or {argument('fresh', True)} to replace them")
        keys = (result_key(config.hash, sources) for sources in (STATE_SOURCES, NUMBER_SOURCES))
        store = Store(folder, *keys)
        store.save_json(_IDENTITY, {"config_hash": config.hash, "config": config.record()})
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


def check_owner(folder: Path, config: Configuration, remedy: str) -> None:
    """Raise InputError, with the remedy, for a folder that holds the results of another configuration."""
    try:
        owner = json.loads((folder / _IDENTITY).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return
    except (OSError, ValueError):
        owner = {}
    if owner.get("config_hash") != config.hash:
        raise InputError(f"{argument('out', folder)}: holds the results of another configuration or version; {remedy}")


def check_no_run(folder: Path) -> None:
    """Raise InputError for a folder that holds the results of a run."""
    if (folder / _IDENTITY).is_file():
        raise InputError(
            f"{argument('out', folder)}: holds the results of a run with one pressure; give another {argument('out')}"
        )


def clear(folder: Path) -> None:
    """Remove what an earlier run left in `folder`, and nothing else."""
    if not (folder / _IDENTITY).is_file():
        return
    for name in _FILES:
        (folder / name).unlink(missing_ok=True)
    for name in _FOLDERS:
        shutil.rmtree(folder / name, ignore_errors=True)


def _state_file(experiment: str, pressure_kPa: float) -> str:
    return f"states/{name_of_state(experiment, pressure_kPa)}.npz"
