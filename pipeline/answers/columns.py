"""Columns of tables in text files, as testing machines and spreadsheets write them.

Found by themselves are the encoding, the separator and the decimal sign, and columns by the words of their titles and
by their units. Titles stand in one line or two, below whatever a program writes above them, with units in them or in
the next line.
"""

import io
import re
import unicodedata
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from geometry.arrays import Array, Index
from pipeline.config import units
from pipeline.values.errors import InputError, quoted

#: how units are written that pint reads otherwise or not at all
UNITS = {"1/s": "s^-1", "⁻¹": "^-1", "²": "^2", "mm2": "mm^2", "m2": "m^2"} | {
    **dict.fromkeys(("Mpa", "mpa", "MPA"), "MPa"), **dict.fromkeys(("KPa", "kpa"), "kPa")
}  # fmt: skip
PURE = {"1", "-", "mm/mm", "m/m", "in/in", "dimensionless", "decimal", "abs"}
PER_CENT = {"percent", "prozent", "pct", "pourcent"}
_TITLE = re.compile(
    r"(?P<name>.*?)\s*(?:\((?P<round>[^()]*)\)|\[(?P<square>[^\]]*)\]|(?:/|\bin\b|,|[\s_])\s*(?P<bare>[^\s_]+))?"
)
#: words in the middle of a title that are units too
_WORDS = {"a", "as", "at", "h", "in", "t"}
_UTF16 = (b"\xff\xfe", b"\xfe\xff")
#: what the title of an absolute pressure has, and what to do with it
ABSOLUTE = r"\babs(olute?r?)?\b.*(pressure|druck)|pressure.*\babs(olute)?\b|\bp abs\b"
TO_GAUGE = "is an absolute pressure; subtract that of the air outside, and name it pressure_kPa"
#: in the first line of motion capture as Motive writes it
MOTIVE = {"Format Version", "Take Name"}


@dataclass(frozen=True)
class Column:
    """What a column may hold."""

    dimension: units.Dimension | None  #: None for texts
    words: str = ""  #: expression that is sought in its title, in small letters without accents; empty: its unit tells
    unless: str = r"(?!)"  #: expression that its title does not have
    written: str = ""  #: its title, for example 'time (s)'
    without: float = np.nan  #: one unit of a column without a unit; NaN: it needs one


@dataclass(frozen=True)
class Form:
    """A kind of file."""

    of: str  #: what it holds
    columns: Mapping[str, Column]  #: by name; of several that a title fits, the first whose unit fits is taken
    needed: tuple[Collection[str], ...]  #: titles name one of each
    names: str  #: what these are, in words
    example: str  #: what a file without them is told
    title_lines: int = 1  #: the most of them

    def column(self, title: str, unit: str) -> "tuple[str, float, str] | None":
        """The name of a column, what one of its units is, and this unit; None if it is not known.

        unit: in the line below.
        """
        written, last = _name_and_unit(title, [one.dimension for one in self.columns.values() if one.dimension])
        name, stated = plain(written), unit or last
        units = [stated] if stated else [word for word in re.split(r"[\s_]+", title) if word.lower() not in _WORDS]
        fits = []
        for key, one in self.columns.items():
            if re.search(one.words, name) and not re.search(one.unless, name):
                value = next((of for text in units if np.isfinite(of := _per_unit(text, one.dimension))), np.nan)
                value = one.without if np.isnan(value) and not stated else value
                fits += [(key, value, stated)] if one.words or np.isfinite(value) else []
        return next((fit for fit in fits if np.isfinite(fit[1])), fits[0] if fits else None)


@dataclass(frozen=True, eq=False)  # arrays inside
class Values:
    """A column."""

    name: str  #: of `Form.columns`
    title: str
    unit: str  #: as written; empty where there is none
    cells: Array  #: (n,) texts
    numbers: Array  #: (n,) in the unit of the dimension; NaN where a cell is no number
    problem: str  #: what is wrong with its unit: numbers are as written; empty for nothing


@dataclass(frozen=True, eq=False)  # arrays inside
class Columns:
    """What stands below a line of titles."""

    path: Path
    lines: Index  #: (n,) numbers of the lines that are not empty, from 1
    known: tuple[Values, ...]  #: in the order of the file
    others: tuple[str, ...]  #: titles of columns that are not known, with their units

    def all(self, *names: str) -> list[Values]:
        """The columns of some names."""
        return [column for column in self.known if column.name in names]

    def check_gauge(self) -> None:
        """Raise InputError for a column of an absolute pressure."""
        for title in (*self.others, *(column.title for column in self.known)):
            if re.search(ABSOLUTE, plain(title)):
                raise InputError(f"{self.path}: column {quoted(title)} {TO_GAUGE}")

    def check(self, *columns: Values) -> None:
        """Raise InputError for columns that have no unit, or a wrong one."""
        for column in columns:
            if column.problem:
                raise InputError(f"{self.path}: column {quoted(column.title)} {column.problem}")

    def check_numbers(self, column: Values) -> None:
        """Raise InputError for a text in a column of numbers."""
        self.check(column)
        for k in np.flatnonzero(~np.isfinite(column.numbers) & (column.cells != "")):
            where = f"{self.path}: line {self.lines[k]}"
            raise InputError(f"{where}: {quoted(column.cells[k])} in column {quoted(column.title)} is no number")


def read(path: Path, form: Form) -> Columns:
    """The table of a file. Raises InputError for several."""
    first, *others = read_all(path, form)
    if others:
        raise InputError(f"{path}: has titles again above line {others[0].lines[:1].sum()}; give one table a file")
    return first


def read_all(path: Path, form: Form) -> list[Columns]:
    """The tables of a file, by their lines of titles. Raises InputError where there is none."""
    cells = _read_cells(path, form)
    if MOTIVE.issubset(cells[: len(MOTIVE)].ravel()):
        raise InputError(
            f"{path}: is an export of Motive; copy its times, and places of the tip less those of the clamp, to a "
            f"table: {form.example}"
        )
    heads = list(_heads(cells, form))
    if not heads:
        raise InputError(f"{path}: no line names {form.names}; {form.example}")
    ends = [row for row, *_ in heads[1:]] + [len(cells)]
    return [
        _below(path, form, titles, units, first + np.flatnonzero((cells[first:end] != "").any(axis=1)), cells)
        for (_, first, titles, units), end in zip(heads, ends, strict=True)
    ]


def _heads(cells: Array, form: Form) -> Iterator[tuple[int, int, Sequence[str], Sequence[str]]]:
    """Of each table the line of its titles and of its first row, from 0, its titles, and the units below them."""
    is_number = np.array([[np.isfinite(_number_in(cell)) for cell in row] for row in cells])
    dimensions = [column.dimension for column in form.columns.values() if column.dimension]
    free = 0
    for row in range(len(cells)):
        for depth in range(1, form.title_lines + 1):
            first = row + depth
            if row < free or first >= len(cells) or is_number[row:first].any():
                continue
            titles = [" ".join(filter(None, above)) for above in cells[row:first].T]
            has_units = not is_number[first].any() and any(_is_unit(unit, dimensions) for unit in cells[first])
            units = cells[first].tolist() if has_units else [""] * len(titles)
            found = {of[0] for of in map(form.column, titles, units) if of}
            if all(found & set(names) for names in form.needed):
                free = first + has_units
                yield row, free, titles, units


def _below(path: Path, form: Form, titles: Sequence[str], units: Sequence[str], rows: Index, cells: Array) -> Columns:
    """The columns of a table with its rows (n,), counted from 0."""
    known, others = [], []
    for title, unit, texts in zip(titles, units, cells[rows].T, strict=True):
        found = form.column(title, unit)
        if found is None:
            others += [f"{title} {unit}".strip()] if title or (texts != "").any() else []
            continue
        name, value, stated = found
        problem, of = "", form.columns[name]
        if of.dimension and np.isnan(value):
            wrong = f"has the unit {quoted(stated)}, which is not that of {of.dimension.name}"
            written = of.written or f"{name} ({of.dimension.example.split()[-1]})"
            problem = f"{wrong if stated else 'has no unit'}; write it as '{written}'"
        numbers = np.array([_number_in(cell) if of.dimension else np.nan for cell in texts], dtype=float)
        known.append(Values(name, title, stated, texts, numbers * (1.0 if problem else value), problem))
    return Columns(path, rows + 1, tuple(known), tuple(others))


def _read_cells(path: Path, form: Form) -> Array:
    """(lines, columns) the texts of all cells; lines without any, and comments, have empty ones."""
    lines = ["" if line.lstrip().startswith("#") else line for line in _text(path, form.of).splitlines()]
    separator = max(("\t", ";", ",", r"\s+"), key=lambda mark: _numeric_lines(lines, mark))  # of equal ones the first
    width = max((len(re.split(separator, line)) for line in lines), default=0)
    if width < 2:
        raise InputError(f"{path}: holds no table; {form.example}")
    try:
        frame = pd.read_csv(
            io.StringIO("\n".join(lines)), sep=separator, header=None, names=range(width), dtype=str, engine="python",
            skip_blank_lines=False, keep_default_na=False, skipinitialspace=True, index_col=False,
        )  # fmt: skip
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as failure:
        raise InputError(f"{path}: cannot be read as a table: {failure}; {form.example}") from None
    return np.array([[str(cell).strip() for cell in row] for row in frame.fillna("").to_numpy()], dtype=object)


def _numeric_lines(lines: Sequence[str], separator: str) -> int:
    """How many lines have two numbers or more between separators."""
    return sum(
        sum(np.isfinite(_number_in(cell.strip(' "'))) for cell in re.split(separator, line)) > 1
        for line in lines[:2000]
    )


def _number_in(cell: str) -> float:
    """A number with a decimal point or comma, and perhaps the other sign between thousands; else NaN."""
    if "," in cell and "." in cell:
        cell = cell.replace(min(",", ".", key=cell.index), "")
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return np.nan


def _text(path: Path, of: str) -> str:
    """The text of a file in UTF-8, UTF-16 or Latin-1. Raises InputError."""
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; give a CSV file of {of}") from None
    except OSError as failure:
        raise InputError(f"{path}: cannot be read: {failure.strerror}; give a readable CSV file") from None
    unmarked = ("utf-16-le",) if content[1:2] == b"\0" else ("utf-8-sig", "cp1252")
    for encoding in ("utf-16",) if content.startswith(_UTF16) else unmarked:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if encoding != "cp1252" or all(sign.isprintable() or sign in "\t\n\r\f" for sign in text):
            return text.replace("\0", "")
    raise InputError(f"{path}: is not a text; save it as CSV, in UTF-8 or UTF-16")


def _name_and_unit(title: str, dimensions: Sequence[units.Dimension]) -> tuple[str, str]:
    """Name and unit of a title; what stands in brackets and is no unit of the dimensions belongs to the name."""
    match = _TITLE.fullmatch(title)
    unit = next((part.strip() for part in match.groups()[1:] if part), "") if match else ""
    return (match["name"], unit) if match and _is_unit(unit, dimensions) else (title, "")


def _is_unit(text: str, dimensions: Sequence[units.Dimension]) -> bool:
    """Whether a text is a unit of one of the dimensions."""
    unit = text.strip("()[] ")
    return bool(unit) and any(np.isfinite(_per_unit(unit, of)) for of in dimensions)


def _per_unit(text: str, dimension: units.Dimension | None) -> float:
    """What one unit is in that of the dimension, 1 of texts; NaN where this is no unit of it."""
    if dimension is None:
        return 1.0
    unit = text.strip("()[] ")
    if unit == "strain":  # pint has it among its units
        return np.nan
    for written, meant in UNITS.items():
        unit = unit.replace(written, meant)
    if dimension is units.STRAIN and plain(unit) in PURE:
        return 1.0
    if dimension is units.STRAIN and plain(unit) in PER_CENT:
        return 0.01
    try:
        return units.convert(f"1 {unit}", dimension)
    except ValueError:
        return np.nan


def plain(text: str) -> str:
    """Small letters without accents."""
    parts = unicodedata.normalize("NFKD", text.replace("_", " ").lower())
    return "".join(sign for sign in parts if not unicodedata.combining(sign)).strip()
