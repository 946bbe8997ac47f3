"""An arm in space in equilibrium, from the end of its path."""

import numpy as np

from geometry.arrays import Array, read_only
from rod.arm.path import Path
from rod.spatial import SpatialLoad, SpatialSolution, Stability


def solved_in_space(
    path: Path, strains: tuple[Array, Array], load: SpatialLoad, stability: Stability, beside: Array
) -> SpatialSolution:
    """With curvatures and with stretch and shears (N, 3) at the nodes; beside: (N, 2 or 3) mm, the material curve."""
    nodes = path.nodes
    return SpatialSolution(
        s=read_only(nodes.s),
        axis=read_only(nodes.place),
        frames=read_only(nodes.frames),
        curvature=read_only(strains[0]),
        stretch=read_only(strains[1]),
        moment=read_only(nodes.moment),
        force=read_only(nodes.force),
        weight=read_only(np.array(load.weight) * float(nodes.s[-1])),
        stability=stability,
        load_steps=path.steps,
        notes=(),
        beside=read_only(beside),
    )
