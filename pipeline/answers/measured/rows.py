"""What was measured on an arm that was built: one row for each state, or for each point along the arm in a state."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from pipeline.config import units
from pipeline.values.errors import InputError

#: columns of numbers by their name without the unit, with what they measure
NUMBERS: dict[str, units.Dimension] = {
    "pressure": units.PRESSURE,
    "tip_x": units.LENGTH,
    "tip_y": units.LENGTH,
    "tip_distance": units.LENGTH,
    "end_angle": units.ANGLE,
    "tip_direction": units.ANGLE,
    "force_x": units.FORCE,
    "force_y": units.FORCE,
    "tip_mass": units.MASS,
    "held_y": units.LENGTH,
    "reaction": units.FORCE,
    "reaction_zero": units.FORCE,
    "s": units.LENGTH,
    "x": units.LENGTH,
    "y": units.LENGTH,
    "t": units.TIME,
    "zero": units.PRESSURE,
    "at_y": units.LENGTH,
}
#: columns of texts
TEXTS = ("repeat", "orientation")
#: columns that hold what was read, of the tip and in all; all others say how the arm was loaded, or which point it is
OF_TIP = ("tip_x", "tip_y", "tip_distance", "tip_direction")
QUANTITIES = (*OF_TIP, "end_angle", "reaction", "x", "y")
#: the same that are places in a frame
PLACES = ("tip_x", "tip_y", "x", "y")
#: what places need that are counted from those at another pressure
OF_DISPLACEMENTS = "zero_kPa, the pressure from which they are counted (0 for rest)"
#: what is told of a vibration
VIBRATION = "frequency_Hz", "damping_ratio"
#: how a column is written, by its name
COLUMNS = {name: f"{name}_{one.unit}" for name, one in NUMBERS.items()} | {name: name for name in (*TEXTS, *VIBRATION)}


@dataclass(frozen=True)
class State:
    """How an arm was loaded."""

    pressure_kPa: float
    force_N: tuple[float, float] = (0.0, 0.0)  #: dead force that acts on the end
    tip_mass_g: float = 0.0  #: that hangs on the end
    held_y_mm: float | None = None  #: height at which the end is held; None: it is free
    orientation: str | None = None  #: of the arm in gravity; None: no weight but that of the run
    t_s: float | None = None  #: after the pressure came, or without pressure the weight; None: long after

    @property
    def is_at_rest(self) -> bool:
        """Whether nothing acts but a weight."""
        loads = self.pressure_kPa, *self.force_N, self.tip_mass_g
        return not any(loads) and self.held_y_mm is None and self.t_s is None

    @property
    def load(self) -> str:
        """What acts besides the pressure, in words; empty for nothing."""
        words = [f"force [{self.force_N[0]:g}, {self.force_N[1]:g}] N"] if any(self.force_N) else []
        words += [f"{self.tip_mass_g:g} g"] if self.tip_mass_g else []
        words += [] if self.held_y_mm is None else [f"held at {self.held_y_mm:g} mm"]
        words += [self.orientation] if self.orientation else []
        return ", ".join([*words, *([] if self.t_s is None else [f"after {self.t_s:.3g} s"])])


@dataclass(frozen=True)
class Row:
    """One row of a file: what was read in a state, by `QUANTITIES`, in mm, degrees and N."""

    line: int  #: of the file, from 1
    state: State
    values: Mapping[str, float]
    s_mm: float | None = None  #: of the point x, y: rest arc length from the clamp
    repeat: str = ""  #: name of the repetition
    zero_kPa: float | None = None  #: values are less those of the same state at this pressure; None: they are not
    at_y_mm: float = 0.0  #: height of the point of the tip that was read, over the material curve of the straight arm

    @property
    def told(self) -> str:
        """Its load and its zero, in words; empty for nothing."""
        zero = [] if self.zero_kPa is None else [f"less that at {self.zero_kPa:g} kPa"]
        return ", ".join(filter(None, [self.state.load, *zero]))


@dataclass(frozen=True)
class Measurements:
    """The rows of a file, in its order."""

    file: str
    rows: tuple[Row, ...]
    is_aligned: bool = False  #: whether the frame of its places is that of the rod

    @property
    def places(self) -> frozenset[str]:
        """Names of those that are counted from the clamp."""
        return frozenset(name for row in self.rows if row.zero_kPa is None for name in row.values if name in PLACES)

    @property
    def pressures_kPa(self) -> tuple[float, ...]:
        """Every pressure once, ascending."""
        return tuple(sorted({row.state.pressure_kPa for row in self.rows}))

    @property
    def are_in_time(self) -> bool:
        """Whether any row is of a motion."""
        return any(row.state.t_s is not None or VIBRATION[0] in row.values for row in self.rows)

    def up_to(self, limit_kPa: float) -> "Measurements":
        """The rows at pressures up to a limit."""
        return replace(self, rows=tuple(row for row in self.rows if row.state.pressure_kPa <= limit_kPa))

    def check_pressures(self, low: float, high: float, known: str) -> None:
        """Raise InputError, with the line, for a pressure that is not between two limits, kPa.

        known: what is known of the arm, with its range.
        """
        for row in self.rows:
            for pressure in (row.state.pressure_kPa, row.zero_kPa):
                if pressure is not None and not low <= pressure <= high:
                    raise InputError(f"{self.file}: line {row.line}: {pressure:.4g} kPa is outside {known}")
