"""The result directory: whole files only, and what is finished is remembered.

A killed run leaves old files or new ones, never halves. Converged states are kept under `states/` with a key made of
the configuration, of the sources that computed them and of the packages these stand on; a state with another key is
never used again.
"""

import csv
import fcntl
import hashlib
import io
import json
import math
import os
import shutil
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pipeline.config.config import Config
from pipeline.errors import InputError
from pipeline.store.atomic_file import left_over, write_whole
from pipeline.store.provenance import installed, pinned

_IDENTITY = "states/configuration.json"
#: what decides a converged state, and what decides the numbers read from states: folders with all that is below them
_SOURCES = ("geometry", "fem", "pipeline/simulation")
_ALL_SOURCES = ("geometry", "fem", "rod", "pipeline")
_FOLDERS = ("states", "pictures", "fields", "rungs")
_FILES = (
    *("parameters.json", "experiments.json", "validation.json", "effects.json", "run.json", "laws.json"),
    *("curves.csv", "validation_curves.csv", "mesh.vtu", "report.html", "I.pvd", "II.pvd", "III.pvd"),
    *("accuracy.json", "accuracy.html", "accuracy.svg"),
)


@dataclass(frozen=True)
class Store:
    """A result directory that belongs to one configuration. It may be sent to worker processes."""

    directory: Path
    key: str  #: sha256 of the configuration, of the sources that decide a state, and of the packages' versions
    numbers_key: str = ""  #: the same with the sources that decide the numbers read from states

    def path(self, name: str) -> Path:
        """Where the file `name` (relative, "/" between folders) stands; its folder is made."""
        path = self.directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def save_json(self, name: str, value: Any) -> None:
        """Write `value` as JSON. Arrays become lists; NaN and infinity become null, which JSON can hold."""
        text = json.dumps(_plain(value), indent=2, allow_nan=False) + "\n"
        write_whole(self.path(name), text.encode())

    def save_rows(self, name: str, columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
        """Write a CSV table with a header line; floats keep all their digits, NaN is an empty cell."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([["" if cell is None else cell for cell in map(_plain, row)] for row in rows])
        write_whole(self.path(name), text.getvalue().encode())

    def save_text(self, name: str, text: str) -> None:
        """Write a text file in UTF-8."""
        write_whole(self.path(name), text.encode())

    def read_json(self, name: str) -> Any:
        """What `save_json` wrote, or None where there is no such file."""
        path = self.directory / name
        return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None

    def save_state(self, experiment: str, pressure_kPa: float, **arrays: ArrayLike) -> None:
        """Remember a converged state: numbers, texts and arrays of numbers by name."""
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **{"state_key": np.array(self.key), **arrays})
        write_whole(self.path(_state_name(experiment, pressure_kPa)), buffer.getvalue())

    def load_state(self, experiment: str, pressure_kPa: float) -> dict[str, NDArray[Any]] | None:
        """The arrays of a remembered state, or None where there is none for this configuration and these sources."""
        try:
            path = self.directory / _state_name(experiment, pressure_kPa)
            with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
                arrays = {name: stored[name] for name in stored.files}
        except (OSError, ValueError, EOFError, zipfile.BadZipFile):
            return None
        return arrays if str(arrays.pop("state_key", "")) == self.key else None


@contextmanager
def open_store(directory: Path | str, config: Config, *, fresh: bool = False) -> Iterator[Store]:
    """The result directory for `config`, made if it is missing and held against other runs until the block ends.

    `fresh` first removes what earlier runs left in it. Raises InputError with one sentence when the directory cannot
    be written, when another run is at work in it, or when it holds the results of another configuration.
    """
    place = Path(directory)
    _check_writable(place)
    with _held(place):
        for left in left_over(place):
            left.unlink(missing_ok=True)  # a worker of the killed run may still be ending
        if fresh:
            _clear(place)
        _check_owner(place, config)
        store = Store(place, _key(config, _SOURCES), _key(config, _ALL_SOURCES))
        store.save_json(_IDENTITY, {"config_hash": config.hash, "config": config.record()})
        yield store


def open_folder(directory: Path | str) -> Store:
    """A folder, made if it is missing, for results that take no time worth remembering and replace earlier ones.

    Raises InputError when it cannot be written.
    """
    place = Path(directory)
    _check_writable(place)
    return Store(place, "")


def _check_writable(place: Path) -> None:
    try:
        place.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            pass
    except OSError as failure:
        reason = failure.strerror or str(failure)
        raise InputError(f"--out {place}: cannot be written ({reason}); give a folder you may write to") from None


@contextmanager
def _held(place: Path) -> Iterator[None]:
    handle = os.open(place, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise InputError(f"--out {place}: another run is at work in it; wait for it or give another --out") from None
    try:
        yield
    finally:
        os.close(handle)


def _check_owner(place: Path, config: Config) -> None:
    """Refuse a folder that holds something else: results of another configuration, or files of the user."""
    try:
        owner = json.loads((place / _IDENTITY).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return
    except (OSError, ValueError):
        owner = {}
    if owner.get("config_hash") != config.hash:
        raise InputError(
            f"--out {place}: holds the results of another configuration; give another --out, or --fresh to replace them"
        )


def _clear(place: Path) -> None:
    """Remove what an earlier run left in `place`, and nothing else."""
    if not (place / _IDENTITY).is_file():
        return
    for name in _FILES:
        (place / name).unlink(missing_ok=True)
    for name in _FOLDERS:
        shutil.rmtree(place / name, ignore_errors=True)


def _state_name(experiment: str, pressure_kPa: float) -> str:
    return f"states/{experiment}_{pressure_kPa:.12g}kPa.npz"


def source_files(names: Sequence[str]) -> list[Path]:
    """The Python files of the named folders (with all folders below) and files, relative to the folder of the rooms.

    Raises FileNotFoundError for a name without any: a key that forgets sources would use states of other sources.
    """
    rooms = Path(__file__).resolve().parents[2]
    found: list[Path] = []
    for name in names:
        below = sorted((rooms / name).rglob("*.py")) if (rooms / name).is_dir() else [rooms / name]
        if not below or not all(path.is_file() for path in below):
            raise FileNotFoundError(f"no Python source at {rooms / name}")
        found += below
    return found


def _key(config: Config, sources: Sequence[str]) -> str:
    digest = hashlib.sha256(config.hash.encode())
    for source in source_files(sources):
        digest.update(source.read_bytes())
    digest.update(repr(sorted((name, installed(name)) for name in pinned())).encode())
    return digest.hexdigest()


def _plain(value: Any) -> Any:
    """`value` in the types JSON has."""
    if isinstance(value, Mapping):
        return {str(name): _plain(item) for name, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
