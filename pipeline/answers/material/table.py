"""The table of tensile tests in a text file (`pipeline.answers.written_table`).

Found by themselves are the lines of titles below metadata and tables of results, a second line of titles, and a line of
units. Titles may be English, German or French.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.answers.written_table import is_unit, name_and_unit, number_in, per_unit, plain, read_cells
from pipeline.config.units import FORCE, LENGTH, STRAIN, STRESS, Dimension
from pipeline.values.errors import InputError, argument, quoted

#: what a file without points is told
EXAMPLE = "a line of titles names columns with their units, for example 'strain (%), stress (MPa)'"
#: words in titles without accents, of columns without a curve of strain or stress, and of the deformed body
OTHERS = re.compile(
    r"rate|speed|geschwindigkeit|vitesse|modul|energ|arbeit|travail|strength|festigkeit|break|bruch|rupture"
    r"|yield|strecksp|streckgr|width|breite|largeur|later|transv|quer|time|zeit|temps|max|peak|\bat\b|\bbei\b"
)
TRUE = re.compile(r"\b(true|cauchy|wahr\w*|vrai\w*|log\w*|hencky)\b")
#: words of columns and tests of tension, of those in which compression is positive, and of those along several axes
PULLED = re.compile(r"\btens|\bzug|traction")
PRESSED = re.compile(r"compress|stauch|(?<!3d[- ])\bdruck")
ACROSS = re.compile(r"\S*(?:bi-?ax|zweiachs|\bplanar|shear|\bscher|\bschub|cisaill|volumetr|hydrostat)\S*")
NOMINAL = re.compile(r"\beng(\b|ineering)|nominal|technisch|ingenieur")
#: kind of a column -> what it measures, and words of its title; the first kind whose words and unit fit is taken
KINDS = {
    "stretch": (STRAIN, r"stretch|lambda|λ|verstreckung|extension ratio|rapport d.allongement"),
    "strain": (STRAIN, r"strain|dehnung|deformation|verformung|stauchung|allongement|elongation|\beps\w*\b|ε"),
    "stress": (STRESS, r"stress|spannung|contrainte|sigma|σ"),
    "force": (FORCE, r"force|load|kraft|charge|effort|\blast\b|^f$"),
    "extension": (LENGTH, r"extension|displacement|elongation|deformation|crosshead|position|stroke|verlangerung"
                          r"|dehnung|verformung|stauchung|weg\b|deplacement|allongement|^dl$|^δl$"),
}  # fmt: skip
TEST = re.compile(r"(test|specimen|sample|probe|prufling|probekorper|eprouvette|essai)( (name|no\.?|id|nr\.?))?")
#: largest strain without a unit that is a number; beyond it is in per cent, because no rubber bears so much
LARGEST_STRAIN = 15.0
DIMENSIONS = (STRAIN, STRESS, FORCE, LENGTH)
#: fewest points of a test
MIN_POINTS = 5


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
    kind: str = ""  #: name and titles in small letters


@dataclass(frozen=True)
class _Column:
    kind: str
    position: int
    title: str
    unit: float  #: MPa, N, mm or strain of one unit; NaN where the title has none
    problem: str = ""  #: what is wrong with the unit


def read_table(path: Path, specimen: Specimen) -> list[Series]:
    """The tests of a file along one axis: by line of titles, pair of columns and name in a column of tests.

    Raises InputError.
    """
    cells = read_cells(path, "tensile tests", EXAMPLE)
    tables = _tables(path, cells, np.array([[number_in(cell) for cell in row] for row in cells], dtype=float))
    most = max(table.points for table in tables)
    pairs = [(table, *pair) for table in tables if table.points >= min(most, MIN_POINTS) for pair in table.pairs()]
    found = [
        series
        for number, (table, *pair, notes) in enumerate(pairs, start=1)
        for series in _series(table, pair, specimen, str(number) if len(pairs) > 1 else "", notes)
    ]
    words = dict.fromkeys(match.group() for series in found if (match := ACROSS.search(series.kind)))
    if not words:
        return found
    named, uniaxial = ", ".join(words), [series for series in found if not ACROSS.search(series.kind)]
    if not uniaxial:
        raise InputError(f"{path}: {quoted(named)} is no test along one axis; give uniaxial tension or compression")
    note = f"{path}: {quoted(named)} is left out: laws are fitted to tension and compression along one axis"
    notes = tuple(dict.fromkeys(text for series in found for text in series.notes))
    return [replace(series, notes=() if number else (*notes, note)) for number, series in enumerate(uniaxial)]


@dataclass(frozen=True)
class _Table:
    path: Path
    cells: Array  #: (rows, columns) texts
    numbers: Array  #: (rows, columns) NaN where a cell is no number
    above: int  #: number of lines above the rows
    columns: Sequence[_Column]

    @property
    def points(self) -> int:
        """How many rows have two numbers or more in columns that are read."""
        read = [column.position for column in self.columns if column.kind != "test"]
        return int((np.isfinite(self.numbers[:, read]).sum(axis=1) > 1).sum())

    def pairs(self) -> list[tuple[_Column, _Column, tuple[str, ...]]]:
        """Columns of strain and stress, and what is left out beside the first ones."""
        strains = _chosen(self.columns, ("stretch", "strain"), "extension")
        stresses = _chosen(self.columns, ("stress",), "force")
        if len(strains) == len(stresses):
            return [(strain, stress, ()) for strain, stress in zip(strains, stresses, strict=True)]
        strains, stresses = (
            [column for column in columns if not ACROSS.search(plain(column.title))] or columns
            for columns in (strains, stresses)
        )
        taken = f"'{strains[0].title}' and '{stresses[0].title}'"
        note = f"{self.path}: the columns {taken} are taken, other columns of strain and stress are not"
        return [(strains[0], stresses[0], (note,))]


def _series(
    table: _Table, pair: Sequence[_Column], specimen: Specimen, number: str, notes: tuple[str, ...]
) -> Iterator[Series]:
    """The tests of a pair of columns."""
    values = [_values(table, column, specimen) for column in pair]
    known = np.isfinite(values[0][0]) & np.isfinite(values[1][0])
    notes += tuple(note for _, note in values if note)
    if not known.any():
        raise InputError(f"{table.path}: has titles and no numbers under them; give a row for each point")
    lines = np.flatnonzero(known) + table.above + 1
    if gaps := int(lines[-1] - lines[0]) + 1 - len(lines):
        notes += (f"{table.path}: {gaps} rows between points have no numbers and are left out",)
    names = np.full(len(lines), number)
    if tests := [column.position for column in table.columns if column.kind == "test"]:
        column = table.cells[:, tests[0]]
        last = np.maximum.accumulate(np.where(column != "", np.arange(len(column)), 0))  # the last that is not empty
        names = np.array([f"{name} {number}".strip() for name in column[last][known]])
    for name in dict.fromkeys(names.tolist()):
        kind, of_test = plain(" ".join([name, *(column.title for column in pair)])), names == name
        strain, stress = (column[known][of_test] for column, _ in values)
        if PRESSED.search(kind):
            strain, stress = (-column if np.median(column) > 0 else column for column in (strain, stress))
        if (impossible := strain <= -1).any():
            line, value = lines[of_test][impossible][0], 100 * strain[impossible][0]
            raise InputError(f"{table.path}: line {line}: {value:g} % is no possible strain; allowed: above -100 %")
        yield Series(name, strain, stress, lines[of_test], notes, kind)
        notes = ()


def _values(table: _Table, column: _Column, specimen: Specimen) -> tuple[Array, str]:
    """(rows,) strains or stresses in MPa, and what is assumed about them."""
    values, note, unit = table.numbers[:, column.position], "", column.unit
    if column.problem and column.kind == "strain" and not name_and_unit(column.title, DIMENSIONS)[1]:
        largest = float(np.nanmax(np.abs(values), initial=0.0))
        unit, name = (1.0, "1") if largest <= LARGEST_STRAIN else (0.01, "%")
        note = f"{table.path}: column '{column.title}' has no unit and reaches {largest:.3g}; it is read in {name}"
    elif column.problem:
        raise InputError(f"{table.path}: column '{column.title}' {column.problem}")
    if column.kind in ("extension", "force"):
        is_force = column.kind == "force"
        size = specimen.area_mm2 if is_force else specimen.length_mm
        if size is None:
            area, length = argument("area", "'16 mm^2'"), argument("length", "'33 mm'")
            needed = f"{area}, the cross-section" if is_force else f"{length}, the length"
            raise InputError(f"{table.path}: column '{column.title}' holds {column.kind}s; give {needed} at rest")
        unit /= size
    return unit * values - (column.kind == "stretch"), note


def _chosen(columns: Sequence[_Column], kinds: Sequence[str], otherwise: str) -> list[_Column]:
    """The columns of one quantity: those that are called nominal where any is."""
    found = [column for column in columns if column.kind in kinds]
    found = found or [column for column in columns if column.kind == otherwise]
    return [column for column in found if NOMINAL.search(plain(column.title))] or found


def _tables(path: Path, cells: Array, numbers: Array) -> list[_Table]:
    """What stands below each line of titles that names the columns of a test."""
    found: list[tuple[int, int, list[_Column]]] = []
    of_body = ""
    for row, titles in enumerate(cells):
        for depth in (1, 2):
            first = row + depth
            if first >= len(cells) or np.isfinite(numbers[row:first]).any() or (found and row < found[-1][1]):
                continue
            if depth == 2:
                titles = [f"{above} {below}".strip() for above, below in zip(titles, cells[row + 1], strict=True)]
            units = cells[first]
            is_units = not np.isfinite(numbers[first]).any() and any(is_unit(unit, DIMENSIONS) for unit in units)
            columns = _named(titles, units if is_units else [""] * len(titles))
            kinds = {column.kind for column in columns}
            if kinds & {"stretch", "strain", "extension"} and kinds & {"stress", "force"}:
                found.append((row, first + is_units, columns))
            of_body = of_body or next((title for title in titles if TRUE.search(plain(title)) and _kind(title)), "")
    if found:
        ends = [row for row, _, _ in found[1:]] + [len(cells)]
        return [
            _Table(path, cells[first:end], numbers[first:end], first, columns)
            for (_, first, columns), end in zip(found, ends, strict=True)
        ]
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
            columns.append(_column(kind, position, title, unit or name_and_unit(title, DIMENSIONS)[1]))
    return columns


def _kind(title: str) -> list[tuple[str, Dimension]]:
    """What a column may hold."""
    name = plain(name_and_unit(title, DIMENSIONS)[0])
    if OTHERS.search(name):
        return []
    return [(kind, dimension) for kind, (dimension, words) in KINDS.items() if re.search(words, name)]


def _column(kinds: Sequence[tuple[str, Dimension]], position: int, title: str, unit: str) -> _Column:
    """A column of the first kind that its unit fits."""
    for kind, dimension in kinds:
        value = 1.0 if kind == "stretch" and not unit else per_unit(unit, dimension)
        if np.isfinite(value):
            return _Column(kind, position, title, value)
    kind, dimension = kinds[0]
    right = f"write it as in '{kind} ({dimension.example.split()[-1]})'"
    wrong = f"has the unit '{unit}', which is not that of {dimension.name}" if unit else "has no unit"
    return _Column(kind, position, title, np.nan, f"{wrong}; {right}")
