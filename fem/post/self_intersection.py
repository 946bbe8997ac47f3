"""Whether a state passes through itself where no contact was looked for: a curled arm that meets its own clamp."""

import numpy as np
from scipy.spatial import cKDTree

from fem.discretisation import Discretisation
from fem.effects.contact import triangles_cross
from fem.post.extremes import in_words
from geometry.arrays import Array

#: edges of the surface within which a node of each lies where two triangles cross
REACH = 1.1
#: distance at rest over that reach, above which two nodes belong to different parts of the body
APART = 2.0


def crossing(space: Discretisation, x: Array, half: bool) -> str:
    """Where the body at the positions x (n, 3) passes through itself, or, being `half`, through its mirror image.

    Empty where it does not. Walls that are closer at rest than two edges of the mesh are left to
    `fem.effects.effect.Term.objection`: what looks at each other there is in contact, and what does not is one wall.
    """
    faces = [surface for name, surface in space.surfaces.items() if name != "sym"]
    triangles = np.concatenate([surface.triangles for surface in faces])
    nodes, local = np.unique(triangles, return_inverse=True)
    triangles = local.reshape(triangles.shape)
    rest, now = space.points[nodes], x[nodes]
    if half and now[:, 2].min() < -1e-6 * np.ptp(rest, axis=0).max():
        return f"passes through its mirror image near {in_words(now[int(np.argmin(now[:, 2]))])}"
    ends = now[triangles[:, [0, 1, 2, 0]]]
    reach = REACH * float(np.linalg.norm(np.diff(ends, axis=1), axis=2).max())
    pairs = cKDTree(now).query_pairs(reach, output_type="ndarray")
    met = pairs[np.linalg.norm(rest[pairs[:, 0]] - rest[pairs[:, 1]], axis=1) > APART * reach]
    if met.shape[0] == 0 or not triangles_cross(rest, now, triangles):
        return ""
    distance = np.linalg.norm(now[met[:, 0]] - now[met[:, 1]], axis=1)
    return f"passes through itself near {in_words(now[met[int(np.argmin(distance)), 0]])}"
