"""What is measured for one configuration of the convergence study: the identified numbers, and what they cost."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from pipeline.store.json_values import JsonObject


@dataclass(frozen=True)
class Headline:
    """The numbers whose largest relative error counts as the error of a configuration."""

    kappa_0_per_mm: float  #: at half the length, from II
    alpha2_N_mm2: float
    force_N: float  #: y component of the end force of III

    def by_name(self) -> dict[str, float]:
        """The numbers by the names of `HEADLINE`."""
        return asdict(self)


#: names of the headline numbers
HEADLINE = tuple(Headline.__dataclass_fields__)


@dataclass(frozen=True)
class RodNumbers:
    """What II and III at one pressure give."""

    pressure_kPa: float
    stride: int  #: identified from every so many-th node of the material curve
    fit_seconds: float
    points: int  #: nodes of the material curve that were used
    kappa_0_per_mm: float
    alpha1_N_mm2: float
    alpha2_N_mm2: float
    d_mm: float | None  #: None where a single line suffices, which has no break
    force_N: float
    end_mm: tuple[float, float]  #: x and y of the end in II
    alpha2_std_N_mm2: float
    stress_error: float  #: the larger error indicator of the two states (`fem.stress_error`)

    @property
    def headline(self) -> Headline:
        """The numbers whose error counts."""
        return Headline(self.kappa_0_per_mm, self.alpha2_N_mm2, self.force_N)

    @property
    def has_two_lines(self) -> bool:
        """Whether the law has two slopes."""
        return self.d_mm is not None

    @staticmethod
    def read(record: Mapping[str, Any]) -> "RodNumbers":
        """From JSON."""
        x, y = record["end_mm"]
        return RodNumbers(**{**record, "end_mm": (x, y)})


@dataclass(frozen=True)
class Cost:
    """What a configuration costs with one thread."""

    wall_seconds: float
    cpu_seconds: float
    seconds: Mapping[str, float]  #: wall time by stage, see `pipeline.accuracy.table.STAGES`
    peak_memory_MB: float
    degrees_of_freedom: int
    tetrahedra: int
    radius_ratio: float  #: the smallest of all tetrahedra
    factorizations: int


@dataclass(frozen=True)
class RungResult:
    """Numbers and cost of one configuration."""

    failure: str  #: empty, or sentences
    numbers: tuple[RodNumbers, ...]
    cost: Cost | None  #: None where the body could not be meshed or no experiment could be started

    def of_stride(self, stride: int) -> tuple[RodNumbers, ...]:
        """The numbers from every `stride`-th node, one per pressure that was reached."""
        return tuple(numbers for numbers in self.numbers if numbers.stride == stride)

    def at(self, pressure_kPa: float) -> RodNumbers | None:
        """The numbers at one pressure from all nodes, None where it was not reached."""
        return next((numbers for numbers in self.of_stride(1) if numbers.pressure_kPa == pressure_kPa), None)

    def record(self) -> JsonObject:
        """As JSON."""
        cost = {} if self.cost is None else asdict(self.cost)
        return {"failure": self.failure, **cost, "numbers": [asdict(numbers) for numbers in self.numbers]}

    @staticmethod
    def read(record: Mapping[str, Any]) -> "RungResult":
        """From JSON."""
        cost = {name: record[name] for name in Cost.__dataclass_fields__ if name in record}
        numbers = tuple(RodNumbers.read(row) for row in record["numbers"])
        return RungResult(record["failure"], numbers, Cost(**cost) if cost else None)
