"""The content of run.json as one frozen value: configuration, versions, mesh, cost, failures and remarks."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from geometry.errors import Values, position_text
from pipeline.values.formats import FORMAT
from pipeline.values.json_values import ReadObject

Position = tuple[float, float, float]


@dataclass(frozen=True)
class Reported:
    """A reason as run.json holds it: code, values, and the sentence that was made of them."""

    code: str
    values: Values = field(default_factory=dict)
    where: Position | None = None  #: mm
    text: str = ""


@dataclass(frozen=True)
class MeshRecord:
    """The mesh of a run."""

    size_mm: float
    from_file: bool
    formulation: str
    grading: str
    averaging_mm: float  #: length over which curvatures are averaged
    curve_height_mm: float  #: y of the material curve in the drawing
    chosen: Mapping[str, str]  #: why, by key, for what the program chose
    elements: int
    mean_edge_mm: float
    longest_edge_mm: float
    smallest_radius_ratio: float
    volume_over_drawing: float


@dataclass(frozen=True)
class Indicator:
    """How far the stress of the elements is from one recovered from it (`fem.stress_error`), in one state."""

    stress_error: float  #: energy of the difference over that of the stress
    experiment: str
    pressure_kPa: float
    at_mm: Position  #: centre of the element with the largest part of it
    sentence: str = ""

    @property
    def location(self) -> str:
        """The state and the position in the body, in words."""
        return f"in {self.experiment} at {self.pressure_kPa:g} kPa, most of it at {position_text(self.at_mm)}"


@dataclass(frozen=True)
class RunRecord:
    """Everything in run.json; empty where the run did not come to its report."""

    format: int = FORMAT
    config: ReadObject = field(default_factory=dict)  #: in mm, MPa, tonne/mm3 and kPa
    config_hash: str = ""
    pneurod: str = ""  #: version; empty where the run did not come to its report
    commit: str | None = None
    python: str = ""
    packages: Mapping[str, str | None] = field(default_factory=dict)
    machine: Mapping[str, str | int | float | None] = field(default_factory=dict)
    mesh: MeshRecord | None = None
    seconds: Mapping[str, float] = field(default_factory=dict)  #: wall time by stage
    solver_seconds: Mapping[str, float] = field(default_factory=dict)
    factorizations: Mapping[str, int] | int = 0  #: by experiment
    degrees_of_freedom: Mapping[str, int] | int = 0
    solver: tuple[str, ...] = ()
    indicator: Indicator | None = None  #: of the state in which it is largest
    end_kPa: float | None = None  #: the lowest pressure at which an experiment has ended
    failures: tuple[Reported, ...] = ()  #: what was not reached; empty where everything was
    remarks: tuple[Reported, ...] = ()  #: what is unusual about the design and its results
