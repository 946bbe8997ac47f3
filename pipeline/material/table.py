"""The table of tensile tests in a text file, as testing machines and spreadsheets write it.

Found by themselves are the encoding, the separator, the decimal sign, the line of titles below any metadata, a second
line of titles, and a line of units. Titles may be English, German or French.
"""

import io
import re
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from geometry.arrays import Array
from pipeline.config.units import FORCE, LENGTH, STRAIN, STRESS, Dimension, convert
from pipeline.errors import InputError, quoted

#: what a file without points is told
EXAMPLE = "a line of titles names columns with their units, for example 'strain (%), stress (MPa)'"
#: words in titles without accents, of columns that hold no strain or stress, and of those of the deformed body
OTHERS = re.compile(
    r"rate|speed|geschwindigkeit|vitesse|modul|energ|arbeit|travail|strength|festigkeit|break|bruch|rupture"
    r"|yield|strecksp|streckgr|width|breite|largeur|later|transv|quer|time|zeit|temps"
)
TRUE = re.compile(r"\b(true|cauchy|wahr\w*|vrai\w*|log\w*|hencky)\b")
#: words of columns in which compression is positive
PRESSED = re.compile(r"compress|druck|stauch")
NOMINAL = re.compile(r"engineering|nominal|technisch|ingenieur")
#: kind of a column -> what it measures, and words of its title; the first kind whose words and unit fit is taken
KINDS = {
    "stretch": (STRAIN, r"stretch|lambda|λ|verstreckung|extension ratio|rapport d.allongement"),
    "strain": (STRAIN, r"strain|dehnung|deformation|verformung|stauchung|allongement|elongation|\beps\w*\b|ε"),
    "stress": (STRESS, r"stress|spannung|contrainte|sigma|σ"),
    "force": (FORCE, r"force|load|kraft|charge|effort|\blast\b|^f$"),
    "extension": (LENGTH, r"extension|displacement|elongation|deformation|crosshead|stroke|verlangerung|dehnung"
                          r"|verformung|stauchung|weg\b|deplacement|allongement|^dl$|^δl$"),
}  # fmt: skip
TEST = re.compile(r"(test|specimen|sample|probe|prufling|probekorper|eprouvette|essai)( (name|no\.?|id|nr\.?))?")
#: how units are written that pint reads otherwise or not at all
UNITS = {"²": "^2", "mm2": "mm^2", "m2": "m^2", "Mpa": "MPa", "mpa": "MPa", "MPA": "MPa", "KPa": "kPa", "kpa": "kPa"}
PURE = {"1", "-", "mm/mm", "m/m", "in/in", "dimensionless", "decimal", "abs"}
PER_CENT = {"percent", "prozent", "pct", "pourcent"}
#: largest strain without a unit that is a number; beyond it is in per cent, because no rubber bears so much
LARGEST_STRAIN = 15.0
_TITLE = re.compile(
    r"(?P<name>.*?)\s*(?:\((?P<round>[^()]*)\)|\[(?P<square>[^\]]*)\]|(?:/|\bin\b|,|[\s_])\s*(?P<bare>[^\s_]+))?"
)
_UTF16 = (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True)
class Specimen:
    """What the tests were made on, where a table has forces and extensions; None where it is not given."""

    length_mm: float | None = None
    area_mm2: float | None = None


@dataclass(frozen=True)
class Series:
    """The points of one test in the order of the file."""

    name: str
    strain: Array  #: (n,)
    stress: Array  #: (n,) MPa
    lines: Array  #: (n,) numbers of their lines
    notes: tuple[str, ...]


@dataclass(frozen=True)
class _Column:
    kind: str
    position: int
    title: str
    unit: float  #: MPa, N, mm or strain of one unit; NaN where the title has none
    problem: str = ""  #: what is wrong with the unit


def read_table(path: Path, specimen: Specimen) -> list[Series]:
    """The tests of a file: one for each name in a column of tests, or for each pair of columns. Raises InputError."""
    cells = _cells(path)
    numbers = np.array([[_number(cell) for cell in row] for row in cells], dtype=float)
    columns, first = _columns(path, cells, numbers)
    strains, stresses = _chosen(columns, ("stretch", "strain"), "extension"), _chosen(columns, ("stress",), "force")
    pairs = list(zip(strains, stresses, strict=False))
    notes = []
    if len(strains) != len(stresses):
        pairs = pairs[:1]
        taken = " and ".join(f"'{column.title}'" for column in pairs[0])
        notes.append(f"{path}: the columns {taken} are taken, others that hold the same are not")
    table = _Table(path, cells[first:], numbers[first:], first, next((c for c in columns if c.kind == "test"), None))
    return [
        series
        for number, pair in enumerate(pairs, start=1)
        for series in _series(table, pair, specimen, str(number) if len(pairs) > 1 else "", tuple(notes))
    ]


@dataclass(frozen=True)
class _Table:
    path: Path
    cells: Array  #: (rows, columns) texts
    numbers: Array  #: (rows, columns) NaN where a cell is no number
    above: int  #: number of lines above the rows
    tests: _Column | None


def _series(
    table: _Table, pair: tuple[_Column, _Column], specimen: Specimen, number: str, notes: tuple[str, ...]
) -> Iterator[Series]:
    """The tests of a pair of columns."""
    values = [_values(table, column, specimen) for column in pair]
    known = np.isfinite(values[0][0]) & np.isfinite(values[1][0])
    notes += tuple(note for _, note in values if note)
    if not known.any():
        raise InputError(f"{table.path}: has titles and no numbers under them; give a row for each point")
    strain, stress = (column[known] for column, _ in values)
    lines = np.flatnonzero(known) + table.above + 1
    if gaps := int(lines[-1] - lines[0]) + 1 - len(lines):
        notes += (f"{table.path}: {gaps} rows between points have no numbers and are left out",)
    if (impossible := strain <= -1).any():
        line, value = lines[impossible][0], 100 * strain[impossible][0]
        raise InputError(f"{table.path}: line {line}: {value:g} % is no possible strain; allowed: above -100 %")
    names = np.full(len(lines), number)
    if table.tests is not None:
        written = pd.Series(table.cells[:, table.tests.position]).replace("", None).ffill().fillna("")
        names = np.array([f"{name} {number}".strip() for name in written[known]])
    for name in dict.fromkeys(names.tolist()):
        of_test = names == name
        yield Series(name, strain[of_test], stress[of_test], lines[of_test], notes)
        notes = ()


def _values(table: _Table, column: _Column, specimen: Specimen) -> tuple[Array, str]:
    """(rows,) strains or stresses in MPa, and what is assumed about them."""
    values, note, unit = table.numbers[:, column.position], "", column.unit
    if column.problem and column.kind == "strain" and not _unit_of(column.title)[1]:
        largest = float(np.nanmax(np.abs(values), initial=0.0))
        unit, name = (1.0, "1") if largest <= LARGEST_STRAIN else (0.01, "%")
        note = f"{table.path}: column '{column.title}' has no unit and reaches {largest:.3g}; it is read in {name}"
    elif column.problem:
        raise InputError(f"{table.path}: column '{column.title}' {column.problem}")
    if column.kind in ("extension", "force"):
        is_force = column.kind == "force"
        size = specimen.area_mm2 if is_force else specimen.length_mm
        if size is None:
            option = "--area '16 mm^2', the cross-section" if is_force else "--length '33 mm', the length"
            raise InputError(f"{table.path}: column '{column.title}' is {_article(column.kind)}; give {option} at rest")
        unit /= size
    if PRESSED.search(plain(column.title)) and np.nanmedian(values[np.isfinite(values)]) > 0:
        unit = -unit
    return unit * values - (column.kind == "stretch"), note


def _article(kind: str) -> str:
    return f"an {kind}" if kind[0] in "aeiou" else f"a {kind}"


def _chosen(columns: Sequence[_Column], kinds: Sequence[str], otherwise: str) -> list[_Column]:
    """The columns of one quantity: those that are called nominal where any is."""
    found = [column for column in columns if column.kind in kinds]
    found = found or [column for column in columns if column.kind == otherwise]
    return [column for column in found if NOMINAL.search(plain(column.title))] or found


def _cells(path: Path) -> Array:
    """(lines, columns) the texts of all cells; lines without any, and comments, have empty ones."""
    lines = ["" if line.lstrip().startswith("#") else line for line in _text(path).splitlines()]
    separator = max(("\t", ";", ",", r"\s+"), key=lambda mark: _numeric_lines(lines, mark))  # of equal ones the first
    width = max((len(re.split(separator, line)) for line in lines), default=0)
    if width < 2:
        raise InputError(f"{path}: holds no table; {EXAMPLE}")
    try:
        frame = pd.read_csv(
            io.StringIO("\n".join(lines)), sep=separator, header=None, names=range(width), dtype=str, engine="python",
            skip_blank_lines=False, keep_default_na=False, skipinitialspace=True, index_col=False,
        )  # fmt: skip
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as failure:
        raise InputError(f"{path}: cannot be read as a table: {failure}; {EXAMPLE}") from None
    return np.array([[str(cell).strip() for cell in row] for row in frame.fillna("").to_numpy()], dtype=object)


def _numeric_lines(lines: Sequence[str], separator: str) -> int:
    """How many lines have two numbers or more between separators."""
    return sum(
        sum(np.isfinite(_number(cell.strip(' "'))) for cell in re.split(separator, line)) > 1 for line in lines[:2000]
    )


def _number(cell: str) -> float:
    """A number with a decimal point or comma, and perhaps the other sign between thousands; else NaN."""
    if "," in cell and "." in cell:
        cell = cell.replace(min(",", ".", key=cell.index), "")
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return np.nan


def _text(path: Path) -> str:
    """The text of a file in UTF-8, UTF-16 or Latin-1. Raises InputError."""
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; give a CSV file of tensile tests") from None
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


def _columns(path: Path, cells: Array, numbers: Array) -> tuple[list[_Column], int]:
    """The columns that the titles name, and the first row below them."""
    of_body = ""
    for row, titles in enumerate(cells):
        for depth in (1, 2):
            if row + depth >= len(cells) or np.isfinite(numbers[row : row + depth]).any():
                continue
            if depth == 2:
                titles = [f"{above} {below}".strip() for above, below in zip(titles, cells[row + 1], strict=True)]
            units = cells[row + depth]
            is_units = not np.isfinite(numbers[row + depth]).any() and any(_is_unit(unit) for unit in units)
            columns = _named(titles, units if is_units else [""] * len(titles))
            kinds = {column.kind for column in columns}
            if kinds & {"stretch", "strain", "extension"} and kinds & {"stress", "force"}:
                return columns, row + depth + is_units
            of_body = of_body or next((title for title in titles if TRUE.search(plain(title)) and _kind(title)), "")
    if of_body:
        raise InputError(
            f"{path}: column {quoted(of_body)} is not nominal; give elongation over length at rest and force over area "
            "at rest"
        )
    raise InputError(f"{path}: no line names columns of strain and stress, or of extension and force; {EXAMPLE}")


def _named(titles: Sequence[str], units: Sequence[str]) -> list[_Column]:
    """The columns that are read, in their order."""
    columns = []
    for position, (title, unit) in enumerate(zip(titles, units, strict=True)):
        if TEST.fullmatch(plain(title)):
            columns.append(_Column("test", position, title, np.nan))
        elif not TRUE.search(plain(title)) and (kind := _kind(title)):
            columns.append(_column(kind, position, title, unit or _unit_of(title)[1]))
    return columns


def _kind(title: str) -> list[tuple[str, Dimension]]:
    """What a column may hold."""
    name = plain(_unit_of(title)[0])
    if OTHERS.search(name):
        return []
    return [(kind, dimension) for kind, (dimension, words) in KINDS.items() if re.search(words, name)]


def _column(kinds: Sequence[tuple[str, Dimension]], position: int, title: str, unit: str) -> _Column:
    """A column of the first kind that its unit fits."""
    for kind, dimension in kinds:
        value = 1.0 if kind == "stretch" and not unit else _per_unit(unit, dimension)
        if np.isfinite(value):
            return _Column(kind, position, title, value)
    kind, dimension = kinds[0]
    right = f"write it as in '{kind} ({dimension.example.split()[-1]})'"
    wrong = f"has the unit '{unit}', which is not that of {dimension.name}" if unit else "has no unit"
    return _Column(kind, position, title, np.nan, f"{wrong}; {right}")


def _unit_of(title: str) -> tuple[str, str]:
    """Name and unit of a title; what stands in brackets and is no unit belongs to the name."""
    match = _TITLE.fullmatch(title)
    unit = next((part.strip() for part in match.groups()[1:] if part), "") if match else ""
    return (match["name"], unit) if match and _is_unit(unit) else (title, "")


def _is_unit(text: str) -> bool:
    unit = text.strip("()[] ")
    return bool(unit) and any(np.isfinite(_per_unit(unit, of)) for of in (STRAIN, STRESS, FORCE, LENGTH))


def _per_unit(text: str, dimension: Dimension) -> float:
    """MPa, N, mm or strain of one unit; NaN where this is no unit of the dimension."""
    unit = text.strip("()[] ")
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
