"""The results of a run as one value, and the content of run.json."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from geometry import Reason
from pipeline.cell.of_run import LawOfRun
from pipeline.config.config import Config
from pipeline.errors import RunFailed
from pipeline.identification.parameters import Parameters
from pipeline.notes import record_reason, render, render_all
from pipeline.results.values import Effect
from pipeline.simulation.outcome import Outcomes
from pipeline.store.formats import FORMAT
from pipeline.store.json_values import JsonObject
from pipeline.store.provenance import provenance
from pipeline.validation.compare import Comparison


@dataclass(frozen=True)
class RunReport:
    """The results of a run as far as it went; the same numbers stand in the files of `directory`."""

    directory: Path
    config: Config  #: as it was solved, with the mesh that an accuracy was planned with
    outcomes: Outcomes  #: of experiments I, II and III
    parameters: tuple[Parameters, ...]  #: by ascending pressure
    comparisons: tuple[Comparison, ...]  #: rod against finite elements, loads of the identification first
    arm: LawOfRun  #: the arm's own law
    effects: tuple[Effect, ...]
    accuracy: JsonObject | None  #: the key `accuracy` of run.json; None where no accuracy was requested
    mesh: JsonObject  #: the key `mesh` of run.json
    seconds: Mapping[str, float]  #: wall time by stage
    failures: tuple[Reason, ...]  #: one for everything that was not reached; empty where all was
    remarks: tuple[Reason, ...]  #: what is unusual about the design and its results, and pressures without parameters

    @property
    def failure(self) -> str:
        """The failures in one sentence; empty where everything was reached."""
        return render_all(self.failures)

    def raise_if_failed(self) -> None:
        """Raise RunFailed with the failures and the directory where anything was not reached."""
        if self.failures:
            raise RunFailed(
                f"{self.failure}; what was reached is in {self.directory}",
                directory=self.directory,
                brief=f"{render(self.failures[0])}; what was reached is in {self.directory}",
            )

    def record(self) -> JsonObject:
        """The content of run.json."""
        indicator = self.outcomes.largest_indicator
        return {
            "format": FORMAT,
            "config": self.config.record(),
            "config_hash": self.config.hash,
            **provenance(),
            "mesh": self.mesh,
            "seconds": self.seconds,
            "solver_seconds": self.outcomes.seconds_by_stage,
            "factorizations": {outcome.name: outcome.factorizations for outcome in self.outcomes},
            "degrees_of_freedom": {outcome.name: outcome.degrees_of_freedom for outcome in self.outcomes},
            "solver": sorted({outcome.solver for outcome in self.outcomes}),
            **({"indicator": indicator.record()} if indicator else {}),
            **({"accuracy": self.accuracy} if self.accuracy else {}),
            "failures": [*map(record_reason, self.failures)],
            **({"end_kPa": end} if isfinite(end := self.outcomes.lowest_end_kPa()) else {}),
            "remarks": [*map(record_reason, self.remarks)],
        }
