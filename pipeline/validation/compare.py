"""The rod compared with the finite elements, and the curves of all experiments as one table."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry import Centreline
from geometry.arrays import Array
from pipeline.identification.parameters import Parameters
from pipeline.simulation.outcome import Outcomes, Record
from pipeline.store.json_values import JsonObject
from rod import Load, MomentRange, Rod, RodError, RodSolution, cell_averaged, moment_from_load, without_stretch

CURVE_COLUMNS = (
    *("experiment", "pressure_kPa", "s_mm", "x_mm", "y_mm", "theta_rad", "kappa_per_mm", "kappa_std_per_mm"),
    *("moment_N_mm", "rod_x_mm", "rod_y_mm", "rod_kappa_per_mm"),
)


#: the errors in a row of validation.json; null where the rod has no equilibrium or where there is no such quantity
ERRORS = (
    *("distance_over_length", "distance_at_s_mm", "distance_over_length_without_stretch", "end_angle_error_rad"),
    *("force_error", "force_N", "rod_force_N", "curvature_error", "curvature_error_at_s_mm"),
    *("distance_over_length_with_eccentricity", "force_error_with_eccentricity"),
)


@dataclass(frozen=True)
class ComparedState:
    """A state of the finite elements that rods are compared with."""

    record: Record
    load: str  #: besides the pressure, in words; empty for II and III as identified
    in_sample: bool  #: the parameters were fitted to this very load and pressure


@dataclass(frozen=True)
class NoSolution:
    """A rod that has no equilibrium under a load, or cannot be compared."""

    reason: str  #: a sentence


@dataclass(frozen=True)
class Comparison:
    """The rod at one pressure under the load of one state."""

    state: ComparedState
    inextensible: RodSolution | NoSolution
    extensible: RodSolution | NoSolution
    pitch: float  #: mm, of the cells over which curvatures are averaged
    warning: str  #: a sentence where the moment leaves the range of the identification; else empty

    @property
    def record(self) -> Record:
        """The state of the finite elements."""
        return self.state.record

    @property
    def shape(self) -> RodSolution | None:
        """The inextensible rod, None where it has no equilibrium."""
        return self.inextensible if isinstance(self.inextensible, RodSolution) else None

    def row(self) -> JsonObject:
        """The row of validation.json; distances over the length, angle in rad, force and curvature relative."""
        return {
            "experiment": self.record.experiment,
            "pressure_kPa": self.record.pressure_kPa,
            "load": self.state.load,
            "sample": "in" if self.state.in_sample else "out",
            **dict.fromkeys(ERRORS),
            **self._errors(),
            "reason": _reason(self.inextensible),
            "reason_with_eccentricity": _reason(self.extensible),
            "warning": self.warning,
        }

    def _errors(self) -> dict[str, float]:
        if isinstance(self.inextensible, NoSolution):
            return {}
        curve, force = self.record.centreline, self.record.load.force[1]
        errors = {**_shape_errors(curve, self.inextensible), **_curvature_errors(curve, self.inextensible, self.pitch)}
        if isinstance(self.extensible, RodSolution):
            distance = float(_distances(self.extensible, curve).max())
            errors["distance_over_length_with_eccentricity"] = distance / curve.length
        if force and self.record.experiment == "III":
            rod_force = float(self.inextensible.force[1])
            errors |= {"force_N": force, "rod_force_N": rod_force, "force_error": rod_force / force - 1.0}
            if isinstance(self.extensible, RodSolution):
                errors["force_error_with_eccentricity"] = float(self.extensible.force[1]) / force - 1.0
        return errors


def _reason(solution: RodSolution | NoSolution) -> str:
    return solution.reason if isinstance(solution, NoSolution) else ""


def _shape_errors(curve: Centreline, shape: RodSolution) -> dict[str, float]:
    distances = _distances(shape, curve)
    ends = np.unwrap([float(curve.angle[-1]), float(shape.theta[-1])])
    return {
        "distance_over_length": float(distances.max()) / curve.length,
        "distance_at_s_mm": float(curve.s[distances.argmax()] - curve.s[0]),
        "distance_over_length_without_stretch": float(_distances(shape, without_stretch(curve)).max()) / curve.length,
        "end_angle_error_rad": float(ends[1] - ends[0]),
    }


def _curvature_errors(curve: Centreline, shape: RodSolution, pitch: float) -> dict[str, float]:
    """Largest difference of the cell-averaged curvatures over the largest of them, and where (mm)."""
    x, y = shape.positions(curve.s - curve.s[0]).T
    try:
        solid, rod = (cell_averaged(shown, pitch) for shown in (curve, Centreline(curve.s, x, y)))
    except RodError:  # an arm of one or two cells has no cell averages to compare
        return {}
    differences = np.abs(rod.kappa - solid.kappa)
    return {
        "curvature_error": float(differences.max() / np.abs(solid.kappa).max()),
        "curvature_error_at_s_mm": float(solid.s[differences.argmax()]),
    }


def _distances(shape: RodSolution, curve: Centreline) -> Array:
    """(n,) mm, at equal s."""
    difference = shape.positions(curve.s - curve.s[0]) - np.column_stack([curve.x, curve.y])
    return np.hypot(difference[:, 0], difference[:, 1])


@dataclass(frozen=True)
class Rods:
    """The rod of one pressure, inextensible and extensible, and the range of moments of the identification."""

    inextensible: Rod
    extensible: Rod
    moment_range: MomentRange


def compare(parameters: Sequence[Parameters]) -> tuple[Comparison, ...]:
    """The rod of every pressure, unloaded as in II and with the height of its end prescribed as in III."""
    comparisons = []
    for p in parameters:
        rods = Rods(p.rod, p.extensible_rod, p.moment_range)
        for record in (p.free, p.loaded):
            comparisons.append(compare_rods(rods, ComparedState(record, "", True), p.kappa.pitch))
    return tuple(comparisons)


def compare_rods(rods: Rods, state: ComparedState, pitch: float) -> Comparison:
    """The rods under the load of a state: their end at the height of III with the couple that the supported
    edge exerts there, the force of dead, nothing in II."""
    record, length = state.record, state.record.centreline.length
    identified = rods.inextensible.length
    if abs(length - identified) > 1e-6 * identified:
        reason = f"The numbers are those of an arm of {identified:g} mm, the shape is one of {length:g} mm."
        return not_compared(state, reason, pitch)
    load = record.load if record.experiment in ("III", "dead") else Load()
    end_y = float(record.centreline.y[-1]) if record.experiment == "III" else None
    shape = _solution(rods.inextensible, load, end_y)
    if isinstance(shape, NoSolution):
        return not_compared(state, shape.reason, pitch)
    extensible = _solution(rods.extensible, load, end_y)
    return Comparison(state, shape, extensible, pitch, rods.moment_range.warning(shape))


def not_compared(state: ComparedState, reason: str, pitch: float) -> Comparison:
    """A state without a rod to compare with."""
    return Comparison(state, NoSolution(reason), NoSolution(reason), pitch, "")


def _solution(rod: Rod, load: Load, end_y: float | None) -> RodSolution | NoSolution:
    try:
        return rod.under(load, end_y)
    except RodError as failure:
        return NoSolution(str(failure))


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
