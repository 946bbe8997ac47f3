"""Shape measures of tetrahedra."""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Index
from geometry.topology import OUTWARD, cross, normals, signed_volumes


@dataclass(frozen=True)
class Quality:
    """Shape of the tetrahedra of a mesh.

    The measure is the radius ratio 3 r_inscribed / R_circumscribed: 1 for the regular tetrahedron, 0 for a flat one.
    """

    count: int  #: number of tetrahedra
    minimum: float  #: smallest radius ratio
    mean: float  #: mean radius ratio
    position: tuple[float, float, float]  #: centroid of the tetrahedron with the smallest radius ratio, mm
    longest_edge: float  #: mm
    mean_edge: float  #: mean over the edges, each counted once, mm


def measure_quality(points: Array, tets: Index, edges: Index) -> Quality:
    """Quality of positively oriented tetrahedra (m, 4) on points (n, 3), mm, with all their edges (e, 2)."""
    corners, ratio = points[tets], radius_ratios(points, tets)
    lengths = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    x, y, z = (float(v) for v in corners[int(np.argmin(ratio))].mean(axis=0))
    return Quality(
        count=len(ratio),
        minimum=float(ratio.min()),
        mean=float(ratio.mean()),
        position=(x, y, z),
        longest_edge=float(lengths.max()),
        mean_edge=float(lengths.mean()),
    )


def radius_ratios(points: Array, tets: Index) -> Array:
    """3 r_inscribed / R_circumscribed of positively oriented tetrahedra (m, 4) on points (n, 3), (m,)."""
    corners, volumes = points[tets], signed_volumes(points, tets)
    areas = np.linalg.norm(normals(corners[:, OUTWARD].reshape(-1, 3, 3)), axis=1).reshape(-1, 4) / 2
    a, b, c = (corners[:, i] - corners[:, 0] for i in (1, 2, 3))
    aa, bb, cc = (np.einsum("ij,ij->i", v, v)[:, None] for v in (a, b, c))
    # centre of the circumscribed sphere from the first corner, times 12 V
    centre = aa * cross(b, c) + bb * cross(c, a) + cc * cross(a, b)
    radius = np.linalg.norm(centre, axis=1) / (12 * volumes)
    return np.asarray(9 * volumes / areas.sum(axis=1) / radius)
