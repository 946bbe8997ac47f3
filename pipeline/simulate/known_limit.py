"""Where experiment II ends, which tells I and III of the same arm how far they are worth being followed.

All three have the same walls under the same pressure, and without II there are no five parameters. On nine arms (svk,
neo-Hooke, round and rectangular, inflated and under vacuum; studies/solver.md) I and III had their limits between 20 %
below and 14 % above that of II. That of III matters where it is lower, so III is followed nearly up to the limit of II.

Where the path of II ends without a limit that it could name, its last equilibrium stands for the limit: on three random
designs III ended 2, 2 and 10 % above it (studies/unseen.md).
"""

from dataclasses import dataclass

from pipeline.simulate.loadcase import LoadCase, has_height_alone
from pipeline.simulate.outcome import Outcome

#: the experiment that is solved first, and those that its end is told to
FIRST, OTHERS = "II", ("I", "III")
#: part of a pressure: where II has reached as much, its limit does not concern I and III
REACHED = 0.9
#: part of the limit of II up to which III is followed: nearer to it increments become many
PART_FOR_III = 0.95


@dataclass(frozen=True)
class EndOfII:
    """How far experiment II goes."""

    reached_kPa: float  #: highest pressure of its states, 0 without one
    end_kPa: float  #: its limit or last equilibrium; 0 where there is nothing to tell
    is_limit: bool

    @classmethod
    def of(cls, outcome: Outcome) -> "EndOfII":
        """There is nothing to tell where all pressures are reached, and of a body that passes through itself."""
        failure = outcome.failure
        reached_kPa = max((record.pressure_kPa for record in outcome.records), default=0.0)
        if failure is None or failure.passes_through_itself:
            return cls(reached_kPa, 0.0, is_limit=False)
        return cls(reached_kPa, failure.end_kPa, is_limit=failure.limit_kPa > 0.0)

    @property
    def name(self) -> str:
        """Limit, or last equilibrium where no limit could be named."""
        return "limit" if self.is_limit else "last equilibrium"

    def is_below(self, pressure_kPa: float) -> bool:
        """Whether a pressure is not worth being tried."""
        return self.reached_kPa < REACHED * pressure_kPa and 0.0 < self.end_kPa < pressure_kPa


def waits_for_II(case: LoadCase) -> bool:
    """Whether the end of II concerns a load case: I, and III where the height of its end alone is held.

    With other conditions at the end the limits were not compared.
    """
    return case.name in OTHERS and (case.experiment == "I" or has_height_alone(case.end))
