"""What is unusual about a meshed body."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry import Body, CadFile, Mesh, MeshFile, PneuNet
from pipeline.config.load import load_config
from pipeline.simulate.mesh_notes import (
    FLAT_ELEMENT,
    check_mesh,
    mirrored_cavity,
    not_along_x,
    partial_clamp,
    straightened_edges,
    volume_differs,
)
from pipeline.simulate.scene import Scene
from pipeline.simulate.too_short import too_coarse
from tests.bodies import bricks, named, on_plane
from tests.foreign_bodies import bar
from tests.step_bodies import save

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent / "configs"


@pytest.mark.parametrize(
    ("settings", "spacing", "is_coarse"),
    [
        ((), 10.0, False),
        (("mesh.formulation=p1",), 10.0, True),
        ((), 12.0, True),
        (("law=cell",), 12.0, False),
        (("geometry.chambers=2",), 12.0, False),  # too short, which is said alone
    ],
)
def test_nodes_too_far_apart_for_means_over_a_cell(settings: tuple[str, ...], spacing: float, is_coarse: bool) -> None:
    """Nodes are at the vertices of the mesh and, of quadratic elements, in the middles between them."""
    points = np.zeros((9, 3))
    points[:, 0] = spacing * np.arange(9)
    body: Any = SimpleNamespace(mesh=SimpleNamespace(points=points), curve_vertices=np.arange(9))
    reason = too_coarse(load_config(CONFIGS / "pneunet_coarse.yaml", settings), body)
    assert bool(reason) is is_coarse
    if reason:
        apart = spacing if settings else spacing / 2
        assert reason.values == {"spacing_mm": apart, "allowed_mm": 5.0, "averaging_mm": 10.0}


def test_curved_edges_of_a_mesh_file_that_are_taken_as_straight() -> None:
    design = object.__new__(MeshFile)
    for count in (2, 0):
        design.__dict__["_content"] = SimpleNamespace(straightened=np.tile([21.0, 11.5, 3.5], (count, 1)))
        reason = straightened_edges(design)
        assert (reason and (reason.values["count"], reason.where)) == ((2, (21.0, 11.5, 3.5)) if count else None)


def test_a_flat_element() -> None:
    mesh = PneuNet(chambers=2).body(5).mesh
    assert check_mesh(mesh) is None
    points = np.array(mesh.points)
    inner = np.setdiff1d(np.arange(len(points)), mesh.boundary)[0]
    tet = next(tet for tet in mesh.tets if inner in tet)
    opposite = points[[v for v in tet if v != inner]]
    for part in (0.5, 0.8, 0.9, 0.95, 0.98):  # the vertex comes near the opposite face of one of its elements
        points[inner] = (1 - part) * mesh.points[inner] + part * opposite.mean(axis=0)
        flat = Mesh(points, mesh.tets, {})
        if flat.quality.minimum < FLAT_ELEMENT:
            break
    reason = check_mesh(flat)
    assert (reason.values["radius_ratio"], reason.where) == (flat.quality.minimum, flat.quality.position)


@pytest.mark.parametrize(("height", "free"), [(8.0, 0), (6.0, 32)], ids=["all of the end", "a part of it"])
def test_a_clamp_that_is_a_part_of_its_end(height: float, free: int) -> None:
    """Of the end face of 8 mm times 16 mm the uppermost 2 mm have no name."""
    filled = np.ones((3, 3, 3), dtype=bool)
    filled[1, 1, 1] = False
    mesh = bricks(filled, [np.array([0.0, 2, 18, 20]), np.array([0.0, 2, 6, 8]), np.array([0.0, 2, 14, 16])])
    clamp = on_plane(mesh, 0, 0.0) & (mesh.points[mesh.boundary, 1] <= height).all(axis=1)
    rest = {"tip": on_plane(mesh, 0, 20.0), "sym": on_plane(mesh, 2, 0.0), "cavity": on_plane(mesh, 0, 18.0)}
    reason = partial_clamp(Body(named(mesh, clamp=clamp, **rest), "bar", 20.0, 2.0, 0.0))
    assert bool(reason) is bool(free)
    if reason:
        assert (reason.values["free_mm2"], reason.values["plane_mm2"]) == pytest.approx((free, 128.0))


@pytest.mark.parametrize("layer", [0, 1])
def test_a_cavity_that_is_mirrored(layer: int) -> None:
    """In a half of 0 <= z <= 8 mm the cavity reaches from the plane of symmetry to 2 mm, or from 2 to 6 mm."""
    filled = np.ones((3, 3, 3), dtype=bool)
    filled[1, 1, layer] = False
    mesh = bricks(filled, [np.array([0.0, 2, 18, 20]), np.array([0.0, 2, 6, 8]), np.array([0.0, 2, 6, 8])])
    ends = {"clamp": on_plane(mesh, 0, 0.0), "tip": on_plane(mesh, 0, 20.0), "sym": on_plane(mesh, 2, 0.0)}
    outer = np.logical_or.reduce([*(on_plane(mesh, axis, value) for axis, value in ((1, 0.0), (1, 8.0), (2, 8.0)))])
    cavity = ~np.logical_or.reduce([*ends.values(), outer])
    reason = mirrored_cavity(Body(named(mesh, **ends, cavity=cavity, outer=outer), "bar", 20.0, 2.0, 0.0))
    assert (reason and reason.values) == ({"cavities": ["cavity"]} if layer else None)


def test_a_body_that_is_not_longest_along_x(tmp_path: Path) -> None:
    def upright(occ: Any) -> Any:
        solids = bar(occ)
        occ.rotate(solids, 0, 0, 0, 0, 0, 1, np.pi / 2)  # x becomes y
        return solids

    path = str(save(tmp_path / "upright.step", upright))
    reason = not_along_x(CadFile(path, 1.5))
    assert (reason.values["length_mm"], reason.values["longest_mm"]) == pytest.approx((12.0, 60.0))
    assert (reason.values["axis"], reason.values["axes"]) == ("y", "[y, x, -z]")
    assert not_along_x(CadFile(path, 1.5, axes=("y", "-x", "z"))) is None
    assert not_along_x(PneuNet(chambers=1, chamber_height=50.0)) is None


@pytest.mark.parametrize(("size", "differs"), [("4 mm", True), ("2.8 mm", False)])
def test_a_mesh_that_does_not_follow_round_walls(size: str, differs: bool) -> None:
    """The suggested size is enough: curved edges tangle no element there."""
    config = load_config(CONFIGS / "bisected_circle.yaml", ["geometry.wall=0.3 mm", f"mesh.size={size}"])
    reason = volume_differs(Scene.meshed(config).body, config)
    assert bool(reason) is differs
    if reason:
        assert (reason.values["percent"], reason.values["size_mm"]) == pytest.approx((4.7, 2.8), abs=0.05)
