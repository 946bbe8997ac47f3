"""The hot loop of the mixed formulation, compiled by numba; axes and addressing as in `fem.kernels.element`."""

import numpy as np
from numba import njit, prange

from fem.kernels.element import (
    FAST,
    ElementArrays,
    ReducedMatrix,
    at_nodes,
    deformation_gradient,
    scatter_block,
    symmetric,
)
from geometry.arrays import Array, Index


@njit(cache=True, parallel=True, fastmath=FAST)
def pressure_columns(
    elements: ElementArrays,
    pressures: Index,
    u: Array,
    shape: Array,
    dilatation: Array,
    offset: Index,
    matrix: ReducedMatrix,
) -> None:
    """Add int (B(u)^T d theta / d E) N_m to the columns of the pressures m in the reduced upper triangle.

    pressures (e, 4) are the numbers of the pressures, shape (q, 4) are the linear shape functions at the stress points,
    dilatation (e, q, v) or (1, 1, v) the derivative d theta / d E, offset (e, a, 4) where the pressures' columns begin;
    pressure v is node n + v.
    """
    colours, chunks, nodes = elements.colours, elements.chunks, elements.nodes
    inverse, reference, weight = elements.inverse, elements.reference, elements.weight
    n, first = nodes.shape[1], u.shape[0]
    for c in range(colours.shape[0] - 1):
        for chunk in prange(colours[c], colours[c + 1]):
            values = np.empty((n, 3))
            f, s, p = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
            k = np.empty((n, 3, 4))
            block = np.zeros((3, 3))
            for e in range(chunks[chunk], chunks[chunk + 1]):
                k[:] = 0.0
                at_nodes(nodes[e], u, values)
                for q in range(reference.shape[0]):
                    at = inverse[e, q if inverse.shape[1] > 1 else 0]
                    deformation_gradient(at, reference[q], values, f)
                    gradient = dilatation[e, q] if dilatation.shape[0] > 1 else dilatation[0, 0]
                    symmetric(gradient, weight[e, q], s)
                    for i in range(3):
                        for j in range(3):
                            p[i, j] = f[i, 0] * s[0, j] + f[i, 1] * s[1, j] + f[i, 2] * s[2, j]
                    for i in range(3):  # times grad N_a, as in `internal_force`
                        along0 = p[i, 0] * at[0, 0] + p[i, 1] * at[0, 1] + p[i, 2] * at[0, 2]
                        along1 = p[i, 0] * at[1, 0] + p[i, 1] * at[1, 1] + p[i, 2] * at[1, 2]
                        along2 = p[i, 0] * at[2, 0] + p[i, 1] * at[2, 1] + p[i, 2] * at[2, 2]
                        for a in range(n):
                            value = (
                                along0 * reference[q, a, 0] + along1 * reference[q, a, 1] + along2 * reference[q, a, 2]
                            )
                            for m in range(4):
                                k[a, i, m] += value * shape[q, m]
                for a in range(n):
                    for m in range(4):
                        for i in range(3):
                            block[i, 0] = k[a, i, m]
                        scatter_block(matrix, block, nodes[e, a], first + pressures[e, m], offset[e, a, m])
