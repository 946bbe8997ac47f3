"""What is known on one mesh of a body, at the nodes of another mesh of it."""

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from fem.discretisation import Discretisation
from fem.equations.state import State
from fem.equations.system import System
from geometry.arrays import Array, Index
from geometry.topology import EDGES

#: elements with the nearest centroids among which that around a position is sought
CANDIDATES = 24


def mapped(points: Array, nodes: Index, values: Array, positions: Array) -> Array:
    """Values (m, k) at positions (m, 3), mm, from those at nodes (n, k), by the shape functions of the elements.

    points: (n, 3) mm; nodes: (e, a) of the elements, a = 10 or 4. A position outside of the elements, as behind a round
    wall, takes the polynomial of that one whose barycentric coordinates are least negative there.
    """
    corners = points[nodes[:, :4]]
    inverse = np.linalg.inv(corners[:, 1:] - corners[:, :1])
    near = cKDTree(corners.mean(axis=1)).query(positions, min(CANDIDATES, len(nodes)))[1].reshape(len(positions), -1)
    inner = np.einsum("mci,mcij->mcj", positions[:, None] - corners[near, 0], inverse[near])
    shares = np.concatenate([1.0 - inner.sum(axis=2, keepdims=True), inner], axis=2)
    best = np.arange(len(positions)), np.argmax(shares.min(axis=2), axis=1)
    share = shape = shares[best]
    if nodes.shape[1] > 4:
        first, second = np.transpose(EDGES)
        shape = np.concatenate([share * (2.0 * share - 1.0), 4.0 * share[:, first] * share[:, second]], axis=1)
    return np.asarray(np.einsum("ma,mak->mk", shape, values[nodes[near[best]]]))


def fields_of(space: Discretisation, state: State) -> Array:
    """(n, 10) displacement, mm, smooth strain and pressure of a state at the nodes.

    The strain is the mean around each vertex; strain and pressure of an edge are the mean of its ends.
    """
    count, (elements, corners) = len(space.points), space.vertices.shape
    belongs = space.vertices.ravel(), np.repeat(np.arange(elements), corners)
    incidence = sp.csr_array((np.ones(elements * corners), belongs), (count, elements))
    sums = incidence @ state.strain[:, space.shear_points].mean(axis=1)
    fields = np.hstack(
        [state.displacement, sums / np.maximum(incidence.sum(axis=1), 1.0)[:, None], np.zeros((count, 1))]
    )
    fields[: len(state.pressure), 9] = state.pressure[:count]
    if space.element.quadratic:
        fields[space.nodes[:, 4:], 3:] = fields[space.nodes[:, EDGES], 3:].mean(axis=2)
    return np.asarray(fields)


def moved(system: System, base: State, change: Array, factor: float) -> State:
    """A state with the displacement of `base` and a change of its fields (n, 10), and with the stress that they give.

    Newton's method may start there: the stress need not be that of the displacement, whose kinks at the edges of other
    elements would make the tangent indefinite. In a body of one material the strain takes the volume change, to first
    order, that goes with the pressure, where there is one.
    """
    space = system.space
    strain = base.strain + np.einsum("qa,eac->eqc", space.vertex_shape, change[space.vertices, 3:9])
    if len((laws := system.formulation.laws).parts) == 1 and change[:, 9].any():
        by_pressure = laws.first.shear_modulus / laws.first.volumetric_modulus
        wanted = laws.dilatation(base.strain).value + by_pressure * change[space.vertices, 9] @ space.vertex_shape.T
        known = laws.dilatation(strain)
        missing = (wanted - known.value) / (known.gradient**2).sum(axis=-1)
        strain = strain + missing[..., None] * known.gradient
    pressure = system.formulation.pressure_of(strain)
    if len(pressure) == int(space.vertices.max()) + 1:
        pressure = base.pressure + change[: len(pressure), 9]
    stress = system.formulation.evaluate(strain, pressure).stress
    return State(factor, base.displacement + change[:, :3], pressure, strain, stress)
