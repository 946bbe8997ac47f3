"""What the result files of a run say, read once; files that a failed run did not write are simply absent."""

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.store.formats import CONVERGED, with_present_keys

Rows = Sequence[Mapping[str, Any]]


@dataclass(frozen=True)
class Curve:
    """The material curve of one experiment at one pressure, all arrays (n,), NaN where a cell is empty."""

    experiment: str
    pressure_kPa: float
    columns: Mapping[str, Array]  #: by the column names of curves.csv
    load: str = ""  #: besides the pressure, in words; empty for I, II and III as identified

    def __getitem__(self, column: str) -> Array:
        return self.columns[column]

    def has(self, column: str) -> bool:
        """Whether the column is there and holds at least one number."""
        return column in self.columns and bool(np.isfinite(self.columns[column]).any())


@dataclass(frozen=True)
class Results:
    """A result directory."""

    directory: Path
    parameters: Mapping[str, Any]  #: empty when the identification was not reached
    curves: tuple[Curve, ...]
    experiments: Rows
    validation: Rows
    validation_curves: tuple[Curve, ...]
    laws: Rows
    effects: Rows
    run: Mapping[str, Any]
    pictures: Mapping[str, Path]  #: by file name without suffix: body, body_open, II_17kPa

    @property
    def pressures(self) -> tuple[float, ...]:
        """All pressures that occur, ascending, kPa."""
        found = {curve.pressure_kPa for curve in self.curves} | {row["pressure_kPa"] for row in self.experiments}
        return tuple(sorted(found))

    @property
    def length(self) -> float:
        """Rest length of the material curve, mm; NaN when nothing says it."""
        if "length_mm" in self.parameters:
            return float(self.parameters["length_mm"])
        return max((float(curve["s_mm"].max()) for curve in self.curves), default=float("nan"))

    @property
    def failures(self) -> Rows:
        """The rows of experiments.json whose pressure was not reached."""
        return [row for row in self.experiments if row.get("status", CONVERGED) != CONVERGED]

    @property
    def in_sample(self) -> Rows:
        """The rows of validation.json about the loads that the numbers were fitted to."""
        return [row for row in self.validation if row.get("sample", "in") == "in"]

    @property
    def out_of_sample(self) -> Rows:
        """The rows about other loads and pressures."""
        return [row for row in self.validation if row.get("sample") == "out"]

    def curve(self, experiment: str, pressure_kPa: float) -> Curve | None:
        """The curve of one experiment at one pressure."""
        for curve in self.curves:
            if curve.experiment == experiment and curve.pressure_kPa == pressure_kPa:
                return curve
        return None

    def at(self, key: str, pressure_kPa: float) -> float | None:
        """The entry of a list in parameters.json that stands at one of its `pressures_kPa`."""
        listed = list(self.parameters.get("pressures_kPa", ()))
        values = self.parameters.get(key)
        if pressure_kPa not in listed or not isinstance(values, Sequence):
            return None
        value = values[listed.index(pressure_kPa)]
        return None if value is None else float(value)


def read_results(directory: Path) -> Results:
    """Read every result file in `directory` that is there."""
    curves = _read_curves(directory / "curves.csv")
    pictures = {path.stem: path for path in sorted((directory / "pictures").glob("*.png"))}
    return Results(
        directory=directory,
        parameters=_read_json(directory / "parameters.json", {}),
        curves=curves,
        experiments=_read_json(directory / "experiments.json", []),
        validation=_read_json(directory / "validation.json", []),
        validation_curves=_read_curves(directory / "validation_curves.csv"),
        laws=_read_json(directory / "laws.json", []),
        effects=_read_json(directory / "effects.json", []),
        run=_read_json(directory / "run.json", {}),
        pictures=pictures,
    )


def _read_json(path: Path, absent: Any) -> Any:
    return with_present_keys(json.loads(path.read_text(encoding="utf-8"))) if path.is_file() else absent


def _read_curves(path: Path) -> tuple[Curve, ...]:
    if not path.is_file():
        return ()
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    groups: dict[tuple[str, float, str], list[dict[str, str]]] = {}
    for row in rows:
        groups.setdefault((row["experiment"], float(row["pressure_kPa"]), row.get("load", "")), []).append(row)
    return tuple(
        Curve(experiment, pressure, _columns(group), load) for (experiment, pressure, load), group in groups.items()
    )


def _columns(rows: list[dict[str, str]]) -> dict[str, Array]:
    names = [name for name in rows[0] if name not in ("experiment", "pressure_kPa", "load")]
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in names}
