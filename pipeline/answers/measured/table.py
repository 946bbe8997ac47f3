"""The file of an arm that was measured: columns with their units, in any order, as spreadsheets write them."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.answers.measured.motions import told_of_motions
from pipeline.answers.measured.rows import COLUMNS, NUMBERS, OF_TIP, QUANTITIES, TEXTS, Measurements, Row, State
from pipeline.answers.written_table import is_unit, name_and_unit, number_in, per_unit, plain, read_cells
from pipeline.values.errors import InputError, ask, quoted
from rod.weight import gravity_direction

EXAMPLE = "a line of titles names columns with their units, for example 'pressure_kPa, tip_x_mm, tip_y_mm'"
#: columns that some columns need
NEEDED = (("s", "x", "y"), ("s", "x", "y")), (("held_y",), ("reaction",)), (("reaction",), ("reaction_zero",))
#: signs before the title of a column whose numbers have the other sign
MINUS = "-−"
#: units of pictures, which pint takes as those of a screen
PIXELS = {"px", "pixel", "pixels"}
_DIMENSIONS = tuple(dict.fromkeys(NUMBERS.values()))


@dataclass(frozen=True)
class _Column:
    name: str  #: of NUMBERS or TEXTS
    position: int
    title: str
    unit: float  #: one unit in that of the name; 1 of a text


def read_measurements(path: Path) -> Measurements:
    """The rows of a file. Raises InputError, with the line and the column of what is wrong."""
    cells = read_cells(path, "a measured arm", EXAMPLE)
    columns, first = _columns(path, cells)
    rows = []
    for line, row in enumerate(cells[first:].tolist(), start=first + 1):
        if any(row):
            rows.append(
                _row(f"{path}: line {line}", line, {column.name: (column, row[column.position]) for column in columns})
            )
    if not rows:
        raise InputError(f"{path}: has titles and no numbers under them; give a row for each state that was measured")
    return Measurements(str(path), told_of_motions(path, rows))


def _columns(path: Path, cells: Array) -> tuple[list[_Column], int]:
    """The columns by the first line that names one, with units there or on the next line; and the first row."""
    filled = [k for k, row in enumerate(cells.tolist()) if any(row)]
    head = next((k for k in filled if any(_name(cell)[0] in NUMBERS for cell in cells[k])), filled[0])
    titles, below = cells[head].tolist(), cells[head + 1].tolist() if head + 1 < len(cells) else [""] * len(cells[head])
    pairs = zip(titles, below, strict=True)
    has_units = any(is_unit(cell, _DIMENSIONS) for title, cell in pairs if plain(title) not in TEXTS)
    columns: dict[str, _Column] = {}
    for position, title in enumerate(titles):
        unit = below[position] if has_units else ""
        if not title and not any(cells[head + 1 :, position]):
            continue
        column = _column(path, position, title, unit)
        if column.name in columns:
            raise InputError(f"{path}: columns {quoted(columns[column.name].title)} and {quoted(title)} hold the same")
        columns[column.name] = column
    _check(path, columns)
    return list(columns.values()), head + 1 + has_units


def _name(title: str) -> tuple[str, str]:
    """The name of a column as in NUMBERS, if it is one, and the unit in its title, without a minus sign before it."""
    written, unit = name_and_unit(title.lstrip(MINUS), _DIMENSIONS)
    return plain(written).replace(" ", "_"), unit


def _column(path: Path, position: int, title: str, unit: str) -> _Column:
    if plain(title) in TEXTS:
        return _Column(plain(title), position, title, 1.0)
    if PIXELS & set(re.split(r"[\W_]+", f"{title} {unit}".lower())):
        raise InputError(
            f"{path}: column {quoted(title)} is in pixels; give mm per px: multiply it by those of the photograph, and "
            "name its unit mm"
        )
    name, of_title = _name(title)
    if name not in NUMBERS:
        raise InputError(f"{path}: column {quoted(title)} is not known; allowed are {', '.join(COLUMNS.values())}")
    dimension, unit = NUMBERS[name], unit or of_title
    if not unit:
        raise InputError(f"{path}: column {quoted(title)} has no unit; write it as '{COLUMNS[name]}'")
    value = per_unit(unit, dimension)
    if not np.isfinite(value):
        raise InputError(
            f"{path}: column {quoted(title)} has the unit {quoted(unit)}, which is not that of {dimension.name}; write "
            f"it as '{COLUMNS[name]}'"
        )
    return _Column(name, position, title, -value if title[0] in MINUS else value)


def _check(path: Path, columns: Mapping[str, _Column]) -> None:
    """Raise InputError for columns that need others."""
    if "pressure" not in columns:
        raise InputError(f"{path}: has no column 'pressure_kPa'; {EXAMPLE}")
    if not any(name in columns for name in QUANTITIES):
        raise InputError(f"{path}: no column holds what was measured; give one of {_list(QUANTITIES)}")


def _row(where: str, line: int, cells: Mapping[str, tuple[_Column, str]]) -> Row:
    numbers: dict[str, float] = {}
    for name, (column, cell) in cells.items():
        if name in NUMBERS and cell:
            value = number_in(cell)
            if not math.isfinite(value):
                raise InputError(f"{where}: {quoted(cell)} in column {quoted(column.title)} is no number")
            numbers[name] = float(f"{column.unit * value:.12g}")
    texts = {name: cells[name][1] if name in cells else "" for name in TEXTS}
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
