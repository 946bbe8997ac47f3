"""Compilation of the kernels of rods ahead of a run, so that its processes load them from disk."""

import numpy as np

from rod.arm.chain import room_for, solve_chain
from rod.arm.nodes import Chain
from rod.arm.small_motions import lowest_of
from rod.law import FiveParameters
from rod.load import Load
from rod.mechanics.equilibrium import Rod


def compile_kernels() -> None:
    """Solve a short rod: a minute at the first time, one second from disk."""
    for kernel in (solve_chain, lowest_of):
        kernel.compile_next()
    none = room_for(Chain(True, True, np.ones(1), 0, 0.0, 1, 1.0), 0)
    none.band[:, 11] = 1.0
    lowest_of(none, none, np.ones(6, bool), np.zeros((0, 2), np.int64))
    Rod(1.0, 0.1, FiveParameters(1.0, 2.0, 0.0, 0.0, 0.5)).under(Load((0.0, 0.1)))
