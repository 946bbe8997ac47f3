"""An arm that was measured beside its rod: how far they differ, and whether that is within what is known."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.answers.measured.aligned import aligned
from pipeline.answers.measured.doubtful import check_numbers, doubt_of_origin
from pipeline.answers.measured.fit import effects_on, off_range, telling
from pipeline.answers.measured.page import comparison_page
from pipeline.answers.measured.predicted import AS_WRITTEN, Compared, Curves, LawRods, Numbers
from pipeline.answers.measured.saved import SavedCalibration, read_calibration
from pipeline.answers.measured.table import read_measurements
from pipeline.answers.measured.unknowns import BuiltArm, tolerance_unknowns
from pipeline.answers.rods.choice import KINDS, choose_rod, plane_of, run_along
from pipeline.answers.rods.rods import Rods
from pipeline.results.rod_errors import RodErrors, mesh_errors
from pipeline.values.errors import InputError
from pipeline.values.run import Run
from pipeline.values.table import Table


@dataclass(frozen=True)
class Comparison:
    """Everything measured on an arm beside its rod."""

    file: str
    design: str
    length_mm: float
    rows: tuple[Compared, ...]
    #: root mean square of what each part allows over that of all: rod, mesh, tolerances, or calibration
    shares: dict[str, float]
    is_calibrated: bool
    curves: Curves = field(repr=False)  #: of the rod
    unknown: tuple[str, ...] = ()  #: what is not known and so not counted, a sentence each

    def rms(self, unit: str) -> float:
        """Root mean square of the differences in mm, deg or N; of mm the distance in the plane. NaN without any."""
        found = [row.difference for row in self.rows if row.quantity.endswith(f"_{unit}")]
        pairs = 2.0 if unit == "mm" and any(row.quantity.endswith("x_mm") for row in self.rows) else 1.0
        return math.sqrt(pairs * sum(d * d for d in found) / len(found)) if found else math.nan

    @property
    def table(self) -> Table:
        """One row for each number."""
        return Table.of(
            self.rows,
            ("line", lambda row: str(row.line)),
            ("pressure (kPa)", lambda row: f"{row.pressure_kPa:g}"),
            ("load", lambda row: row.load),
            ("quantity", lambda row: row.quantity),
            ("measured", lambda row: f"{row.measured:.4g}"),
            ("predicted", lambda row: f"{row.predicted:.4g}"),
            ("difference", lambda row: f"{row.difference:.2g}"),
            ("allowed", lambda row: f"{row.allowed:.2g}"),
            ("", lambda row: "" if row.is_within else "outside"),
        )

    def __str__(self) -> str:
        return "\n".join([str(self.table), *self.lines])

    @property
    def within(self) -> float:
        """Part of the numbers that are within what is allowed."""
        return sum(row.is_within for row in self.rows) / len(self.rows)

    @property
    def largest(self) -> str:
        """Which part allows most; empty where nothing is known."""
        return max(self.shares, key=lambda name: self.shares[name], default="")

    @property
    def page(self) -> str:
        """The arm and its rod in a picture, an HTML page."""
        return comparison_page(self.design, self.rows, self.curves)

    @property
    def lines(self) -> tuple[str, ...]:
        """What was found, in words."""
        sizes = [(self.rms("mm"), "mm", f" ({100.0 * self.rms('mm') / self.length_mm:.2g} % of l)")]
        sizes += [(self.rms("deg"), "degrees", ""), (self.rms("N"), "N", "")]
        sizes += [(self.rms("Hz"), "Hz", ""), (self.rms("ratio"), "of the damping ratio", "")]
        words = ", ".join(f"{rms:.2g} {unit}{more}" for rms, unit, more in sizes if math.isfinite(rms))
        inside = sum(row.is_within for row in self.rows)
        allowed = "the 90 % intervals of the calibration" if self.is_calibrated else "rod, mesh and tolerances"
        most = f"; largest part: the {self.largest}" if self.largest else ""
        return (
            f"{self.design}: root mean square of the differences {words}.",
            f"{inside} of {len(self.rows)} numbers are within {allowed}{most}.",
            *self.unknown,
        )


def compare_files(
    folder: Path, file: Path, align: bool = False, ratio: str | None = None, tell: Callable[[str], object] = str
) -> Comparison:
    """The measurements of a file beside the rod of a result folder.

    ratio: of the pressures of a law that has several. tell: is told the time left. Raises InputError.
    """
    run, measurements = run_along(folder, ratio), read_measurements(file)
    rods = choose_rod(run)
    if not rods.law.has_plane:
        plane_of(run, "a comparison")  # refuses it
    saved = read_calibration(run.directory)
    setup = saved.setup if saved else AS_WRITTEN
    measurements = aligned(measurements, rods.at, setup) if align else measurements
    numbers = Numbers.of(measurements)
    low, high = rods.pressures_kPa
    measurements.check_pressures(low, high, f"the rod, which goes from {low:g} to {high:g} kPa")
    law = rods.law.plane
    if measurements.are_in_time and law is None:
        raise InputError(f"{measurements.file}: a motion is compared with the arm's own law; take rod law")
    any_rod = LawRods(law, run.material) if law else rods.at
    predicted = numbers.predicted(any_rod, setup)
    check_numbers(numbers, predicted, run.length_mm)
    bands, unknown = _bands(run, rods, numbers, predicted, saved, tell)
    total = np.sum(list(bands.values()), axis=0) if bands else np.zeros(len(numbers.values))
    rows, unknown = numbers.beside(predicted, total), (*unknown, *(off_range(law, numbers, setup) if law else ()))
    if saved is None and not all(row.is_within for row in rows):
        unknown = (*unknown, *doubt_of_origin(measurements))
    curves, sizes = numbers.curves(any_rod, setup), {name: float(np.sqrt(np.mean(of**2))) for name, of in bands.items()}
    shares = {name: size / (sum(sizes.values()) or 1.0) for name, size in sizes.items()}
    return Comparison(measurements.file, run.design, run.length_mm, rows, shares, saved is not None, curves, unknown)


def _bands(
    run: Run,
    rods: Rods,
    numbers: Numbers,
    predicted: Array,
    saved: SavedCalibration | None,
    tell: Callable[[str], object],
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """What each part allows, (n,) in the units of the numbers; and what is not known."""
    law = rods.law.plane
    if saved is not None and law is not None:
        told = telling(tell, len(saved.unknowns), len(numbers.values))
        effects = effects_on(BuiltArm(law, saved.unknowns, saved.setup, run.material, told), numbers)
        return {"calibration": saved.posterior.quantile * saved.posterior.deviations(effects, numbers.units)}, ()
    name, unknown = KINDS[rods.kind], list[str]()
    bands: dict[str, Array] = {}
    of_rod, of_mesh = RodErrors.of(run, name), mesh_errors(run, name)
    if math.isfinite(of_rod.shape) and run.errors_of(name):
        largest = max((abs(row.force_N) for row in run.rod_errors if row.force_N is not None), default=0.0)
        # an arc whose end moves by a part of the length turns it by twice as many radians
        shape = {"mm": of_rod.shape * run.length_mm, "N": of_rod.force * largest, "deg": math.degrees(2 * of_rod.shape)}
        bands["rod"] = np.array([shape.get(unit, 0.0) for unit in numbers.units])
    else:
        unknown.append("The error of the rod is not known, because no whole arm was solved.")
    if of_mesh.kappa_0 is None:
        unknown.append("The error of the mesh is not known.")
    else:
        relative = np.array([of_mesh.force or 0.0 if unit == "N" else of_mesh.kappa_0 for unit in numbers.units])
        bands["mesh"] = relative * np.abs(predicted - numbers.straight(run.length_mm))
    if law is not None and law.rates:
        unknowns = tolerance_unknowns(law, run.config, float(numbers.pressures.max()) or law.pressures[-1])
        told = telling(tell, len(unknowns), len(numbers.values))
        by = effects_on(BuiltArm(law, unknowns, AS_WRITTEN, run.material, told), numbers).by_unknown
        bands["tolerances"] = np.sqrt(by**2 @ np.array([unknown.std_before for unknown in unknowns]) ** 2)
    else:
        unknown.append("Tolerances are not counted, because this rod has no derivatives.")
    return bands, tuple(unknown)
