"""The file of an arm that was measured: columns with their units, in any order, as spreadsheets write them."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pipeline.answers.columns import Column, Columns, Form, Values, plain, read
from pipeline.answers.measured.motions import told_of_motions
from pipeline.answers.measured.rows import (
    COLUMNS,
    NUMBERS,
    OF_DISPLACEMENTS,
    OF_TIP,
    QUANTITIES,
    TEXTS,
    Measurements,
    Row,
    State,
)
from pipeline.values.errors import InputError, ask, quoted
from rod.weight import gravity_direction

EXAMPLE = "a line of titles names columns with their units, for example 'pressure_kPa, tip_x_mm, tip_y_mm'"
#: columns that some columns need
NEEDED = (("s", "x", "y"), ("s", "x", "y")), (("held_y",), ("reaction",)), (("reaction",), ("reaction_zero",))
#: signs before the title of a column whose numbers have the other sign
MINUS = "-−"
#: what titles have that are not known, and what to do with them
CURES = {
    r"^p(ressure)? ?_?\d": "is one of several pressures; give the largest one as pressure_kPa, and --ratio, as 1:0.5",
    r"^(frames?|frame number|image|picture)\b": "counts pictures; divide it by those per second, and name it t_s",
    r"^(d|u|delta) ?[xy]\b|displacement|disp\b": "holds displacements; name it tip_x_mm or tip_y_mm, and add a column "
    f"{OF_DISPLACEMENTS}",
}
#: units of pictures, which pint takes as those of a screen
PIXELS = {"px", "pixel", "pixels"}
MEASURED = Form(
    "a measured arm",
    {
        name: Column(NUMBERS.get(name), f"^[{MINUS}]?{name.replace('_', ' ')}$", written=COLUMNS[name])
        for name in (*TEXTS, *NUMBERS)
    },
    (tuple(NUMBERS),),
    "what was measured on an arm",
    EXAMPLE,
)


def read_measurements(path: Path) -> Measurements:
    """The rows of a file. Raises InputError, with the line and the column of what is wrong."""
    table = read(path, MEASURED)
    columns = _checked(table)
    rows = [_row(f"{path}: line {line}", line, columns, k) for k, line in enumerate(table.lines.tolist())]
    if not rows:
        raise InputError(f"{path}: has titles and no numbers under them; give a row for each state that was measured")
    kinds = Counter(repr(replace(row, line=0)) for row in rows)
    if len(rows) > 2 and min(kinds.values()) > 1:
        raise InputError(f"{path}: every row is there {min(kinds.values())} times; leave copies out, or name repeats")
    return Measurements(str(path), told_of_motions(path, rows))


def _checked(table: Columns) -> dict[str, Values]:
    """The columns by name."""
    for title in (*table.others, *(f"{column.title} {column.unit}" for column in table.known)):
        if PIXELS & set(re.split(r"[\W_]+", title.lower())):
            raise InputError(
                f"{table.path}: column {quoted(title.strip())} is in pixels; give mm per px: multiply it by those of "
                "the photograph, and name its unit mm"
            )
    table.check_gauge()
    for title in table.others:
        allowed = f"is not known; allowed are {', '.join(COLUMNS.values())}"
        cure = next((cure for words, cure in CURES.items() if re.search(words, plain(title))), allowed)
        raise InputError(f"{table.path}: column {quoted(title)} {cure}")
    columns: dict[str, Values] = {}
    for column in table.known:
        if column.name in columns:
            both = f"{quoted(columns[column.name].title)} and {quoted(column.title)}"
            raise InputError(f"{table.path}: columns {both} hold the same")
        columns[column.name] = column
    _check(table.path, columns)
    for name in NUMBERS:
        if name in columns:
            table.check_numbers(columns[name])
    return columns


def _check(path: Path, columns: Mapping[str, Values]) -> None:
    """Raise InputError for columns that need others."""
    if "pressure" not in columns:
        raise InputError(f"{path}: has no column 'pressure_kPa'; {EXAMPLE}")
    if not any(name in columns for name in QUANTITIES):
        raise InputError(f"{path}: no column holds what was measured; give one of {_list(QUANTITIES)}")


def _row(where: str, line: int, columns: Mapping[str, Values], k: int) -> Row:
    """The row k of the columns."""
    numbers = {
        name: float(f"{columns[name].numbers[k]:.12g}") * (-1.0 if columns[name].title[0] in MINUS else 1.0)
        for name in NUMBERS
        if name in columns and columns[name].cells[k]
    }
    texts = {name: columns[name].cells[k] if name in columns else "" for name in TEXTS}
    _check_row(where, numbers, texts["orientation"])
    state = State(
        numbers["pressure"],
        (numbers.get("force_x", 0.0), numbers.get("force_y", 0.0)),
        numbers.get("tip_mass", 0.0),
        numbers.get("held_y"),
        texts["orientation"] or None,
        numbers.get("t"),
    )
    values = {name: numbers[name] for name in QUANTITIES if name in numbers}
    if "reaction_zero" in numbers:
        values["reaction"] -= numbers["reaction_zero"]
    return Row(line, state, values, numbers.get("s"), texts["repeat"], numbers.get("zero"), numbers.get("at_y", 0.0))


def _check_row(where: str, numbers: Mapping[str, float], orientation: str) -> None:
    """Raise InputError for a row that is no state, or in which nothing was read."""
    if "pressure" not in numbers:
        raise InputError(f"{where}: has no pressure")
    if not any(name in numbers for name in QUANTITIES):
        raise InputError(f"{where}: has no measured number; leave the line out, or give one of {_list(QUANTITIES)}")
    for needed, by in NEEDED:
        missing = [name for name in needed if name not in numbers]
        if missing and any(name in numbers for name in by):
            raise InputError(f"{where}: has no {COLUMNS[missing[0]]}, which {_list(by)} need")
    if "held_y" in numbers and any(name in numbers for name in ("force_x", "force_y", "tip_mass")):
        raise InputError(f"{where}: an end that is held has no force that is given; leave out held_y_mm, or the force")
    if numbers.get("at_y") and not any(name in numbers for name in OF_TIP):
        raise InputError(f"{where}: at_y_mm is a point of the tip; give {_list(OF_TIP)}, or leave it out")
    if "t" in numbers and any(name in numbers for name in ("zero", "at_y")):
        raise InputError(f"{where}: at a time give places of the end itself; leave out zero_kPa and at_y_mm")
    if "t" in numbers and ("held_y" in numbers or not any(name in numbers for name in OF_TIP)):
        raise InputError(f"{where}: at a time give the tip of a free end: {_list(OF_TIP)}")
    if numbers.get("tip_mass", 0.0) < 0.0:
        raise InputError(f"{where}: tip_mass_g must not be negative")
    if numbers.get("tip_mass") and not orientation:
        raise InputError(f"{where}: tip_mass_g needs an orientation: hanging, lying, standing, or an angle as '30 deg'")
    if orientation:
        ask(where, gravity_direction, orientation)


def _list(names: Sequence[str]) -> str:
    return ", ".join(COLUMNS[name] for name in names)
