"""The hot loop of the mixed formulation, compiled by numba; axes and addressing as in `fem.kernels.element`."""

import numpy as np
from numba import njit, prange

from fem.kernels.element import at_nodes, deformation_gradient, gradients, place, symmetric
from geometry.arrays import Array, Index


@njit(cache=True, parallel=True)
def pressure_columns(
    colours: Index,
    chunks: Index,
    nodes: Index,
    inverse: Array,
    reference: Array,
    weight: Array,
    shape: Array,
    u: Array,
    slope: Array,
    offset: Index,
    node_dof: Index,
    row_start: Index,
    free: Index,
    data: Array,
) -> None:
    """Add int (B(u)^T slope) N_m to the columns of the pressures m in the reduced upper triangle `data`.

    shape (q, 4) are the linear shape functions at the stress points, slope (e, q, v) or (1, 1, v) the derivative of the
    dilatation by the strain, offset (e, a, 4) where the pressures' columns begin; pressure v is node n + v.
    """
    n, first = nodes.shape[1], u.shape[0]
    for c in range(colours.shape[0] - 1):
        for chunk in prange(colours[c], colours[c + 1]):
            values = np.empty((n, 3))
            g = np.empty((n, 3))
            f = np.empty((3, 3))
            s = np.empty((3, 3))
            k = np.empty((n, 3, 4))
            block = np.zeros((3, 3))
            for e in range(chunks[chunk], chunks[chunk + 1]):
                k[:] = 0.0
                at_nodes(nodes[e], u, values)
                for q in range(reference.shape[0]):
                    gradients(inverse[e], reference[q], g)
                    deformation_gradient(inverse[e], reference[q], values, f)
                    law = slope[e, q] if slope.shape[0] > 1 else slope[0, 0]
                    symmetric(law, 1.0, s)
                    for a in range(n):
                        for i in range(3):
                            value = 0.0
                            for j in range(3):
                                value += f[i, j] * (s[j, 0] * g[a, 0] + s[j, 1] * g[a, 1] + s[j, 2] * g[a, 2])
                            for m in range(4):
                                k[a, i, m] += weight[e, q] * value * shape[q, m]
                for a in range(n):
                    for m in range(4):
                        for i in range(3):
                            block[i, 0] = k[a, i, m]
                        column = first + nodes[e, m]
                        place(data, block, nodes[e, a], column, offset[e, a, m], node_dof, row_start, free)
