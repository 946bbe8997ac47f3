"""Supports that couple displacement components, for the verification of general constraints."""

from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.spatial import cKDTree

from fem.discretisation import Discretisation
from fem.supports import Equations, Support, Where, _components, _unit, nodes_at
from geometry.arrays import Index


@final
@dataclass(frozen=True)
class Symmetry(Support):
    """Nodes that move only within a plane of any direction: their displacement along its normal is prescribed, mm."""

    where: Where
    normal: tuple[float, float, float]
    offset: float = 0.0
    ramp: bool = True

    def equations(self, space: Discretisation) -> Equations:
        """n . u = offset."""
        nodes, normal = nodes_at(self.where, space), _unit(self.normal)
        along = np.abs(normal) > 0.0
        components = _components("xyz", nodes).reshape(-1, 3)[:, along]
        return Equations.of(components, normal[along], np.full(nodes.shape[0], self.offset), self.ramp)


@final
@dataclass(frozen=True)
class Tied(Support):
    """Nodes whose displacements equal those of one node, or of those that stand beside them up to one translation."""

    where: Where
    to: Where
    components: str = "xyz"

    def equations(self, space: Discretisation) -> Equations:
        """u_i - u_i(to) = 0."""
        nodes, targets = nodes_at(self.where, space), nodes_at(self.to, space)
        targets = np.repeat(targets, nodes.shape[0]) if targets.shape[0] == 1 else _matching(nodes, targets, space)
        pairs = np.stack([_components(self.components, nodes), _components(self.components, targets)], axis=-1)
        pairs = pairs.reshape(-1, 2)
        return Equations.of(pairs, np.array([1.0, -1.0]), np.zeros(pairs.shape[0]), ramp=False)


def _matching(nodes: Index, targets: Index, space: Discretisation) -> Index:
    positions, others = space.points[nodes], space.points[targets]
    _, order = cKDTree(others).query(positions + (others.mean(axis=0) - positions.mean(axis=0)))
    return targets[order]
