"""What is refused, row by row: what is given, and what the sentence of the refusal says.

A section of `tests/data/refused/*.txt` begins with `[modules] error`: its rows have the names of these modules, and
each is `expression -> words`. After `[module] error | call` what stands before the arrow is the text `row` of the call,
where `\\n` ends a line, `text_in(NAME)` a file that holds it, and `line(...)` the sentence of a command that ends with
2. A call whose error is `-` returns the sentence. After another bar stands how sentences begin. Words between which
something else stands have ` ... ` between them.
"""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fem
import geometry
import pneurod
import rod
from tests.coarse import COARSE
from tests.commands import refused as refused_command

HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Refused:
    """A row."""

    place: str  #: file and line
    modules: str
    error: str
    call: str
    start: str  #: of its sentence
    given: str
    words: tuple[str, ...]


def rows(file: Path) -> Iterator[Refused]:
    """Those of a file."""
    head: tuple[str, ...] = ()
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        if begun := re.match(r"\[([a-z_., ]+)\] (.*)", line):
            error, call, start, *_ = *(part.strip() for part in begun[2].split(" | ")), "", ""
            head = begun[1], error, call, start
        elif line and not line.startswith("# "):
            given, arrow, words = line.rpartition(" -> ")
            assert arrow, f"{file}:{number} has no arrow"
            yield Refused(f"{file.stem}:{number}", *head, given, tuple(words.split(" ... ")))


def written(folder: Path, text: str, name: str) -> Path:
    """A file with a text."""
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def line(*words: object) -> str:
    """What a command refuses; the last word is a whole row."""
    *before, row = map(str, words)
    return refused_command(*before, *shlex.split(row))


#: names that rows have beside those of their modules
NAMES: dict[str, Any] = {"pneurod": pneurod, "np": np, "replace": replace, "nan": nan, "inf": inf, "Path": Path}
NAMES |= {name: getattr(room, name) for room in (pneurod, rod, fem, geometry) for name in room.__all__}
NAMES |= {"CONFIGS": HERE.parent / "configs", "COARSE": COARSE, "line": line}
ROWS = [row for file in sorted((HERE / "data" / "refused").glob("*.txt")) for row in rows(file)]


@pytest.mark.filterwarnings("ignore::pneurod.RodWarning")
@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.place)
def test_what_cannot_be_meant_is_refused(row: Refused, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """In one sentence; nothing is printed, as libraries in C do, and nothing is written to the folder of results."""
    names = dict(NAMES)
    for module in row.modules.split(", "):
        names |= vars(import_module(module))
    given = row.given.replace("\\n", "\n")
    names |= {"tmp_path": tmp_path, "row": given, "text_in": partial(written, tmp_path, given)}
    call = row.call or row.given
    if row.error == "-":
        sentence, lines = str(eval(call, names)), 1
    else:
        with pytest.raises(eval(row.error, names)) as refused:
            eval(call, names)
        sentence, lines = str(refused.value), len(getattr(refused.value, "sentences", "1"))
    assert len(sentence.splitlines()) == lines
    begin = rf"^{re.escape(row.start.format(tmp_path=tmp_path))} ?" if row.start else ""
    assert re.search(begin + ".*".join(map(re.escape, row.words)), sentence, re.MULTILINE), sentence
    assert all(row.words)
    assert capfd.readouterr() == ("", "")
    assert not (tmp_path / "out").exists()


def test_no_row_stands_twice() -> None:
    given = [(row.modules, row.error, row.call, row.given) for row in ROWS]
    assert len(set(given)) == len(given) > 200
