"""Bodies from mesh files, and the messages for meshes that cannot be used."""

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import meshio
import numpy as np
import pytest

from geometry import DesignError, Mesh, MeshFile, PneuNet
from geometry.manifold import count_components
from tests.foreign_bodies import bar, meshed


@pytest.fixture(scope="module")
def pneunet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mesh") / "pneunet.msh"
    PneuNet(chambers=2).body(5).mesh.write(path)
    return path


def test_mesh_file_becomes_a_body(pneunet: Path) -> None:
    drawn = PneuNet(chambers=2)
    design = MeshFile(str(pneunet), curve=1)
    assert design.extent == pytest.approx(drawn.extent)
    assert design.solid_volume == pytest.approx(drawn.solid_volume)
    assert design.cavity_volume == pytest.approx(drawn.cavity_volume)
    assert design.length == pytest.approx(22)
    assert design.body(3) is design.fixed_body
    assert len(design.digest) == 64


def test_mesh_in_metres_needs_its_unit(pneunet: Path, tmp_path: Path) -> None:
    mesh = Mesh.read(pneunet)
    Mesh(np.add(mesh.points, [3, 0, 0]) / 1000, mesh.tets, mesh.faces).write(tmp_path / "metres.msh")
    with pytest.raises(DesignError, match=r"file, unit: the body measures .* in another unit"):
        MeshFile(str(tmp_path / "metres.msh"), curve=1)
    assert MeshFile(str(tmp_path / "metres.msh"), curve=1, unit=1000).length == pytest.approx(22)


def renamed(mesh: Mesh, **names: str) -> Mesh:
    return Mesh(mesh.points, mesh.tets, {names.get(name, name): triangles for name, triangles in mesh.faces.items()})


def duplicated(mesh: Mesh) -> Mesh:
    count = len(mesh.points)
    faces = {name: np.vstack([f, f + count]) for name, f in mesh.faces.items()}
    return Mesh(
        np.vstack([mesh.points, np.add(mesh.points, [0, 2 * np.ptp(mesh.points), 0])]),
        np.vstack([mesh.tets, mesh.tets + count]),
        faces,
    )


def with_open_cavity(mesh: Mesh) -> Mesh:
    return Mesh(mesh.points, mesh.tets, dict(mesh.faces) | {"cavity": mesh.faces["cavity"][1:]})


def with_hinge(mesh: Mesh) -> Mesh:
    """One more tetrahedron that touches the body along an edge of its top only."""
    a, b = mesh.faces["outer"][np.argmax(mesh.points[mesh.faces["outer"]][:, :, 1].min(axis=1))][:2]
    count, middle = len(mesh.points), mesh.points[[a, b]].mean(axis=0)
    points = np.vstack([mesh.points, np.add(middle, [[0.5, 3, 0.2], [-0.5, 3, -0.2]])])
    return Mesh(points, np.vstack([mesh.tets, [[a, b, count, count + 1]]]), mesh.faces)


def with_moved_vertex(mesh: Mesh) -> Mesh:
    """A vertex inside the wall is moved by 11 mm through the cavity; the file keeps the order of the vertices."""
    points = np.array(mesh.points)
    inner = np.setdiff1d(np.arange(len(points)), mesh.boundary)
    points[inner[np.argmax(points[inner, 1])], 1] -= 11.0
    return Mesh(points, mesh.tets, mesh.faces)


def with_sym_elsewhere(mesh: Mesh) -> Mesh:
    """Not in one plane."""
    return Mesh(mesh.points + np.outer(mesh.points[:, 0], [0, 0, 0.01]), mesh.tets, mesh.faces)


def half_below(mesh: Mesh) -> Mesh:
    return Mesh(np.multiply(mesh.points, [1, 1, -1]), mesh.tets, mesh.faces)


def bad(change: Callable[[Mesh], Mesh], folder: Path) -> str:
    """A file with the mesh of an arm after a change."""
    change(PneuNet(chambers=2).body(5).mesh).write(folder / "bad.msh")
    return str(folder / "bad.msh")


def test_what_has_no_name_is_found_by_planes(pneunet: Path, tmp_path: Path) -> None:
    """Named faces may leave triangles out; a clamp at the larger x turns the body."""
    mesh, usual = Mesh.read(pneunet), MeshFile(str(pneunet), curve=1)
    for name, changed in {
        "open": with_open_cavity(mesh),
        "less": renamed(mesh, clamp="foot", cavity="air", sym="sym"),
        "backwards": renamed(mesh, clamp="tip", tip="clamp"),
    }.items():
        changed.write(tmp_path / f"{name}.msh")
        design = MeshFile(str(tmp_path / f"{name}.msh"), curve=1)
        assert design.cavity_volume == pytest.approx(usual.cavity_volume, rel=1e-12)
        assert design.is_turned == (name == "backwards")
        assert set(design.fixed_body.mesh.faces) >= {"clamp", "tip", "sym", "gap"}


def test_a_cavity_may_have_any_name_that_begins_so(pneunet: Path, tmp_path: Path) -> None:
    mesh = Mesh.read(pneunet)
    renamed(mesh, cavity="cavity_a").write(tmp_path / "named.msh")
    design, usual = (MeshFile(str(path), curve=1) for path in (tmp_path / "named.msh", pneunet))
    assert design.cavities == ("cavity_a",)
    assert design.cavity_volumes["cavity_a"] == pytest.approx(usual.cavity_volumes["cavity"], rel=1e-12)


def test_a_triangle_that_a_face_lists_twice_counts_once(pneunet: Path, tmp_path: Path) -> None:
    mesh = Mesh.read(pneunet)
    twice = np.vstack([mesh.faces["cavity"], mesh.faces["cavity"]])
    Mesh(mesh.points, mesh.tets, {**mesh.faces, "cavity": twice}).write(tmp_path / "twice.msh")
    design, usual = (MeshFile(str(path), curve=1) for path in (tmp_path / "twice.msh", pneunet))
    assert design.cavity_volume == pytest.approx(usual.cavity_volume, rel=1e-12)


def test_the_order_of_vertices_alone_does_not_tangle_a_mesh(pneunet: Path, tmp_path: Path) -> None:
    """Files of other programs may list the vertices of some elements the other way round."""
    mesh = Mesh.read(pneunet)
    content = meshio.read(pneunet)
    tets = content.cells[-1].data
    tets[::3] = tets[::3][:, [1, 0, 2, 3]]
    meshio.write(tmp_path / "turned.msh", content, file_format="gmsh22", binary=False)
    assert MeshFile(str(tmp_path / "turned.msh"), curve=1).solid_volume == pytest.approx(2 * mesh.volume)


def test_components_are_counted() -> None:
    mesh = PneuNet().body(5).mesh
    assert [count_components(m) for m in (mesh, duplicated(mesh), duplicated(duplicated(mesh)))] == [1, 2, 4]


def test_a_mesh_with_names_whose_middle_is_elsewhere(pneunet: Path, tmp_path: Path) -> None:
    """A half whose face sym lies in another plane, and a whole body with its origin at a corner."""
    half = Mesh.read(pneunet)
    Mesh(np.add(half.points, [0, 0, 0.5]), half.tets, half.faces).write(tmp_path / "half.msh")
    with pytest.raises(DesignError, match=r"symmetric: true and middle: 0\.5 mm"):
        MeshFile(str(tmp_path / "half.msh"), curve=1)
    volume = MeshFile(str(tmp_path / "half.msh"), curve=1, middle=0.5).solid_volume
    assert volume == pytest.approx(2 * half.volume)
    whole = half.mirrored()
    Mesh(np.add(whole.points, [0, 0, 7.5]), whole.tets, whole.faces).write(tmp_path / "whole.msh")
    with pytest.raises(DesignError, match=r"from z = 0 to 15 mm; .* middle: 7\.5 mm for a whole arm"):
        MeshFile(str(tmp_path / "whole.msh"), curve=1)
    assert MeshFile(str(tmp_path / "whole.msh"), curve=1, middle=7.5).solid_volume == pytest.approx(volume)


def test_a_whole_body_with_names_is_no_half(pneunet: Path, tmp_path: Path) -> None:
    Mesh.read(pneunet).mirrored().write(tmp_path / "whole.msh")
    path = str(tmp_path / "whole.msh")
    assert MeshFile(path, curve=1).solid_volume == pytest.approx(MeshFile(str(pneunet), curve=1).solid_volume)
    with pytest.raises(DesignError, match="one half alone"):
        MeshFile(path, curve=1, symmetric=True)
    assert MeshFile(str(pneunet), curve=1, symmetric=True).fixed_body.half


def test_a_named_half_below_is_mirrored(pneunet: Path, tmp_path: Path) -> None:
    half_below(Mesh.read(pneunet)).write(tmp_path / "below.msh")
    above, below = (MeshFile(str(path), curve=1).fixed_body for path in (pneunet, tmp_path / "below.msh"))
    assert below.half
    np.testing.assert_allclose(below.mesh.points, above.mesh.points, atol=1e-12)


def test_a_named_mesh_is_divided_along_the_curve(pneunet: Path) -> None:
    design = MeshFile(str(pneunet), curve=1.5)
    drawn, mesh = Mesh.read(pneunet), design.fixed_body.mesh
    assert mesh.volume == pytest.approx(drawn.volume, rel=1e-12)
    for name in drawn.faces:
        assert mesh.area(name) == pytest.approx(drawn.area(name), rel=1e-12)
    assert mesh.enclosed_volume("cavity") == pytest.approx(drawn.enclosed_volume("cavity"), rel=1e-12)
    assert len(design.fixed_body.edge("tip")) > 2
    assert mesh.quality.minimum > 0.05


def test_a_curve_outside_of_the_material_is_refused(pneunet: Path) -> None:
    with pytest.raises(DesignError, match=r"curve: the line y = 4 mm, z = 0 is outside the material from 3 to 9 mm"):
        MeshFile(str(pneunet), curve=4)


def test_results_of_older_companion_files_are_not_reused(tmp_path: Path) -> None:
    """The digest of a design changes with every file that its mesh is read from."""
    points, tets = meshed(bar, 6.0)
    meshio.write(tmp_path / "bar.node", meshio.Mesh(points, [("tetra", tets)]))
    digests = set()
    for height in (0.0, 0.5):
        moved = meshio.Mesh(np.add(points, [0, height, 0]), [("tetra", tets)])
        meshio.write(tmp_path / "bar.node", moved)  # both files; the elements stay the same
        elements = sha256((tmp_path / "bar.ele").read_bytes()).hexdigest()
        digests |= {MeshFile(str(tmp_path / f"bar{end}"), curve=1.5).digest for end in (".node", ".ele")}
        assert elements not in digests
    assert len(digests) == 4
