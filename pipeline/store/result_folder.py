"""A folder of result files: JSON, CSV and text, each written completely or not at all."""

import csv
import io
import json
import math
import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from pipeline.store.atomic_file import write_atomic
from pipeline.values.errors import InputError, argument
from pipeline.values.json_values import Json

#: a list without texts, lists and objects in it, over several lines (no text of JSON has a line break); its breaks
_LIST_OF_NUMBERS, _BREAK = re.compile(r'\[\n\s+([^\[\]{}"]+?)\n\s*\]'), re.compile(r"\n\s*")
#: in each folder: what was written at its top, by name with the sha256
MADE = ".pneurod-made"


@dataclass(frozen=True)
class ResultFolder:
    """A folder that results are written to. A killed process leaves old files or new ones, never halves."""

    directory: Path

    def path(self, name: str) -> Path:
        """Where the file `name` (relative, "/" between folders) stands; its folder is made."""
        path = self.directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def save_json(self, name: str, value: Json) -> None:
        """Write `value` as JSON. Arrays become lists; NaN and infinity become null, which JSON can hold."""
        self.save_text(name, json_text(value))

    def save_rows(self, name: str, columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
        """Write a CSV table with a header line; floats keep all their digits, NaN is an empty cell."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([["" if isinstance(c, float) and not math.isfinite(c) else c for c in row] for row in rows])
        self.save_text(name, text.getvalue())

    def save_text(self, name: str, text: str) -> None:
        """Write a text file in UTF-8; one at the top of the folder is noted, so that a change by hand is seen."""
        write_atomic(self.path(name), text.encode())
        if "/" not in name:
            made = {**self._made, name: sha256(text.encode()).hexdigest()}
            write_atomic(self.path(MADE), "".join(f"{one} {key}\n" for key, one in made.items()).encode())

    @property
    def _made(self) -> dict[str, str]:
        try:
            lines = (self.directory / MADE).read_text(encoding="utf-8").splitlines()
        except (OSError, ValueError):
            return {}
        return {name: digest for digest, _, name in (line.partition(" ") for line in lines)}

    def was_made(self, name: str) -> bool | None:
        """Whether a file at the top is there as it was written; False for one that was changed by hand, None for one
        of which nothing is known."""
        if (known := self._made.get(name)) is None:
            return None
        return known == sha256((self.directory / name).read_bytes()).hexdigest()

    def read_json(self, name: str) -> Any:
        """What `save_json` wrote, or None where there is no such file."""
        path = self.directory / name
        return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None


def open_folder(directory: Path | str) -> ResultFolder:
    """A folder, made if it is missing, for results that replace earlier ones.

    Raises InputError when it cannot be written.
    """
    folder = Path(directory)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as failure:
        in_the_way = next((part for part in (folder, *folder.parents) if part.is_file()), None)
        reason = f"{in_the_way} is a file" if in_the_way else failure.strerror or str(failure)
        sentence = f"{argument('out', folder)}: cannot be written ({reason}); give a folder you may write to"
        raise InputError(sentence) from None
    return ResultFolder(folder)


def open_file(file: Path) -> Path:
    """The file that `out` names, ready to be written; its folder is made if it is missing.

    Raises InputError when it cannot be written.
    """
    if file.is_dir():
        raise InputError(f"{argument('out', file)}: is a folder; give a file")
    open_folder(file.parent)
    return file


def json_text(value: Json) -> str:
    """`value` as JSON that ends with a line break. Arrays become lists; NaN and infinity become null.

    A list of numbers has a line of its own, which makes a file of many numbers two fifths smaller.
    """
    from pydantic_core import to_json  # `--help` does not wait for it

    text = to_json(value, indent=2, inf_nan_mode="null", fallback=_plain).decode()
    return _LIST_OF_NUMBERS.sub(lambda found: f"[{_BREAK.sub(' ', found[1])}]", text) + "\n"


def _plain(value: Any) -> Any:
    """What JSON has instead of an array, a number of numpy or a mapping that is no dict."""
    return dict(value) if isinstance(value, Mapping) else value.tolist()
