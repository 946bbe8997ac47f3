"""What a rod says of the states in which an arm was measured."""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.errors import InputError
from pipeline.measured.rows import COLUMNS, Measurements, Row, State
from rod.errors import RodError, RodWarning
from rod.mechanics.equilibrium import Rod
from rod.solution import RodSolution
from rod.weight import gravity_direction

#: kinds of numbers, with what their errors have in common, and units
KINDS = {"tip_x": "mm", "tip_y": "mm", "x": "mm", "y": "mm", "end_angle": "deg", "reaction": "N"}
#: the rod at a pressure in kPa
Rods = Callable[[float], Rod]


@dataclass(frozen=True)
class Setup:
    """How a measurement differs from what its file says."""

    gauge_kPa: float = 0.0  #: pressure in the arm less that of the gauge
    clamp_deg: float = 0.0  #: angle of the clamp, counter-clockwise
    #: stiffness of the arm against loads on its end over that of the rod, whose curvature without load stays as it is
    stiffness: float = 1.0

    def __add__(self, other: "Setup") -> "Setup":
        return Setup(
            self.gauge_kPa + other.gauge_kPa, self.clamp_deg + other.clamp_deg, self.stiffness * other.stiffness
        )


AS_WRITTEN = Setup()


@dataclass(frozen=True, eq=False)  # arrays inside
class Numbers:
    """Every number of a file in one row: what was read, in which row of it, and of which kind."""

    measurements: Measurements = field(repr=False)
    rows: tuple[Row, ...]  #: (n,) of each number
    names: tuple[str, ...]  #: (n,) of `KINDS`
    values: Array  #: (n,) mm, degrees, N

    @staticmethod
    def of(measurements: Measurements) -> "Numbers":
        """In the order of the file."""
        pairs = [(row, name) for row in measurements.rows for name in row.values]
        values = np.array([row.values[name] for row, name in pairs])
        return Numbers(measurements, tuple(row for row, _ in pairs), tuple(name for _, name in pairs), values)

    @property
    def units(self) -> tuple[str, ...]:
        """(n,)"""
        return tuple(KINDS[name] for name in self.names)

    @property
    def titles(self) -> tuple[str, ...]:
        """(n,) titles of their columns."""
        return tuple(COLUMNS[name] for name in self.names)

    @property
    def pressures(self) -> Array:
        """(n,) kPa."""
        return np.array([row.state.pressure_kPa for row in self.rows])

    def predicted(self, rods: Rods, setup: Setup = AS_WRITTEN) -> Array:
        """(n,) the same numbers by a rod. Raises InputError, with the line, where it has none."""
        shapes: dict[State, _Read] = {}
        at: dict[float, Rod] = {}
        found = []
        for row, name in zip(self.rows, self.names, strict=True):
            pressure = row.state.pressure_kPa + setup.gauge_kPa
            try:
                at[pressure] = at.get(pressure) or rods(pressure)
                shapes[row.state] = shapes.get(row.state) or _Read(shape_of(at[pressure], row.state, setup), setup)
                found.append(shapes[row.state].number(name, row.s_mm))
            except RodError as failure:
                raise InputError(f"{self.measurements.file}: line {row.line}: {failure}") from None
        return np.array(found)


def shape_of(rod: Rod, state: State, setup: Setup = AS_WRITTEN) -> RodSolution:
    """The equilibrium of a rod in a state, in the frame of its clamp. Raises `RodError`."""
    turn = np.radians(setup.clamp_deg)
    weight = _weight(state, float(turn), setup.stiffness)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RodWarning)
        if state.held_y_mm is None:
            force = _turned(np.array(state.force_N) / setup.stiffness, -turn).tolist()
            return rod.solve(force, **weight) if any(state.force_N) else rod.solve(**weight)
        shape = rod.solve(end_y=state.held_y_mm, **weight)
        if setup.clamp_deg:  # the height is that of another point of the frame of the clamp
            height = (state.held_y_mm - math.sin(turn) * shape.end[0]) / math.cos(turn)
            shape = rod.solve(end_y=height, **weight)
    return shape


def _weight(state: State, turn: float, stiffness: float) -> dict[str, Any]:
    if state.orientation is None:
        return {}
    direction = _turned(np.array(gravity_direction(state.orientation)), -turn)
    return {"direction": (float(direction[0]), float(direction[1])), "tip_mass": state.tip_mass_g / stiffness}


def _turned(vectors: Array, angle: float) -> Array:
    """Vectors (..., 2) turned counter-clockwise by an angle in rad."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return vectors @ np.array([[cosine, sine], [-sine, cosine]])


@dataclass(frozen=True, eq=False)  # arrays inside
class _Read:
    """What is read of a shape."""

    shape: RodSolution
    setup: Setup

    def number(self, name: str, s_mm: float | None) -> float:
        """In mm, degrees or N. Raises `RodError` for a point off the rod."""
        turn = math.radians(self.setup.clamp_deg)
        if name == "end_angle":
            return math.degrees(self.shape.end_angle) + self.setup.clamp_deg
        if name == "reaction":
            return float(_turned(self.shape.force, turn)[1]) * self.setup.stiffness
        place = np.array(self.shape.end) if s_mm is None or name.startswith("tip") else self._point(s_mm)
        return float(_turned(place, turn)[0 if name.endswith("x") else 1])

    def _point(self, s_mm: float) -> Array:
        return np.asarray(self.shape.positions(np.array([s_mm]))[0])


def without(measurements: Measurements, above_kPa: float) -> Measurements:
    """The rows at pressures up to a limit."""
    rows = tuple(row for row in measurements.rows if row.state.pressure_kPa <= above_kPa)
    return replace(measurements, rows=rows)
