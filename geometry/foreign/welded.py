"""Points of a file that are one point but for the rounding of their coordinates."""

import numpy as np

from geometry.arrays import Array, Index


def welded(points: Array, distance: float) -> Index:
    """For each of the points (n, 3) the first one that is the same, (n,): those within `distance`, in the unit of the
    points, and those within `distance` of these, are one."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    count = len(points)
    first, second = KDTree(points).query_pairs(distance, output_type="ndarray").T
    near = coo_array((np.ones(len(first), dtype=bool), (first, second)), shape=(count, count))
    _, group = connected_components(near, directed=False)
    _, earliest = np.unique(group, return_index=True)
    return np.asarray(earliest[group], dtype=np.int64)
