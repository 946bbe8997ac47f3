"""Tensile tests from CSV files: nominal stress over nominal strain, units in the header.

    # a comment
    test, strain (%), stress (MPa)
    A, 0.0, 0.001
    A, 5.0, 0.031

Every error message is one sentence: `FILE: line and column: what is wrong; what is allowed`.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.errors import InputError
from pipeline.material.doubts import SMALLEST_STRAIN, are_stretches, breaks_after, goes_back, usual
from pipeline.material.table import Table, number_of, read_table

#: smallest number of points of a test: three constants at most, and residuals that show the scatter
MIN_POINTS = 5


@dataclass(frozen=True)
class TensileTest:
    """One specimen, pulled or pressed."""

    name: str
    stretch: Array  #: (n,) along the axis, ascending
    stress: Array  #: (n,) MPa, force over the area at rest
    notes: tuple[str, ...] = ()  #: sentences on what is most likely wrong with the points, or was left out

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
        kept.append(TensileTest(test.name, test.stretch[inside], test.stress[inside], test.notes))
    return tuple(kept)


@dataclass(frozen=True)
class _Point:
    line: int
    stretch: float
    stress: float  #: MPa


def _tests(path: Path, alone: bool) -> Iterator[TensileTest]:
    table = read_table(path)
    points: dict[str, list[_Point]] = {}
    for line, cells in table.rows:
        name, point = _point(f"{path}: line {line}", line, cells, table)
        points.setdefault(name, []).append(point)
    if not points:
        raise InputError(f"{path}: has a header and no points under it; give at least {MIN_POINTS}")
    every = [point for group in points.values() for point in group]
    notes = tuple(f"{path}: {doubt}" for doubt in (_swapped(table, every), _stretches(table, every)) if doubt)
    for name, group in points.items():
        label = name if alone and name else f"{path.stem} {name}".strip()
        yield _test(f"{path}: test '{label}'", label, group, notes)
        notes = ()


def _point(where: str, line: int, cells: Sequence[str], table: Table) -> tuple[str, _Point]:
    """Name of the test, and point."""
    columns = table.columns
    if len(cells) != len(columns.titles):
        hint = "; a comma within numbers needs ';' between them" if table.separator == "," else ""
        raise InputError(f"{where}: has {len(cells)} cells under {len(columns.titles)} columns{hint}")
    name = "" if columns.test is None else cells[columns.test]
    if columns.test is not None and not name:
        raise InputError(f"{where}, column '{columns.titles[columns.test]}': is empty; name the test of every point")
    strain = columns.strain_unit * _number(where, cells, table, columns.strain)
    stress = columns.stress_unit * _number(where, cells, table, columns.stress)
    stretch = 1 - columns.rest + strain
    if stretch <= 0:
        raise InputError(
            f"{where}, column '{columns.titles[columns.strain]}': {cells[columns.strain]} is no "
            "possible strain; allowed: strains above -100 %, stretches above 0"
        )
    return name, _Point(line, stretch, stress)


def _number(where: str, cells: Sequence[str], table: Table, position: int) -> float:
    written, value = cells[position], number_of(cells[position], table.separator)
    if not math.isfinite(value):
        problem = f"'{written}' is not a number" if written else "is empty"
        title = table.columns.titles[position]
        raise InputError(f"{where}, column '{title}': {problem}; write a finite number, as in 0.25")
    return value


def _swapped(table: Table, points: Sequence[_Point]) -> str:
    """The question whether strains stand in the column of stresses, where that would be likelier; else empty."""
    columns = table.columns
    strain = max(abs(point.stretch - 1) for point in points)
    stress = max(abs(point.stress) for point in points)
    written = (strain + columns.rest) / columns.strain_unit, stress / columns.stress_unit
    other = written[1] * columns.strain_unit - columns.rest, written[0] * columns.stress_unit
    if strain >= SMALLEST_STRAIN or not usual(*other):
        return ""
    return (
        f"strains reach {100 * strain:.3g} % and stresses {stress:.3g} MPa: are the columns "
        f"'{columns.titles[columns.strain]}' and '{columns.titles[columns.stress]}' swapped?"
    )


def _stretches(table: Table, points: Sequence[_Point]) -> str:
    """The question whether strains are stretches, where the least of them is 1 with hardly any stress; else empty."""
    columns = table.columns
    first = min(points, key=lambda point: point.stretch)
    largest = max(abs(point.stress) for point in points)
    if columns.rest or not are_stretches(first.stretch - 1, first.stress, largest):
        return ""
    return (
        f"column '{columns.titles[columns.strain]}' begins at a strain of {100 * (first.stretch - 1):.4g} % with a "
        f"stress of {first.stress:.3g} MPa, of {largest:.3g} MPa at most: if these are stretches, call the column "
        "'stretch (1)'"
    )


def _test(where: str, name: str, points: Sequence[_Point], notes: tuple[str, ...]) -> TensileTest:
    """One test, checked."""
    stretch, stress = (np.array([getattr(point, key) for point in points]) for key in ("stretch", "stress"))
    _enough(where, len(points))
    if np.ptp(stretch) == 0:
        raise InputError(f"{where}: has one strain only; stress must be given over strain")
    if not stress.any():
        raise InputError(f"{where}: every stress is zero; give the measured force over the area at rest")
    if np.sum((stretch - 1) * stress) <= 0:
        raise InputError(f"{where}: stress falls as the strain grows; tension must be positive in both columns")
    if (turn := goes_back(stretch - 1)) is not None:
        notes += (
            f"{where}: the strain goes back after line {points[turn].line}: unloading and repeated loading are "
            "averaged with the first loading; leave them out, or name the specimens in a column 'test' if these are "
            "several",
        )
    order = np.lexsort((stress, stretch))
    stretch, stress = stretch[order], stress[order]
    if (last := breaks_after(stretch - 1, stress)) is not None:
        low, high = (100 * (stretch[point] - 1) for point in (last, last + 1))
        notes += (
            f"{where}: the stress drops after a strain of {low:.4g} %, where the specimen has broken: "
            f"the points from {high:.4g} % on are left out",
        )
        stretch, stress = stretch[: last + 1], stress[: last + 1]
        _enough(f"{where}: before its break at {low:.4g} %", len(stretch))
    return TensileTest(name, stretch, stress, notes)


def _enough(where: str, count: int) -> None:
    if count < MIN_POINTS:
        raise InputError(f"{where}: has {count} points; {MIN_POINTS} are needed")
