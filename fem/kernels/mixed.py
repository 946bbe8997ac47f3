"""The hot loop of the mixed formulation, compiled by numba; axes and addressing as in `fem.kernels.element`."""

import numpy as np
from numba import njit, prange

from fem.kernels.element import (
    ElementArrays,
    ReducedMatrix,
    at_nodes,
    deformation_gradient,
    gradients,
    scatter_block,
    symmetric,
)
from geometry.arrays import Array, Index


@njit(cache=True, parallel=True)
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
            g = np.empty((n, 3))
            f = np.empty((3, 3))
            s = np.empty((3, 3))
            k = np.empty((n, 3, 4))
            block = np.zeros((3, 3))
            for e in range(chunks[chunk], chunks[chunk + 1]):
                k[:] = 0.0
                at_nodes(nodes[e], u, values)
                for q in range(reference.shape[0]):
                    at = inverse[e, q if inverse.shape[1] > 1 else 0]
                    gradients(at, reference[q], g)
                    deformation_gradient(at, reference[q], values, f)
                    gradient = dilatation[e, q] if dilatation.shape[0] > 1 else dilatation[0, 0]
                    symmetric(gradient, 1.0, s)
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
                        scatter_block(matrix, block, nodes[e, a], first + pressures[e, m], offset[e, a, m])
