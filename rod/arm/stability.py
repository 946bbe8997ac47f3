"""Stability of an arm in equilibrium, against all small motions or those out of its plane."""

from dataclasses import dataclass
from typing import final

import numpy as np

from geometry.arrays import Array, Mask, read_only
from rod.arm.chain import Nodes
from rod.arm.response import SolvedPath
from rod.arm.small_motions import lowest
from rod.arm.solver import ArmModel, Solver
from rod.load import Load

#: of the three motions and three turns of a section those out of the plane
OUT_OF_PLANE = (2, 3, 4)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Stability:
    """The lowest eigenvalue of the second variation of a rod's energy over the elastic part, in equilibrium."""

    lowest: float  #: 1 without loads, 0 where the rod buckles, below 0 beyond
    motion: Array  #: (n, 3) of the axis that belongs to it, of largest component 1

    @property
    def is_stable(self) -> bool:
        """Whether the rod returns from small motions."""
        return self.lowest > 0.0


def stability_of(path: SolvedPath, *, out_of_plane: bool = False) -> Stability:
    """Stability on both chains of an arm's path, at the limit of the elements, under a load that keeps its direction.

    out_of_plane: whether only motions out of its plane are possible.
    """
    (arm, load), chains = path.rod.posed(path.load), path.chains
    kept = np.isin(np.arange(6), OUT_OF_PLANE) if out_of_plane else np.ones(6, bool)
    (coarse, _), (fine, motion) = (_lowest(arm, nodes, load, kept) for nodes in chains)
    at = np.searchsorted(chains[1].s, chains[0].s - 1e-9 * chains[0].s[-1])
    moved = motion[at, :3]
    largest = float(np.abs(moved).max())
    return Stability(fine + (fine - coarse) / 3.0, read_only(moved / largest if largest else moved))


def _lowest(arm: ArmModel, nodes: Nodes, load: Load, kept: Mask) -> tuple[float, Array]:
    return lowest(Solver(arm, nodes.s, load, in_space=True), nodes.state, kept)
