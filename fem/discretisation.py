"""From a mesh to quadratic tetrahedra: nodes, gradients and quadrature (the only door to scikit-fem)."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import skfem
from numpy.typing import NDArray

from fem.kernels import greedy_colours
from geometry import Mesh

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FORMULATIONS = ("p2p0", "p2", "mixed")


@dataclass(frozen=True)
class Faces:
    """Quadratic triangles of one named surface."""

    nodes: Index  #: (f, 6), vertices then mid-edge nodes (01, 12, 02), normal out of the solid
    shape: Array  #: (q, 6) shape functions at the quadrature points
    derivative: Array  #: (q, 6, 2) their reference derivatives
    weight: Array  #: (q,)

    @cached_property
    def triangles(self) -> Index:
        """(4 f, 3) linear triangles through all six nodes of each face, same orientation."""
        order = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
        return self.nodes[:, order].reshape(-1, 3)

    @cached_property
    def unique_nodes(self) -> Index:
        """(k,) nodes of the surface, sorted."""
        return np.unique(self.nodes)


@dataclass(frozen=True)
class Discretisation:
    """Quadratic tetrahedra with straight edges, their stress points and their surfaces.

    Stress points: with `p2p0` four points carry the shear part of the law and the centroid the volumetric part; with
    `p2` and `mixed` four points carry the whole law (`fem.formulation`).
    """

    points: Array  #: (n, 3) reference positions of all nodes, vertices first, mm
    nodes: Index  #: (e, 10), vertices then mid-edge nodes (01, 12, 02, 03, 13, 23), sorted by colour
    colours: Index  #: (c + 1,) where each colour begins in `nodes`
    inverse: Array  #: (e, 3, 3) inverse Jacobians d xi / d X, 1/mm
    reference: Array  #: (q, 10, 3) reference gradients of the shape functions at the stress points
    vertex_shape: Array  #: (q, 4) linear shape functions of the vertices at the stress points
    weight: Array  #: (e, q) quadrature weights times volume, mm3
    formulation: str
    surfaces: Mapping[str, Faces]

    @classmethod
    def of(cls, mesh: Mesh, formulation: str) -> "Discretisation":
        """Quadratic elements on `mesh`; raises ValueError for a formulation that does not exist."""
        if formulation not in FORMULATIONS:
            raise ValueError(f"formulation {formulation!r}: allowed are {', '.join(FORMULATIONS)}")
        grid = skfem.MeshTet(mesh.points.T.copy(), np.asarray(mesh.tets, dtype=np.int64).T.copy())
        basis = skfem.Basis(grid, skfem.ElementVector(skfem.ElementTetP2()), intorder=2)
        nodes = np.ascontiguousarray(basis.element_dofs[::3].T // 3, dtype=np.int64)
        points = np.ascontiguousarray(basis.doflocs[:, ::3].T)
        colour = greedy_colours(nodes[:, :4], mesh.points.shape[0])
        order = np.argsort(colour, kind="stable")
        nodes = nodes[order]
        colours = np.concatenate([[0], np.cumsum(np.bincount(colour))])
        jacobian = np.stack([points[nodes[:, k]] - points[nodes[:, 0]] for k in (1, 2, 3)], axis=2)
        volume = np.abs(np.linalg.det(jacobian)) / 6.0
        reference, vertex_shape, share = _stress_points(basis, formulation)
        return cls(
            points=points,
            nodes=nodes,
            colours=colours.astype(np.int64),
            inverse=np.ascontiguousarray(np.linalg.inv(jacobian)),
            reference=reference,
            vertex_shape=vertex_shape,
            weight=np.ascontiguousarray(volume[:, None] * share[None, :]),
            formulation=formulation,
            surfaces=_surfaces(mesh, grid),
        )

    def surface(self, name: str) -> Faces:
        """The named surface; raises ValueError naming those that exist."""
        if name not in self.surfaces:
            raise ValueError(f"face {name!r} does not exist; the mesh has {', '.join(sorted(self.surfaces))}")
        return self.surfaces[name]


def _stress_points(basis: skfem.Basis, formulation: str) -> tuple[Array, Array, Array]:
    """Reference gradients (q, 10, 3), linear shape functions (q, 4) and shares of the element volume (q,)."""
    element = skfem.ElementTetP2()
    places, share = [basis.X], [6.0 * basis.W]
    if formulation == "p2p0":
        places.append(np.full((3, 1), 0.25))
        share.append(np.ones(1))
    where = np.concatenate(places, axis=1)
    gradients = np.stack([element.lbasis(where, a)[1].T for a in range(10)], axis=1)
    linear = np.stack([skfem.ElementTetP1().lbasis(where, a)[0] for a in range(4)], axis=1)
    return np.ascontiguousarray(gradients), np.ascontiguousarray(linear), np.concatenate(share)


def _surfaces(mesh: Mesh, grid: skfem.MeshTet) -> dict[str, Faces]:
    element = skfem.ElementTriP2()
    where, weight = skfem.quadrature.get_quadrature(skfem.refdom.RefTri, 4)
    shape = np.stack([element.lbasis(where, a)[0] for a in range(6)], axis=1)
    derivative = np.stack([element.lbasis(where, a)[1].T for a in range(6)], axis=1)
    vertices = mesh.points.shape[0]
    keys = grid.edges[0].astype(np.int64) * vertices + grid.edges[1]
    order = np.argsort(keys)
    surfaces = {}
    for name, triangles in mesh.faces.items():
        corner = np.asarray(triangles, dtype=np.int64)
        ends = np.sort(corner[:, [[0, 1], [1, 2], [0, 2]]], axis=2)
        edge = order[np.searchsorted(keys[order], ends[..., 0] * vertices + ends[..., 1])]
        nodes = np.concatenate([corner, vertices + edge], axis=1)
        surfaces[name] = Faces(nodes, np.ascontiguousarray(shape), np.ascontiguousarray(derivative), weight)
    return surfaces
