"""Tables in text files, as testing machines and spreadsheets write them.

Found by themselves are the encoding, the separator and the decimal sign. Units stand in titles or on a line of their
own.
"""

import io
import re
import unicodedata
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from geometry.arrays import Array
from pipeline.config.units import STRAIN, Dimension, convert
from pipeline.values.errors import InputError

#: how units are written that pint reads otherwise or not at all
UNITS = {"²": "^2", "mm2": "mm^2", "m2": "m^2", "Mpa": "MPa", "mpa": "MPa", "MPA": "MPa", "KPa": "kPa", "kpa": "kPa"}
PURE = {"1", "-", "mm/mm", "m/m", "in/in", "dimensionless", "decimal", "abs"}
PER_CENT = {"percent", "prozent", "pct", "pourcent"}
_TITLE = re.compile(
    r"(?P<name>.*?)\s*(?:\((?P<round>[^()]*)\)|\[(?P<square>[^\]]*)\]|(?:/|\bin\b|,|[\s_])\s*(?P<bare>[^\s_]+))?"
)
_UTF16 = (b"\xff\xfe", b"\xfe\xff")


def read_cells(path: Path, of: str, example: str) -> Array:
    """(lines, columns) the texts of all cells; lines without any, and comments, have empty ones.

    of: what the file holds; example: what a file without a table is told. Raises InputError.
    """
    lines = ["" if line.lstrip().startswith("#") else line for line in _text(path, of).splitlines()]
    separator = max(("\t", ";", ",", r"\s+"), key=lambda mark: _numeric_lines(lines, mark))  # of equal ones the first
    width = max((len(re.split(separator, line)) for line in lines), default=0)
    if width < 2:
        raise InputError(f"{path}: holds no table; {example}")
    try:
        frame = pd.read_csv(
            io.StringIO("\n".join(lines)), sep=separator, header=None, names=range(width), dtype=str, engine="python",
            skip_blank_lines=False, keep_default_na=False, skipinitialspace=True, index_col=False,
        )  # fmt: skip
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as failure:
        raise InputError(f"{path}: cannot be read as a table: {failure}; {example}") from None
    return np.array([[str(cell).strip() for cell in row] for row in frame.fillna("").to_numpy()], dtype=object)


def _numeric_lines(lines: Sequence[str], separator: str) -> int:
    """How many lines have two numbers or more between separators."""
    return sum(
        sum(np.isfinite(number_in(cell.strip(' "'))) for cell in re.split(separator, line)) > 1 for line in lines[:2000]
    )


def number_in(cell: str) -> float:
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


def name_and_unit(title: str, dimensions: Sequence[Dimension]) -> tuple[str, str]:
    """Name and unit of a title; what stands in brackets and is no unit of the dimensions belongs to the name."""
    match = _TITLE.fullmatch(title)
    unit = next((part.strip() for part in match.groups()[1:] if part), "") if match else ""
    return (match["name"], unit) if match and is_unit(unit, dimensions) else (title, "")


def is_unit(text: str, dimensions: Sequence[Dimension]) -> bool:
    """Whether a text is a unit of one of the dimensions."""
    unit = text.strip("()[] ")
    return bool(unit) and any(np.isfinite(per_unit(unit, of)) for of in dimensions)


def per_unit(text: str, dimension: Dimension) -> float:
    """What one unit is in that of the dimension; NaN where this is no unit of it."""
    unit = text.strip("()[] ")
    if unit == "strain":  # pint has it among its units
        return np.nan
    for written, meant in UNITS.items():
        unit = unit.replace(written, meant)
    if dimension is STRAIN and plain(unit) in PURE:
        return 1.0
    if dimension is STRAIN and plain(unit) in PER_CENT:
        return 0.01
    try:
        return convert(f"1 {unit}", dimension)
    except ValueError:
        return np.nan


def plain(text: str) -> str:
    """Small letters without accents."""
    parts = unicodedata.normalize("NFKD", text.replace("_", " ").lower())
    return "".join(sign for sign in parts if not unicodedata.combining(sign)).strip()
