"""The other files that a mesh file needs: formats that part points, elements or numbers from each other."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree

#: suffixes of files that are read together, whichever of them is named (TetGen)
PAIRS = {".node": ".ele", ".ele": ".node"}
#: a line of an Abaqus file that reads another one
_INCLUDE = re.compile(r"\s*\*include\s*,[^=]*=\s*\"?(.+?)\"?\s*$", re.IGNORECASE)


def companions(path: Path) -> tuple[Path, ...]:
    """The files that are read besides `path`, those included by included ones too; only those that exist."""
    files: list[Path] = []
    waiting = [path]
    while waiting:
        for other in _named_in(waiting.pop()):
            if other.is_file() and not any(other.samefile(known) for known in (path, *files)):
                files.append(other)
                waiting.append(other)
    return tuple(files)


def _named_in(path: Path) -> Iterator[Path]:
    suffix = path.suffix.lower()
    if suffix in PAIRS:
        yield path.parent / (path.stem + PAIRS[suffix])
    elif suffix in _REFERENCES:
        yield from _REFERENCES[suffix](path)


def _of_xdmf(path: Path) -> Iterator[Path]:
    """The files with the numbers; nothing where the file is no XML, which reading it says."""
    try:
        items = list(ElementTree.parse(path).iter("DataItem"))
    except ElementTree.ParseError:
        return
    for item in items:
        text = (item.text or "").strip()
        if item.get("Format") == "HDF":  # name of the file, colon, place in it
            yield path.resolve().parent / text.rpartition(":")[0]
        elif item.get("Format") == "Binary":
            yield Path(text)


def _of_abaqus(path: Path) -> Iterator[Path]:
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        other = included(path, line)
        if other is not None:
            yield other


def included(path: Path, line: str) -> Path | None:
    """The file that a line of the Abaqus file `path` reads; None for any other line."""
    match = _INCLUDE.match(line)
    if match is None:
        return None
    other = Path(match.group(1))
    return other if other.exists() else path.parent / other


_REFERENCES: dict[str, Callable[[Path], Iterator[Path]]] = {".xdmf": _of_xdmf, ".xmf": _of_xdmf, ".inp": _of_abaqus}
