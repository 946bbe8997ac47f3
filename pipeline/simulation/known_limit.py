"""Where experiment II ends, which I and III of the same arm ask for before they go on to a pressure.

All three have the same walls under the same pressure, and without II there are no five parameters. On nine arms (svk,
neo-Hooke, round and rectangular, inflated and under vacuum; docs/robustness.md) I and III had their limits between 20 %
below and 14 % above that of II. That of III matters where it is lower, so III is followed nearly up to the limit of II.

I takes the increments of II on the way to a pressure, and III where the whole way has failed: walls that fold or meet
do so at nearly the same pressures in all three. Where II could not go the whole way at once, I could in two of 20
states and III in 13 of 17 (40 designs drawn at random).

Where the path of II ends without a limit that it could name, its last equilibrium stands for the limit: on three random
designs III ended 2, 2 and 10 % above it (docs/robustness.md).
"""

from time import sleep
from typing import Any, final

from pipeline.processes import SPAWN
from pipeline.simulation.loadcase import LoadCase, has_height_alone

#: the experiment that tells where it ends, and those that ask for it
FIRST, OTHERS = "II", ("I", "III")
#: part of a pressure: where II has reached as much, I and III do not ask for its limit, nor wait for it
REACHED = 0.9
#: part of the limit of II up to which III is followed: nearer to it increments become many
PART_FOR_III = 0.95
#: seconds after which it is asked again how far II has come
ASK_AGAIN = 0.1
#: groups of load cases that one run can tell apart: so many that their shared memory is one page of a file
GROUPS = 128


@final
class KnownLimit:
    """Told by the process of II while it goes on; the processes of I and III ask for it before each pressure.

    A run solves several groups of load cases, on other meshes for example, and each has a limit of its own.
    """

    def __init__(self, values: Any = None, group: int = 0) -> None:
        # one process writes those of a group: without a lock, which a process that is killed might keep
        self._values: Any = SPAWN.RawArray("d", 4 * GROUPS) if values is None else values
        first = 4 * (group % GROUPS)
        self._has_ended, self._end_kPa, self._is_limit, self._reached_kPa = range(first, first + 4)

    def of_group(self, group: int) -> "KnownLimit":
        """That of another group of load cases."""
        return KnownLimit(self._values, group)

    def reached(self, pressure_kPa: float) -> None:
        """Experiment II has an equilibrium there, so that its limit is not below."""
        self._values[self._reached_kPa] = max(pressure_kPa, self._values[self._reached_kPa])

    def ended(self, end_kPa: float = 0.0, is_limit: bool = False) -> None:
        """Experiment II has ended at this pressure, a limit or its last equilibrium; 0 where there is nothing to tell.

        The first time counts.
        """
        if not self._values[self._has_ended]:
            self._values[self._end_kPa], self._values[self._is_limit] = end_kPa, is_limit
            self._values[self._has_ended] = 1.0

    @property
    def end_kPa(self) -> float:
        """Of II, where it has ended; 0 where there is nothing to tell."""
        return float(self._values[self._end_kPa])

    @property
    def name_of_end(self) -> str:
        """Limit, or last equilibrium where no limit could be named."""
        return "limit" if self._values[self._is_limit] else "last equilibrium"

    def why_not(self, pressure_kPa: float) -> str:
        """Why a pressure is not worth being tried; empty where it may be.

        Waits until II has ended or reached a pressure not far below. What is answered does not depend on time.
        """
        near_kPa = REACHED * pressure_kPa
        self.wait_for(near_kPa)
        if self._values[self._reached_kPa] >= near_kPa or not 0.0 < self.end_kPa < pressure_kPa:
            return ""
        return f"experiment {FIRST} of the same arm has its {self.name_of_end} at {self.end_kPa:.4g} kPa"

    def wait_for(self, pressure_kPa: float) -> None:
        """Wait until experiment II has an equilibrium there, or has ended."""
        while not self._values[self._has_ended] and self._values[self._reached_kPa] < pressure_kPa:
            sleep(ASK_AGAIN)


def asks(case: LoadCase) -> bool:
    """Whether an experiment asks for the limit of II: I does, and III where the height of its end alone is held.

    With other conditions at the end the limits were not compared.
    """
    return case.name in OTHERS and (case.experiment == "I" or has_height_alone(case.end))


def in_order(cases: list[LoadCase]) -> list[LoadCase]:
    """The case of II first: those that wait for it must not keep it from starting."""
    return sorted(cases, key=lambda case: case.name != FIRST)
