"""Compilation of the kernels of rods ahead of a run, so that its processes load them from disk."""

import numpy as np

from rod.arm_law import integration
from rod.law import FiveParameters
from rod.load import Load
from rod.mechanics import shooting
from rod.mechanics.equilibrium import Rod


def compile_kernels() -> None:
    """Solve a short rod of either law: 20 s at the first time, one second from disk."""
    for kernel in (shooting.sweep, shooting.converge, integration.converge):
        kernel.compile_next()
    Rod(1.0, 0.1, FiveParameters(1.0, 2.0, 0.0, 0.0, 0.5)).under(Load((0.0, 0.1)))
    _solve_arm_law()


def _solve_arm_law() -> None:
    """An arm of one cell without load, whose ends neither turn nor move."""
    law = integration.LawArrays(-1.0, 1.0, *(np.full(3, value) for value in (0.0, 0.01, 1.0, 0.0, 50.0, 10.0)))
    clamp = (np.array([-1.0, 1.0]), np.zeros(2), np.zeros(2), np.zeros((2, 2)), np.zeros((2, 2)), 0.5)
    ends = integration.EndArrays(*clamp, np.zeros((2, 5)), np.zeros((2, 5)), np.zeros(2))
    load = integration.EndLoad(1.0, np.zeros(2), 0.0, np.zeros(2, bool), np.zeros(2), np.zeros((2, 4)))
    integration.converge(law, ends, load, np.zeros(3), np.ones(3), np.empty((2, 4)))
