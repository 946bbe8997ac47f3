"""The result files of a run, read once; files that a failed run did not write are simply absent."""

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from geometry.arrays import Array
from pipeline.store.formats import CONVERGED, validation_rows, with_present_keys
from pipeline.validation.rods import FIVE

Row = TypeVar("Row")

#: cells at each end of an arm that differ from inner ones
END_CELLS = 1.5


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
class StateRow:
    """A row of experiments.json; None where the pressure was not reached."""

    experiment: str
    pressure_kPa: float
    end_x_mm: float | None = None
    end_y_mm: float | None = None
    reaction_N: Sequence[float] | None = None
    stretch_of_curve: float | None = None
    min_stretch: float | None = None
    max_stretch: float | None = None
    min_J: float | None = None
    min_gap_mm: float | None = None
    newton_iterations: int | None = None
    factorizations: int | None = None
    seconds: float | None = None
    status: str = CONVERGED
    reason: str = ""

    @property
    def reached(self) -> bool:
        """Whether the pressure was reached."""
        return self.status == CONVERGED


@dataclass(frozen=True)
class ValidationRow:
    """A row of validation.json; None where there is no rod or no force to compare."""

    experiment: str
    pressure_kPa: float
    load: str = ""  #: besides the pressure, in words; empty for II and III as identified
    rod: str = FIVE  #: one of the names in `pipeline.validation.rods`
    sample: str = "in"  #: in: the parameters were fitted to this load; out: they were not
    distance_over_length: float | None = None
    distance_at_s_mm: float | None = None
    distance_over_length_without_stretch: float | None = None
    end_angle_error_rad: float | None = None
    force_error: float | None = None
    force_N: float | None = None
    rod_force_N: float | None = None
    curvature_error: float | None = None
    curvature_error_at_s_mm: float | None = None
    reason: str = ""
    warning: str = ""

    @property
    def title(self) -> str:
        """The load in words, or the experiment."""
        return self.load or self.experiment

    @property
    def location(self) -> str:
        """Load and pressure, for a sentence."""
        return f"{self.title}, {self.pressure_kPa:g} kPa"


@dataclass(frozen=True)
class EffectRow:
    """A row of effects.json."""

    effect: str
    state: str
    reason: str
    share_of_time: float | None


@dataclass(frozen=True)
class Results:
    """A result directory."""

    directory: Path
    parameters: Mapping[str, Any]  #: empty when the identification was not reached
    curves: tuple[Curve, ...]
    experiments: tuple[StateRow, ...]
    validation: tuple[ValidationRow, ...]
    validation_curves: tuple[Curve, ...]
    effects: tuple[EffectRow, ...]
    run: Mapping[str, Any]
    arm_law: Mapping[str, Any]  #: law.json, empty where the arm's own law was not made
    pictures: Mapping[str, Path]  #: by file name without suffix: body, body_open, II_17kPa

    @property
    def pressures(self) -> tuple[float, ...]:
        """All pressures that occur, ascending, kPa."""
        occurring = {curve.pressure_kPa for curve in self.curves} | {row.pressure_kPa for row in self.experiments}
        return tuple(sorted(occurring))

    @property
    def reached_pressures(self) -> tuple[float, ...]:
        """The pressures at which at least one experiment has an equilibrium, ascending, kPa."""
        reached = {row.pressure_kPa for row in self.experiments if row.reached}
        return tuple(sorted(reached)) or tuple(sorted({curve.pressure_kPa for curve in self.curves}))

    @property
    def cell_mm(self) -> float:
        """Length over which curvatures are averaged, mm; 0 where no file has it."""
        return float((self.run.get("mesh") or {}).get("averaging_mm") or 0.0)

    @property
    def end_zone_mm(self) -> float:
        """Length at each end of the arm where averages over a cell, which reach half a cell farther, are not those of
        inner cells; 0 where the length of a cell is not known."""
        return END_CELLS * self.cell_mm

    @property
    def end_of_third(self) -> tuple[tuple[bool, bool], tuple[float, float]]:
        """Whether x and y of the end are held in experiment III, and the forces on it, N."""
        end = (self.run.get("config") or {}).get("end") or {}
        fx, fy = end.get("force_N") or (0.0, 0.0)
        return (end.get("x_mm") is not None, end.get("y_mm", 0.0) is not None), (fx, fy)

    @property
    def identified_pressures(self) -> tuple[float, ...]:
        """The pressures of the parameters, kPa."""
        return tuple(self.parameters.get("pressures_kPa", ()))

    @property
    def length(self) -> float:
        """Rest length of the material curve, mm; NaN when no file has it."""
        if "length_mm" in self.parameters:
            return float(self.parameters["length_mm"])
        return max((float(curve["s_mm"].max()) for curve in self.curves), default=float("nan"))

    @property
    def failures(self) -> tuple[StateRow, ...]:
        """The pressures that were not reached."""
        return tuple(row for row in self.experiments if not row.reached)

    @property
    def rods(self) -> tuple[str, ...]:
        """The names of the rods that were compared, in the order of the file."""
        return tuple(dict.fromkeys(row.rod for row in self.validation))

    def rows_of(self, rod: str, sample: str = "") -> tuple[ValidationRow, ...]:
        """The rows of one rod; with a sample, in or out, those alone."""
        return tuple(row for row in self.validation if row.rod == rod and sample in ("", row.sample))

    def curve(self, experiment: str, pressure_kPa: float) -> Curve | None:
        """The curve of one experiment at one pressure."""
        for curve in self.curves:
            if curve.experiment == experiment and curve.pressure_kPa == pressure_kPa:
                return curve
        return None

    def loaded_and_free(self, pressure_kPa: float) -> tuple[Curve, Curve] | None:
        """III and II at one pressure, at the same points, with the moment of III; None where they are not there."""
        free, loaded = self.curve("II", pressure_kPa), self.curve("III", pressure_kPa)
        if free is None or loaded is None or not loaded.has("moment_N_mm") or len(free["s_mm"]) != len(loaded["s_mm"]):
            return None
        return loaded, free

    def break_mm(self, pressure_kPa: float) -> float | None:
        """d of the rod that does not stretch; None where it has a single line or is not known."""
        return None if self.at("single_line_suffices", pressure_kPa) else self.at("d_mm", pressure_kPa)

    def at(self, key: str, pressure_kPa: float) -> float | None:
        """The entry at one pressure of a list in parameters.json."""
        values = self.parameters.get(key)
        if pressure_kPa not in self.identified_pressures or not isinstance(values, Sequence):
            return None
        value = values[self.identified_pressures.index(pressure_kPa)]
        return None if value is None else float(value)


def read_results(directory: Path) -> Results:
    """Read every result file in `directory` that is there, with the keys of the present format."""
    pictures = {path.stem: path for path in sorted((directory / "pictures").glob("*.png"))}
    return Results(
        directory=directory,
        parameters=_read_json(directory / "parameters.json", {}),
        curves=_read_curves(directory / "curves.csv"),
        experiments=_read_rows(directory / "experiments.json", StateRow),
        validation=_rows(validation_rows(_read_json(directory / "validation.json", ())), ValidationRow),
        validation_curves=_read_curves(directory / "validation_curves.csv"),
        effects=_read_rows(directory / "effects.json", EffectRow),
        run=_read_json(directory / "run.json", {}),
        arm_law=_read_json(directory / "law.json", {}),
        pictures=pictures,
    )


def _read_json(path: Path, absent: Any) -> Any:
    return with_present_keys(json.loads(path.read_text(encoding="utf-8"))) if path.is_file() else absent


def _read_rows(path: Path, kind: type[Row]) -> tuple[Row, ...]:
    """Rows of a table; columns that `kind` has no field for are left out."""
    return _rows(_read_json(path, ()), kind)


def _rows(rows: Sequence[Mapping[str, Any]], kind: type[Row]) -> tuple[Row, ...]:
    names = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    return tuple(kind(**{name: row[name] for name in names if name in row}) for row in rows)


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
