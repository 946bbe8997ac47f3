"""The equilibrium about which, or from which, an arm moves."""

import numpy as np

from geometry.arrays import Array
from rod.along import are_heights
from rod.arm.chain import halved, thinned
from rod.arm.nodes import FORCES, StateArrays
from rod.arm.path import PathOptions, follow, positions_under
from rod.arm.solver import Solver
from rod.errors import RodError
from rod.load import Load
from rod.mechanics.equilibrium import Arm

#: fewest elements of an arm that moves, where its equilibrium has twice as many
ELEMENTS = 24


def equilibrium(arm: Arm, load: Load, later: Load, in_space: bool, size: int) -> tuple[Solver, StateArrays]:
    """Under a load, on nodes where this and a later load have breaks.

    size: 1 for the elements of `Rod.solve`, 2 for half their number, 0 for twice as many.

    Raises `RodError` where there is none that the law knows.
    """
    (model, posed), (_, other) = arm.posed(load), arm.posed(later)
    path = follow(model, posed, PathOptions(not in_space and are_heights(posed.supports), in_space))
    if outside := arm.outside(path):
        raise RodError(outside)
    both = (*posed.along, *other.along, *posed.supports)
    s = positions_under(model, Load(along=(*posed.along, *other.along), supports=posed.supports))
    breaks = [model.decides_at, *(at for one in both for at in one.breaks)]
    s = (halved(s), s, thinned(s, np.array(breaks), ELEMENTS))[size]
    solver = Solver(model, s, posed, in_space=in_space)
    state = path.chains[0].on(solver.s)
    if not solver.converge(state, 1.0, solver.load.target).converged:
        raise RodError("The arm has no equilibrium from which it could move.")
    return solver, state


def elastic_forces(solver: Solver, state: StateArrays) -> Array:
    """(n, m) N mm and N: elastic forces of the elements in a state."""
    copied = state._replace(inner=state.inner.copy(), reaction=np.zeros(len(solver.load.held)))
    solver.converge(copied, 1.0, solver.load.target, iterations=0)
    first, m = FORCES[solver.chain.in_space], 6 if solver.chain.in_space else 3
    return solver.room.kept[:, first : first + m].copy()
