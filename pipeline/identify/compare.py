"""The rods compared with the finite elements, with five parameters and with the arm's own law, and the curves of all
experiments as one table."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from geometry import Centreline
from geometry.arrays import Array
from pipeline.simulate.outcome import Outcomes, Record
from pipeline.values.formats import ARM_LAW, CURVE_COLUMNS, CURVE_PREFIXES, FIVE
from pipeline.values.parameters import RodParameters
from pipeline.values.run import Curve
from pipeline.values.run import RodError as ErrorOfRod
from rod import ArmLaw, Load, Rod, RodError, RodSolution, cell_averaged, moment_from_load, without_stretch
from rod.same_pressure import is_among

#: the rods of one pressure by their names; why there is none
Rods = Mapping[str, Rod | RodError]


@dataclass(frozen=True)
class ArmRods:
    """All rods of an arm over the pressure."""

    parameters: RodParameters = field(repr=False)  #: without pressures: no rods with five parameters
    law: ArmLaw | None  #: None: no rod with the law of the arm
    start: tuple[float, float] = (0.0, 0.0)  #: mm, the clamped end of the material curve

    @property
    def identified_kPa(self) -> tuple[float, ...]:
        """The pressures that have five parameters."""
        return self.parameters.pressures_kPa

    def at(self, pressure: float) -> Rods:
        """The rods at a pressure in kPa, between identified ones by cubics; a reason for each that is none."""
        law, rods, sources = self.law, dict[str, Rod | RodError](), dict[str, Callable[[float], Rod]]()
        if self.identified_kPa:
            sources[FIVE] = self.parameters.rods().at
        if law is not None:
            sources[ARM_LAW] = lambda pressure: Rod(law.length, law=law.at(pressure))
        for name, rod_at in sources.items():
            try:
                rods[name] = replace(rod_at(pressure), start=self.start)
            except RodError as failure:
                rods[name] = failure
        return rods


@dataclass(frozen=True)
class RodUnderLoad:
    """A rod under the load of a state, or why there is none."""

    rod: str  #: one of the names in `pipeline.identify.compare`
    solution: RodSolution | RodError
    is_fitted: bool = False  #: whether the five parameters are its own
    warning: str = ""  #: a sentence where the moment leaves the range of the identification


@dataclass(frozen=True)
class Comparison:
    """The rods at one pressure under the load of one state."""

    record: Record  #: the state of the finite elements
    load: str  #: besides the pressure, in words; empty for II and III as identified
    in_sample: bool  #: the five parameters were fitted to this very load and pressure
    rods: tuple[RodUnderLoad, ...]
    pitch: float  #: mm, of the cells over which curvatures are averaged

    def shape(self, name: str) -> RodSolution | None:
        """The rod of this name; None where it was not compared or has no equilibrium."""
        solutions = (rod.solution for rod in self.rods if rod.rod == name)
        return next((solution for solution in solutions if not isinstance(solution, RodError)), None)

    @property
    def errors(self) -> tuple[ErrorOfRod, ...]:
        """The errors of every rod: the rows of validation.json."""
        return tuple(self._error(rod) for rod in self.rods)

    def _error(self, rod: RodUnderLoad) -> ErrorOfRod:
        found = rod.solution
        return ErrorOfRod(
            experiment=self.record.experiment,
            pressure_kPa=self.record.pressure_kPa,
            load=self.load,
            rod=rod.rod,
            sample="in" if self.in_sample and rod.is_fitted else "out",
            warning=rod.warning,
            **({"reason": str(found)} if isinstance(found, RodError) else self._errors(found)),
        )

    def _errors(self, shape: RodSolution) -> dict[str, Any]:
        curve = self.record.centreline
        errors = {**_shape_errors(curve, shape), **_curvature_errors(curve, shape, self.pitch)}
        return errors | _force_errors(self.record, shape)


def _shape_errors(curve: Centreline, shape: RodSolution) -> dict[str, float]:
    distances = _distances(shape, curve)
    ends = np.unwrap([curve.end_angle, shape.along(curve).end_angle])
    return {
        "distance_over_length": float(distances.max()) / curve.length,
        "distance_at_s_mm": float(curve.s[distances.argmax()] - curve.s[0]),
        "distance_over_length_without_stretch": float(_distances(shape, without_stretch(curve)).max()) / curve.length,
        "end_angle_error_rad": float(ends[1] - ends[0]),
    }


def _force_errors(record: Record, shape: RodSolution) -> dict[str, float]:
    """The force on the end along the axis where its displacement is prescribed; where both are, the size of both.

    Relative error: of the component with its sign, of both the size of the difference. Empty where the load prescribes
    the force, and where there is none.
    """
    force, rod_force = (np.array(both)[list(record.held)] for both in (record.load.force[:2], shape.force))
    if not force.any():
        return {}
    if len(force) == 2:
        sizes = float(np.linalg.norm(force)), float(np.linalg.norm(rod_force))
        error = float(np.linalg.norm(rod_force - force)) / sizes[0]
        return {"force_N": sizes[0], "rod_force_N": sizes[1], "force_error": error}
    return {
        "force_N": float(force[0]),
        "rod_force_N": float(rod_force[0]),
        "force_error": float(rod_force[0] / force[0]) - 1.0,
    }


def _curvature_errors(curve: Centreline, shape: RodSolution, pitch: float) -> dict[str, float]:
    """Largest difference of the cell-averaged curvatures over the largest of them, and where (mm)."""
    try:
        solid, rod = (cell_averaged(shown, pitch) for shown in (curve, shape.along(curve)))
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


def compare(outcomes: Outcomes, rods: ArmRods, pitch: float) -> tuple[Comparison, ...]:
    """The rods of every pressure of II and III, unloaded as in II and with what acts on the end in III.

    Rods with five parameters are compared at the pressures where these were identified.
    """
    identified = set(rods.identified_kPa)
    records = sorted((*outcomes["II"].records, *outcomes["III"].records), key=lambda r: (r.pressure_kPa, r.experiment))
    if rods.law is None:
        records = [record for record in records if is_among(identified, record.pressure_kPa)]
    return tuple(
        compare_rods(rods.at(r.pressure_kPa), r, pitch, in_sample=is_among(identified, r.pressure_kPa)) for r in records
    )


def compare_rods(rods: Rods, record: Record, pitch: float, load: str = "", *, in_sample: bool) -> Comparison:
    """The rods under the load of a state: their end where it is held in III, the force of dead, nothing in II.

    In III the edge exerts a couple on the end. A rod with five parameters is given that of the finite elements; the
    law of the arm has its own.
    """
    loaded = tuple(_under_load(name, rod, record) for name, rod in rods.items())
    return Comparison(record, load, in_sample, loaded, pitch)


def _under_load(name: str, rod: Rod | RodError, record: Record) -> RodUnderLoad:
    if isinstance(rod, RodError):
        return RodUnderLoad(name, rod)
    is_fitted = not rod.has_own_law  # nothing was fitted to the arm's own law
    try:
        solution = _solution(rod, record)
    except RodError as failure:
        return RodUnderLoad(name, failure, is_fitted)
    warning = "" if rod.moment_range is None else rod.moment_range.warning(solution)
    return RodUnderLoad(name, solution, is_fitted, warning)


def _solution(rod: Rod, record: Record) -> RodSolution:
    """The rod under what acts on a state. Raises `RodError`."""
    load = Load()
    if record.experiment in ("III", "dead"):  # of the weight the rod itself knows
        load = Load(record.load.force, 0.0 if rod.has_own_law else record.load.couple)
    end_x, end_y = record.held_end
    try:
        return rod.under(load, end_y, end_x)
    except RodError as failure:
        raise RodError(_beyond_law(rod, record) or str(failure)) from None


def _beyond_law(rod: Rod, record: Record) -> str:
    """A sentence where a state has moments that the arm's own law does not know; empty elsewhere."""
    if not rod.has_own_law:
        return ""
    (low, high), moment = rod.arm.moments, moment_from_load(record.centreline, record.load).value
    if low <= moment.min() and moment.max() <= high:
        return ""
    needed, known = f"{moment.min():.3g} to {moment.max():.3g} N mm", f"{low:.3g} to {high:.3g}"
    where = f"At {record.pressure_kPa:g} kPa"
    return f"{where} its loads bend it with {needed}, and its law has {known}; make the arm lighter or stiffer."


def curves_of(outcomes: Outcomes, comparisons: Sequence[Comparison], pitch: float) -> tuple[Curve, ...]:
    """The curves of all states, and of the rods that were compared with them: curves.csv."""
    compared = {id(comparison.record): comparison for comparison in comparisons}
    return tuple(curve_of(record, compared.get(id(record)), pitch) for record in outcomes.records)


def curve_of(record: Record, comparison: Comparison | None, pitch: float) -> Curve:
    """The curve of one state and of the rods it is compared with, at the nodes of the material curve."""
    curve = record.centreline
    s = curve.s - curve.s[0]
    kappa, std = _curvature(curve, s, pitch)
    theta = np.interp(s, 0.5 * (s[1:] + s[:-1]), np.unwrap(curve.angle))
    shapes = [None if comparison is None else comparison.shape(name) for name in CURVE_PREFIXES]
    rods = [column for shape in shapes for column in _rod_columns(shape, s, pitch)]
    arrays = (s, curve.x, curve.y, theta, kappa, std, moment_from_load(curve, record.load).value, *rods)
    columns = dict(zip(CURVE_COLUMNS[2:], arrays, strict=True))
    load = "" if comparison is None else comparison.load
    x, y, _ = record.load.force
    return Curve(record.experiment, record.pressure_kPa, columns, load, (x, y) if record.experiment == "dead" else ())


def _rod_columns(shape: RodSolution | None, s: Array, pitch: float) -> tuple[Array, Array, Array]:
    """x, y and cell-averaged curvature of a rod at s (n,); NaN without one."""
    if shape is None:
        return (np.full(len(s), np.nan),) * 3
    x, y = shape.positions(s).T
    return x, y, _curvature(Centreline(s, x, y), s, pitch)[0]


def _curvature(curve: Centreline, s: Array, pitch: float) -> tuple[Array, Array]:
    """Cell-averaged curvature and its standard deviation at s (n,); the ends repeat the nearest cell's value."""
    try:
        curvature = cell_averaged(curve, pitch)
    except RodError:  # an arm of one or two cells has none
        return np.full_like(s, np.nan), np.full_like(s, np.nan)
    kappa = np.interp(s, curvature.s, curvature.kappa)
    return kappa, np.interp(s, curvature.s, curvature.kappa_std)
