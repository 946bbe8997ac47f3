"""What a stored state depends on beside its configuration: the sources that compute it and the packages they use."""

import hashlib
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from pipeline.store.provenance import installed, required

#: what decides a converged state: files, and folders with all that is below them
STATE_SOURCES = (
    *("geometry", "fem", "pipeline/values/pressure.py"),
    *(f"pipeline/simulate/{name}.py" for name in ("case_path", "known_limit", "loadcase", "scene", "simulate")),
)
#: what decides the curves of a cell, and the numbers that a mesh is planned with
NUMBER_SOURCES = (
    *(*STATE_SOURCES, "rod"),
    *(f"pipeline/simulate/{name}.py" for name in ("mass", "outcome", "records", "too_short")),
    *("pipeline/study/accuracy", "pipeline/law", "pipeline/identify"),
    *("pipeline/values/richardson.py", "pipeline/results/laws.py", "pipeline/results/unloaded.py"),
)
#: what decides a picture besides the states
PICTURE_SOURCES = ("pipeline/show/drawing.py", "pipeline/show/pictures.py")
#: the whole program, with all its sentences
ALL_SOURCES = ("geometry", "fem", "rod", "pipeline")


def result_key(config_hash: str, sources: Sequence[str]) -> str:
    """sha256 of a configuration's hash, of the sources and of the versions of the packages."""
    digest = hashlib.sha256(config_hash.encode())
    for source in source_files(sources):
        digest.update(source.read_bytes())
    digest.update(repr(sorted((name, installed(name)) for name in required())).encode())
    return digest.hexdigest()


@cache
def program_key() -> str:
    """sha256 of all sources and of the versions of the packages, when this process first asks for it."""
    return result_key("", ALL_SOURCES)


def source_files(names: Sequence[str]) -> list[Path]:
    """The Python files of the named folders (with all folders below) and files, relative to the folder of the rooms.

    Raises FileNotFoundError for a name without any: a key that forgets sources would use states of other sources.
    """
    rooms = Path(__file__).resolve().parents[2]
    files: list[Path] = []
    for name in names:
        below = sorted((rooms / name).rglob("*.py")) if (rooms / name).is_dir() else [rooms / name]
        if not below or not all(path.is_file() for path in below):
            raise FileNotFoundError(f"no Python source at {rooms / name}")
        files += below
    return files
