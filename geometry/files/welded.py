"""Points of a file that are one point but for the rounding of their coordinates."""

import numpy as np

from geometry.arrays import Array, Index
from geometry.topology import parts_of_graph


def welded(points: Array, distance: float) -> Index:
    """For each of the points (n, 3) the first one that is the same, (n,): those within `distance`, in the unit of the
    points, and those within `distance` of these, are one."""
    from scipy.spatial import KDTree

    group = parts_of_graph(len(points), KDTree(points).query_pairs(distance, output_type="ndarray"))
    _, earliest = np.unique(group, return_index=True)
    return np.asarray(earliest[group], dtype=np.int64)
