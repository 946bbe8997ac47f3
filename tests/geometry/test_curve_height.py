"""Heights of the material curve at which a body cannot be divided, and ends without a flat face."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from geometry import CadFile, Design, DesignError, Mesh, MeshError, MeshFile, SurfaceFile
from tests.foreign_bodies import bar, meshed, write_mesh, write_surface
from tests.step_bodies import save


def round_tip(occ: Any) -> Any:
    """A round bar of radius 7 mm that ends in half a sphere."""
    bar, tip = (3, occ.addCylinder(0, 0, 0, 50, 0, 0, 7)), (3, occ.addSphere(50, 0, 0, 7))
    return occ.cut(occ.fuse([bar], [tip])[0], [(3, occ.addCylinder(4, 1, 0, 44, 0, 0, 4.5))])[0]


KINDS: dict[str, tuple[Callable[..., Design], Callable[[Path, Any], Path]]] = {
    "stl": (SurfaceFile, lambda path, draw: write_surface(path, draw, 50)),
    "vtu": (MeshFile, lambda path, draw: write_mesh(path, *meshed(draw, 4.0))),
    "step": (CadFile, save),
}


@pytest.mark.parametrize("suffix", KINDS)
def test_an_end_without_a_flat_face_is_named_whatever_the_curve(suffix: str, tmp_path: Path) -> None:
    kind, write = KINDS[suffix]
    path = write(tmp_path / f"round.{suffix}", round_tip)
    with pytest.raises(DesignError, match=r"tip: the body has no flat face .*cut a rounded end off"):
        kind(str(path), 1.0).body(4.0)


def test_a_height_at_which_elements_would_be_flat_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> Mesh:
        raise MeshError("tetrahedron 7 of the mesh is flat")

    monkeypatch.setattr("geometry.files.mesh.placing.with_curve", fails)
    path = str(write_mesh(tmp_path / "bar.vtk", *meshed(bar, 4.0)))
    with pytest.raises(DesignError, match=r"curve: the elements around the line y = .* because tetrahedron 7"):
        MeshFile(path, 1.0)
