"""The tables of a run as pandas frames; units are in the names of the columns."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import pandas as pd

from pipeline.answers.rods.budget import Budget
from pipeline.answers.rods.pressures import PressureFor
from pipeline.values.formats import CURVE_COLUMNS
from pipeline.values.parameters import RestShape
from pipeline.values.run import Effect, RodError, State
from rod import ArmLaw
from rod.arm_law.quantities import OF_CELLS, UNITS, QuantityAt

SENSITIVITIES = ("parameter", "number", "pressure_kPa", "derivative", "unit", "relative")
#: columns that hold texts, empty where there is none; all others hold numbers or true and false
_TEXTS = {"experiment", "load", "rod", "sample", "effect", "state", "status", "reason", "warning"}
#: endings of the components of a pair or of a position
_AXES = ("x", "y", "z")


def frame_of(kind: type[State | RodError | Effect], rows: Sequence[State | RodError | Effect]) -> pd.DataFrame:
    """One row per value; a pair or a position becomes a column per component, with the unit at its end."""
    columns: dict[str, list[Any]] = {}
    for field in fields(kind):
        values = [getattr(row, field.name) for row in rows]
        size = str(field.type).count("float")  # of a pair, and of a position
        if size not in (2, 3):
            columns[field.name] = values
            continue
        stem, _, unit = field.name.rpartition("_")
        for k, axis in enumerate(_AXES[:size]):
            columns[f"{stem}_{axis}_{unit}"] = [None if value is None else value[k] for value in values]
    return pd.DataFrame({name: _column(name, values) for name, values in columns.items()})


def _column(name: str, values: Sequence[Any]) -> Any:
    if name in _TEXTS:
        return pd.Series([value or "" for value in values], dtype=object)
    return pd.Series(values, dtype=float)


def curves_frame(path: Path) -> pd.DataFrame:
    """The table of curves in a CSV file; without rows where there is none."""
    if not path.is_file():
        return pd.DataFrame(columns=list(CURVE_COLUMNS))
    frame = pd.read_csv(path, dtype={"experiment": str, "load": str})
    return frame.fillna({"load": ""}) if "load" in frame else frame


def by_pressure(content: Mapping[str, object], pressures: Sequence[float]) -> pd.DataFrame:
    """One row per pressure: every key of the content that has one number, or one pair, for each of them."""
    count = len(pressures)
    columns: dict[str, pd.Series] = {"pressure_kPa": pd.Series(list(pressures), dtype=float)}
    for key, values in content.items():
        if key == "pressures_kPa" or not isinstance(values, tuple) or len(values) != count:
            continue
        if any(isinstance(value, bool) for value in values):
            columns[key] = pd.array(values, dtype="boolean")
        elif all(value is None or isinstance(value, int | float) for value in values):
            columns[key] = pd.Series(values, dtype=float)
        elif all(value is None or (isinstance(value, tuple) and len(value) == 2) for value in values):
            name = f"{key}_{{}}" if key.endswith("_95") else key.replace("_N_mm", "_{}_N_mm")
            for k, end in enumerate(("low", "high")):
                columns[name.format(end)] = pd.Series([None if v is None else v[k] for v in values], dtype=float)
    return pd.DataFrame(columns)


def profiles(rest: RestShape, pressures: Sequence[float]) -> pd.DataFrame:
    """pressure_kPa, s_mm, kappa_0_per_mm: the curvature of the rod without load along the arm."""
    rows = zip(pressures, rest.kappa_0_per_mm, strict=True)
    parts = [pd.DataFrame({"pressure_kPa": p, "s_mm": rest.s_mm, "kappa_0_per_mm": kappa}) for p, kappa in rows]
    empty = pd.DataFrame({name: pd.Series(dtype=float) for name in ("pressure_kPa", "s_mm", "kappa_0_per_mm")})
    return pd.concat(parts, ignore_index=True) if parts else empty


class Shown(pd.DataFrame):
    """A frame that prints every column, with four digits."""

    def __repr__(self) -> str:
        return self.to_string(index=False, float_format=lambda x: f"{round(x, 9) + 0.0:.4g}", na_rep="-")


def pressures_frame(found: Sequence[PressureFor], cavities: Sequence[str]) -> Shown:
    """One row per pressure, with the end of the arm there; cavities: if several, of each its pressure."""
    rows, several = [], len(cavities) > 1
    for at in found:
        row = {"pressure_kPa": at.pressure_kPa, "error_kPa": at.error_kPa}
        row |= {f"pressure_{name}_kPa": p for name, p in zip(cavities, at.pressures_kPa, strict=True) if several}
        row |= {f"tip_{axis}_mm": value for axis, value in zip(_AXES, at.tip_mm, strict=False)}
        row |= {"angle_deg": at.angle_deg} | {f"force_{a}_N": f for a, f in zip(_AXES, at.force_N, strict=False)}
        rows.append(row | {"away_mm": at.away_mm})
    frame = Shown(rows, dtype=float)
    if any(notes := [at.note for at in found]):
        frame["note"] = notes
    return frame


def budget_frame(found: Budget | None) -> Shown:
    """One row per tolerance and one for all: changes in %, that of the tip over the length; no rows for None."""
    if found is None:
        return Shown()
    columns: dict[str, list[str] | list[float]] = {"tolerance_of": [*(row.parameter for row in found.rows), "all"]}
    columns["tolerance"] = [*(row.tolerance for row in found.rows), ""]
    for name in found.numbers:
        columns[f"{name}_percent"] = [
            100.0 * change for change in (*(r.changes[name] for r in found.rows), found.total(name))
        ]
    return Shown(columns)


def sensitivities_frame(law: ArmLaw | None) -> pd.DataFrame:
    """One row per parameter, number and pressure above zero.

    relative: by how many % a number changes by 1 % of the parameter; NaN of a number that is zero, or not
    in the law.
    """
    return pd.DataFrame([] if law is None else list(_sensitivities(law)), columns=list(SENSITIVITIES))


def _sensitivities(law: ArmLaw) -> Iterator[tuple[object, ...]]:
    rods = {pressure: law.at(pressure) for pressure in law.pressures if pressure}
    values = {
        (name, p): float(QuantityAt(name, p, rod).of(rods.__getitem__)[0]) for name in UNITS for p, rod in rods.items()
    }
    for name, parameter in law.rates.items():
        for number, rates in law.derivative(name).items():
            unit = (UNITS | OF_CELLS)[number]
            unit = unit if parameter.unit == "1" else f"{unit} per {parameter.unit}"
            for pressure, rate in zip(law.pressures, rates.tolist(), strict=True):
                value = values.get((number, pressure), 0.0)
                if pressure:
                    yield name, number, pressure, rate, unit, rate * parameter.value / value if value else math.nan
