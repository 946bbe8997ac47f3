"""Stability of an arm in equilibrium, against all small motions or those out of its plane."""

import numpy as np

from geometry.arrays import Array, read_only
from rod.arm.chain import Nodes
from rod.arm.response import SolvedPath
from rod.arm.small_motions import lowest
from rod.arm.solver import ArmModel, Solver
from rod.spatial import SpatialLoad, Stability

#: the three motions and three turns of a section, and those of them out of the plane
ALL, OUT_OF_PLANE = (0, 1, 2, 3, 4, 5), (2, 3, 4)


def stability_of(path: SolvedPath, motions: tuple[int, ...]) -> Stability:
    """Of an arm on both chains of its path, at the limit of the elements, under a load that keeps its direction.

    motions: which of the three motions and three turns of a section are possible.
    """
    (arm, load), chains = path.rod.posed(path.load), path.chains
    (coarse, _), (fine, motion) = (_lowest(arm, nodes, load, motions) for nodes in chains)
    at = np.searchsorted(chains[1].s, chains[0].s - 1e-9 * chains[0].s[-1])
    moved = motion[at, :3]
    largest = float(np.abs(moved).max())
    return Stability(fine + (fine - coarse) / 3.0, read_only(moved / largest if largest else moved))


def _lowest(arm: ArmModel, nodes: Nodes, load: SpatialLoad, motions: tuple[int, ...]) -> tuple[float, Array]:
    return lowest(Solver(arm, nodes.s, load, in_space=True), nodes.state, np.isin(np.arange(6), motions))
