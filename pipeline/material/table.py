"""The table of tensile tests in a CSV file, as testing machines and spreadsheets write it: encoding, titles, units.

Lines above the titles are skipped. Units stand in the titles, or in a line below them.
"""

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pipeline.config.units import STRAIN, STRESS, Dimension, convert
from pipeline.errors import InputError

#: what a file without points is told
EXAMPLE = "the first line names the columns with their units, for example 'test, strain (%), stress (MPa)'"
_REMEDY = "give a CSV file in UTF-8, in UTF-16 with a byte order mark, or in Latin-1"
_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_TITLE = re.compile(r"(?P<name>[^(\[/]*?)\s*(?:\((?P<round>.*)\)|\[(?P<square>.*)\]|/\s*(?P<slash>.+))?")
_TEST = ("test", "specimen", "sample")
_STRAIN, _STRESS, _STRETCH = "strain", "stress", "stretch"
_NOMINAL = {"", "nominal", "engineering", "tensile"}
_TRUE = {"true", "cauchy", "logarithmic", "log", "hencky"}
_PLAIN = {"1", "-"}  # how people write that a strain has no unit


@dataclass(frozen=True)
class Columns:
    """Positions and units of the columns that are read."""

    titles: tuple[str, ...]
    test: int | None
    strain: int
    strain_unit: float  #: strain or stretch of one unit
    rest: float  #: value of the strain column at rest: 0, or 1 for stretches
    stress: int
    stress_unit: float  #: MPa


@dataclass(frozen=True)
class Table:
    """The rows below the titles and units."""

    columns: Columns
    separator: str
    rows: tuple[tuple[int, tuple[str, ...]], ...]  #: number of the line, cells


def read_table(path: Path) -> Table:
    """The table of a file in UTF-8, in UTF-16 with a byte order mark, or in Latin-1. Raises InputError."""
    lines = [
        (number, line)
        for number, line in enumerate(_text(path).splitlines(), start=1)
        if line.strip(" \t;,") and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise InputError(f"{path}: holds no table; {EXAMPLE}")
    begin = next((index for index, (_, line) in enumerate(lines) if _names_both(line)), 0)
    for number, line in lines[:begin]:
        if all(math.isfinite(number_of(cell, _separator(line))) for cell in _cells(line, _separator(line))):
            raise InputError(
                f"{path}: line {number}: holds numbers above the titles of line {lines[begin][0]}; {EXAMPLE}"
            )
    separator = _separator(lines[begin][1])
    titles = _cells(lines[begin][1], separator)
    rows = tuple((number, tuple(_cells(line, separator))) for number, line in lines[begin + 1 :])
    if rows and (titles_and_units := _with_units(titles, rows[0][1])):
        titles, rows = titles_and_units, rows[1:]
    return Table(_columns(f"{path}: line {lines[begin][0]}", titles), separator, rows)


def number_of(cell: str, separator: str) -> float:
    """A number with a decimal point, or with a comma where this does not separate cells; else NaN."""
    try:
        return float(cell.replace(",", ".") if separator != "," and "." not in cell else cell)
    except ValueError:
        return math.nan


def _text(path: Path) -> str:
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; give a CSV file of tensile tests") from None
    except OSError as failure:
        raise InputError(f"{path}: cannot be read: {failure.strerror}; give a readable CSV file") from None
    for encoding in ("utf-16",) if content.startswith(_UTF16) else ("utf-8-sig", "cp1252"):
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if encoding != "cp1252" or all(sign.isprintable() or sign in "\t\n\r\f" for sign in text):
            return text
    raise InputError(f"{path}: is not a text; {_REMEDY}")


def _separator(line: str) -> str:
    return next((mark for mark in "\t;," if mark in line), ",")


def _cells(line: str, separator: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]


def _columns(where: str, titles: Sequence[str]) -> Columns:
    """The columns that the header names. Columns with other names are ignored."""
    positions: dict[str, list[int]] = {}
    for position, title in enumerate(titles):
        before, kind = _kind(title)
        if kind in (_STRAIN, _STRESS) and before not in _NOMINAL:
            what = "is not" if _TRUE.intersection(before.split()) else "is not known to be"
            raise InputError(
                f"{where}: column '{title}' {what} nominal; give elongation over length at rest and force over area at "
                "rest, as 'strain (%)' and 'stress (MPa)'"
            )
        positions.setdefault(kind, []).append(position)
    for kind in (_STRAIN, _STRESS):
        if kind not in positions:
            raise InputError(f"{where}: no column is named {kind}; {EXAMPLE}")
    for kind in ("test", _STRAIN, _STRESS):
        if len(positions.get(kind, ())) > 1:
            named = " and ".join(f"'{titles[position]}'" for position in positions[kind])
            raise InputError(f"{where}: columns {named} mean the same; leave one of them out")
    strain, stress = positions[_STRAIN][0], positions[_STRESS][0]
    return Columns(
        tuple(titles),
        positions["test"][0] if "test" in positions else None,
        strain,
        _unit(where, titles[strain], STRAIN, "strain (%)"),
        1.0 if _split(titles[strain])[0].endswith(_STRETCH) else 0.0,
        stress,
        _unit(where, titles[stress], STRESS, "stress (MPa)"),
    )


def _kind(title: str) -> tuple[str, str]:
    """What a column holds, stretches as strains, and the words before it."""
    *before, last = _split(title)[0].split() or [""]
    return " ".join(before), {**dict.fromkeys(_TEST, "test"), _STRETCH: _STRAIN}.get(last, last)


def _names_both(line: str) -> bool:
    """Whether a line names a column of strains and one of stresses."""
    return {_STRAIN, _STRESS} <= {_kind(title)[1] for title in _cells(line, _separator(line))}


def _with_units(titles: Sequence[str], below: Sequence[str]) -> list[str]:
    """The titles with the units in the line below them; empty where that line holds no units."""
    dimensions = {_STRAIN: STRAIN, _STRESS: STRESS}
    units = [cell.strip("()[] ") for cell in below]
    if len(units) != len(titles) or all(math.isfinite(number_of(unit, ";")) for unit in units):
        return []
    for title, unit in zip(titles, units, strict=True):
        dimension = dimensions.get(_kind(title)[1])
        if dimension is not None and math.isnan(_per_unit(unit, dimension)):
            return []
    return [f"{_split(title)[0]} ({unit})" for title, unit in zip(titles, units, strict=True)]


def _split(title: str) -> tuple[str, str]:
    """Name in small letters and unit: 'Stress (MPa)', 'stress [MPa]' or 'stress / MPa'."""
    match = _TITLE.fullmatch(title)
    if match is None:
        return title.lower(), ""
    return match["name"].lower(), (match["round"] or match["square"] or match["slash"] or "").strip()


def _unit(where: str, title: str, dimension: Dimension, example: str) -> float:
    """MPa, or strain, per unit of the column."""
    unit = _split(title)[1]
    if not unit:
        raise InputError(f"{where}: column '{title}' has no unit; write it as in '{example}'")
    if math.isnan(value := _per_unit(unit, dimension)):
        raise InputError(
            f"{where}: column '{title}': '{unit}' is not the unit of {dimension.name}; write it as in '{example}'"
        )
    return value


def _per_unit(unit: str, dimension: Dimension) -> float:
    """MPa, or strain; NaN where this is no unit of the dimension."""
    if dimension is STRAIN and unit in _PLAIN:
        return 1.0
    try:
        return convert(f"1 {unit}", dimension)
    except ValueError:
        return math.nan
