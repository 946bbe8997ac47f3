"""Bending stiffness of a flat layer: a quadratic form of the positions of its nodes.

A plate that hardly stretches has the energy D/2 of the squares of its curvatures per area, D = E t^3 / (12 (1 - nu^2)).
Where it keeps its lengths the second derivatives of the positions x by the coordinates at rest are normal to it, so
that with their vectors

    W = D/2 ((1 - nu) x,ab . x,ab + nu x,aa . x,bb),

which needs no normal, is not changed by rigid motions and has a constant second derivative. (Second derivatives along
the layer, which stretching has as well, add t^2/12 of the squares of gradients of strain.) Quadratic triangles are
continuous, but their slopes jump at edges; the terms of the jumps are those of the interior penalty method, with
which constant curvatures are exact:

    sum over edges of integrals of {M_nn(x)} . [x,n] + penalty/2 |[x,n]|^2,   M_nn = D (x,nn + nu x,ss).

Linear triangles have the penalty alone: elastic hinges. In a plane of symmetry z = 0 an edge has its mirror image
beside it; elsewhere at its ends a layer bends freely, and so at edges that two triangles have at an angle.

Sources: S. Brenner and L.-Y. Sung, "C0 interior penalty methods for fourth order elliptic boundary value problems on
polygonal domains", J. Sci. Comput. 22 (2005); M. Wardetzky et al., "Discrete quadratic curvature energies", Comput.
Aided Geom. Des. 24 (2007).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
import scipy.sparse as sp

from geometry.arrays import Array, Index, Mask

#: the penalty of an edge over D times its length over the area of the smaller triangle: the smallest with which the
#: form is positive on triangles of any shape is 1.5; with that of hinges equilateral triangles bend as the plate does
PENALTY, PENALTY_OF_HINGES = 3.0, 0.5
#: barycentric coordinate of one end at the two Gauss points of an edge
GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)
#: sine of the angle between two triangles that counts as none
FLAT = 1e-6
#: the vertices of the sides of a triangle, and that on the other side of each
SIDES, OPPOSITE = np.array([[0, 1], [1, 2], [0, 2]]), np.array([2, 0, 1])


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class BendingForm:
    """The symmetric matrices A of the energy x . A x / 2, by component of the positions x (n, 3); N/mm.

    They give zero for the positions at rest, so that displacements may stand for positions, with less rounding.
    """

    rest: Array  #: (n, 3) positions at rest, mm
    across: sp.csr_array  #: (n, n) for x and y
    along_z: sp.csr_array  #: (n, n) for z, the normal of a plane of symmetry; with the entries of the other, some zero

    def energy(self, x: Array) -> float:
        """N mm, at the positions x (n, 3)."""
        return 0.5 * float(np.vdot(x - self.rest, self.force(x)))

    def force(self, x: Array) -> Array:
        """Derivative (n, 3) of the energy by the positions, N."""
        u = x - self.rest
        return np.column_stack([self.across @ u[:, 0], self.across @ u[:, 1], self.along_z @ u[:, 2]])

    @property
    def blocks(self) -> tuple[Index, Index, Array]:
        """Node pairs rows <= columns (m,) and the second derivative by each of them (m, 3, 3)."""
        across, along_z = self.across.tocoo(), self.along_z.tocoo()
        upper = across.row <= across.col
        values = np.zeros((np.count_nonzero(upper), 3, 3))
        values[:, 0, 0] = values[:, 1, 1] = across.data[upper]
        values[:, 2, 2] = along_z.data[upper]
        return across.row[upper].astype(np.int64), across.col[upper].astype(np.int64), values


def bending_form(points: Array, nodes: Index, rigidity: float, nu: float, mirror: Mask) -> BendingForm:
    """The form of flat triangles with nodes (f, 6) or (f, 3) at rest at points (n, 3), mm.

    rigidity: D, N mm. mirror: (n,) whether a node is in a plane of symmetry z = 0.
    """
    plate = _Plate.of(points, nodes, rigidity, nu)
    of_mirror = plate.of_mirror(mirror)
    parts = [plate.of_triangles, plate.of_edges]
    across, along_z = ([*parts, (of_mirror[0], factor * of_mirror[1])] for factor in (1.0, 0.0))
    return BendingForm(points, _matrix(across, points.shape[0]), _matrix(along_z, points.shape[0]))


def mirror_form(points: Array, nodes: Index, rigidity: float, nu: float, mirror: Mask) -> sp.csr_array:
    """Matrix A (n, n) of the energy x . A x / 2 of the edges in a plane of symmetry, of one component x along it.

    Half of what such an edge has with the mirror image of its triangle; arguments as of `bending_form`.
    """
    return _matrix([_Plate.of(points, nodes, rigidity, nu).of_mirror(mirror)], points.shape[0])


@dataclass(frozen=True, eq=False)
class _Plate:
    """Triangles with their sides; a nodes, two Gauss points on a side."""

    nodes: Index  #: (f, a)
    rigidity: float  #: D, N mm
    nu: float
    area: Array  #: (f,) mm2
    normal: Array  #: (f, 3)
    second: Array  #: (f, a, 3, 3) second derivatives by the nodes' positions, 1/mm2
    length: Array  #: (3 f,) of the sides, mm
    slope: Array  #: (3 f, 2, a) derivative along the outward normal of a side by the nodes' positions, 1/mm
    moment: Array  #: (3 f, a) M_nn by the nodes' positions, N/mm

    @staticmethod
    def of(points: Array, nodes: Index, rigidity: float, nu: float) -> "_Plate":
        gradient, area, normal = _barycentric(points[nodes[:, :3]])
        straight = _straightened(points[nodes], gradient)
        second = np.einsum("faij,fab->fbij", _second_derivatives(gradient, nodes.shape[1]), straight)
        outward = -gradient[:, OPPOSITE] / np.linalg.norm(gradient[:, OPPOSITE], axis=2)[..., None]
        slope = np.einsum("fsga,fab->fsgb", _slopes(nodes, gradient, outward), straight)
        along = np.einsum("fsi,faij,fsj->fsa", outward, second, outward)
        moment = rigidity * ((1 - nu) * along + nu * np.einsum("faii->fa", second)[:, None])
        length = np.linalg.norm(points[nodes[:, SIDES[:, 0]]] - points[nodes[:, SIDES[:, 1]]], axis=2).ravel()
        count = nodes.shape[1]
        sides = length, slope.reshape(-1, 2, count), moment.reshape(-1, count)
        return _Plate(nodes, rigidity, nu, area, normal, second, *sides)

    @property
    def of_triangles(self) -> tuple[Index, Array]:
        """Nodes (f, a) and matrices (f, a, a) of the triangles."""
        trace = np.einsum("faii->fa", self.second)
        form = (1 - self.nu) * np.einsum("faij,fbij->fab", self.second, self.second)
        form += self.nu * trace[:, :, None] * trace[:, None, :]
        return self.nodes, self.rigidity * self.area[:, None, None] * form

    @property
    def of_edges(self) -> tuple[Index, Array]:
        """Nodes (e, 2 a) and matrices (e, 2 a, 2 a) of the edges between two triangles in one plane."""
        first, last = self._edges[:2]
        jump = -np.concatenate([self.slope[first], self.slope[last]], axis=2)
        mean = np.concatenate([self.moment[first], self.moment[last]], axis=1) / 2
        nodes = np.concatenate([self.nodes[first // 3], self.nodes[last // 3]], axis=1)
        return nodes, self._of(first, np.minimum(self.area[first // 3], self.area[last // 3]), jump, mean)

    def of_mirror(self, mirror: Mask) -> tuple[Index, Array]:
        """Nodes (e, a) and matrices (e, a, a) of half the edges with both ends at nodes in a plane of symmetry (n,).

        The mirror image of a triangle has the opposite slope.
        """
        sides = self._edges[2]
        sides = sides[mirror[self.nodes[:, SIDES].reshape(-1, 2)[sides]].all(axis=1)]
        matrices = self._of(sides, self.area[sides // 3], -2 * self.slope[sides], self.moment[sides])
        return self.nodes[sides // 3], matrices / 2

    def _of(self, sides: Index, area: Array, jump: Array, mean: Array) -> Array:
        """Matrices (e, a, a) of edges from the jumps of slope (e, 2, a) and the mean moments (e, a) by the nodes."""
        penalty = PENALTY if self.nodes.shape[1] == 6 else PENALTY_OF_HINGES
        stiffness = penalty * self.rigidity * self.length[sides] / area
        consistent = np.einsum("ea,eb->eab", mean, jump.mean(axis=1))
        squares = stiffness[:, None, None] * np.einsum("ega,egb->eab", jump, jump) / 2
        return np.asarray(self.length[sides, None, None] * (squares + consistent + consistent.transpose(0, 2, 1)))

    @cached_property
    def _edges(self) -> tuple[Index, Index, Index]:
        """Numbers of the sides that two triangles in one plane have in common (e,), (e,), and of single ones (k,)."""
        ends = np.sort(self.nodes[:, SIDES], axis=2).reshape(-1, 2)
        _, edge, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
        order = np.argsort(edge.reshape(-1), kind="stable")
        start = np.concatenate([[0], np.cumsum(count)[:-1]])
        first, last = order[start[count == 2]], order[start[count == 2] + 1]
        angle = np.linalg.norm(np.cross(self.normal[first // 3], self.normal[last // 3]), axis=1)
        return first[angle < FLAT], last[angle < FLAT], order[start[count == 1]]


def _barycentric(vertices: Array) -> tuple[Array, Array, Array]:
    """Gradients (f, 3, 3) of the barycentric coordinates, areas (f,) and unit normals (f, 3) of triangles (f, 3, 3)."""
    edge = np.roll(vertices, -2, axis=1) - np.roll(vertices, -1, axis=1)  # opposite to each vertex
    normal = np.cross(edge[:, 0], edge[:, 1])
    twice = np.linalg.norm(normal, axis=1)
    normal /= twice[:, None]
    return np.cross(normal[:, None], edge) / twice[:, None, None], twice / 2, normal


def _second_derivatives(gradient: Array, count: int) -> Array:
    """(f, a, 3, 3) of the shape functions of a = 3 or 6 nodes along the triangles."""
    if count == 3:
        return np.zeros((gradient.shape[0], 3, 3, 3))
    first, last = gradient[:, SIDES[:, 0]], gradient[:, SIDES[:, 1]]
    middle = 4 * np.einsum("fai,faj->faij", first, last)
    corner = 4 * np.einsum("fai,faj->faij", gradient, gradient)
    return np.concatenate([corner, middle + middle.transpose(0, 1, 3, 2)], axis=1)


def _straightened(positions: Array, gradient: Array) -> Array:
    """(f, a, a) what takes the nodes of triangles with positions (f, a, 3) to those of triangles with straight edges.

    A node off the middle of its edge is moved as the linear triangle is; gradient (f, 3, 3) of its coordinates.
    """
    triangles, count = positions.shape[:2]
    result = np.tile(np.eye(count), (triangles, 1, 1))
    if count == 6:
        off = positions[:, 3:] - (positions[:, SIDES[:, 0]] + positions[:, SIDES[:, 1]]) / 2
        result[:, 3:, :3] = -np.einsum("fsi,fai->fsa", off, gradient)
    return result


def _slopes(nodes: Index, gradient: Array, outward: Array) -> Array:
    """(f, 3, 2, a) derivative along the outward normal (f, 3, 3) of each side at its Gauss points by the positions."""
    linear = np.einsum("fai,fsi->fsa", gradient, outward)[:, :, None]  # of the barycentric coordinates
    if nodes.shape[1] == 3:
        return np.repeat(linear, 2, axis=2)
    at = np.zeros((3, 2, 3))  # the barycentric coordinates at the Gauss points of each side
    i, j = SIDES.T
    for side in range(3):
        at[side, :, i[side]], at[side, :, j[side]] = GAUSS, GAUSS[::-1]
    middle = 4 * (at[..., i] * linear[..., j] + at[..., j] * linear[..., i])
    slope = np.concatenate([(4 * at - 1) * linear, middle], axis=3)
    swapped = nodes[:, SIDES[:, 0]] > nodes[:, SIDES[:, 1]]  # so that both triangles of an edge have the same points
    return np.where(swapped[:, :, None, None], slope[:, :, ::-1], slope)


def _matrix(parts: list[tuple[Index, Array]], count: int) -> sp.csr_array:
    """Sum (n, n) of matrices (e, a, a) by the nodes (e, a)."""
    rows = np.concatenate([np.repeat(nodes, nodes.shape[1], axis=1).ravel() for nodes, _ in parts])
    columns = np.concatenate([np.tile(nodes, (1, nodes.shape[1])).ravel() for nodes, _ in parts])
    values = np.concatenate([matrices.ravel() for _, matrices in parts])
    return sp.coo_array((values, (rows, columns)), shape=(count, count)).tocsr()
