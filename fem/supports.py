"""Supports: linear equations between displacement components on named faces, common edges, lines or single nodes.

Each support is a value that states its equations for a discretisation; `fem.equations.constraints` solves those of a
model together.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from fem.discretisation import Discretisation
from fem.finite import check_finite
from geometry import PneurodError
from geometry.arrays import Array, Index

COMPONENTS = "xyz"
#: distance over the size of the body within which a node stands at a position
NEAR = 1e-6


class SupportError(PneurodError, ValueError):
    """A support that names no node or component, or that contradicts another one."""


@final
@dataclass(frozen=True, eq=False)  # an array inside
class Line:
    """A line along edges of the mesh."""

    vertices: Array  #: (k, 3) the vertices on it at rest in their order, mm

    def positions(self, space: Discretisation) -> Array:
        """Its nodes (m, 3) at rest in their order, mm: with the middles of its edges where the elements have them."""
        if not space.element.quadratic:
            return self.vertices
        line = np.empty((2 * self.vertices.shape[0] - 1, 3))
        line[::2] = self.vertices
        line[1::2] = (self.vertices[1:] + self.vertices[:-1]) / 2
        return line

    def nodal_weights(self, space: Discretisation) -> Array:
        """Consistent nodal weights (m,) of a uniform line load; they sum to 1."""
        edges = np.linalg.norm(np.diff(self.vertices, axis=0), axis=1)
        of_edge = space.element.shape.edge_weights
        step = len(of_edge) - 1
        weights = np.zeros(step * edges.shape[0] + 1)
        for node, weight in enumerate(of_edge):
            weights[node : node + step * edges.shape[0] : step] += weight * edges
        return weights / edges.sum()


Where = str | tuple[str, str] | Array | Line


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Equations:
    """k linear equations of a support: sum_t coefficients_t u_t = common s + factor ramped + constant.

    u_t are displacement components in mm, s is one unknown in mm that the equations have in common, factor is the load
    factor.
    """

    components: Index  #: (k, t) displacement components, 3 times the node plus 0, 1 or 2 for x, y or z
    coefficients: Array  #: (k, t)
    ramped: Array  #: (k,) right-hand sides that grow with the load factor, mm at factor 1
    constant: Array  #: (k,) right-hand sides in full from the first target on, mm
    common: float = 0.0  #: coefficient of the unknown in common; 0 where there is none

    @classmethod
    def of(cls, components: Index, coefficients: Array, value: Array, ramp: bool, common: float = 0.0) -> "Equations":
        """Equations with the right-hand sides value (k,), ramped or not; coefficients (k, t) or (t,)."""
        none = np.zeros_like(value)
        coefficients = np.array(np.broadcast_to(coefficients, components.shape), dtype=float)
        return cls(components, coefficients, value if ramp else none, none if ramp else value, common)


class Support(ABC):
    """What restricts the displacement of nodes."""

    where: Where

    @abstractmethod
    def equations(self, space: Discretisation) -> Equations:
        """Its equations.

        Raises `SupportError` where it names no node or a component that does not exist, and ValueError for a face that
        does not exist.
        """


@final
@dataclass(frozen=True)
class Fixed(Support):
    """Displacement components that stay zero.

    where: a face name, a pair of face names (their common edge), node positions (n, 3) in mm or a line. components: one
    or more of the letters x, y and z.
    """

    where: Where
    components: str = "xyz"

    def equations(self, space: Discretisation) -> Equations:
        """u_i = 0."""
        components = _components(self.components, nodes_at(self.where, space)).reshape(-1, 1)
        return Equations.of(components, np.ones(1), np.zeros(components.shape[0]), ramp=False)


@final
@dataclass(frozen=True)
class Prescribed(Support):
    """One displacement component with a given value in mm at load factor 1.

    With ramp=False the value is prescribed in full from the first target on. Raises `SupportError` for a value that is
    not finite.
    """

    where: Where
    component: str
    value: float
    ramp: bool = True

    def __post_init__(self) -> None:
        check_finite(f"prescribed displacement {self.component}: value (mm)", self.value, SupportError)

    def equations(self, space: Discretisation) -> Equations:
        """u_i = value."""
        components = _components(self.component, nodes_at(self.where, space)).reshape(-1, 1)
        return Equations.of(components, np.ones(1), np.full(components.shape[0], self.value), self.ramp)


@final
@dataclass(frozen=True)
class SharedPlane(Support):
    """Nodes that lie in one plane of given normal whose distance from the origin is an unknown of the model.

    The plane takes the position in which the forces along its normal balance: without other loads on it the nodes carry
    no resultant force along the normal. Positions are x = c n + eta e2 + zeta e3 with a common unknown c. Where the
    normal is not that of the nodes at rest they are moved into the plane that passes through the mean of their
    distances, in full from the first target on.

    normal: (3,) of any length. Raises `SupportError` for a normal of length zero.
    """

    where: Where
    normal: tuple[float, float, float]

    def equations(self, space: Discretisation) -> Equations:
        """n . (X + u) = c with c = s + the mean of n . X."""
        nodes, normal = nodes_at(self.where, space), _unit(self.normal)
        distance = space.points[nodes] @ normal
        components = _components("xyz", nodes).reshape(-1, 3)
        return Equations.of(components, normal, distance.mean() - distance, ramp=False, common=1.0)


@final
@dataclass(frozen=True)
class FixedAlong(Support):
    """Displacements along one direction that stay zero; those across it are free.

    normal: the direction, (3,) of any length. Raises `SupportError` for a length of zero.
    """

    where: Where
    normal: tuple[float, float, float]

    def equations(self, space: Discretisation) -> Equations:
        """n . u = 0."""
        components = _components("xyz", nodes_at(self.where, space)).reshape(-1, 3)
        return Equations.of(components, _unit(self.normal), np.zeros(components.shape[0]), ramp=False)


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
    distance, nodes = space.tree.query(positions)
    if distance.max() > NEAR * np.ptp(space.points, axis=0).max():
        worst = positions[int(np.argmax(distance))]
        raise SupportError(f"no node at {tuple(np.round(worst, 6))} mm; the nearest is {distance.max():.3g} mm away")
    return np.asarray(nodes)


def _components(letters: str, nodes: Index) -> Index:
    """(k, c) component numbers of the nodes (k,) for c letters; raises `SupportError`."""
    for letter in letters:
        if letter not in COMPONENTS:
            raise SupportError(f"component {letter!r} does not exist; allowed are x, y and z")
    return 3 * np.asarray(nodes)[:, None] + np.array([COMPONENTS.index(letter) for letter in letters], dtype=np.int64)


def _unit(normal: tuple[float, float, float]) -> Array:
    """The normal with length 1; raises `SupportError`."""
    length = float(np.linalg.norm(normal))
    if not (np.isfinite(length) and length > 0.0):
        raise SupportError(f"a plane needs a normal of finite length greater than zero, not {tuple(normal)}")
    return np.asarray(normal, dtype=float) / length
