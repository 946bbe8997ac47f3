"""All sweeps of a folder: states, estimates, ends and laws, by what the claims and the figures ask for."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from benchmarks.paper.estimates import Estimate, estimates_of
from benchmarks.paper.random_cells import RandomCell, read
from benchmarks.paper.states import EndState, State, ends_of, laws_of, states_of, unreached
from rod import ArmLaw

#: the pneu-net and the three other arms, in the order of Fig. 14
ARMS = ("pneunet", "semicircular", "semicircular_single", "bisected_circle")
#: material laws, that of the paper first
LAWS = ("svk", "hencky")
#: sweeps whose points are experiments II and III
_WITH_STATES = ("pneunet", "arms", "heights", "lengths", "contact")


@dataclass(frozen=True)
class Data:
    """The results in a folder; a sweep that is not there gives nothing."""

    folder: Path

    @cached_property
    def sweeps(self) -> dict[str, Path]:
        """By name without `paper_`; those that came to their end."""
        return {
            path.parent.name.removeprefix("paper_"): path.parent for path in sorted(self.folder.glob("*/sweep.csv"))
        }

    @cached_property
    def estimates(self) -> dict[str, list[Estimate]]:
        """Of all states, by sweep."""
        return {
            name: [e for state in states_of(path) for e in estimates_of(state)]
            for name, path in self.sweeps.items()
            if name in _WITH_STATES
        }

    @cached_property
    def ends(self) -> list[EndState]:
        """The end under the forces of Fig. 5 (b)."""
        return ends_of(self.sweeps["forces"]) if "forces" in self.sweeps else []

    @cached_property
    def laws(self) -> dict[tuple[str, str], ArmLaw]:
        """The arms' own laws by arm and material law."""
        return laws_of(self.sweeps["cells"]) if "cells" in self.sweeps else {}

    @cached_property
    def random_cells(self) -> list[RandomCell]:
        """Half cells drawn at random."""
        return read(self.folder)

    def of(self, sweep: str, law: str, arm: str = "", estimator: str = "") -> list[Estimate]:
        """The estimates of a sweep, ascending in pressure; of all arms and estimators where none is named."""
        estimates = [
            e
            for e in self.estimates.get(sweep, [])
            if e.state.law == law and arm in ("", e.state.family) and estimator in ("", e.estimator)
        ]
        return sorted(estimates, key=lambda e: e.state.pressure)

    def arm(self, arm: str, law: str, estimator: str = "") -> list[Estimate]:
        """Of one of the four arms."""
        return self.of("pneunet" if arm == ARMS[0] else "arms", law, arm, estimator)

    def states(self, sweep: str, law: str, arm: str = "") -> list[State]:
        """The states of a sweep, ascending in pressure."""
        return states_in(self.of(sweep, law, arm))

    def unreached(self) -> dict[str, list[str]]:
        """What was not reached, by sweep."""
        return {name: sentences for name, path in self.sweeps.items() if (sentences := unreached(path))}


def states_in(estimates: Iterable[Estimate]) -> list[State]:
    """The states of estimates, each once, in their order."""
    return list({id(e.state): e.state for e in estimates}.values())


def above(estimates: Sequence[Estimate], low: float, high: float = 100.0) -> list[Estimate]:
    """Those with pressures between low and high, kPa."""
    return [e for e in estimates if low <= e.state.pressure <= high]
