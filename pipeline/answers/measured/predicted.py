"""What a rod says of the states in which an arm was measured."""

import math
import warnings
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, partial
from typing import Any, final

import numpy as np

from geometry.arrays import Array
from geometry.centreline import chord_angle
from pipeline.answers.measured.rows import COLUMNS, OF_TIP, VIBRATION, Measurements, Row, State
from pipeline.answers.rods.in_time import rubber_of
from pipeline.values.errors import InputError
from rod import Body, Loading, Mode, Relaxation
from rod.arm_law.law import ArmLaw
from rod.errors import RodError, RodWarning
from rod.in_time.frequencies import Undamped, undamped
from rod.in_time.relaxation import ELASTIC
from rod.mechanics.equilibrium import Rod
from rod.solution import RodSolution
from rod.weight import gravity_direction

#: kinds of numbers, with what their errors have in common, and units
KINDS = {
    **dict.fromkeys(("tip_x", "tip_y", "tip_distance", "x", "y"), "mm"),
    "end_angle": "deg", "tip_direction": "deg", "reaction": "N", **dict(zip(VIBRATION, ("Hz", "1"), strict=True)),
}  # fmt: skip
#: (n, 2) mm, material curves in the frame of a measurement, by pressure in kPa and load in words
Curves = Mapping[tuple[float, str], Array]


@dataclass(frozen=True)
class Setup:
    """How a measurement differs from what its file says."""

    gauge_kPa: float = 0.0  #: pressure in the arm less that of the gauge
    clamp_deg: float = 0.0  #: angle of the clamp, counter-clockwise
    #: stiffness of the arm against loads on its end over that of the rod, whose curvature without load stays as it is
    stiffness: float = 1.0
    origin_mm: tuple[float, float] = (0.0, 0.0)  #: x and y of the clamped end in the frame of the places
    drawn_mm: float | None = None  #: length at which a point of the arm is its end; None: that of the rod


AS_WRITTEN = Setup()


@final
@dataclass(frozen=True, eq=False)
class LawRods:
    """The rods of a law before any snap; a pressure off its range, where a gauge's offset leads, is that at its end."""

    law: ArmLaw
    material: Mapping[str, Any] = field(default_factory=dict)  #: of its rubber in time, as files have it
    elastic: "LawRods | None" = None  #: the same law, whose shapes and vibrations are found once for several rubbers

    def __call__(self, pressure_kPa: float) -> Rod:
        return Rod(self.law.length, law=self.law.before_snap.at(self._within(pressure_kPa)))

    @cached_property
    def solved(self) -> Callable[[float, Loading], Any]:
        """Shapes by pressure in kPa and loads; rods and shapes are found once for all numbers and setups."""
        if self.elastic:
            return self.elastic.solved
        rod_at = cache(self)
        return cache(lambda pressure_kPa, loading: rod_at(pressure_kPa).bear(loading))

    @cached_property
    def _first(self) -> Callable[[float, Loading], Undamped]:
        """The first vibration in the plane, by pressure in kPa and loads. Raises `RodError`."""
        if self.elastic:
            return self.elastic._first
        body = Body(self.law)
        return cache(lambda kPa, loading: undamped(body, self._within(kPa), loading, count=1, across=False)[0])

    @cached_property
    def rubber(self) -> Relaxation:
        """Its rubber in time. Raises `RodError` as `rubber_of` does."""
        first = partial(self._first, self.law.pressures[-1], Loading())
        return rubber_of(self.material, lambda: first().damped(ELASTIC).frequency_hz)[0]

    def after(self, t_s: float, pressure_kPa: float, *, is_let_go: bool) -> tuple["LawRods", float]:
        """Rods and their pressure some time after one came; or after the weight came, which are of softer rubber."""
        felt = float(self.rubber.creep.compliance(t_s))
        return (LawRods(self.law.scaled(1.0 / felt)), 0.0) if is_let_go else (self, felt * pressure_kPa)

    def vibration(self, pressure_kPa: float, loading: Loading) -> Mode:
        """The first vibration in the plane. Raises `RodError`."""
        return self._first(pressure_kPa, loading).damped(self.rubber)

    def _within(self, pressure_kPa: float) -> float:
        return min(max(pressure_kPa, self.law.pressures[0]), self.law.pressures[-1])


#: the rod at a pressure in kPa; that of a law where something was measured in time
Rods = Callable[[float], Rod] | LawRods


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
    zero_kPa: float | None = None  #: as of `Row`

    @property
    def difference(self) -> float:
        """Measured less predicted."""
        return self.measured - self.predicted

    @property
    def is_within(self) -> bool:
        """Whether it is no larger than what is allowed."""
        return abs(self.difference) <= self.allowed


@dataclass(frozen=True, eq=False)  # arrays inside
class Numbers:
    """Every number of a file in one row: what was read, in which row of it, and of which kind."""

    measurements: Measurements = field(repr=False)
    rows: tuple[Row, ...]  #: (n,) of each number
    names: tuple[str, ...]  #: (n,) of `KINDS`
    values: Array  #: (n,) mm, degrees, N

    @staticmethod
    def of(measurements: Measurements) -> "Numbers":
        """All numbers in the order of the file."""
        pairs = [(row, name) for row in measurements.rows for name in row.values]
        values = np.array([row.values[name] for row, name in pairs])
        return Numbers(measurements, tuple(row for row, _ in pairs), tuple(name for _, name in pairs), values)

    @property
    def units(self) -> tuple[str, ...]:
        """(n,)"""
        return tuple(KINDS[name] for name in self.names)

    def where(self, k: int) -> str:
        """File and line of a number."""
        return f"{self.measurements.file}: line {self.rows[k].line}"

    @property
    def pressures(self) -> Array:
        """(n,) kPa."""
        return np.array([row.state.pressure_kPa for row in self.rows])

    def straight(self, length_mm: float) -> Array:
        """(n,) the numbers of the straight arm, of which displacements and angles are multiples of the curvature."""

        def number(row: Row, name: str) -> float:
            end = {"tip_x": length_mm, "tip_y": row.at_y_mm, "x": row.s_mm or 0.0}
            end["tip_direction"] = math.degrees(math.atan2(row.at_y_mm, length_mm))
            return end.get(name, 0.0) if row.zero_kPa is None else 0.0

        return np.array([number(row, name) for row, name in zip(self.rows, self.names, strict=True)])

    def predicted(self, rods: Rods, setup: Setup = AS_WRITTEN) -> Array:
        """(n,) the same numbers by a rod. Raises InputError, with the line, where it has none."""
        state_of, vibration_of = cache(partial(_shape_in, rods, setup)), cache(partial(_vibration_in, rods, setup))
        found = []
        for k, (row, name) in enumerate(zip(self.rows, self.names, strict=True)):
            try:
                is_in_time = name in VIBRATION
                found.append(vibration_of(row.state)[name] if is_in_time else _read(state_of, setup, row, name))
            except RodError as failure:
                raise InputError(f"{self.where(k)}: {failure}") from None
        return np.array(found)

    def curves(self, rods: Rods, setup: Setup = AS_WRITTEN) -> Curves:
        """The rod in every state; without those that have none."""
        turn, found = math.radians(setup.clamp_deg), dict[tuple[float, str], Array]()
        for state in dict.fromkeys(row.state for row in self.rows):
            with suppress(RodError):
                shape = _shape_in(rods, setup, state)
                found[state.pressure_kPa, state.load] = turned(shape.curve, turn)
        return found

    def beside(self, predicted: Array, allowed: Array) -> tuple[Compared, ...]:
        """Every number beside that of a rod, and what is allowed, (n,) each. Raises InputError for NaN."""
        for k in np.flatnonzero(~np.isfinite(predicted + allowed))[:1]:
            told = f"what the rod has of {COLUMNS[self.names[k]]} is not known; leave this number out"
            raise InputError(f"{self.where(k)}: {told}")
        columns = zip(self.rows, self.names, self.values.tolist(), predicted.tolist(), allowed.tolist(), strict=True)
        return tuple(
            Compared(row.line, row.state.pressure_kPa, row.told, COLUMNS[name], value, rod, most,
                     row.s_mm if name in ("x", "y") else None, row.zero_kPa)
            for row, name, value, rod, most in columns
        )  # fmt: skip


def _shape_in(rods: Rods, setup: Setup, state: State) -> RodSolution:
    """The shape in a state. Raises `RodError`."""
    pressure = state.pressure_kPa + setup.gauge_kPa
    if not isinstance(rods, LawRods):
        return _shape_of(rods(pressure).bear, state, setup)
    if state.t_s is not None:
        rods, pressure = rods.after(state.t_s, pressure, is_let_go=not state.pressure_kPa)
    return _shape_of(partial(rods.solved, pressure), state, setup)


def _vibration_in(rods: Rods, setup: Setup, state: State) -> dict[str, float]:
    """The vibration about a state, by the names of its numbers. Raises `RodError`."""
    assert isinstance(rods, LawRods)
    turned = _weight(state, math.radians(setup.clamp_deg), 1.0)
    mode = rods.vibration(state.pressure_kPa + setup.gauge_kPa, Loading(**turned))
    return dict(zip(VIBRATION, (mode.frequency_hz * math.sqrt(setup.stiffness), mode.damping_ratio), strict=True))


def _shape_of(bear: Callable[[Loading], Any], state: State, setup: Setup) -> Any:
    """The equilibrium of a rod in a state, in the frame of its clamp. Raises `RodError`."""
    turn = math.radians(setup.clamp_deg)
    weight = _weight(state, turn, setup.stiffness)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RodWarning)
        if state.held_y_mm is None:
            force = turned(np.array(state.force_N) / setup.stiffness, -turn).tolist()
            shape = bear(Loading(force if any(state.force_N) else None, **weight))
        else:
            shape = bear(Loading(end=(None, state.held_y_mm), **weight))
        if state.held_y_mm is not None and setup.clamp_deg:  # the height is that of another point of the clamp's frame
            height = (state.held_y_mm - math.sin(turn) * shape.end[0]) / math.cos(turn)
            shape = bear(Loading(end=(None, height), **weight))
    shape.path.refuse_fall()
    return shape


def _weight(state: State, turn: float, stiffness: float) -> dict[str, Any]:
    if state.orientation is None:
        return {}
    direction = turned(np.array(gravity_direction(state.orientation)), -turn)
    return {"direction": (float(direction[0]), float(direction[1])), "tip_mass": state.tip_mass_g / stiffness}


def turned(vectors: Array, angle: float) -> Array:
    """Vectors (..., 2) turned counter-clockwise by an angle in rad."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return vectors @ np.array([[cosine, sine], [-sine, cosine]])


def _read(state_of: Callable[[State], RodSolution], setup: Setup, row: Row, name: str) -> float:
    """What a row reads, in mm, degrees or N, less what it reads at its zero. Raises `RodError`."""
    here = state_of(row.state)
    if name == "tip_distance":
        rest = state_of(State(row.zero_kPa or 0.0, orientation=row.state.orientation))
        return math.dist(_tip(here, row), _tip(rest, row))
    value = _reading(here, setup, row, name)
    if row.zero_kPa is None:
        return value
    return value - _reading(state_of(replace(row.state, pressure_kPa=row.zero_kPa)), setup, row, name)


def _reading(shape: RodSolution, setup: Setup, row: Row, name: str) -> float:
    """Of one shape. Raises `RodError` for a point off the rod."""
    turn = math.radians(setup.clamp_deg)
    if name == "end_angle":
        return math.degrees(shape.end_angle) + setup.clamp_deg
    if name == "reaction":
        return float(turned(shape.force, turn)[1]) * setup.stiffness
    is_tip = row.s_mm is None or name in OF_TIP
    longer = float(shape.s[-1]) / (setup.drawn_mm or float(shape.s[-1]))  # points are of the rubber, also of the end
    place = _tip(shape, row) if is_tip else shape.positions(np.array([row.s_mm]) * longer)[0]
    if name == "tip_direction":
        x, y = place.tolist()
        return math.degrees(chord_angle(x, y, 0.5 * float(shape.theta[-1]))) + setup.clamp_deg
    return float((turned(place, turn) + setup.origin_mm)[0 if name.endswith("x") else 1])


def _tip(shape: RodSolution, row: Row) -> Array:
    """(2,) mm, the point of the tip that a row reads: the end of the material curve, or one beside it."""
    turn = float(shape.theta[-1])
    return np.array(shape.end) + row.at_y_mm * np.array([-math.sin(turn), math.cos(turn)])
