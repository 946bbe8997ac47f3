"""Meshes as values: orientation, names, volumes, files."""

import pickle
import signal
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

from geometry import BisectedCircle, Mesh, MeshError
from geometry.files.mesh.reader import read_mesh_file

REFERENCE = Path(__file__).parent.parent / "data" / "t2_coarse.msh"
REGULAR = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)


@pytest.fixture(scope="module")
def reference() -> Mesh:
    return Mesh.read(REFERENCE)


def normals(mesh: Mesh, triangles: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(mesh.points[triangles], 1, 0)
    return np.cross(b - a, c - a)


def test_reference_has_its_names_and_volumes(reference: Mesh) -> None:
    assert set(reference.faces) == {"clamp", "tip", "sym", "cavity", "outer", "gap"}
    assert len(reference.points) == 1509
    assert len(reference.tets) == 4222
    # 11 cavities of 5 x 12 x 5.25 mm and 10 channels of 5 x 2 x 1 mm in the half z >= 0
    assert reference.enclosed_volume("cavity") == pytest.approx(11 * 5 * 12 * 5.25 + 10 * 5 * 2 * 1, rel=1e-13)
    # plates 112 x 7 x 7.5, chambers 11 x 8 x 10 x 7.5, less the air
    assert reference.volume == pytest.approx(112 * 7 * 7.5 + 11 * 8 * 10 * 7.5 - 3565, rel=1e-13)


def test_reference_is_outward_and_named_once(reference: Mesh) -> None:
    assert (reference.volumes > 0).all()
    assert (normals(reference, reference.faces["clamp"])[:, 0] < 0).all()
    assert (normals(reference, reference.faces["tip"])[:, 0] > 0).all()
    assert (normals(reference, reference.faces["sym"])[:, 2] < 0).all()
    named = np.sort(np.vstack(list(reference.faces.values())), axis=1)
    assert len(np.unique(named, axis=0)) == len(named) == len(reference.boundary)
    assert normals(reference, reference.boundary).sum(axis=0) == pytest.approx([0, 0, 0], abs=1e-10)


def test_arrays_are_read_only(reference: Mesh) -> None:
    for array in (reference.points, reference.tets, reference.faces["tip"], reference.boundary, reference.edges):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1
    with pytest.raises(TypeError):
        reference.faces["new"] = reference.boundary  # type: ignore[index]


def test_inverted_tetrahedra_and_faces_are_turned_and_unused_points_dropped() -> None:
    points = np.vstack([[[9.0, 9, 9]], REGULAR])
    for order in ([1, 2, 3, 4], [1, 3, 2, 4]):
        for triangle in ([1, 2, 3], [1, 3, 2]):
            mesh = Mesh(points, np.array([order]), {"one": np.array([triangle])})
            assert mesh.volume == pytest.approx(8 / 3)
            assert len(mesh.points) == 4
            outward = normals(mesh, mesh.faces["one"])[0] @ mesh.points[mesh.faces["one"][0]].mean(axis=0)
            assert outward > 0


def test_regular_tetrahedron_is_perfect() -> None:
    quality = Mesh(REGULAR, np.array([[0, 1, 2, 3]]), {}).quality
    assert quality.minimum == pytest.approx(1, abs=1e-14)
    assert quality.mean == pytest.approx(1, abs=1e-14)
    assert quality.longest_edge == pytest.approx(np.sqrt(8))
    assert (quality.count, quality.position) == (1, (0, 0, 0))


def test_radius_ratio_of_the_corner_tetrahedron() -> None:
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    quality = Mesh(corner, np.array([[0, 1, 2, 3]]), {}).quality
    inscribed, circumscribed = 1 / (3 + np.sqrt(3)), np.sqrt(3) / 2
    assert quality.minimum == pytest.approx(3 * inscribed / circumscribed)


def test_file_round_trip(reference: Mesh, tmp_path: Path) -> None:
    reference.write(tmp_path / "again.msh")
    again = Mesh.read(tmp_path / "again.msh")
    assert np.array_equal(again.tets, reference.tets)
    assert again.points == pytest.approx(reference.points, abs=1e-13)
    assert set(again.faces) == set(reference.faces)
    for name, triangles in reference.faces.items():
        assert np.array_equal(again.faces[name], triangles)
    reference.write(tmp_path / "body.vtu")
    assert len(meshio.read(tmp_path / "body.vtu").cells_dict["tetra"]) == len(reference.tets)
    with pytest.raises(MeshError, match=r"\.msh or \.vtu"):
        reference.write(tmp_path / "body.stl")


def test_second_order_file_is_read_by_its_corners(tmp_path: Path) -> None:
    middles = [(REGULAR[i] + REGULAR[j]) / 2 for i, j in [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]]
    cells = [("triangle6", np.array([[0, 1, 2, 4, 5, 6]])), ("tetra10", np.array([[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]]))]
    tags = [np.array([1]), np.array([2])]
    content = meshio.Mesh(
        np.vstack([REGULAR, middles]),
        cells,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"clamp": np.array([1, 2])},
    )
    meshio.write(tmp_path / "second.msh", content, file_format="gmsh22", binary=False)
    mesh = Mesh.read(tmp_path / "second.msh")
    assert (len(mesh.points), len(mesh.faces["clamp"])) == (4, 1)


def test_mirrored_body_is_twice_the_half(reference: Mesh) -> None:
    full = reference.mirrored()
    assert "sym" not in full.faces
    assert full.volume == pytest.approx(2 * reference.volume, rel=1e-13)
    assert full.enclosed_volume("cavity") == pytest.approx(2 * 3565, rel=1e-13)
    assert len(full.points) == 2 * len(reference.points) - len(np.unique(reference.faces["sym"]))
    assert sum(map(len, full.faces.values())) == len(full.boundary)
    with pytest.raises(MeshError, match="named sym"):
        full.mirrored()


def test_mesh_survives_a_trip_to_another_process(reference: Mesh) -> None:
    again = pickle.loads(pickle.dumps(reference))
    assert np.array_equal(again.points, reference.points)
    assert np.array_equal(again.tets, reference.tets)
    assert all(np.array_equal(again.faces[name], reference.faces[name]) for name in reference.faces)
    assert not again.points.flags.writeable


def test_plane_holds_inner_triangles_too(reference: Mesh) -> None:
    full = reference.mirrored()
    inner = full.plane(2, 0)
    assert len(inner) == len(reference.faces["sym"])
    assert (normals(full, inner)[:, 2] > 0).all()


def broken(content: meshio.Mesh, case: str) -> meshio.Mesh:
    triangles = np.vstack([block.data for block in content.cells if block.type == "triangle"])
    tets = content.cells_dict["tetra"]
    inside = np.array([[tets[0][0], tets[0][1], tets[-1][2]]])
    cells = {
        "no tetrahedra": [("triangle", triangles)],
        "no named faces": [("tetra", tets)],
        "no boundary face": [("triangle", inside), ("tetra", tets)],
    }[case]
    tags = [np.full(len(data), tag, dtype=np.int32) for tag, (_, data) in enumerate(cells, start=1)]
    field_data = {"clamp": np.array([1, 2])} if case != "no named faces" else {"solid": np.array([1, 3])}
    return meshio.Mesh(
        content.points, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=field_data
    )


@pytest.mark.parametrize("case", ["no tetrahedra", "no named faces", "no boundary face"])
def test_unusable_files_are_refused(case: str, tmp_path: Path) -> None:
    path = tmp_path / "broken.msh"
    meshio.write(path, broken(meshio.read(REFERENCE), case), file_format="gmsh22", binary=False)
    with pytest.raises(MeshError, match=case):
        Mesh.read(path)


def test_missing_and_foreign_files_are_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(MeshError, match="does not exist"):
        Mesh.read(tmp_path / "none.msh")
    (tmp_path / "text.msh").write_text("not a mesh\n")
    with pytest.raises(MeshError, match="cannot be read"):
        Mesh.read(tmp_path / "text.msh")
    (tmp_path / "text.what").write_text("not a mesh\n")
    with pytest.raises(MeshError, match="cannot be read"):
        Mesh.read(tmp_path / "text.what")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("part", [0.0, 0.5])
@pytest.mark.parametrize("suffix", [".vtk", ".vtu", ".su2", ".mesh", ".msh"])
def test_a_file_that_is_cut_off_is_refused_in_words(suffix: str, part: float, tmp_path: Path) -> None:
    """Also where meshio gives up with a number or an error of its own code."""
    content, path = meshio.read(REFERENCE), tmp_path / f"cut{suffix}"
    tets = [block for block in content.cells if block.type == "tetra"]
    meshio.Mesh(content.points, tets).write(path, **({"file_format": "gmsh22"} if suffix == ".msh" else {}))
    whole = path.read_bytes()
    path.write_bytes(whole[: int(part * len(whole))])
    cut = r"cannot be read: empty, cut off or unknown.*; save it again$"
    with pytest.raises(MeshError, match=cut):
        read_mesh_file(path)


def test_open_face_encloses_nothing(reference: Mesh) -> None:
    with pytest.raises(MeshError, match="tip encloses no volume"):
        reference.enclosed_volume("tip")


def test_importing_geometry_loads_neither_gmsh_nor_meshio() -> None:
    code = "import sys, geometry; print([m for m in ('gmsh', 'meshio', 'scipy', 'pyvista') if m in sys.modules])"
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert process.stdout.strip() == "[]"


def test_gmsh_leaves_signals_and_output_alone(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(MeshError, match=r"Gmsh could not mesh the body .* a smaller mesh\.size"):
        BisectedCircle(wall=0.05).body(6.0)  # the mesher inside Gmsh says why on the standard output
    assert capfd.readouterr() == ("", "")
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    assert int(status["SigIgn"], 16) & 1 << (signal.SIGPIPE - 1)
