"""How the contact of a state differs from that of its model, so that a path can go on from the stored state."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from fem.effects.facing_pairs import FacingPairs
from geometry.arrays import Array


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Tightening:
    """Contact that is stiffer than at first, has pairs of walls that crossed in a crease, or exact distances."""

    stiffness: float  #: MPa, of the barrier between the pairs; with exact distances of that to mirror images
    stiffenings: int  #: how often it may still be raised
    is_exact: bool  #: whether distances are exact
    pairs: FacingPairs  #: those that were added
    dhat: Array  #: (m,) mm, their activation distances

    def arrays(self, name: str) -> dict[str, NDArray[Any]]:
        """For a file; the names begin with `name`."""
        pairs = self.pairs
        return {
            name: np.array([self.stiffness, self.stiffenings, self.is_exact], dtype=float),
            f"{name}_nodes": np.column_stack([pairs.nodes, pairs.triangles]),
            f"{name}_sizes": np.column_stack([pairs.area, self.dhat]),
            f"{name}_mirrored": pairs.is_mirrored,
        }

    @classmethod
    def from_arrays(cls, name: str, arrays: Mapping[str, NDArray[Any]]) -> "Tightening | None":
        """What `arrays` gave; None where there is nothing of that name."""
        if name not in arrays:
            return None
        stiffness, stiffenings, is_exact = arrays[name].tolist()
        nodes, sizes = arrays[f"{name}_nodes"], arrays[f"{name}_sizes"]
        pairs = FacingPairs(nodes[:, 0], nodes[:, 1:], sizes[:, 0], arrays[f"{name}_mirrored"])
        return cls(stiffness, int(stiffenings), bool(is_exact), pairs, sizes[:, 1])
