"""An arm that was measured beside its rod: how far they differ, and whether that is within what is known."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.config.tolerances import Tolerances
from pipeline.errors import InputError
from pipeline.measured.aligned import aligned, check_degrees
from pipeline.measured.calibration import quantile_of
from pipeline.measured.fit import LawRods, effects_on
from pipeline.measured.predicted import AS_WRITTEN, Numbers
from pipeline.measured.rows import Measurements
from pipeline.measured.saved import SavedCalibration, read_calibration
from pipeline.measured.table import read_measurements
from pipeline.measured.unknowns import BuiltArm, tolerance_unknowns
from pipeline.notes.rods import RodErrors, mesh_errors
from pipeline.results.files import read_results
from pipeline.results.values import Run
from pipeline.rods.choice import KINDS, RodOfRun, check_kind, choose_rod
from rod.arm_law.law import ArmLaw

#: what may make an arm differ from its rod, in words
PARTS = {"rod": "the rod", "mesh": "the mesh", "tolerances": "the tolerances", "calibration": "the calibration"}


@dataclass(frozen=True)
class Compared:
    """One measured number beside that of the rod."""

    line: int
    pressure_kPa: float
    load: str
    quantity: str  #: with its unit, as in the titles of the file
    measured: float
    predicted: float
    allowed: float  #: by what is known of rod, mesh, and tolerances or calibration
    s_mm: float | None = None  #: of a point along the arm

    @property
    def difference(self) -> float:
        """Measured less predicted."""
        return self.measured - self.predicted

    @property
    def is_within(self) -> bool:
        """Whether it is no larger than what is allowed."""
        return abs(self.difference) <= self.allowed


@dataclass(frozen=True)
class Comparison:
    """Everything measured on an arm beside its rod."""

    file: str
    design: str
    length_mm: float
    rows: tuple[Compared, ...]
    shares: dict[str, float]  #: root mean square of what each part allows over that of all, by `PARTS`
    is_calibrated: bool
    unknown: tuple[str, ...] = ()  #: what is not known and so not counted, a sentence each

    def rms(self, unit: str) -> float:
        """Root mean square of the differences in mm, deg or N; of mm the distance in the plane. NaN without any."""
        found = [row.difference for row in self.rows if row.quantity.endswith(f"_{unit}")]
        pairs = 2.0 if unit == "mm" and any(row.quantity.endswith("x_mm") for row in self.rows) else 1.0
        return math.sqrt(pairs * sum(d * d for d in found) / len(found)) if found else math.nan

    @property
    def within(self) -> float:
        """Part of the numbers that are within what is allowed."""
        return sum(row.is_within for row in self.rows) / len(self.rows)

    @property
    def largest(self) -> str:
        """Which part allows most, of `PARTS`; empty where nothing is known."""
        return max(self.shares, key=lambda name: self.shares[name], default="")

    @property
    def lines(self) -> tuple[str, ...]:
        """What was found, in words."""
        sizes = [(self.rms("mm"), "mm", f" ({100.0 * self.rms('mm') / self.length_mm:.2g} % of l)")]
        sizes += [(self.rms("deg"), "degrees", ""), (self.rms("N"), "N", "")]
        words = ", ".join(f"{rms:.2g} {unit}{more}" for rms, unit, more in sizes if math.isfinite(rms))
        inside = sum(row.is_within for row in self.rows)
        allowed = "the 90 % intervals of the calibration" if self.is_calibrated else "rod, mesh and tolerances"
        most = f"; largest part: {PARTS[self.largest]}" if self.largest else ""
        return (
            f"{self.design}: root mean square of the differences {words}.",
            f"{inside} of {len(self.rows)} numbers are within {allowed}{most}.",
            *self.unknown,
        )


def compare_files(folder: Path, file: Path, align: bool = False, kind: str | None = None) -> Comparison:
    """The measurements of a file beside the rod of a result folder. Raises InputError."""
    check_kind(kind, "--rod ")
    run, measurements = read_results(folder), read_measurements(file)
    rods = choose_rod(run, kind)
    return compare(run, rods, aligned(measurements, rods.at) if align else measurements)


def compare(run: Run, rods: RodOfRun, measurements: Measurements) -> Comparison:
    """Measurements beside one of the rods of a run. Raises InputError, with file and line."""
    numbers, saved = Numbers.of(measurements), read_calibration(run.directory)
    setup = AS_WRITTEN if saved is None else saved.setup
    if isinstance(rods.source, ArmLaw):  # an offset of the gauge may leave its pressures a little
        _check(numbers, rods)
        predicted = numbers.predicted(LawRods(rods.source), setup)
    else:
        predicted = numbers.predicted(rods.at, setup)
    check_degrees(numbers, predicted)
    bands, unknown = _bands(run, rods, numbers, predicted, saved)
    total = np.sum(list(bands.values()), axis=0) if bands else np.zeros(len(numbers.values))
    columns = zip(
        numbers.rows, numbers.titles, numbers.values.tolist(), predicted.tolist(), total.tolist(), strict=True
    )
    rows = tuple(
        Compared(row.line, row.state.pressure_kPa, row.state.load, title, value, rod, allowed,
                 row.s_mm if title in ("x_mm", "y_mm") else None)
        for row, title, value, rod, allowed in columns
    )  # fmt: skip
    return Comparison(measurements.file, run.design, run.length_mm, rows, _shares(bands), saved is not None, unknown)


def _check(numbers: Numbers, rods: RodOfRun) -> None:
    low, high = rods.pressures_kPa
    for row in numbers.rows:
        if not low <= row.state.pressure_kPa <= high:
            where = f"{numbers.measurements.file}: line {row.line}"
            raise InputError(f"{where}: {row.state.pressure_kPa:g} kPa is outside the rod: {low:g} to {high:g} kPa")


def _shares(bands: dict[str, Array]) -> dict[str, float]:
    sizes = {name: float(np.sqrt(np.mean(band**2))) for name, band in bands.items()}
    return {name: size / (sum(sizes.values()) or 1.0) for name, size in sizes.items()}


def _bands(
    run: Run, rods: RodOfRun, numbers: Numbers, predicted: Array, saved: SavedCalibration | None
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """What each part allows, (n,) in the units of the numbers; and what is not known."""
    unknown: list[str] = []
    if saved is not None and isinstance(rods.source, ArmLaw):
        arm = BuiltArm(rods.source, saved.unknowns, saved.setup)
        effects = effects_on(arm, numbers, np.zeros(len(saved.unknowns)))
        scatter = np.array([saved.posterior.spread.scatter.get(unit, 0.0) for unit in numbers.units])
        variance = np.maximum(np.diag(saved.posterior.error_covariance(effects)), 0.0) + scatter**2
        return {"calibration": quantile_of(saved.posterior) * np.sqrt(variance)}, ()
    name = KINDS[rods.kind]
    bands: dict[str, Array] = {}
    of_rod, of_mesh = RodErrors.of(run, name), mesh_errors(run, name)
    if math.isfinite(of_rod.shape) and run.errors_of(name):
        largest = max((abs(row.force_N) for row in run.rod_errors if row.force_N is not None), default=0.0)
        bands["rod"] = _allowed(numbers, of_rod.shape, run.length_mm, of_rod.force * largest)
    else:
        unknown.append("The error of the rod is not known, because no whole arm was solved.")
    if of_mesh.kappa_0 is None:
        unknown.append("The error of the mesh is not known.")
    else:
        bands["mesh"] = _of_mesh(numbers, predicted, run.length_mm, of_mesh.kappa_0, of_mesh.force or 0.0)
    if isinstance(rods.source, ArmLaw) and rods.source.rates:
        tolerances = Tolerances.from_record(run.config.get("tolerances"))
        unknowns = tolerance_unknowns(rods.source, tolerances, float(numbers.pressures.max()))
        arm = BuiltArm(rods.source, unknowns)
        by = effects_on(arm, numbers, np.zeros(len(unknowns))).by_unknown
        bands["tolerances"] = np.sqrt(by**2 @ np.array([unknown.std for unknown in unknowns]) ** 2)
    else:
        unknown.append("Tolerances are not counted, because this rod has no derivatives.")
    return bands, tuple(unknown)


def _allowed(numbers: Numbers, shape: float, length_mm: float, force_N: float) -> Array:
    """(n,) of an error of the shape over the length, which turns the end by as much as an arc's does, and of forces."""
    by_unit = {"mm": shape * length_mm, "N": force_N, "deg": math.degrees(2.0 * shape)}
    return np.array([by_unit[unit] for unit in numbers.units])


def _of_mesh(numbers: Numbers, predicted: Array, length_mm: float, curvature: float, force: float) -> Array:
    """(n,) of relative errors of the curvature and of forces: of displacements from the straight arm, and angles."""
    straight = {"tip_x": length_mm}
    origins = [
        row.s_mm or 0.0 if name == "x" else straight.get(name, 0.0)
        for row, name in zip(numbers.rows, numbers.names, strict=True)
    ]
    relative = np.array([force if unit == "N" else curvature for unit in numbers.units])
    return np.asarray(relative * np.abs(predicted - np.array(origins)))
