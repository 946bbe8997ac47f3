"""The rod held against the finite elements, and the curves of all experiments as one table."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry import Centreline
from geometry.arrays import Array
from pipeline.identification.parameters import Parameters
from pipeline.simulation.outcome import Outcomes, Record
from rod import Load, MomentRange, Rod, RodError, RodSolution, cell_averaged, moment_from_load, without_stretch

CURVE_COLUMNS = (
    *("experiment", "pressure_kPa", "s_mm", "x_mm", "y_mm", "theta_rad", "kappa_per_mm", "kappa_std_per_mm"),
    *("moment_N_mm", "rod_x_mm", "rod_y_mm", "rod_kappa_per_mm"),
)


@dataclass(frozen=True)
class Comparison:
    """The rod at one pressure under the load of one experiment, or why there is none."""

    record: Record
    shape: RodSolution | None
    reason: str  #: empty, or a sentence
    pitch: float  #: mm
    extensible: RodSolution | None = None  #: of the extensible rod
    warning: str = ""  #: a sentence where the moment leaves what the identification has seen
    load: str = ""  #: besides the pressure, in words; empty for II and III as identified
    in_sample: bool = True  #: the numbers were fitted to this very load and pressure

    def row(self) -> dict[str, Any]:
        """As in validation.json; distances over the length, angle in rad, force and curvature relative."""
        row: dict[str, Any] = {
            "experiment": self.record.experiment,
            "pressure_kPa": self.record.pressure_kPa,
            "load": self.load,
            "sample": "in" if self.in_sample else "out",
            "distance_over_length": None,
            "distance_at_s_mm": None,
            "distance_over_length_without_stretch": None,
            "end_angle_error_rad": None,
            "force_error": None,
            "force_N": None,
            "rod_force_N": None,
            "curvature_error": None,
            "curvature_error_at_s_mm": None,
            "distance_over_length_with_eccentricity": None,
            "force_error_with_eccentricity": None,
            "reason": self.reason,
            "warning": self.warning,
        }
        if self.shape is None:
            return row
        curve = self.record.centreline
        off = self._distances(self.shape, curve)
        row["distance_over_length"] = float(off.max()) / curve.length
        row["distance_at_s_mm"] = float(curve.s[off.argmax()] - curve.s[0])
        row["distance_over_length_without_stretch"] = (
            float(self._distances(self.shape, without_stretch(curve)).max()) / curve.length
        )
        ends = np.unwrap([float(curve.angle[-1]), float(self.shape.theta[-1])])
        row["end_angle_error_rad"] = float(ends[1] - ends[0])
        force = self.record.load.force[1]
        if force and self.record.experiment == "III":
            row["force_N"], row["rod_force_N"] = force, float(self.shape.force[1])
            row["force_error"] = float(self.shape.force[1]) / force - 1.0
            if self.extensible is not None:
                row["force_error_with_eccentricity"] = float(self.extensible.force[1]) / force - 1.0
        if self.extensible is not None:
            row["distance_over_length_with_eccentricity"] = (
                float(self._distances(self.extensible, curve).max()) / curve.length
            )
        row["curvature_error"], row["curvature_error_at_s_mm"] = self._curvature_error(self.shape, curve)
        return row

    @staticmethod
    def _distances(shape: RodSolution, curve: Centreline) -> Array:
        """(n,) mm, at equal s."""
        off = shape.positions(curve.s - curve.s[0]) - np.column_stack([curve.x, curve.y])
        return np.hypot(off[:, 0], off[:, 1])

    def _curvature_error(self, shape: RodSolution, curve: Centreline) -> tuple[float | None, float | None]:
        """Largest difference of the cell-averaged curvatures over the largest of them, and where (mm)."""
        places = shape.positions(curve.s - curve.s[0])
        try:
            found = [cell_averaged(c, self.pitch) for c in (curve, Centreline(curve.s, places[:, 0], places[:, 1]))]
        except RodError:  # an arm of one or two cells has none
            return None, None
        off = np.abs(found[1].kappa - found[0].kappa)
        return float(off.max() / np.abs(found[0].kappa).max()), float(found[0].s[off.argmax()])


@dataclass(frozen=True)
class Rods:
    """The rod of one pressure, inextensible and extensible, and the range of moments of the identification."""

    inextensible: Rod
    extensible: Rod
    moment_range: MomentRange


def compare(found: Sequence[Parameters]) -> tuple[Comparison, ...]:
    """The rod of every pressure, unloaded as in II and with its end held as in III."""
    rows = []
    for parameters in found:
        rods = Rods(parameters.rod, parameters.extensible_rod, parameters.moment_range)
        for record in (parameters.free, parameters.loaded):
            rows.append(held_against(rods, record, parameters.kappa.pitch))
    return tuple(rows)


def held_against(rods: Rods, record: Record, pitch: float, load: str = "", in_sample: bool = True) -> Comparison:
    """The rod under the load of a record: its end at the height of III with the couple that the held edge exerts
    there, the force of dead, nothing in II."""
    length = record.centreline.length
    identified = rods.inextensible.length
    if abs(length - identified) > 1e-6 * identified:
        reason = f"The numbers are those of an arm of {identified:g} mm, the shape is one of {length:g} mm."
        return Comparison(record, None, reason, pitch, load=load, in_sample=in_sample)
    applied = record.load if record.experiment in ("III", "dead") else Load()
    end_y = float(record.centreline.y[-1]) if record.experiment == "III" else None
    try:
        shape = rods.inextensible.under(applied, end_y)
    except RodError as failure:
        return Comparison(record, None, str(failure), pitch, load=load, in_sample=in_sample)
    warning = rods.moment_range.warning(shape)
    return Comparison(record, shape, "", pitch, _solved(rods.extensible, applied, end_y), warning, load, in_sample)


def _solved(rod: Rod, load: Load, end_y: float | None) -> RodSolution | None:
    try:
        return rod.under(load, end_y)
    except RodError:  # the inextensible rod stands for both
        return None


def curve_rows(outcomes: Outcomes, comparisons: Sequence[Comparison], pitch: float) -> list[tuple[Any, ...]]:
    """Rows of curves.csv at the cell-averaged curvature's points, in the order of `CURVE_COLUMNS`."""
    shapes = {(c.record.experiment, c.record.pressure_kPa): c.shape for c in comparisons}
    rows: list[tuple[Any, ...]] = []
    for record in outcomes.records:
        rows.extend(rows_of(record, shapes.get((record.experiment, record.pressure_kPa)), pitch))
    return rows


def rows_of(record: Record, shape: RodSolution | None, pitch: float) -> list[tuple[Any, ...]]:
    """The curve of one record and its rod, in the order of `CURVE_COLUMNS`."""
    curve = record.centreline
    moment = moment_from_load(curve, record.load)
    s = curve.s - curve.s[0]
    kappa, std = _curvature(curve, s, pitch)
    middles = 0.5 * (s[1:] + s[:-1])
    theta = np.interp(s, middles, np.unwrap(curve.angle))
    rod = shape.positions(s) if shape is not None else np.full((len(s), 2), np.nan)
    bent = np.full(len(s), np.nan) if shape is None else _curvature(Centreline(s, rod[:, 0], rod[:, 1]), s, pitch)[0]
    table = np.column_stack([s, curve.x, curve.y, theta, kappa, std, moment.value, rod, bent])
    return [(record.experiment, record.pressure_kPa, *values) for values in table.tolist()]


def _curvature(curve: Centreline, s: Array, pitch: float) -> tuple[Array, Array]:
    """Cell-averaged curvature and its standard deviation at s (n,); the ends repeat the nearest cell's value."""
    try:
        curvature = cell_averaged(curve, pitch)
    except RodError:  # an arm of one or two cells has none
        return np.full_like(s, np.nan), np.full_like(s, np.nan)
    kappa = np.interp(s, curvature.s, curvature.kappa)
    return kappa, np.interp(s, curvature.s, curvature.kappa_std)
