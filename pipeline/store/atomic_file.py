"""Files are written completely or not at all: to a temporary file in the same folder, flushed to the disk, renamed."""

import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

_PREFIX = ".pneurod-part-"


def write_atomic(path: Path, content: bytes) -> None:
    """Make `path` a file with this content. Raises OSError, which names `path`; the old file stays then."""
    with replacing(path) as part:
        part.write_bytes(content)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Temporary path in the folder of `path`, with its suffix; on success flushed and atomically renamed to `path`.

    Raises OSError, which names `path`; the old file stays then.
    """
    part = None
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=_PREFIX, suffix=path.suffix)
        part = Path(name)
        os.close(handle)
        yield part
        _flush(part)
        os.chmod(part, 0o644)
        os.replace(part, path)
    except OSError as failure:
        _remove(part)
        raise OSError(failure.errno, failure.strerror or str(failure), str(path)) from failure
    except BaseException:
        _remove(part)
        raise


def remove_parts(folders: Iterable[Path]) -> None:
    """Remove the temporary files in these folders that a killed process has left."""
    for folder in folders:
        for part in folder.glob(f"{_PREFIX}*"):
            part.unlink(missing_ok=True)


def _flush(part: Path) -> None:
    handle = os.open(part, os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _remove(part: Path | None) -> None:
    if part is not None:
        part.unlink(missing_ok=True)
