"""From a mesh to quadratic or linear tetrahedra: nodes, gradients and quadrature (the only door to scikit-fem)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from fem.elements import Element, Volumetric, element_of
from fem.kernels.element import ElementArrays, chunk_colours, green_lagrange
from fem.kernels.surface import FaceArrays
from geometry import Mesh
from geometry.arrays import Array, Index, Mask
from geometry.topology import EDGES

try:
    import skfem
except ModuleNotFoundError as missing:
    said = "bodies and finite elements need the solver, which pip install 'pneurod[solve]' brings"
    raise ModuleNotFoundError(said, name=missing.name) from None

#: least number of elements in a chunk, and largest number of chunks: enough chunks for the threads of a laptop, and
#: chunks small enough to stay in the cache of a core
MIN_CHUNK_SIZE, MAX_CHUNKS = 64, 32


def pairs_within(nodes: Index) -> tuple[Index, Index, Mask]:
    """All pairs of nodes in each row of (m, a): the smaller and the larger one (k m,), and whether they were swapped
    for it (k m,)."""
    a, b = np.triu_indices(nodes.shape[1])
    first, second = nodes[:, a].ravel(), nodes[:, b].ravel()
    return np.minimum(first, second), np.maximum(first, second), first > second


@dataclass(frozen=True)
class Faces:
    """Triangles of one named surface, with a = 6 nodes on quadratic elements and 3 on linear ones."""

    nodes: Index  #: (f, a), vertices then mid-edge nodes (01, 12, 02), normal out of the solid
    shape: Array  #: (q, a) shape functions at the quadrature points
    derivative: Array  #: (q, a, 2) their reference derivatives
    weight: Array  #: (q,)

    @property
    def arrays(self) -> FaceArrays:
        """What the kernels take."""
        return FaceArrays(self.nodes, self.shape, self.derivative, self.weight)

    @cached_property
    def triangles(self) -> Index:
        """(4 f, 3) linear triangles through all six nodes of each face, same orientation; the (f, 3) of linear ones."""
        if self.nodes.shape[1] == 3:
            return self.nodes
        order = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
        return self.nodes[:, order].reshape(-1, 3)

    @cached_property
    def unique_nodes(self) -> Index:
        """(k,) nodes of the surface, sorted."""
        return np.unique(self.nodes)

    @cached_property
    def node_pairs(self) -> tuple[Index, Index, Mask]:
        """For all pairs a <= b of nodes of each face, the smaller and the larger node (m f,), and whether they were
        swapped for it (m f,). The same arrays on each call, so that their position in a matrix can be kept."""
        return pairs_within(self.nodes)


@dataclass(frozen=True)
class Discretisation:
    """Tetrahedra, their stress points and their surfaces; a = 10 nodes, 4 in linear elements.

    Quadratic elements are isoparametric: where the mesh has curved edges, their middle is a node on the round wall.

    The stress points are those of the quadrature rule of the shape functions, and after them the centroid where the
    element evaluates the volumetric part of the law there alone.
    """

    points: Array  #: (n, 3) reference positions of all nodes, vertices first, mm
    nodes: Index  #: (e, a), vertices then mid-edge nodes (01, 12, 02, 03, 13, 23), sorted by colour and chunk
    chunks: Index  #: (k + 1,) where each chunk begins in `nodes`
    colours: Index  #: (c + 1,) where each colour begins in `chunks`
    inverse: Array  #: (e, q, 3, 3) inverse Jacobians d xi / d X, 1/mm; (e, 1, 3, 3) where all edges are straight
    reference: Array  #: (q, a, 3) reference gradients of the shape functions at the stress points
    vertex_shape: Array  #: (q, 4) linear shape functions of the vertices at the stress points
    weight: Array  #: (e, q) quadrature weights times volume, mm3
    element: Element
    surfaces: Mapping[str, Faces]
    regions: Mapping[str, Index]  #: name -> (m,) elements of a region with a material of its own
    of_tets: Index  #: (e,) the element that each tetrahedron of the mesh is; what leaves `fem` is in the mesh's order

    @classmethod
    def of(cls, mesh: Mesh, formulation: str) -> "Discretisation":
        """The elements of that name on `mesh`; raises ValueError where there are none (`fem.elements.ELEMENTS`)."""
        element = element_of(formulation)
        grid = skfem.MeshTet(mesh.points.T.copy(), np.asarray(mesh.tets, dtype=np.int64).T.copy())
        nodes, points = _nodes(grid, element.quadratic)
        if element.quadratic and len(mesh.curved):
            points[mesh.points.shape[0] + _edge_numbers(grid, mesh.curved.ends)] = mesh.curved.middles
        nodes, chunks, colours, order = _in_chunks(nodes, mesh.points)
        new_index = np.argsort(order)
        reference, vertex_shape, fraction = _stress_points(element)
        curved = element.quadratic and len(mesh.curved) > 0
        inverse, weight = (_curved if curved else _straight)(points[nodes], reference, fraction)
        return cls(
            points=points,
            nodes=nodes,
            chunks=chunks,
            colours=colours,
            inverse=inverse,
            reference=reference,
            vertex_shape=vertex_shape,
            weight=weight,
            element=element,
            surfaces=_surfaces(mesh, grid if element.quadratic else None),
            regions={name: np.sort(new_index[tets]) for name, tets in mesh.regions.items()},
            of_tets=new_index,
        )

    def moved(self, points: Array) -> "Discretisation":
        """These elements with their nodes at other positions (n, 3), mm; straight edges must stay straight."""
        _, _, fraction = _stress_points(self.element)
        geometry = _straight if self.inverse.shape[1] == 1 else _curved
        inverse, weight = geometry(points[self.nodes], self.reference, fraction)
        return replace(self, points=points, inverse=inverse, weight=weight)

    def positions_on(self, mesh: Mesh) -> Array:
        """Positions (n, 3) of the nodes on a mesh of the same elements whose vertices lie elsewhere, mm."""
        points = np.empty_like(self.points)
        points[: len(mesh.points)] = mesh.points
        if self.element.quadratic:
            pairs = self.nodes[:, EDGES].reshape(-1, 2)
            points[self.nodes[:, 4:].ravel()] = mesh.curved.middles_of(pairs, mesh.points)
        return points

    @property
    def arrays(self) -> ElementArrays:
        """What the kernels take."""
        return ElementArrays(self.colours, self.chunks, self.nodes, self.inverse, self.reference, self.weight)

    @cached_property
    def vertices(self) -> Index:
        """(e, 4) the nodes that are vertices."""
        return np.ascontiguousarray(self.nodes[:, :4])

    @cached_property
    def tree(self) -> cKDTree:
        """For the nodes next to positions."""
        return cKDTree(self.points)

    @property
    def nodes_of_tets(self) -> Index:
        """(e, a) the nodes of the tetrahedra in the order of the mesh."""
        return np.ascontiguousarray(self.nodes[self.of_tets])

    @property
    def shear_points(self) -> slice:
        """The stress points that carry the shear part of the law: those of the quadrature rule of the elements."""
        return slice(0, self.element.shape.points)

    @cached_property
    def volume(self) -> Array:
        """(e,) mm3."""
        return np.asarray(self.weight[:, self.shear_points].sum(axis=1))

    def strain_of(self, displacement: Array) -> tuple[Array, Array]:
        """Green-Lagrange strain (e, q, 6) and det F (e, q) at the stress points, of a displacement (n, 3)."""
        strain, jacobian = np.empty((*self.weight.shape, 6)), np.empty(self.weight.shape)
        green_lagrange(self.arrays, displacement, strain, jacobian)
        return strain, jacobian

    def triangles_between(self, nodes: Index) -> Index:
        """(m, 3) of all surfaces, between nodes (k,)."""
        ours = np.zeros(len(self.points), dtype=bool)
        ours[nodes] = True
        triangles = np.unique(np.vstack([surface.triangles for surface in self.surfaces.values()]), axis=0)
        return np.asarray(triangles[ours[triangles].all(axis=1)])

    def surface(self, name: str) -> Faces:
        """The named surface; raises ValueError naming those that exist."""
        if name not in self.surfaces:
            raise ValueError(f"face {name!r} does not exist; the mesh has {', '.join(sorted(self.surfaces))}")
        return self.surfaces[name]


def _straight(corners: Array, reference: Array, fraction: Array) -> tuple[Array, Array]:
    """Inverse Jacobians (e, 1, 3, 3) and weights (e, q) of elements with straight edges and nodes at `corners`
    (e, a, 3), mm."""
    jacobian = np.stack([corners[:, k] - corners[:, 0] for k in (1, 2, 3)], axis=2)
    volume = np.abs(np.linalg.det(jacobian)) / 6.0
    inverse = np.ascontiguousarray(np.linalg.inv(jacobian))[:, None]
    return inverse, np.ascontiguousarray(volume[:, None] * fraction[None, :])


def _curved(corners: Array, reference: Array, fraction: Array) -> tuple[Array, Array]:
    """The same, (e, q, 3, 3) and (e, q), of isoparametric elements. The points of the quadrature rule come first; the
    weight of a centroid after them is the volume of its element."""
    jacobian = np.einsum("qak,eai->eqik", reference, corners)
    weight = np.abs(np.linalg.det(jacobian)) / 6.0 * fraction
    rule = int(np.argmax(np.cumsum(fraction) > 1.0 - 1e-9)) + 1
    weight[:, rule:] = weight[:, :rule].sum(axis=1, keepdims=True)
    return np.ascontiguousarray(np.linalg.inv(jacobian)), np.ascontiguousarray(weight)


def _in_chunks(nodes: Index, vertices: Array) -> tuple[Index, Index, Index, Index]:
    """The elements nodes (e, a) sorted into chunks along the body's longest side, by colour; `chunks` and `colours`;
    the former numbers (e,) of the sorted elements."""
    centre = vertices[nodes[:, :4]].mean(axis=1)
    along = np.argsort(centre[:, np.ptp(vertices, axis=0).argmax()], kind="stable")
    nodes = nodes[along]
    count = min(max(nodes.shape[0] // MIN_CHUNK_SIZE, 1), MAX_CHUNKS)
    chunks = np.linspace(0, nodes.shape[0], count + 1).astype(np.int64)
    colour = chunk_colours(chunks, np.ascontiguousarray(nodes[:, :4]), vertices.shape[0])
    order = np.argsort(colour, kind="stable")
    parts = [np.arange(chunks[chunk], chunks[chunk + 1]) for chunk in order]
    begins = np.concatenate([[0], np.cumsum([part.shape[0] for part in parts])])
    colours = np.concatenate([[0], np.cumsum(np.bincount(colour))])
    sorted_ = np.concatenate(parts)
    return np.ascontiguousarray(nodes[sorted_]), begins.astype(np.int64), colours.astype(np.int64), along[sorted_]


def _nodes(grid: skfem.MeshTet, quadratic: bool) -> tuple[Index, Array]:
    """Nodes (e, a) of the elements and their positions (n, 3): vertices, then the middles of edges.

    Those of scikit-fem's bases, which evaluate all shape functions in all elements besides.
    """
    vertices, points = grid.t.T.astype(np.int64), np.ascontiguousarray(grid.p.T)
    if not quadratic:
        return vertices, points
    middles = grid.t2e.T.astype(np.int64) + grid.p.shape[1]
    return np.hstack([vertices, middles]), np.vstack([points, points[grid.edges].mean(axis=0)])


def _stress_points(element: Element) -> tuple[Array, Array, Array]:
    """Reference gradients (q, a, 3), linear shape functions (q, 4) and fractions of the element volume (q,)."""
    tetrahedron, count = (skfem.ElementTetP2(), 10) if element.quadratic else (skfem.ElementTetP1(), 4)
    rule, weight = skfem.quadrature.get_quadrature(skfem.refdom.RefTet, element.shape.degree)
    points, fractions = [rule], [6.0 * weight]
    if element.volumetric is Volumetric.CENTROID:
        points.append(np.full((3, 1), 0.25))
        fractions.append(np.ones(1))
    positions = np.concatenate(points, axis=1)
    gradients = np.stack([tetrahedron.lbasis(positions, a)[1].T for a in range(count)], axis=1)
    linear = np.stack([skfem.ElementTetP1().lbasis(positions, a)[0] for a in range(4)], axis=1)
    return np.ascontiguousarray(gradients), np.ascontiguousarray(linear), np.concatenate(fractions)


def _surfaces(mesh: Mesh, grid: skfem.MeshTet | None) -> dict[str, Faces]:
    """The named faces, with the middles of their edges where the grid of quadratic elements is given."""
    triangle, degree = (skfem.ElementTriP1(), 1) if grid is None else (skfem.ElementTriP2(), 4)
    positions, weight = skfem.quadrature.get_quadrature(skfem.refdom.RefTri, degree)
    values = [triangle.lbasis(positions, a) for a in range(3 if grid is None else 6)]
    shape = np.stack([value for value, _ in values], axis=1)
    derivative = np.stack([gradient.T for _, gradient in values], axis=1)
    surfaces = {}
    for name, triangles in mesh.faces.items():
        nodes = np.array(triangles, dtype=np.int64)  # writable, as those of quadratic elements: one kernel for both
        if grid is not None:
            nodes = np.concatenate(
                [nodes, mesh.points.shape[0] + _edge_numbers(grid, nodes[:, [[0, 1], [1, 2], [0, 2]]])], axis=1
            )
        surfaces[name] = Faces(nodes, np.ascontiguousarray(shape), np.ascontiguousarray(derivative), weight)
    return surfaces


def _edge_numbers(grid: skfem.MeshTet, ends: Index) -> Index:
    """Numbers (...) of the edges between vertices `ends` (..., 2)."""
    vertices = grid.p.shape[1]
    keys = grid.edges[0].astype(np.int64) * vertices + grid.edges[1]
    order = np.argsort(keys)
    ends = np.sort(ends, axis=-1)
    return np.asarray(order[np.searchsorted(keys[order], ends[..., 0] * vertices + ends[..., 1])])
