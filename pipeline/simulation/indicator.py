"""The error indicator of a run: the state in which it is largest, and where."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import fem
from pipeline.simulation.simulate import Outcome


@dataclass(frozen=True)
class Indicator:
    """How far the stress of the elements is from one recovered from it (`fem.stress_error`), in one state."""

    stress_error: float  #: energy of the difference over that of the stress
    experiment: str
    pressure_kPa: float
    at_mm: tuple[float, float, float]  #: centre of the element that has the largest share of it

    def record(self) -> dict[str, Any]:
        """The part of run.json about it."""
        return {**asdict(self), "sentence": self.sentence()}

    def place(self) -> str:
        """The state and the place, in words."""
        return f"in {self.experiment} at {self.pressure_kPa:g} kPa, most of it at {fem.in_words(self.at_mm)}"

    def sentence(self) -> str:
        """For the report."""
        return (
            f"The stress of the elements differs from a smooth one recovered from it by at most "
            f"{100 * self.stress_error:.2g} % in energy, {self.place()}"
        )


def largest_indicator(outcomes: Mapping[str, Outcome]) -> Indicator | None:
    """That of the state with the largest one; None where no state was reached."""
    rows = [record.row for outcome in outcomes.values() for record in outcome.records]
    if not rows:
        return None
    row = max(rows, key=lambda one: one["stress_error"])
    x, y, z = row["stress_error_at_mm"]
    return Indicator(row["stress_error"], row["experiment"], row["pressure_kPa"], (x, y, z))
