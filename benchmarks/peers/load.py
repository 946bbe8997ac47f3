"""How busy the machine is with other things, before a round of runs: seconds mean little where it is."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import sleep

#: cores that other programs may use before a round
MAX_BUSY = 0.15
#: seconds over which the use is measured
SAMPLE = 3.0


class Busy(RuntimeError):
    """Other programs use the machine."""


@dataclass(frozen=True)
class Ticks:
    """Processor time of all cores since the system started, in the system's ticks."""

    idle: int
    total: int
    cores: int

    @classmethod
    def read(cls, stat: str) -> "Ticks":
        """From the text of /proc/stat: of the first line idle and waiting for input count as idle (proc(5))."""
        lines = [line.split() for line in stat.splitlines() if line.startswith("cpu")]
        numbers = [int(word) for word in lines[0][1:9]]
        return cls(numbers[3] + numbers[4], sum(numbers), len(lines) - 1)


def busy_cores(before: Ticks, after: Ticks) -> float:
    """Cores that were in use on average between two readings."""
    total = after.total - before.total
    return before.cores * (1.0 - (after.idle - before.idle) / total) if total > 0 else 0.0


def now() -> Ticks:
    """The present reading."""
    return Ticks.read(Path("/proc/stat").read_text(encoding="ascii"))


def measured(read: Callable[[], Ticks] = now, wait: Callable[[float], None] = sleep) -> float:
    """Cores that are in use while this process waits; raises `Busy` where they are too many."""
    before = read()
    wait(SAMPLE)
    busy = busy_cores(before, read())
    if busy > MAX_BUSY:
        raise Busy(f"other programs use {busy:.2f} cores; a round begins with at most {MAX_BUSY:g} of them in use")
    return busy
