"""The table of a sweep: a row per point and pressure, units in the names of the columns. The only door to pyarrow."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow
import pyarrow.parquet

from pipeline.config.units import in_unit_of, number_and_unit
from pipeline.store.atomic_file import replacing
from pipeline.store.result_folder import ResultFolder
from pipeline.sweep.axes import Setting, switch_as_word
from pipeline.sweep.record import PointRecord, Row


@dataclass(frozen=True)
class SolvedPoint:
    """A point with what is known of it."""

    number: int
    folder: str  #: relative to that of the sweep; empty for a refused point
    setting: Setting
    record: PointRecord


@dataclass(frozen=True)
class Column:
    """The values of a key of the axes, as numbers in one unit where they are."""

    key: str
    unit: str  #: that of its first value; empty without one

    @staticmethod
    def of(key: str, settings: Sequence[Setting]) -> "Column":
        """The column of a key over all points."""
        measured = number_and_unit(settings[0][key])
        unit = measured[1] if measured else ""
        try:
            for setting in settings if unit else ():
                in_unit_of(setting[key], unit)
        except ValueError:
            unit = ""
        return Column(key, unit)

    @property
    def name(self) -> str:
        """The key with the unit."""
        return f"{self.key}_{self.unit}" if self.unit else self.key

    def cell(self, setting: Setting) -> float | int | str:
        """The value at one point."""
        value = switch_as_word(setting[self.key])
        if self.unit:
            return in_unit_of(value, self.unit)
        return value if isinstance(value, int | float | str) else json.dumps(value)


def table_rows(columns: Sequence[Column], points: Sequence[SolvedPoint]) -> list[Row]:
    """One row per point and pressure, and one for a point without numbers; all have the same columns."""
    rows: list[Row] = []
    for point in points:
        axes: Row = {column.name: column.cell(point.setting) for column in columns}
        ended: Row = {"status": point.record.status, "reason": point.record.reason}
        head: Row = {"point": point.number, **axes, "pressure_kPa": None, **ended, "folder": point.folder}
        rows += [{**head, **numbers} for numbers in point.record.rows or ({},)]
    names = list(dict.fromkeys(name for row in rows for name in row))
    return [{name: row.get(name) for name in names} for row in rows]


def save_table(folder: ResultFolder, rows: Sequence[Row]) -> None:
    """Write sweep.csv and sweep.parquet; a number that does not exist is an empty cell."""
    names = list(rows[0])
    folder.save_rows("sweep.csv", names, [list(row.values()) for row in rows])
    table = pyarrow.table({name: _array([row[name] for row in rows]) for name in names})
    with replacing(folder.path("sweep.parquet")) as part:
        pyarrow.parquet.write_table(table, part)


def _array(values: Sequence[Any]) -> Any:
    """A column; plain numbers beside texts become texts, and one without any value a column of numbers."""
    there = [value for value in values if value is not None]
    if not there:
        return pyarrow.array(values, pyarrow.float64())
    if any(isinstance(value, str) for value in there):
        return pyarrow.array([None if value is None else str(value) for value in values])
    return pyarrow.array(values)
