"""An arm in space in equilibrium, from the end of its path."""

from functools import partial

import numpy as np

from geometry.arrays import Array, read_only
from rod.arm.path import ArmModel, Path
from rod.arm.stability import stability_of
from rod.spatial import Held, SpatialSolution


def solved_in_space(
    arm: ArmModel, path: Path, held: Held, strains: tuple[Array, Array], beside: Array
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
        weight=read_only(np.array(held.load.weight) * float(nodes.s[-1])),
        load_steps=path.steps,
        notes=(),
        beside=read_only(beside),
        find_stability=partial(stability_of, arm, path.chains, held),
    )
