"""Tensile tests from CSV files: nominal stress over nominal strain, units in the header.

    # a comment
    test, strain (%), stress (MPa)
    A, 0.0, 0.001
    A, 5.0, 0.031

Every error message is one sentence: `FILE: line and column: what is wrong; what is allowed`.
"""

import csv
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.config.units import STRAIN, STRESS, Dimension, convert
from pipeline.errors import InputError

#: smallest number of points of a test: three constants at most, and residuals that show the scatter
MIN_POINTS = 5
_EXAMPLE = "the first line names the columns with their units, for example 'test, strain (%), stress (MPa)'"
_TITLE = re.compile(r"(?P<name>[^(\[/]*?)\s*(?:\((?P<round>.*)\)|\[(?P<square>.*)\]|/\s*(?P<slash>.+))?")
_TEST = ("test", "specimen", "sample")
_STRAIN, _STRESS, _STRETCH = "strain", "stress", "stretch"
_NOMINAL = {"", "nominal", "engineering"}
_PLAIN = {"1", "-"}  # how people write that a strain has no unit


@dataclass(frozen=True)
class TensileTest:
    """One specimen, pulled or pressed."""

    name: str
    stretch: Array  #: (n,) along the axis, ascending
    stress: Array  #: (n,) MPa, force over the area at rest

    @property
    def strain(self) -> Array:
        """(n,) stretch - 1."""
        return self.stretch - 1


def read_tensile(paths: Sequence[Path]) -> tuple[TensileTest, ...]:
    """All tests of all files, in their order. A file without a column of tests is one test with the name of the file.

    Raises InputError.
    """
    tests: dict[str, TensileTest] = {}
    for path in paths:
        for test in _tests(path, alone=len(paths) == 1):
            if test.name in tests:
                raise InputError(f"{path}: test '{test.name}' was read already; give every test once")
            tests[test.name] = test
    return tuple(tests.values())


def up_to(tests: Sequence[TensileTest], strain: float) -> tuple[TensileTest, ...]:
    """The points of strain between -`strain` and `strain`. Raises InputError where too few are left."""
    kept = []
    for test in tests:
        inside = np.abs(test.strain) <= strain * (1 + 1e-9)
        if np.count_nonzero(inside) < MIN_POINTS:
            raise InputError(
                f"--up-to {100 * strain:g} %: leaves {np.count_nonzero(inside)} points of test '{test.name}'; "
                f"{MIN_POINTS} are needed"
            )
        kept.append(TensileTest(test.name, test.stretch[inside], test.stress[inside]))
    return tuple(kept)


@dataclass(frozen=True)
class _Columns:
    """Positions and units of the columns that are read."""

    titles: tuple[str, ...]
    test: int | None
    strain: int
    strain_unit: float  #: strain or stretch of one unit
    rest: float  #: value of the strain column at rest: 0, or 1 for stretches
    stress: int
    stress_unit: float  #: MPa


def _tests(path: Path, alone: bool) -> Iterator[TensileTest]:
    lines = [
        (number, line)
        for number, line in enumerate(_text(path).splitlines(), start=1)
        if line.strip(" \t;,") and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise InputError(f"{path}: holds no table; {_EXAMPLE}")
    separator = next((mark for mark in "\t;," if mark in lines[0][1]), ",")
    columns = _columns(f"{path}: line {lines[0][0]}", _cells(lines[0][1], separator))
    rows: dict[str, list[tuple[float, float]]] = {}
    for number, line in lines[1:]:
        name, stretch, stress = _row(f"{path}: line {number}", _cells(line, separator), columns, separator)
        rows.setdefault(name, []).append((stretch, stress))
    if not rows:
        raise InputError(f"{path}: has a header and no points under it; give at least {MIN_POINTS}")
    for name, points in rows.items():
        label = name if alone and name else f"{path.stem} {name}".strip()
        yield _test(f"{path}: test '{label}'", label, np.array(sorted(points)))


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; give a CSV file of tensile tests") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text in UTF-8; give a CSV file of tensile tests") from None
    except OSError as failure:
        raise InputError(f"{path}: cannot be read: {failure.strerror}; give a readable CSV file") from None


def _cells(line: str, separator: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]


def _columns(where: str, titles: Sequence[str]) -> _Columns:
    """The columns that the header names. Columns with other names are ignored."""
    positions: dict[str, list[int]] = {}
    for position, title in enumerate(titles):
        name, _ = _split(title)
        *before, last = name.split() or [""]
        if last in (_STRAIN, _STRETCH, _STRESS) and " ".join(before) not in _NOMINAL:
            raise InputError(
                f"{where}: column '{title}' is not nominal; give elongation over length at rest and force over area at "
                "rest, as 'strain (%)' and 'stress (MPa)'"
            )
        kind = {**dict.fromkeys(_TEST, "test"), _STRETCH: _STRAIN}.get(last, last)
        positions.setdefault(kind, []).append(position)
    for kind in (_STRAIN, _STRESS):
        if kind not in positions:
            raise InputError(f"{where}: no column is named {kind}; {_EXAMPLE}")
    for kind in ("test", _STRAIN, _STRESS):
        if len(positions.get(kind, ())) > 1:
            named = " and ".join(f"'{titles[position]}'" for position in positions[kind])
            raise InputError(f"{where}: columns {named} mean the same; leave one of them out")
    strain, stress = positions[_STRAIN][0], positions[_STRESS][0]
    return _Columns(
        tuple(titles),
        positions["test"][0] if "test" in positions else None,
        strain,
        _unit(where, titles[strain], STRAIN, "strain (%)"),
        1.0 if _split(titles[strain])[0].endswith(_STRETCH) else 0.0,
        stress,
        _unit(where, titles[stress], STRESS, "stress (MPa)"),
    )


def _split(title: str) -> tuple[str, str]:
    """Name in small letters and unit: 'Stress (MPa)', 'stress [MPa]' or 'stress / MPa'."""
    match = _TITLE.fullmatch(title)
    if match is None:
        return title.lower(), ""
    return match["name"].lower(), (match["round"] or match["square"] or match["slash"] or "").strip()


def _unit(where: str, title: str, dimension: Dimension, example: str) -> float:
    """MPa, or strain, per unit of the column."""
    unit = _split(title)[1]
    if dimension is STRAIN and unit in _PLAIN:
        return 1.0
    if not unit:
        raise InputError(f"{where}: column '{title}' has no unit; write it as in '{example}'")
    try:
        return convert(f"1 {unit}", dimension)
    except ValueError:
        raise InputError(
            f"{where}: column '{title}': '{unit}' is not the unit of {dimension.name}; write it as in '{example}'"
        ) from None


def _row(where: str, cells: Sequence[str], columns: _Columns, separator: str) -> tuple[str, float, float]:
    """Test, stretch, stress in MPa."""
    if len(cells) != len(columns.titles):
        hint = "; a comma within numbers needs ';' between them" if separator == "," else ""
        raise InputError(f"{where}: has {len(cells)} cells under {len(columns.titles)} columns{hint}")
    name = "" if columns.test is None else cells[columns.test]
    if columns.test is not None and not name:
        raise InputError(f"{where}, column '{columns.titles[columns.test]}': is empty; name the test of every point")
    strain = columns.strain_unit * _number(where, cells, columns, columns.strain, separator)
    stress = columns.stress_unit * _number(where, cells, columns, columns.stress, separator)
    stretch = 1 - columns.rest + strain
    if stretch <= 0:
        raise InputError(
            f"{where}, column '{columns.titles[columns.strain]}': {cells[columns.strain]} is no "
            "possible strain; allowed: strains above -100 %, stretches above 0"
        )
    return name, stretch, stress


def _number(where: str, cells: Sequence[str], columns: _Columns, position: int, separator: str) -> float:
    written = cells[position]
    text = written.replace(",", ".") if separator != "," and "." not in written else written
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        problem = f"'{written}' is not a number" if written else "is empty"
        raise InputError(f"{where}, column '{columns.titles[position]}': {problem}; write a finite number, as in 0.25")
    return value


def _test(where: str, name: str, points: Array) -> TensileTest:
    """One test, checked."""
    stretch, stress = points.T
    if len(points) < MIN_POINTS:
        raise InputError(f"{where}: has {len(points)} points; {MIN_POINTS} are needed")
    if np.ptp(stretch) == 0:
        raise InputError(f"{where}: has one strain only; stress must be given over strain")
    if np.sum((stretch - 1) * stress) <= 0:
        raise InputError(f"{where}: stress falls as the strain grows; tension must be positive in both columns")
    return TensileTest(name, stretch, stress)
