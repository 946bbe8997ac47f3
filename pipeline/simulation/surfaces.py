"""The surface of the deformed body in every state, for the view in the report that can be turned."""

import io
from collections.abc import Sequence

import numpy as np

from geometry import Body
from geometry.arrays import Array, Index
from geometry.topology import EDGES, OUTWARD, row_keys
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.simulate import EXPERIMENTS
from pipeline.store.atomic_file import write_atomic
from pipeline.store.formats import SURFACES
from pipeline.store.store import Store


def save_surfaces(body: Body, outcomes: Outcomes, store: Store) -> None:
    """Write the surface of the body with displacement, stretch and von Mises stress at its nodes, for every state.

    Stretch and stress at a node are the means over the elements around it.
    """
    present = [outcomes[name] for name in EXPERIMENTS if name in outcomes.by_name and outcomes[name].records]
    if not present:
        return
    first = present[0]
    faces, in_plane = boundary(first.points, first.nodes)
    if not body.half:
        in_plane = np.zeros(len(faces), dtype=bool)
    shown, numbers = np.unique(faces, return_inverse=True)
    states = [(outcome, record) for outcome in present for record in outcome.records]
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        half=np.array(body.half),
        points=first.points[shown].astype(np.float32),
        faces=numbers.reshape(faces.shape).astype(np.int32),
        in_plane=in_plane,
        experiments=np.array([outcome.name for outcome, _ in states]),
        pressures_kPa=np.array([record.pressure_kPa for _, record in states]),
        displacement=np.array([record.displacement[shown] for _, record in states], dtype=np.float32),
        stretch=at_nodes([record.fields["stretch"] for _, record in states], first.nodes)[:, shown],
        von_mises_MPa=at_nodes([von_mises(r.fields["cauchy_stress_MPa"]) for _, r in states], first.nodes)[:, shown],
    )
    write_atomic(store.path(SURFACES), buffer.getvalue())


def boundary(points: Array, nodes: Index) -> tuple[Index, Array]:
    """Boundary faces of tetrahedra, normals outward: nodes (f, 6) or (f, 3), and which lie in the plane z = 0 (f,).

    The first three nodes are the corners, the others the middles of the edges behind the first, second, third corner.
    """
    columns = OUTWARD
    if nodes.shape[1] == 10:
        middle = {frozenset(edge): 4 + number for number, edge in enumerate(EDGES.tolist())}
        pairs = ((0, 1), (1, 2), (2, 0))
        columns = np.array([[*face, *(middle[frozenset((face[a], face[b]))] for a, b in pairs)] for face in OUTWARD])
    faces = nodes[:, columns].reshape(-1, columns.shape[1])
    _, first, counts = np.unique(row_keys(faces[:, :3], len(points)), return_index=True, return_counts=True)
    outer = faces[first[counts == 1]]
    return outer, np.abs(points[outer[:, :3], 2]).max(axis=1) < 1e-6 * np.ptp(points[:, 0])


def von_mises(stress: Array) -> Array:
    """Equivalent stress (e,) of stresses (e, 6): xx, yy, zz, xy, yz, xz."""
    xx, yy, zz, xy, yz, xz = stress.T
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(0.5 * normal + 3.0 * (xy**2 + yz**2 + xz**2))


def at_nodes(states: Sequence[Array], nodes: Index) -> Array:
    """Means over the elements around every node, (states, n), of values per element (states, e)."""
    count = nodes.max() + 1
    elements = np.bincount(nodes.ravel(), minlength=count)
    sums = [np.bincount(nodes.ravel(), np.repeat(v, nodes.shape[1]), minlength=count) for v in states]
    return (np.array(sums) / np.maximum(elements, 1)).astype(np.float32)
