"""Whether the body passes through itself where no contact is simulated: a curled arm that meets its own clamp."""

import numpy as np
from scipy.spatial import cKDTree

from fem.discretisation import Discretisation
from fem.effects.contact import crossings, triangles_cross
from fem.reasons import position_of
from geometry import Mesh, Reason
from geometry.arrays import Array

#: search radius over the longest edge of the surface: where two triangles cross, it contains a node of each
SEARCH_RADIUS = 1.1
#: distance at rest over the search radius, above which two nodes belong to different parts of the body
MIN_DISTANCE_AT_REST = 2.0


def self_intersection(space: Discretisation, x: Array, half: bool) -> Reason | None:
    """Where the body at the positions x (n, 3) passes through itself, or, being `half`, through its mirror image.

    None where it does not. Walls that are closer at rest than two edges of the mesh are not examined here:
    where they face each other, their contact term does so, and where they meet in a re-entrant edge that closes, the
    body only overlaps beside that edge, by less than an element.
    """
    faces = [surface for name, surface in space.surfaces.items() if name != "sym"]
    triangles = np.concatenate([surface.triangles for surface in faces])
    nodes, local = np.unique(triangles, return_inverse=True)
    triangles = local.reshape(triangles.shape)
    rest, current = space.points[nodes], x[nodes]
    if half and current[:, 2].min() < -1e-6 * np.ptp(rest, axis=0).max():
        return Reason("crosses_mirror_image", where=position_of(current[int(np.argmin(current[:, 2]))]))
    ends = current[triangles[:, [0, 1, 2, 0]]]
    radius = SEARCH_RADIUS * float(np.linalg.norm(np.diff(ends, axis=1), axis=2).max())
    pairs = cKDTree(current).query_pairs(radius, output_type="ndarray")
    distance_at_rest = np.linalg.norm(rest[pairs[:, 0]] - rest[pairs[:, 1]], axis=1)
    if not (distance_at_rest > MIN_DISTANCE_AT_REST * radius).any():
        return None
    edges, crossed = crossings(current, triangles)
    between = rest[edges][:, :, None] - rest[crossed][:, None, :]
    distance_at_rest = np.linalg.norm(between, axis=3).min(axis=(1, 2))
    apart = np.flatnonzero(distance_at_rest > MIN_DISTANCE_AT_REST * radius)
    if apart.size == 0:
        return None
    farthest = int(apart[np.argmax(distance_at_rest[apart])])
    return Reason("crosses_itself", where=position_of(current[edges[farthest]].mean(axis=0)))


def crossing_at_rest(mesh: Mesh) -> tuple[float, float, float] | None:
    """A position (mm) at which the boundary of a mesh passes through itself; None where it does not.

    The triangles are ordered along x; the fewest of the first ones that cross end with one of those that do.
    """
    nodes, local = np.unique(mesh.boundary, return_inverse=True)
    points, triangles = mesh.points[nodes], local.reshape(mesh.boundary.shape)
    triangles = triangles[np.argsort(points[triangles, 0].max(axis=1), kind="stable")]
    if not triangles_cross(points, points, triangles):
        return None
    apart, crossing = 0, len(triangles)
    while crossing - apart > 1:
        middle = (apart + crossing) // 2
        if triangles_cross(points, points, triangles[:middle]):
            crossing = middle
        else:
            apart = middle
    return position_of(points[triangles[crossing - 1]].mean(axis=0))
