"""Where the body is held: prescribed displacement components on named faces, common edges or single nodes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.spatial import cKDTree

from fem.discretisation import Discretisation
from geometry.arrays import Array, Index, Mask

COMPONENTS = "xyz"


class SupportError(ValueError):
    """A support that names no node, or components that do not exist."""


@final
@dataclass(frozen=True, eq=False)  # an array inside
class Line:
    """A line along edges of the mesh."""

    vertices: Array  #: (k, 3) the vertices on it at rest in their order, mm

    def positions(self, space: Discretisation) -> Array:
        """Its nodes (m, 3) at rest in their order, mm: with the middles of its edges where the elements have them."""
        if not space.has_middles:
            return self.vertices
        line = np.empty((2 * self.vertices.shape[0] - 1, 3))
        line[::2] = self.vertices
        line[1::2] = (self.vertices[1:] + self.vertices[:-1]) / 2
        return line

    def nodal_weights(self, space: Discretisation) -> Array:
        """Consistent nodal weights (m,) of a uniform line load; they sum to 1."""
        edges = np.linalg.norm(np.diff(self.vertices, axis=0), axis=1)
        at_ends, inside, step = (1 / 6, 4 / 6, 2) if space.has_middles else (1 / 2, 0.0, 1)
        weights = np.zeros(step * edges.shape[0] + 1)
        weights[1::step] += inside * edges
        weights[:-step:step] += at_ends * edges
        weights[step::step] += at_ends * edges
        return weights / edges.sum()


Where = str | tuple[str, str] | Array | Line


@final
@dataclass(frozen=True)
class Fixed:
    """Displacement components held at zero.

    where: a face name, a pair of face names (their common edge), node positions (n, 3) in mm or a line.
    """

    where: Where
    components: str = "xyz"


@final
@dataclass(frozen=True)
class Prescribed:
    """One displacement component given a value in mm at load factor 1; with ramp=False whole from the first step."""

    where: Where
    component: str
    value: float
    ramp: bool = True


Support = Fixed | Prescribed


@final
@dataclass(frozen=True)
class Constraints:
    """All supports of a model, resolved to nodes."""

    fixed: Mask  #: (n, 3) components that are prescribed
    ramped: Array  #: (n, 3) prescribed values that grow with the load factor, mm
    constant: Array  #: (n, 3) prescribed values that are whole from the first step, mm

    @classmethod
    def of(cls, supports: Sequence[Support], space: Discretisation) -> "Constraints":
        """Resolve `supports`; raises `SupportError`."""
        shape = space.points.shape
        fixed = np.zeros(shape, dtype=bool)
        ramped, constant = np.zeros(shape), np.zeros(shape)
        for support in supports:
            nodes = nodes_at(support.where, space)
            letters = support.components if isinstance(support, Fixed) else support.component
            for letter in letters:
                if letter not in COMPONENTS:
                    raise SupportError(f"component {letter!r} does not exist; allowed are x, y and z")
                axis = COMPONENTS.index(letter)
                fixed[nodes, axis] = True
                value = support.value if isinstance(support, Prescribed) else 0.0
                moving = isinstance(support, Prescribed) and support.ramp
                ramped[nodes, axis] = value if moving else 0.0
                constant[nodes, axis] = 0.0 if moving else value
        return cls(fixed, ramped, constant)


def nodes_at(where: Where, space: Discretisation) -> Index:
    """Node numbers (k,) of a face, of the common edge of two faces, at given positions (n, 3), or along a line.

    Raises `SupportError` where there is none, and ValueError for a face that does not exist.
    """
    if isinstance(where, str):
        return space.surface(where).unique_nodes
    if isinstance(where, tuple):
        first, second = (space.surface(name).unique_nodes for name in where)
        nodes = np.intersect1d(first, second)
        if nodes.size == 0:
            raise SupportError(f"faces {where[0]!r} and {where[1]!r} have no common edge")
        return nodes
    positions = where.positions(space) if isinstance(where, Line) else np.atleast_2d(np.asarray(where, dtype=float))
    distance, nodes = cKDTree(space.points).query(positions)
    if distance.max() > 1e-6 * np.ptp(space.points, axis=0).max():
        worst = positions[int(np.argmax(distance))]
        raise SupportError(f"no node at {tuple(np.round(worst, 6))} mm; the nearest is {distance.max():.3g} mm away")
    return np.asarray(nodes)
