"""An arm in space in equilibrium, from the end of its path."""

import numpy as np

from geometry.arrays import Array, read_only
from rod.along import reactions_of
from rod.arm.path import Path
from rod.arm.response import Posed, SolvedPath
from rod.solution import SpatialSolution
from rod.spatial import SpatialLoad


def solved_in_space(
    rod: Posed, path: Path, load: SpatialLoad, strains: tuple[Array, ...], beside: Array
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
        reactions=reactions_of(load.supports, nodes.reaction),
        weight=read_only(np.array(rod.posed(load)[1].weight) * float(nodes.s[-1])),
        load_steps=path.steps,
        notes=(),
        beside=read_only(beside),
        path=SolvedPath(rod, load, path.chains, in_space=True),
    )
