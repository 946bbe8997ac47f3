"""Heights of the material curve that a refusal suggests: the program accepts them."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from geometry import CadFile, Design, DesignError, Mesh, MeshError, MeshFile, SurfaceFile
from geometry.files.frame import height_advice
from tests.foreign_bodies import bar, meshed, write_mesh, write_surface
from tests.step_bodies import box, save


def rounded_ends(occ: Any) -> Any:
    """A bar of 60 x 12 x 15 mm whose edges at its ends are rounded by 2 mm, with a cavity 4 mm over the base."""
    block = occ.addBox(0, 0, -7.5, 60, 12, 15)
    occ.synchronize()
    boxes = {tag: occ.getBoundingBox(1, tag) for _, tag in occ.getEntities(1)}
    ends = [tag for tag, reach in boxes.items() if reach[3] - reach[0] < 1]
    return occ.cut(occ.fillet([block], ends, [2.0]), [box(occ, (5, 4, -4), (55, 9, 4))])[0]


def round_tip(occ: Any) -> Any:
    """A round bar of radius 7 mm that ends in half a sphere."""
    bar, tip = (3, occ.addCylinder(0, 0, 0, 50, 0, 0, 7)), (3, occ.addSphere(50, 0, 0, 7))
    return occ.cut(occ.fuse([bar], [tip])[0], [(3, occ.addCylinder(4, 1, 0, 44, 0, 0, 4.5))])[0]


KINDS: dict[str, tuple[Callable[..., Design], Callable[[Path, Any], Path]]] = {
    "stl": (SurfaceFile, lambda path, draw: write_surface(path, draw, 50)),
    "vtu": (MeshFile, lambda path, draw: write_mesh(path, *meshed(draw, 4.0))),
    "step": (CadFile, save),
}


def suggested(design: Callable[[float], object], curve: float) -> list[float]:
    with pytest.raises(DesignError, match=r"curve: the line y = .* is outside the material") as caught:
        design(curve)
    return [float(y) for y in re.findall(r"[-0-9.]+(?=,| mm$)", caught.value.sentence.split("y = ")[-1])]


@pytest.mark.parametrize("suffix", ["step", *(pytest.param(k, marks=pytest.mark.slow) for k in KINDS if k != "step")])
def test_what_is_suggested_for_rounded_ends_is_accepted(suffix: str, tmp_path: Path) -> None:
    kind, write = KINDS[suffix]
    path = write(tmp_path / f"rounded.{suffix}", rounded_ends)

    def meshed_with(curve: float) -> object:
        return kind(str(path), curve).body(3.0).curve_vertices

    heights = suggested(meshed_with, 6.0)
    assert heights
    assert all(2 < y < 4 or 9 < y < 10 for y in heights)
    for y in {heights[0], heights[-1]}:
        meshed_with(y)
    assert all(2 < y < 4 or 9 < y < 10 for y in suggested(meshed_with, 1.0))


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


def test_heights_are_written_as_they_were_looked_at() -> None:
    looked: list[float] = []

    def fits(y: float) -> bool:
        looked.append(y)
        return True

    advice = height_advice(1000.0, 1012.0, fits)
    named = [float(y) for y in re.findall(r"[0-9.]+(?=,| mm$)", advice.split("y = ")[-1])]
    assert len(set(named)) == 5
    assert set(named) <= set(looked)
