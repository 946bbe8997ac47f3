"""How busy the machine is with other things, before a round of runs: seconds mean little where it is."""

import psutil

#: cores that other programs may use before a round
MAX_BUSY = 0.15
#: seconds over which the use is measured
SAMPLE = 3.0


class Busy(RuntimeError):
    """Other programs use the machine."""


def busy_cores() -> float:
    """Cores that are in use while this process waits for SAMPLE."""
    return float(psutil.cpu_percent(SAMPLE)) / 100.0 * (psutil.cpu_count() or 1)


def check_load() -> float:
    """Cores that are in use; raises `Busy` where they are too many."""
    if (busy := busy_cores()) > MAX_BUSY:
        raise Busy(f"other programs use {busy:.2f} cores; a round begins with at most {MAX_BUSY:g} of them in use")
    return busy
