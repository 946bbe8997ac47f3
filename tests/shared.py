"""Folders that are made once in a run of the tests, for all of its processes.

Tests read them. A test that changes a folder takes a copy; one that did not is found when its process ends.
"""

import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from filelock import FileLock


@dataclass(frozen=True)
class SharedFolders:
    """Those of a run of the tests, below one folder."""

    root: Path
    used: set[str] = field(default_factory=set)

    def folder(self, name: str, make: Callable[[Path], object]) -> Path:
        """The folder `name`, as `make` filled it in the first process that asked for it."""
        self.root.mkdir(exist_ok=True)
        folder, record = self.root / name, self._record(name)
        with FileLock(self.root / f"{name}.lock"):
            if not record.exists():
                shutil.rmtree(folder, ignore_errors=True)  # of a process that could not finish it
                folder.mkdir()
                make(folder)
                record.write_text(json.dumps(_content(folder)), encoding="utf-8")
        self.used.add(name)
        return folder

    def changed(self) -> list[str]:
        """Names of files of the folders that were used here which are no longer as they were made."""
        found = []
        for name in sorted(self.used):
            made = json.loads(self._record(name).read_text(encoding="utf-8"))
            now = _content(self.root / name)
            found += [f"{name}/{file}" for file in sorted({*made, *now}) if made.get(file) != now.get(file)]
        return found

    def _record(self, name: str) -> Path:
        return self.root / f"{name}.json"


def _content(folder: Path) -> dict[str, list[int]]:
    """Size and time of change of every file below a folder."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): [path.stat().st_size, path.stat().st_mtime_ns] for path in files}
