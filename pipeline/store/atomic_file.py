"""Files are written whole or not at all: beside their place, flushed to the disk, then renamed."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_PREFIX = ".pneurod-part-"


def write_whole(path: Path, content: bytes) -> None:
    """Make `path` a file with this content. Raises OSError, which names `path`; the old file stays then."""
    with beside(path) as place:
        place.write_bytes(content)


@contextmanager
def beside(path: Path) -> Iterator[Path]:
    """Where to write what becomes `path` at the end of the block; it has the same suffix.

    Raises OSError, which names `path`; the old file stays then.
    """
    place = None
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=_PREFIX, suffix=path.suffix)
        place = Path(name)
        os.close(handle)
        yield place
        _flush(place)
        os.chmod(place, 0o644)
        os.replace(place, path)
    except OSError as failure:
        _forget(place)
        raise OSError(failure.errno, failure.strerror or str(failure), str(path)) from failure
    except BaseException:
        _forget(place)
        raise


def left_over(folder: Path) -> Iterator[Path]:
    """The files below `folder` that a killed process had begun to write."""
    yield from folder.rglob(f"{_PREFIX}*")


def _flush(place: Path) -> None:
    handle = os.open(place, os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _forget(place: Path | None) -> None:
    if place is not None:
        place.unlink(missing_ok=True)
