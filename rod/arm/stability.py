"""Stability of an arm in equilibrium, against all small motions or those out of its plane."""

import numpy as np

from geometry.arrays import Array, read_only
from rod.arm.chain import NodeLoads, Nodes, chain_arrays, held_along, load_arrays
from rod.arm.path import ArmModel
from rod.arm.response import SolvedPath
from rod.arm.small_motions import lowest
from rod.spatial import Held, Stability

#: the three motions and three turns of a section, and those of them out of the plane
ALL, OUT_OF_PLANE = (0, 1, 2, 3, 4, 5), (2, 3, 4)


def stability_of(path: SolvedPath, motions: tuple[int, ...]) -> Stability:
    """Of an arm on both chains of its path, at the limit of the elements, under a load that keeps its direction.

    motions: which of the three motions and three turns of a section are possible.
    """
    (arm, load), chains = path.rod.posed(*path.held), path.chains
    held = Held(load, path.held.position)
    (coarse, _), (fine, motion) = (_lowest(arm, nodes, held, motions) for nodes in chains)
    at = np.searchsorted(chains[1].s, chains[0].s - 1e-9 * chains[0].s[-1])
    moved = motion[at, :3]
    largest = float(np.abs(moved).max())
    return Stability(fine + (fine - coarse) / 3.0, read_only(moved / largest if largest else moved))


def _lowest(arm: ArmModel, nodes: Nodes, held: Held, motions: tuple[int, ...]) -> tuple[float, Array]:
    chain = chain_arrays(nodes.s, arm.decides_at, arm.clamp_reach, in_space=True)
    loads = NodeLoads.of(held.load, arm.mass, nodes.s)
    load = load_arrays(held.load, loads, held_along(held.position), np.zeros(3))
    kept, ends = np.isin(np.arange(6), motions), arm.ends(held.position)
    return lowest(arm.section.arrays(nodes.s), ends, chain, load, nodes.state, kept)
