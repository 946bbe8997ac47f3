"""Properties of the bodies of every family: face names, closed surface, symmetry, equal cells, curve along edges."""

import hashlib
import threading
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest

from geometry import (
    BisectedCircle,
    Body,
    Design,
    PneuNet,
    Rectangular,
    Semicircular,
    SemicircularSingle,
)
from tests.bodies import cell_boundaries, inside
from tests.pieces import half_cell, tip_piece

DESIGNS = [
    PneuNet(),
    PneuNet(chambers=1),
    PneuNet(chambers=2, gap=3, wall=1.5, channel=1),
    PneuNet(chambers=3, fillet=0.5),
    Semicircular(chambers=4),
    Semicircular(chambers=1, partition=7),
    SemicircularSingle(length=60),
    SemicircularSingle(length=10),
    BisectedCircle(length=60),
    Rectangular(chambers=3),
    Rectangular(chambers=1, base=2),
]


@pytest.mark.parametrize(
    "design",
    [PneuNet(chambers=2, fillet=0.5), Semicircular(chambers=2), SemicircularSingle(length=20), Rectangular(chambers=2)],
    ids=lambda design: design.family,
)
def test_the_base_is_a_part_of_the_mesh_with_the_volume_of_the_plate(design: Design) -> None:
    divided = design.with_regions(["base"])
    body, (length, _, width) = divided.body(4.0), design.extent
    assert body.mesh.volume == pytest.approx(design.body(4.0).mesh.volume, rel=1e-3)
    height = body.edge("clamp")[0, 1] * 2
    assert divided.region_volumes == pytest.approx({"base": length * height * width})
    for piece, share in (
        (body, 0.5),
        (body.full(), 1.0),
        (half_cell(divided, 4.0), None),
        (tip_piece(divided, 1, 4.0), None),
    ):
        tets = piece.mesh.regions["base"]
        part = 0.5 * piece.length / length if share is None else share
        assert piece.mesh.volumes[tets].sum() == pytest.approx(part * length * height * width, rel=1e-9)
        inside = piece.mesh.points[piece.mesh.tets[tets], 1]
        outside = np.delete(piece.mesh.points[piece.mesh.tets, 1], tets, axis=0)
        assert inside.max() == pytest.approx(height)
        assert outside.min() == pytest.approx(height)
    assert design.body(4.0).mesh.regions == {}


@lru_cache
def meshed(design: Design, size: float) -> Body:
    return design.body(size)


@pytest.fixture(params=DESIGNS, ids=lambda design: f"{design.family}-{design.length:g}mm")
def design(request: pytest.FixtureRequest) -> Design:
    return request.param


def matching(points: np.ndarray, image: np.ndarray) -> np.ndarray:
    """For each row of `image` the index of the equal row of `points` (to 1e-9)."""
    order, other = (np.lexsort(np.round(p, 6).T) for p in (points, image))
    assert points[order] == pytest.approx(image[other], abs=1e-9)
    match = np.empty(len(points), dtype=int)
    match[other] = order
    return match


def rows(indices: np.ndarray) -> set[tuple[int, ...]]:
    return set(map(tuple, np.sort(indices, axis=1).tolist()))


def test_every_boundary_triangle_has_one_name_and_the_surface_is_closed(design: Design) -> None:
    mesh = meshed(design, 4).mesh
    named = np.vstack(list(mesh.faces.values()))
    assert len(rows(named)) == len(named) == len(mesh.boundary)
    directed = named[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    # each edge occurs once in each direction: the surface is closed and its triangles are oriented alike
    assert set(map(tuple, directed.tolist())) == set(map(tuple, directed[:, ::-1].tolist()))
    assert len(np.unique(directed, axis=0)) == len(directed)


def test_named_planes_have_their_position_and_face_outward(design: Design) -> None:
    mesh = meshed(design, 4).mesh
    for name, axis, value, sign in [("clamp", 0, 0, -1), ("tip", 0, design.length, 1), ("sym", 2, 0, -1)]:
        corners = mesh.points[mesh.faces[name]]
        assert corners[:, :, axis] == pytest.approx(np.full(corners.shape[:2], value), abs=1e-10)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (sign * normal[:, axis] > 0).all()
    others = np.vstack([mesh.faces[name] for name in mesh.faces if name not in ("clamp", "tip", "sym")])
    for axis, value in ((0, 0), (0, design.length), (2, 0)):
        assert not (np.abs(mesh.points[others][:, :, axis] - value) < 1e-9).all(axis=1).any()


def test_body_fills_its_extent(design: Design) -> None:
    full = meshed(design, 4).full()
    assert np.ptp(full.mesh.points, axis=0) == pytest.approx(design.extent, rel=1e-12)
    assert not full.half
    assert full.full() is full


def test_body_is_mirror_symmetric_about_its_middle(design: Design) -> None:
    mesh = meshed(design, 4).mesh
    image = matching(mesh.points, mesh.points * [-1, 1, 1] + [design.length, 0, 0])
    assert rows(image[mesh.tets]) == rows(mesh.tets)
    assert rows(image[mesh.faces["clamp"]]) == rows(mesh.faces["tip"])
    for name in mesh.faces.keys() - {"clamp", "tip"}:
        assert rows(image[mesh.faces[name]]) == rows(mesh.faces[name])


@pytest.mark.parametrize(
    "design",
    [PneuNet(chambers=5), Semicircular(chambers=5), Rectangular(chambers=5), BisectedCircle(), SemicircularSingle()],
)
def test_inner_cells_are_equal(design: Design) -> None:
    mesh, cells = meshed(design, 4).mesh, cell_boundaries(design)
    assert len(cells) == (6 if isinstance(design, PneuNet | Semicircular | Rectangular) else 12)
    points, tets = inside(mesh, cells[1], cells[2])
    for low, high in pairwise(cells[2:-1]):
        other_points, other_tets = inside(mesh, low, high)
        assert other_points == pytest.approx(points, abs=1e-9)
        assert rows(other_tets) == rows(tets)


@pytest.mark.parametrize("size", [4, 1.7])
def test_curve_runs_along_edges_from_clamp_to_tip(design: Design, size: float) -> None:
    body = meshed(design, size)
    curve = body.mesh.points[body.curve_vertices]
    assert curve[:, 1] == pytest.approx(np.full(len(curve), design.curve_y), abs=1e-12)
    assert not curve[:, 2].any()
    assert curve[[0, -1], 0] == pytest.approx([0, design.length], abs=1e-12)
    assert np.diff(curve[:, 0]).min() > 0
    assert np.diff(curve[:, 0]).max() <= size * (1 + 1e-12)
    assert body.curve_y == design.curve_y
    assert (body.length, body.pitch) == (design.length, design.pitch)


def test_tip_and_clamp_have_an_edge_at_the_height_of_the_curve(design: Design) -> None:
    body = meshed(design, 4)
    mesh = body.mesh
    for name in ("clamp", "tip"):
        vertices = np.unique(mesh.faces[name])
        edge = vertices[np.abs(mesh.points[vertices, 1] - design.curve_y) < 1e-9]
        edge = edge[np.argsort(mesh.points[edge, 2])]
        assert np.ptp(mesh.points[edge, 2]) == pytest.approx(design.extent[2] / 2)
        assert mesh.has_edges(np.column_stack([edge[:-1], edge[1:]])).all()


def test_plane_of_the_curve_consists_of_mesh_faces(design: Design) -> None:
    mesh = meshed(design, 4).mesh
    a, b, c = np.moveaxis(mesh.points[mesh.plane(1, design.curve_y)], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(design.length * design.extent[2] / 2, rel=1e-12)


def test_radius_ratio_of_the_elements_is_bounded(design: Design) -> None:
    bounds = {6: 0.08, 4: 0.12, 2.5: 0.14}
    for size, bound in bounds.items():
        quality = meshed(design, size).mesh.quality
        assert quality.minimum > bound
        assert quality.mean > 0.4
        assert quality.longest_edge < 1.9 * size


def test_equal_designs_give_equal_meshes(design: Design) -> None:
    def digest(body: Body) -> str:
        arrays = [body.mesh.points, body.mesh.tets, *body.mesh.faces.values()]
        return hashlib.sha256(b"".join(np.ascontiguousarray(array).tobytes() for array in arrays)).hexdigest()

    assert digest(replace(design).body(4)) == digest(meshed(design, 4))


def test_meshing_is_silent_and_works_in_threads(capfd: pytest.CaptureFixture[str]) -> None:
    bodies: list[Body] = []
    threads = [threading.Thread(target=lambda: bodies.append(PneuNet(chambers=1).body(5))) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({body.mesh.volume for body in bodies}) == 1
    assert len(bodies) == 3
    assert capfd.readouterr() == ("", "")
