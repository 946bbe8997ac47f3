"""All pictures and fields of a run, and the surface of the deformed body for the view in the report."""

import io
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from geometry import Body, Mesh
from geometry.arrays import Array, Index, Mask
from geometry.topology import EDGES, OUTWARD, row_keys
from pipeline.show.drawing import Colour, draw_body, draw_deformed, window_for_pictures, write_fields
from pipeline.simulate.outcome import Outcome, Outcomes
from pipeline.simulate.simulate import EXPERIMENTS
from pipeline.store.atomic_file import write_atomic
from pipeline.store.context import RunContext
from pipeline.store.parallel import TaskContext
from pipeline.store.state_key import PICTURE_SOURCES, result_key
from pipeline.store.store import Store
from pipeline.values.pressure import name_of_state

#: the file with the surface of the body in every state
SURFACES = "pictures/surfaces.npz"
#: what the pictures were drawn with
_DRAWN = "pictures/drawn.json"


def draw_all(body: Body, outcomes: Outcomes, context: RunContext) -> None:
    """The body, also cut open at z = 0; each state as a picture and as a file for ParaView, a series per experiment.

    Workers draw body and experiments. Nothing is drawn where the pictures of an earlier run show the same states, drawn
    by the same sources.
    """
    store = context.store
    titles = [name_of_state(outcome.name, record.pressure_kPa) for outcome in outcomes for record in outcome.records]
    drawn = {"key": result_key(store.key, PICTURE_SOURCES), "states": titles}
    needed = ["mesh.vtu", "pictures/body.png", *(f"pictures/{title}.png" for title in titles)]
    needed += [*(f"fields/{title}.vtu" for title in titles), *([SURFACES] if titles else [])]
    if store.read_json(_DRAWN) == drawn and all((store.directory / name).is_file() for name in needed):
        return
    stretches = {
        one.name: at_nodes([record.fields["stretch"] for record in one.records], one.nodes) for one in outcomes
    }
    limits = (1.0, max((float(values.max()) for values in stretches.values() if values.size), default=1.1))
    begun = [context.submit(_draw_body, body, store)]
    for outcome in outcomes:
        colours = [Colour(values, "largest principal stretch", limits) for values in stretches[outcome.name]]
        begun.append(context.submit(_draw_states, outcome, colours, body.half, store))
    save_surfaces(body, outcomes, store)
    for pending in begun:
        pending.result()
    store.save_json(_DRAWN, drawn)


def region_field(mesh: Mesh) -> dict[str, Array]:
    """The number of the region of each tetrahedron (m,), 0 where it has none; empty for a mesh without regions."""
    if not mesh.regions:
        return {}
    number = np.zeros(len(mesh.tets))
    for count, tets in enumerate(mesh.regions.values(), start=1):
        number[tets] = count
    return {"region": number}


def _draw_body(_: TaskContext, body: Body, store: Store) -> None:
    """The body at rest; a task."""
    mesh, regions = body.mesh, region_field(body.mesh)
    write_fields(store.path("mesh.vtu"), mesh.points, mesh.tets, regions)
    with window_for_pictures() as window:
        at_rest = {"regions": regions.get("region"), "window": window}
        draw_body(store.path("pictures/body.png"), mesh.points, mesh.tets, mirrored=body.half, **at_rest)
        if body.half:
            draw_body(store.path("pictures/body_open.png"), mesh.points, mesh.tets, cut_open=True, **at_rest)


def _draw_states(_: TaskContext, outcome: Outcome, colours: Sequence[Colour], half: bool, store: Store) -> None:
    """The states of an experiment, each with its colours; a task."""
    series = []
    with window_for_pictures() as window:
        for record, colour in zip(outcome.records, colours, strict=True):
            title = name_of_state(outcome.name, record.pressure_kPa)
            body = outcome.points, outcome.nodes
            picture = store.path(f"pictures/{title}.png")
            draw_deformed(picture, *body, record.displacement, colour, mirrored=half, window=window)
            fields = {"displacement": record.displacement, **record.fields}
            write_fields(store.path(f"fields/{title}.vtu"), *body, fields)
            series.append((record.pressure_kPa, f"fields/{title}.vtu"))
    write_series(store.path(f"{outcome.name}.pvd"), series)


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


def boundary(points: Array, nodes: Index) -> tuple[Index, Mask]:
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
    """Means over the elements around every node, (states, n), of values per element (states, e); (0, n) of none."""
    count = nodes.max() + 1
    elements = np.bincount(nodes.ravel(), minlength=count)
    sums = [np.bincount(nodes.ravel(), np.repeat(v, nodes.shape[1]), minlength=count) for v in states]
    return (np.reshape(sums, (len(states), count)) / np.maximum(elements, 1)).astype(np.float32)


def write_series(path: Path, files: Sequence[tuple[float, str]]) -> None:
    """Write a .pvd time series: pairs of pressure in kPa (its time) and the .vtu file, relative to the .pvd."""
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = ElementTree.SubElement(root, "Collection")
    for pressure, file in files:
        ElementTree.SubElement(collection, "DataSet", timestep=f"{pressure:.12g}", group="", part="0", file=file)
    ElementTree.indent(root)
    write_atomic(path, ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))
