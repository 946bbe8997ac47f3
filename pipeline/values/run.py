"""The results of a run as frozen values, one field for every key of the result files.

Units are in the names of the fields: mm, N, MPa, rad and kPa. None or NaN stands for a number that does not exist.
A new column of a table is a new field here; `pipeline.results.files` reads and writes it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.values.errors import RunFailed
from pipeline.values.formats import CONVERGED, FIVE
from pipeline.values.json_values import ReadObject
from pipeline.values.law import DeliveredLaw
from pipeline.values.parameters import Number, Numbers, RodParameters
from pipeline.values.record import MeshRecord, Position, Reported, RunRecord
from rod.same_pressure import is_same

Pair = tuple[Number, Number]
_NONE = (math.nan, math.nan)

#: rad: an error of the curvature is relative to the curvature that turns the arm by at least this angle
SMALLEST_TURN = 0.1


@dataclass(frozen=True)
class State:
    """One experiment at one pressure: a row of experiments.json. Forces and volumes are those of the full body.

    The report shows the fields that have a title.
    """

    experiment: str = field(metadata={"title": "experiment"})  #: I, II or III
    pressure_kPa: float = field(metadata={"title": "p (kPa)"})
    #: current position of the end of the material curve
    end_x_mm: Number = field(default=math.nan, metadata={"title": "end x (mm)"})
    end_y_mm: Number = field(default=math.nan, metadata={"title": "end y (mm)"})
    reaction_N: Pair = field(default=_NONE, metadata={"title": "reaction x, y (N)"})  #: on the end
    clamp_reaction_N: Pair = _NONE
    clamp_moment_N_mm: Number = math.nan
    cavity_volume_mm3: Number = math.nan
    #: current length of the material curve over its length at rest
    stretch_of_curve: Number = field(default=math.nan, metadata={"title": "stretch of the curve"})
    #: of the end section about z against the clamped one, negative where the arm bends downwards
    end_rotation_deg: Number = math.nan
    curve_z_mm: Number = math.nan  #: largest distance of the material curve from the plane z = 0
    min_J: Number = field(default=math.nan, metadata={"title": "smallest volume ratio J"})
    max_stretch: Number = field(default=math.nan, metadata={"title": "largest stretch"})
    min_stretch: Number = field(default=math.nan, metadata={"title": "smallest stretch"})
    min_J_at_mm: Position | None = None
    max_stretch_at_mm: Position | None = None
    min_stretch_at_mm: Position | None = None
    #: smallest signed gap between facing walls; NaN without such walls
    min_gap_mm: Number = field(default=math.nan, metadata={"title": "smallest gap (mm)"})
    contact_error_mm: Number = math.nan  #: NaN where contact was not compared with exact distances
    contact_error_N: Number = math.nan
    stress_error: Number = math.nan  #: energy of the difference to the recovered stress over that of the stress
    stress_error_at_mm: Position | None = None
    negative_pivots: int | None = None
    newton_iterations: int | None = field(default=None, metadata={"title": "Newton iterations"})
    factorizations: int | None = field(default=None, metadata={"title": "factorizations"})
    cutbacks: int | None = None
    seconds: Number = field(default=math.nan, metadata={"title": "seconds"})
    status: str = field(default=CONVERGED, metadata={"title": "status"})
    #: why the pressure was not reached, or what limits the trust in the state
    reason: str = field(default="", metadata={"title": "remark"})

    @property
    def end_mm(self) -> tuple[float, float]:
        """Current position of the end of the material curve."""
        return self.end_x_mm, self.end_y_mm

    @property
    def reached(self) -> bool:
        """Whether the pressure was reached."""
        return self.status == CONVERGED


@dataclass(frozen=True)
class RodError:
    """A rod against the finite elements under one load: a row of validation.json."""

    experiment: str
    pressure_kPa: float
    load: str = ""  #: besides the pressure, in words; empty for II and III as identified
    rod: str = FIVE  #: five or arm_law
    sample: str = "in"  #: in: the rod was fitted to this load; out: it was not
    distance_over_length: float | None = None  #: largest distance between the curves over the length
    distance_at_s_mm: float | None = None
    distance_over_length_without_stretch: float | None = None
    end_angle_error_rad: float | None = None
    force_error: float | None = None  #: relative
    force_N: float | None = None
    rod_force_N: float | None = None
    curvature_error: float | None = None  #: relative
    curvature_error_at_s_mm: float | None = None
    reason: str = ""  #: why there is no rod to compare
    warning: str = ""  #: where the moment leaves the range of the identification

    @property
    def location(self) -> str:
        """Load and pressure, for a table."""
        return f"{self.load or self.experiment}, {self.pressure_kPa:g} kPa"


@dataclass(frozen=True)
class Effect:
    """Whether an effect took part in a run: a row of effects.json."""

    effect: str
    state: str  #: on or off
    reason: str
    share_of_time: float | None = None  #: of the solver's time; None for an effect without time of its own


@dataclass(frozen=True)
class Curve:
    """The material curve of one state: rows of curves.csv or of validation_curves.csv, arrays (n,)."""

    experiment: str
    pressure_kPa: float
    columns: Mapping[str, Array] = field(repr=False)  #: by column name; NaN where a cell is empty
    load: str = ""  #: besides the pressure, in words; empty for I, II and III as identified
    force_N: Pair | tuple[()] = ()  #: x and y of a dead force on the end; empty for another load

    def __getitem__(self, column: str) -> Array:
        return self.columns[column]

    def has(self, column: str) -> bool:
        """Whether the column is there and holds at least one number."""
        return column in self.columns and bool(np.isfinite(self.columns[column]).any())

    @property
    def tip_mm(self) -> Pair:
        """Position of the end from the clamped end, mm."""
        x, y = self["x_mm"], self["y_mm"]
        return float(x[-1] - x[0]), float(y[-1] - y[0])


def bending_error_deg(moved_mm: float, tip_mm: Sequence[float]) -> float:
    """Largest change of the bending of a circular arc whose end moves by a distance from its position, degrees."""
    return math.degrees(2.0 * moved_mm / math.hypot(*tip_mm))


@dataclass(frozen=True)
class Run:
    """Everything in a result folder; what a failed run did not write is empty."""

    directory: Path
    record: RunRecord = field(default_factory=RunRecord, repr=False)  #: run.json
    parameters: RodParameters = field(default_factory=RodParameters, repr=False)  #: no pressures: nothing identified
    states: tuple[State, ...] = field(default=(), repr=False)
    curves: tuple[Curve, ...] = field(default=(), repr=False)
    rod_errors: tuple[RodError, ...] = field(default=(), repr=False)
    validation_curves: tuple[Curve, ...] = field(default=(), repr=False)
    effects: tuple[Effect, ...] = field(default=(), repr=False)
    law: DeliveredLaw | None = field(default=None, repr=False)  #: None where the arm's own law was not made

    @property
    def config(self) -> ReadObject:
        """The configuration in mm, MPa, tonne/mm3 and kPa."""
        return self.record.config

    @property
    def material(self) -> ReadObject:
        """The material, as files have it; empty where none does."""
        return self.parameters.material or self.config.get("material") or {}

    @property
    def held_mm(self) -> float | None:
        """The height at which experiment III holds the end, mm; None where it holds both axes, or none."""
        end = self.config.get("end") or {}
        return end.get("y_mm") if end.get("x_mm") is None else None

    @property
    def is_accurate(self) -> bool:
        """Whether its law has an accuracy to reach, and so comes from finer meshes than the arm."""
        return bool(self.config.get("accuracy"))

    def given_between(self, low: float, high: float) -> list[float]:
        """The pressures of its configuration from one to another, kPa."""
        return [p for p in self.config.get("pressures_kPa", ()) if low <= p <= high]

    @property
    def mesh(self) -> MeshRecord | None:
        """The mesh that was solved on; None where the run did not come to its report."""
        return self.record.mesh

    @property
    def finished(self) -> bool:
        """Whether the run came to its report; it may have failures even so."""
        return bool(self.record.pneurod)

    @property
    def failures(self) -> tuple[Reported, ...]:
        """What was not reached; empty where everything was."""
        return self.record.failures

    @property
    def remarks(self) -> tuple[Reported, ...]:
        """What is unusual about the design and its results."""
        return self.record.remarks

    def remark(self, *codes: str) -> Reported | None:
        """The first remark with one of these codes; None without any."""
        return next((one for one in self.remarks if one.code in codes), None)

    @property
    def falls(self) -> Reported | None:
        """The remark that the arm without a load falls over, and from which pressure on; None where it stands."""
        unstable = (one for one in self.remarks if one.code == "unstable_states" and one.values["experiment"] == "II")
        return next(unstable, None)

    @property
    def failure(self) -> str:
        """What was not reached, in one text; empty where everything was."""
        return " ".join(failure.text for failure in self.failures)

    def raise_if_failed(self) -> None:
        """Raise RunFailed with the failures and the directory where anything was not reached."""
        if self.failures:
            there = f"What was reached is in {self.directory}."
            brief = f"{(self.falls or self.failures[0]).text} {there}"
            raise RunFailed(f"{self.failure} {there}", directory=self.directory, brief=brief)

    @property
    def design(self) -> str:
        """The name of the design, or of the folder."""
        return str(self.config.get("name", self.directory.name))

    @property
    def length_mm(self) -> float:
        """Rest length of the material curve, mm; NaN where no file has it."""
        if self.parameters.length_mm is not None:
            return self.parameters.length_mm
        if self.law is not None:
            return self.law.law.length
        return max((float(curve["s_mm"].max()) for curve in self.curves), default=float("nan"))

    @property
    def pressures_kPa(self) -> Numbers:
        """All pressures that occur, ascending; those of the arm's own law where no experiment was solved."""
        occurring = {curve.pressure_kPa for curve in self.curves} | {state.pressure_kPa for state in self.states}
        if not occurring and self.law:
            occurring = {state.pressure_kPa for state in self.law.unloaded}
        return tuple(sorted(occurring))

    @property
    def reached_kPa(self) -> Numbers:
        """The pressures at which at least one experiment has an equilibrium, ascending."""
        return tuple(sorted({state.pressure_kPa for state in self.states if state.reached}))

    @property
    def identified_kPa(self) -> Numbers:
        """The pressures that have five parameters, ascending."""
        return self.parameters.pressures_kPa

    @property
    def averaging_mm(self) -> float:
        """Length over which curvatures are averaged, mm; 0 where it is not known."""
        return self.mesh.averaging_mm if self.mesh else 0.0

    @property
    def rods(self) -> tuple[str, ...]:
        """The names of the rods that were compared, in the order of the file."""
        return tuple(dict.fromkeys(error.rod for error in self.rod_errors))

    def errors_of(self, rod: str) -> tuple[RodError, ...]:
        """The errors of one rod."""
        return tuple(error for error in self.rod_errors if error.rod == rod)

    def curve(self, experiment: str, pressure_kPa: float) -> Curve | None:
        """The curve of one experiment at one pressure; None where it was not reached."""
        at = (c for c in self.curves if c.experiment == experiment and is_same(c.pressure_kPa, pressure_kPa))
        return next(at, None)

    def curves_of(self, experiment: str) -> list[Curve]:
        """The curves of one experiment by ascending pressure."""
        return sorted((c for c in self.curves if c.experiment == experiment), key=lambda c: c.pressure_kPa)

    def bending_deg(self, pressure_kPa: float) -> float:
        """How far the clamped arm without a load bends (II), degrees; NaN where that was not reached."""
        bent = [s for s in self.states if s.experiment == "II" and is_same(s.pressure_kPa, pressure_kPa)]
        return abs(bent[0].end_rotation_deg) if bent else math.nan

    def picture(self, name: str) -> Path | None:
        """The picture of this name without suffix (body, body_open, II_17kPa); None where there is none."""
        path = self.directory / "pictures" / f"{name}.png"
        return path if path.is_file() else None
