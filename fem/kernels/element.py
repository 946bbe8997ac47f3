"""The hot loops over elements, compiled by numba; everything here is tested against scikit-fem forms.

Array axes of all kernels: ``e`` element, ``q`` stress point, ``a``/``b`` node of the element, ``i``/``j`` component,
``v`` Voigt component (11, 22, 33, 12, 23, 13; strains carry the engineering factor 2 on the last three).

A node pair is addressed in the upper triangle of the reduced matrix without a dof-level map: `offset[e, pair]` is where
the columns of the node with the larger number begin inside the rows of the other one (see `fem.equations.pattern`).
Elements are sorted into chunks, whose memory lies together. Chunks of one colour share no node, so those of a colour
are processed in parallel, always with the same sums.
"""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from geometry.arrays import Array, Index

#: sums may be reassociated so that loops over nodes can be vectorised; the order is fixed when a kernel is compiled, so
#: results do not depend on the number of threads
FAST = {"contract", "reassoc", "nsz"}

VOIGT = np.array([[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [0, 2]])


class ElementArrays(NamedTuple):
    """The elements of a body, sorted by colour and chunk."""

    colours: Index  #: (c + 1,) where each colour begins among the chunks
    chunks: Index  #: (k + 1,) where each chunk begins among the elements
    nodes: Index  #: (e, a)
    inverse: Array  #: (e, q, 3, 3) inverse Jacobians d xi / d X, 1/mm; (e, 1, 3, 3) where all edges are straight
    reference: Array  #: (q, a, 3) reference gradients of the shape functions at the stress points
    weight: Array  #: (e, q) quadrature weights times volume, mm3


class ReducedMatrix(NamedTuple):
    """The upper triangle of a symmetric matrix over the free components of all nodes (see `fem.equations.pattern`)."""

    node_dof: Index  #: (n, 3) row of each component, -1 where it is prescribed
    row_start: Index  #: (d + 1,) where each row begins in `data`
    free: Index  #: (n,) free components per node
    data: Array  #: (nnz,) values, changed in place


@njit(cache=True, inline="always")
def gradients(inverse: Array, reference: Array, g: Array) -> None:
    """g[a, i] = d N_a / d X_i from the reference gradients (a, k) and the inverse Jacobian (k, i)."""
    for a in range(reference.shape[0]):
        for i in range(3):
            g[a, i] = (
                reference[a, 0] * inverse[0, i] + reference[a, 1] * inverse[1, i] + reference[a, 2] * inverse[2, i]
            )


@njit(cache=True, inline="always")
def at_nodes(nodes: Index, u: Array, values: Array) -> None:
    """values (a, i) = u (n, 3) at the nodes of one element."""
    for a in range(nodes.shape[0]):
        for i in range(3):
            values[a, i] = u[nodes[a], i]


@njit(cache=True, inline="always")
def displacement_gradient(inverse: Array, reference: Array, values: Array, h: Array) -> None:
    """h[i, j] = d u_i / d X_j at a stress point from the displacements `values` (a, i) of the element's nodes."""
    for i in range(3):
        along0, along1, along2 = 0.0, 0.0, 0.0
        for a in range(reference.shape[0]):
            along0 += values[a, i] * reference[a, 0]
            along1 += values[a, i] * reference[a, 1]
            along2 += values[a, i] * reference[a, 2]
        for j in range(3):
            h[i, j] = along0 * inverse[0, j] + along1 * inverse[1, j] + along2 * inverse[2, j]


@njit(cache=True, inline="always")
def deformation_gradient(inverse: Array, reference: Array, values: Array, f: Array) -> None:
    """f = F at a stress point; arguments as those of `displacement_gradient`."""
    displacement_gradient(inverse, reference, values, f)
    for i in range(3):
        f[i, i] += 1.0


@njit(cache=True, inline="always")
def symmetric(values: Array, factor: float, s: Array) -> None:
    """s (3, 3) = factor times the symmetric tensor with the Voigt components values (v,), no factor 2 in them."""
    for v in range(6):
        s[VOIGT[v, 0], VOIGT[v, 1]] = values[v] * factor
        s[VOIGT[v, 1], VOIGT[v, 0]] = values[v] * factor


@njit(cache=True, parallel=True, fastmath=FAST)
def green_lagrange(elements: ElementArrays, u: Array, strain: Array, jacobian: Array) -> None:
    """Green-Lagrange strain (e, q, v) and J = det F (e, q) at all stress points, into the last two arguments."""
    nodes, inverse, reference = elements.nodes, elements.inverse, elements.reference
    for e in prange(nodes.shape[0]):
        values = np.empty((nodes.shape[1], 3))
        h = np.empty((3, 3))
        at_nodes(nodes[e], u, values)
        for q in range(reference.shape[0]):
            displacement_gradient(inverse[e, q if inverse.shape[1] > 1 else 0], reference[q], values, h)
            for v in range(6):
                i, j = VOIGT[v, 0], VOIGT[v, 1]
                value = h[i, j] + h[j, i] + h[0, i] * h[0, j] + h[1, i] * h[1, j] + h[2, i] * h[2, j]
                strain[e, q, v] = 0.5 * value if v < 3 else value
            for i in range(3):
                h[i, i] += 1.0
            jacobian[e, q] = (
                h[0, 0] * (h[1, 1] * h[2, 2] - h[1, 2] * h[2, 1])
                - h[0, 1] * (h[1, 0] * h[2, 2] - h[1, 2] * h[2, 0])
                + h[0, 2] * (h[1, 0] * h[2, 1] - h[1, 1] * h[2, 0])
            )


@njit(cache=True, parallel=True, fastmath=FAST)
def linearised_strain(elements: ElementArrays, u: Array, du: Array, strain: Array) -> None:
    """B(u) du (e, q, v): the change of the Green-Lagrange strain at u to first order in du."""
    nodes, inverse, reference = elements.nodes, elements.inverse, elements.reference
    for e in prange(nodes.shape[0]):
        values = np.empty((nodes.shape[1], 3))
        changes = np.empty((nodes.shape[1], 3))
        f = np.empty((3, 3))
        d = np.empty((3, 3))
        at_nodes(nodes[e], u, values)
        at_nodes(nodes[e], du, changes)
        for q in range(reference.shape[0]):
            at = inverse[e, q if inverse.shape[1] > 1 else 0]
            deformation_gradient(at, reference[q], values, f)
            displacement_gradient(at, reference[q], changes, d)
            for v in range(6):
                i, j = VOIGT[v, 0], VOIGT[v, 1]
                value = 0.0
                for k in range(3):
                    value += f[k, i] * d[k, j] + d[k, i] * f[k, j]
                strain[e, q, v] = 0.5 * value if v < 3 else value


@njit(cache=True, parallel=True, fastmath=FAST)
def internal_force(elements: ElementArrays, u: Array, stress: Array, force: Array) -> None:
    """Add int P : grad N_a to force (n, 3), N; stress is the second Piola-Kirchhoff stress (e, q, v), MPa."""
    colours, chunks, nodes = elements.colours, elements.chunks, elements.nodes
    inverse, reference, weight = elements.inverse, elements.reference, elements.weight
    for c in range(colours.shape[0] - 1):
        for chunk in prange(colours[c], colours[c + 1]):
            values = np.empty((nodes.shape[1], 3))
            f = np.empty((3, 3))
            p = np.empty((3, 3))
            s = np.empty((3, 3))
            fe = np.empty((nodes.shape[1], 3))
            for e in range(chunks[chunk], chunks[chunk + 1]):
                fe[:] = 0.0
                at_nodes(nodes[e], u, values)
                for q in range(reference.shape[0]):
                    at = inverse[e, q if inverse.shape[1] > 1 else 0]
                    deformation_gradient(at, reference[q], values, f)
                    symmetric(stress[e, q], weight[e, q], s)
                    for i in range(3):
                        for j in range(3):
                            p[i, j] = f[i, 0] * s[0, j] + f[i, 1] * s[1, j] + f[i, 2] * s[2, j]
                    for i in range(3):  # P : grad N_a = (P J^-T) : reference gradient
                        along0 = p[i, 0] * at[0, 0] + p[i, 1] * at[0, 1] + p[i, 2] * at[0, 2]
                        along1 = p[i, 0] * at[1, 0] + p[i, 1] * at[1, 1] + p[i, 2] * at[1, 2]
                        along2 = p[i, 0] * at[2, 0] + p[i, 1] * at[2, 1] + p[i, 2] * at[2, 2]
                        for a in range(nodes.shape[1]):
                            fe[a, i] += (
                                along0 * reference[q, a, 0] + along1 * reference[q, a, 1] + along2 * reference[q, a, 2]
                            )
                for a in range(nodes.shape[1]):
                    for i in range(3):
                        force[nodes[e, a], i] += fe[a, i]


@njit(cache=True, inline="always")
def scatter_block(matrix: ReducedMatrix, block: Array, row_node: int, column_node: int, offset: int) -> None:
    """Add the 3 x 3 block of the node pair row_node < column_node (or the upper half of a diagonal one)."""
    node_dof, row_start, free, data = matrix.node_dof, matrix.row_start, matrix.free, matrix.data
    if row_node == column_node:
        for i in range(3):
            r = node_dof[row_node, i]
            if r >= 0:
                for j in range(i, 3):
                    t = node_dof[row_node, j]
                    if t >= 0:
                        data[row_start[r] + t - r] += block[i, j]
        return
    first = node_dof[row_node, 0]
    if first < 0:
        first = node_dof[row_node, 1] if node_dof[row_node, 1] >= 0 else node_dof[row_node, 2]
    lead = node_dof[column_node, 0]
    if lead < 0:
        lead = node_dof[column_node, 1] if node_dof[column_node, 1] >= 0 else node_dof[column_node, 2]
    for i in range(3):
        r = node_dof[row_node, i]
        if r >= 0:
            start = row_start[r] + free[row_node] - (r - first) + offset
            for j in range(3):
                t = node_dof[column_node, j]
                if t >= 0:
                    data[start + t - lead] += block[i, j]


@njit(cache=True)
def scatter_blocks(matrix: ReducedMatrix, rows: Index, columns: Index, values: Array, starts: Index) -> None:
    """Add node-pair blocks values (m, 3, 3), rows <= columns, to the reduced upper triangle.

    starts (m, 3): where the columns of the pair begin in each row, -1 where that row is prescribed; not used for pairs
    of a node with itself.
    """
    node_dof, row_start, free, data = matrix.node_dof, matrix.row_start, matrix.free, matrix.data
    for m in range(rows.shape[0]):
        node, other = rows[m], columns[m]
        for i in range(3):
            start = starts[m, i]
            if node == other:
                row = node_dof[node, i]
                for j in range(i, 3):
                    if row >= 0 and node_dof[node, j] >= 0:
                        data[row_start[row] + node_dof[node, j] - row] += values[m, i, j]
            elif start >= 0 and free[other] == 3:
                data[start] += values[m, i, 0]
                data[start + 1] += values[m, i, 1]
                data[start + 2] += values[m, i, 2]
            elif start >= 0:
                for j in range(3):
                    if node_dof[other, j] >= 0:
                        data[start] += values[m, i, j]
                        start += 1


@njit(cache=True)
def blocks_times(rows: Index, columns: Index, values: Array, du: Array, force: Array) -> None:
    """Add H du to force (n, 3) for the symmetric H given by its node-pair blocks, rows <= columns."""
    for m in range(rows.shape[0]):
        r, c = rows[m], columns[m]
        for i in range(3):
            for j in range(3):
                force[r, i] += values[m, i, j] * du[c, j]
                if r != c:
                    force[c, j] += values[m, i, j] * du[r, i]


@njit(cache=True)
def chunk_colours(chunks: Index, tets: Index, vertices: int) -> Index:
    """Colour (k,) per chunk of elements tets (e, 4) such that chunks sharing a vertex differ; at most 64 chunks."""
    used = np.zeros(vertices, dtype=np.uint64)
    colour = np.empty(chunks.shape[0] - 1, dtype=np.int64)
    for chunk in range(colour.shape[0]):
        taken = np.uint64(0)
        for e in range(chunks[chunk], chunks[chunk + 1]):
            for a in range(4):
                taken |= used[tets[e, a]]
        bit = np.uint64(0)
        while taken & (np.uint64(1) << bit):
            bit += np.uint64(1)
        for e in range(chunks[chunk], chunks[chunk + 1]):
            for a in range(4):
                used[tets[e, a]] |= np.uint64(1) << bit
        colour[chunk] = bit
    return colour
