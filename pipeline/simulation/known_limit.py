"""The limit of experiment II, which I and III of the same arm ask for before they search their own.

All three have the same walls under the same pressure, and without II there are no five parameters. On nine arms (svk,
neo-Hooke, round and rectangular, inflated and under vacuum; docs/robustness.md) I and III had their limits between 20 %
below and 14 % above that of II. That of III matters where it is lower, so III is followed nearly up to the limit of II.
"""

from time import sleep
from typing import Any, final

from pipeline.processes import SPAWN
from pipeline.simulation.loadcase import LoadCase

#: the experiment that names its limit, and those that ask for it
FIRST, OTHERS = "II", ("I", "III")
#: pressure over the last one that II has reached, up to which I and III do not ask for its limit, nor wait for it
AHEAD = 1.25
#: part of the limit of II up to which III is followed in small increments: nearer to it they become many
PART_FOR_III = 0.95
#: seconds after which it is asked again how far II has come
ASK_AGAIN = 0.1
#: groups of load cases that one run can tell apart: so many that their shared memory is one page of a file
GROUPS = 128


@final
class KnownLimit:
    """Told by the process of II while it goes on; the processes of I and III ask for it where they fail.

    A run solves several groups of load cases, on other meshes for example, and each has a limit of its own.
    """

    def __init__(self, values: Any = None, group: int = 0) -> None:
        # one process writes those of a group: without a lock, which a process that is killed might keep
        self._values: Any = SPAWN.RawArray("d", 3 * GROUPS) if values is None else values
        self._ended, self._limit_kPa, self._reached_kPa = range(3 * (group % GROUPS), 3 * (group % GROUPS) + 3)

    def of_group(self, group: int) -> "KnownLimit":
        """That of another group of load cases."""
        return KnownLimit(self._values, group)

    def reached(self, pressure_kPa: float) -> None:
        """Experiment II has an equilibrium there, so that its limit is not below."""
        self._values[self._reached_kPa] = max(pressure_kPa, self._values[self._reached_kPa])

    def set(self, limit_kPa: float) -> None:
        """Experiment II has ended, at this limit or, with 0, at none; the first time counts."""
        if not self._values[self._ended]:
            self._values[self._limit_kPa] = limit_kPa
            self._values[self._ended] = 1.0

    @property
    def limit_kPa(self) -> float:
        """That of II, where it has ended; 0 where it has none."""
        return float(self._values[self._limit_kPa])

    def why_not(self, pressure_kPa: float) -> str:
        """Why a pressure is not worth smaller increments; empty where it may be.

        Waits until II has ended or reached a pressure not far below. What is answered does not depend on time.
        """
        while not self._values[self._ended]:
            if self._is_near(pressure_kPa):
                return ""
            sleep(ASK_AGAIN)
        if self._is_near(pressure_kPa) or not 0.0 < self.limit_kPa < pressure_kPa:
            return ""
        return (
            f"it was not tried in small increments, because experiment {FIRST} of the same arm has its limit at "
            f"{self.limit_kPa:.4g} kPa"
        )

    def _is_near(self, pressure_kPa: float) -> bool:
        """Whether II has reached a pressure not far below."""
        return bool(pressure_kPa <= AHEAD * self._values[self._reached_kPa])


def asks(case: LoadCase) -> bool:
    """Whether an experiment asks for the limit of II: I does, and III where the height of its end alone is held.

    With other conditions at the end the limits were not compared.
    """
    is_usual = case.experiment == "I" or (case.held == (False, True) and not any(case.end.force_N))
    return case.name in OTHERS and is_usual


def in_order(cases: list[LoadCase]) -> list[LoadCase]:
    """The case of II first: those that wait for it must not keep it from starting."""
    return sorted(cases, key=lambda case: case.name != FIRST)
