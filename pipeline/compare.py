"""The rod held against the finite elements, and the curves of all experiments as one table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry import Centreline
from pipeline.parameters import Parameters
from pipeline.simulate import Outcome, Record
from rod import RodError, RodSolution, cell_averaged, moment_from_force, without_stretch

__all__ = ["CURVE_COLUMNS", "Comparison", "compare", "curve_rows"]

Array = NDArray[np.float64]

CURVE_COLUMNS = (
    *("experiment", "pressure_kPa", "s_mm", "x_mm", "y_mm", "theta_rad", "kappa_per_mm", "kappa_std_per_mm"),
    *("moment_N_mm", "rod_x_mm", "rod_y_mm"),
)


@dataclass(frozen=True)
class Comparison:
    """The rod at one pressure under the load of one experiment, or why there is none."""

    record: Record
    shape: RodSolution | None
    reason: str  #: empty, or a sentence

    def row(self) -> dict[str, Any]:
        """As in validation.json; distances over the length, angle in rad, force relative."""
        row: dict[str, Any] = {
            "experiment": self.record.experiment,
            "pressure_kPa": self.record.pressure_kPa,
            "distance_over_length": None,
            "distance_over_length_without_stretch": None,
            "end_angle_error_rad": None,
            "force_error": None,
            "rod_force_N": None,
            "reason": self.reason,
        }
        if self.shape is None:
            return row
        curve = self.record.centreline
        row["distance_over_length"] = self._distance(curve)
        row["distance_over_length_without_stretch"] = self._distance(without_stretch(curve))
        ends = np.unwrap([float(curve.angle[-1]), float(self.shape.theta[-1])])
        row["end_angle_error_rad"] = float(ends[1] - ends[0])
        force = self.record.end_force[1]
        if force:
            row["rod_force_N"] = float(self.shape.force[1])
            row["force_error"] = float(self.shape.force[1]) / force - 1.0
        return row

    def _distance(self, curve: Centreline) -> float:
        assert self.shape is not None
        off = self.shape.positions(curve.s - curve.s[0]) - np.column_stack([curve.x, curve.y])
        return float(np.hypot(off[:, 0], off[:, 1]).max()) / curve.length


def compare(found: Sequence[Parameters]) -> tuple[Comparison, ...]:
    """The rod of every pressure, unloaded as in II and with its end held as in III."""
    rows = []
    for parameters in found:
        rows.append(_solved(parameters, parameters.free, None))
        rows.append(_solved(parameters, parameters.loaded, float(parameters.loaded.centreline.y[-1])))
    return tuple(rows)


def _solved(parameters: Parameters, record: Record, end_y: float | None) -> Comparison:
    try:
        return Comparison(record, parameters.rod.solve(end_y=end_y), "")
    except RodError as failure:
        return Comparison(record, None, str(failure))


def curve_rows(
    outcomes: Mapping[str, Outcome], comparisons: Sequence[Comparison], pitch: float
) -> list[tuple[Any, ...]]:
    """Rows of curves.csv at the cell-averaged curvature's points, in the order of `CURVE_COLUMNS`."""
    shapes = {(c.record.experiment, c.record.pressure_kPa): c.shape for c in comparisons}
    rows: list[tuple[Any, ...]] = []
    for outcome in outcomes.values():
        for record in outcome.records:
            shape = shapes.get((record.experiment, record.pressure_kPa))
            rows.extend(_rows_of(record, shape, pitch))
    return rows


def _rows_of(record: Record, shape: RodSolution | None, pitch: float) -> list[tuple[Any, ...]]:
    curve = record.centreline
    moment = moment_from_force(curve, record.end_force, record.end_couple)
    s = curve.s - curve.s[0]
    kappa, std = _curvature(curve, s, pitch)
    middles = 0.5 * (s[1:] + s[:-1])
    theta = np.interp(s, middles, np.unwrap(curve.angle))
    rod = shape.positions(s) if shape is not None else np.full((len(s), 2), np.nan)
    table = np.column_stack([s, curve.x, curve.y, theta, kappa, std, moment.value, rod])
    return [(record.experiment, record.pressure_kPa, *values) for values in table.tolist()]


def _curvature(curve: Centreline, s: Array, pitch: float) -> tuple[Array, Array]:
    """Cell-averaged curvature and its standard deviation at s (n,); NaN where there is no whole cell around s."""
    try:
        curvature = cell_averaged(curve, pitch)
    except RodError:  # an arm of one or two cells has none
        return np.full_like(s, np.nan), np.full_like(s, np.nan)
    kappa = np.interp(s, curvature.s, curvature.kappa, left=np.nan, right=np.nan)
    return kappa, np.interp(s, curvature.s, curvature.kappa_std, left=np.nan, right=np.nan)
