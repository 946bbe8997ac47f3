"""Compilation of the kernels of rods ahead of a run, so that its processes load them from disk."""

from rod.arm.small_motions import compile_solver
from rod.law import FiveParameters
from rod.load import Load
from rod.mechanics.equilibrium import Rod


def compile_kernels() -> None:
    """Solve a short rod: a minute at the first time, one second from disk."""
    compile_solver()
    Rod(1.0, 0.1, FiveParameters(1.0, 2.0, 0.0, 0.0, 0.5)).under(Load((0.0, 0.1)))
