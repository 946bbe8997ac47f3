"""A mesh: points, tetrahedra and named boundary triangles in one frozen value."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.curved import NO_CURVED_EDGES, CurvedEdges, areas, flux
from geometry.errors import MeshError, position_text
from geometry.mesh_content import read_mesh, write_mesh
from geometry.quality import Quality, measure_quality
from geometry.topology import EDGES, OUTWARD, find_rows, normals, open_edges, row_keys, signed_volumes

Frozen = TypeVar("Frozen", Array, Index)


@dataclass(frozen=True)
class Mesh:
    """Tetrahedra with named boundary faces; their edges are straight but for those on round walls.

    The constructor orients tetrahedra positively and named triangles outward (their normal by the right-hand rule
    points out of the solid), and drops points that belong to no tetrahedron. Raises `MeshError` when an index has no
    point, a tetrahedron is flat, or a named triangle is not on the boundary.
    """

    points: Array  #: (n, 3), mm, read-only
    tets: Index  #: (m, 4) vertex indices, positively oriented, read-only
    faces: Mapping[str, Index]  #: name -> (k, 3) vertex indices of boundary triangles, outward, read-only
    curved: CurvedEdges = NO_CURVED_EDGES  #: edges with a middle that is not halfway, for quadratic elements
    regions: Mapping[str, Index] = field(default_factory=dict)  #: name -> (m,) tetrahedra of a part of the body

    def __post_init__(self) -> None:
        points, tets, faces = _checked(self.points, self.tets, self.faces)
        used, renumbered = np.unique(tets, return_inverse=True)
        tets = renumbered.reshape(tets.shape).astype(np.int64)
        new = np.full(len(points), -1)
        new[used] = np.arange(len(used))
        points = points[used]
        faces = {name: new[triangles] for name, triangles in faces.items()}
        volumes = signed_volumes(points, tets)
        flat = np.abs(volumes) <= 1e-14 * np.ptp(points, axis=0).max() ** 3
        if flat.any():
            first = int(np.flatnonzero(flat)[0])
            where = position_text(points[tets[first]].mean(axis=0))
            raise MeshError(f"tetrahedron {first} of the mesh is flat, near {where}")
        tets[volumes < 0] = tets[volumes < 0][:, [0, 2, 1, 3]]
        object.__setattr__(self, "points", _frozen(points))
        object.__setattr__(self, "tets", _frozen(tets))
        object.__setattr__(self, "curved", self.curved.renumbered(new))
        oriented = {name: _frozen(self._outward(name, triangles)) for name, triangles in faces.items()}
        object.__setattr__(self, "faces", MappingProxyType(oriented))
        object.__setattr__(self, "regions", MappingProxyType({name: _members(self, name) for name in self.regions}))

    def __reduce__(self) -> tuple[Any, ...]:
        # a read-only mapping cannot be pickled; the copy is checked and frozen like any other mesh
        return Mesh, (self.points, self.tets, dict(self.faces), self.curved, dict(self.regions))

    def _outward(self, name: str, triangles: Index) -> Index:
        """The boundary triangles, outward oriented, with the vertices of `triangles` (k, 3).

        Raises `MeshError` when one of them is not on the boundary.
        """
        row = find_rows(triangles, self.boundary, len(self.points))
        if (row < 0).any():
            first = triangles[np.flatnonzero(row < 0)[0]]
            reason = "uses points outside the body"
            if (first >= 0).all():
                centre = self.points[first].mean(axis=0)
                reason = f"near {position_text(centre)} is no boundary face of a tetrahedron"
            raise MeshError(f"the named face {name} has a triangle that {reason}")
        return self.boundary[row]

    @classmethod
    def read(cls, path: str | Path) -> "Mesh":
        """Read a mesh file whose physical groups of triangles name the faces (Gmsh .msh; lengths in mm).

        Of second-order elements only the corners are used. Raises `MeshError` when the file is missing or
        unreadable, or has no tetrahedra or no named faces.
        """
        return cls(*read_mesh(Path(path)))

    def write(self, path: str | Path) -> None:
        """Write `path`: .msh (Gmsh 2.2, names as physical groups; `Mesh.read` reads it back) or .vtu (tetrahedra).

        Curved edges are written as straight ones.

        Raises `MeshError` for another suffix.
        """
        write_mesh(Path(path), self.points, self.tets, self.faces)

    @cached_property
    def volumes(self) -> Array:
        """Volume of each tetrahedron with straight edges, (m,), mm3."""
        return _frozen(signed_volumes(self.points, self.tets))

    @property
    def volume(self) -> float:
        """Volume of the meshed solid, mm3."""
        if len(self.curved):
            return float(flux(self.points, self.boundary, self.curved).sum())
        return float(self.volumes.sum())

    @cached_property
    def boundary(self) -> Index:
        """All boundary triangles, outward oriented, (k, 3). Raises `MeshError` when three tetrahedra share a face."""
        triangles = self.tets[:, OUTWARD].reshape(-1, 3)
        _, first, counts = np.unique(row_keys(triangles, len(self.points)), return_index=True, return_counts=True)
        if (counts > 2).any():
            centre = self.points[triangles[first[counts > 2][0]]].mean(axis=0)
            doubled = len(self.tets) - len(np.unique(np.sort(self.tets, axis=1), axis=0))
            twice = f": {doubled} elements are listed twice; save the mesh with one group for each solid"
            where = position_text(centre)
            raise MeshError(f"three or more tetrahedra share one face, near {where}{twice if doubled else ''}")
        return _frozen(triangles[np.sort(first[counts == 1])])

    @cached_property
    def edges(self) -> Index:
        """All edges, the smaller vertex first, sorted, (e, 2); a second-order mesh has one more node on each."""
        pairs = np.sort(self.tets[:, EDGES].reshape(-1, 2), axis=1)
        keys = np.unique(pairs[:, 0] * len(self.points) + pairs[:, 1])
        return _frozen(np.column_stack(np.divmod(keys, len(self.points))))

    def has_edges(self, pairs: Index) -> Mask:
        """True for each of the vertex pairs (k, 2) that is an edge of the mesh, (k,)."""
        return find_rows(pairs, self.edges, len(self.points)) >= 0

    def plane(self, axis: int, value: float) -> Index:
        """All triangles of the mesh, interior ones too, that lie in the plane x[axis] = value (mm), (k, 3).

        Their normals point along the positive axis.
        """
        on_plane = np.abs(self.points[:, axis] - value) < 1e-9 * np.ptp(self.points, axis=0).max()
        triangles = self.tets[:, OUTWARD].reshape(-1, 3)
        triangles = triangles[on_plane[triangles].all(axis=1)]
        _, first = np.unique(row_keys(triangles, len(self.points)), return_index=True)
        triangles = triangles[first]
        reversed_ = normals(self.points[triangles])[:, axis] < 0
        triangles[reversed_] = triangles[reversed_][:, ::-1]
        return _frozen(triangles)

    def area(self, name: str) -> float:
        """Area of a named face, mm2."""
        if len(self.curved):
            return float(areas(self.points, self.faces[name], self.curved).sum())
        return float(np.linalg.norm(normals(self.points[self.faces[name]]), axis=1).sum() / 2)

    def enclosed_volume(self, name: str) -> float:
        """Volume of the air that a named face encloses, closed by the planes z = 0 and x = 0 if these cut it, mm3.

        V = -1/3 sum over triangles of the integral of x . n dA (divergence theorem), n out of the solid; both planes
        contain the origin and add nothing. Raises `MeshError` when the face has an open edge away from them.
        """
        triangles = self.faces[name]
        corners = self.points[open_edges(triangles, len(self.points))]
        away = np.abs(corners[:, :, [0, 2]]).max(axis=1).min(axis=1)
        if len(away) and away.max() > 1e-7 * np.ptp(self.points, axis=0).max():
            edge = f"it has an open edge near {position_text(corners[np.argmax(away)].mean(axis=0))}"
            raise MeshError(f"the face {name} encloses no volume: {edge}, away from the clamp and z = 0")
        if len(self.curved):
            return -float(flux(self.points, triangles, self.curved).sum())
        a, b, c = np.moveaxis(self.points[triangles], 1, 0)
        return float(-np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    @cached_property
    def quality(self) -> Quality:
        """Shape measures of the tetrahedra with straight edges."""
        return measure_quality(self.points, self.tets, self.edges)

    def mirrored(self) -> "Mesh":
        """Both halves of a body from its half z >= 0: mirrored at z = 0, without the face `sym`, other faces completed.

        Vertices on `sym` are shared by both halves; the first half keeps its numbering. Raises `MeshError` when there
        is no face `sym` in the plane z = 0.
        """
        if "sym" not in self.faces:
            raise MeshError(f"only a half with a face named sym can be mirrored; this has {', '.join(self.faces)}")
        shared = np.unique(self.faces["sym"])
        if np.abs(self.points[shared, 2]).max() > 1e-9 * np.ptp(self.points, axis=0).max():
            raise MeshError("the face sym must lie in the plane z = 0")
        count = len(self.points)
        image = np.full(count, -1)
        image[shared] = shared
        unshared = np.flatnonzero(image < 0)
        image[unshared] = count + np.arange(len(unshared))
        points = np.vstack([self.points, self.points[unshared] * [1, 1, -1]])
        faces = {name: np.vstack([f, image[f]]) for name, f in self.faces.items() if name != "sym"}
        mirrored = CurvedEdges(image[self.curved.ends], self.curved.middles * [1, 1, -1])
        regions = {name: np.concatenate([tets, tets + len(self.tets)]) for name, tets in self.regions.items()}
        return Mesh(points, np.vstack([self.tets, image[self.tets]]), faces, self.curved.joined(mirrored), regions)


def _checked(points: Array, tets: Index, faces: Mapping[str, Index]) -> tuple[Array, Index, dict[str, Index]]:
    """Copies of the arrays with their shapes and indices checked. Raises `MeshError`."""
    points = np.array(points, dtype=np.float64)
    tets = np.array(tets, dtype=np.int64)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise MeshError(f"points must be finite numbers of shape (n, 3), not {points.shape}")
    if tets.ndim != 2 or tets.shape[1] != 4 or not len(tets):
        raise MeshError("the mesh has no tetrahedra; mesh the volume, not only its surface")
    groups = {name: np.array(triangles, dtype=np.int64).reshape(-1, 3) for name, triangles in faces.items()}
    for name, indices in [("a tetrahedron", tets), *((f"the named face {k}", v) for k, v in groups.items())]:
        if indices.size and (indices.min() < 0 or indices.max() >= len(points)):
            raise MeshError(f"{name} uses a point that the mesh does not have")
    return points, tets, groups


def _members(mesh: Mesh, name: str) -> Index:
    """The tetrahedra of a region, sorted. Raises `MeshError` for numbers of no tetrahedron."""
    tets = np.unique(np.asarray(mesh.regions[name], dtype=np.int64))
    if not len(tets) or tets[0] < 0 or tets[-1] >= len(mesh.tets):
        raise MeshError(f"the region {name} has no tetrahedra, or some that the mesh does not have")
    return _frozen(tets)


def _frozen(array: Frozen) -> Frozen:
    array.setflags(write=False)
    return array
