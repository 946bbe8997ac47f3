"""What a path costs: wall time, seconds by stage and factorizations."""

from dataclasses import dataclass, replace
from time import perf_counter
from typing import Self

from fem.equations.system import System
from fem.solution import Seconds


@dataclass(frozen=True)
class Costs:
    """What a system has spent so far, or between two times."""

    wall: float  #: s
    seconds: Seconds  #: by stage, without the set-up
    factorizations: int

    @classmethod
    def of(cls, system: System) -> Self:
        """So far."""
        times, effects = system.solver.times, dict(system.clock.seconds)
        assembly = effects.pop("assembly", 0.0)
        seconds = Seconds(0.0, assembly, times.analysis, times.factorization, times.solve, effects)
        return cls(perf_counter(), seconds, times.factorizations)

    def __sub__(self, before: Self) -> Self:
        return replace(
            self,
            wall=self.wall - before.wall,
            seconds=self.seconds - before.seconds,
            factorizations=self.factorizations - before.factorizations,
        )
