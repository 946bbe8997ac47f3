"""The limit of experiment II, which I and III of the same arm ask for before they search their own.

All three have the same walls under the same pressure. On nine arms (svk, neo-Hooke, round and rectangular, inflated and
under vacuum; docs/robustness.md) I and III had their limits between 20 % below and 14 % above that of II.
"""

from typing import Any, final

from pipeline.processes import SPAWN
from pipeline.simulation.loadcase import LoadCase

#: the experiment that names its limit, and those that ask for it
FIRST, OTHERS = "II", ("I", "III")
#: pressure over the limit of II from which on I and III do not search for an equilibrium in small increments
BEYOND = 1.25


@final
class KnownLimit:
    """Set once by the process of II, when it has ended; the processes of I and III wait for it where they fail."""

    def __init__(self) -> None:
        self._ended: Any = SPAWN.Event()
        self._limit_kPa: Any = SPAWN.Value("d", 0.0)

    def set(self, limit_kPa: float) -> None:
        """Experiment II has ended, at this limit or, with 0, at none."""
        self._limit_kPa.value = limit_kPa
        self._ended.set()

    def why_not(self, pressure_kPa: float) -> str:
        """Why a pressure is not worth smaller increments; empty where it may be. Waits until II has ended."""
        self._ended.wait()
        limit_kPa = float(self._limit_kPa.value)
        if not 0.0 < BEYOND * limit_kPa < pressure_kPa:
            return ""
        return (
            f"an increment failed, and smaller ones were not tried, because experiment {FIRST} of the same arm has its "
            f"limit at {limit_kPa:.4g} kPa"
        )


def asks(case: LoadCase) -> bool:
    """Whether an experiment asks for the limit of II: I does, and III where the height of its end alone is held.

    With other conditions at the end the limits were not compared.
    """
    is_usual = case.experiment == "I" or (case.held == (False, True) and not any(case.end.force_N))
    return case.name in OTHERS and is_usual


def in_order(cases: list[LoadCase]) -> list[LoadCase]:
    """The case of II first: those that wait for it must not keep it from starting."""
    return sorted(cases, key=lambda case: case.name != FIRST)
