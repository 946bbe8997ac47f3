"""Abaqus input files: one part, instance or none; reference points, types, includes; several parts are refused."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from geometry import DesignError, MeshFile
from tests.foreign_bodies import BAR_AIR, BAR_VOLUME, bar, meshed, tube

HEAD = ["*Heading", "** written by a test", "a bar, 60 mm"]


@pytest.fixture(scope="module")
def plain() -> tuple[np.ndarray, np.ndarray]:
    return meshed(bar, 5.0)


def nodes(points: np.ndarray, start: int = 1, head: str = "*Node") -> list[str]:
    return [head, *(f"{start + k}, {x:.9g}, {y:.9g}, {z:.9g}" for k, (x, y, z) in enumerate(points))]


def elements(tets: np.ndarray, head: str = "*Element, type=C3D4", start: int = 1) -> list[str]:
    return [head, *(f"{start + k}, " + ", ".join(map(str, tet + 1)) for k, tet in enumerate(tets))]


def part(name: str, content: Sequence[str]) -> list[str]:
    return [f"*Part, name={name}", *content, "*End Part"]


def assembly(*instances: str) -> list[str]:
    """Instances ("A-1 of A") and a reference point, which has the number of a node of the part."""
    lines = ["*Assembly, name=Assembly"]
    for name, _, of_part in (instance.partition(" of ") for instance in instances):
        lines += [f"*Instance, name={name}, part={of_part}", "*End Instance"]
    return [
        *lines,
        "*Node",
        "1, 100., 0., 0.",
        "*Nset, nset=reference",
        "1,",
        "*End Assembly",
        "*Step",
        "*Static",
        "1.",
    ]


def read(path: Path, lines: Sequence[str]) -> MeshFile:
    path.write_text("\n".join([*HEAD, *lines, ""]), encoding="utf-8")
    return MeshFile(str(path), curve=1.5)


def layouts(points: np.ndarray, tets: np.ndarray) -> dict[str, list[str]]:
    """The same mesh as programs write it."""
    mesh = [*nodes(points), *elements(tets)]
    return {
        "without parts": mesh,
        "part": [*part("Arm", mesh), *assembly("Arm-1 of arm")],
        "instance": [*part("Arm", []), "*Instance, name=Arm-1, part=Arm", *mesh, "*End Instance"],
        "nodes in two blocks": [*nodes(points[:50]), *nodes(points[50:], 51), *elements(tets)],
        "small letters": [*nodes(points, head="*node, nset=all"), *elements(tets, "*element,type = c3d4,elset=arm")],
        "hybrid": [*nodes(points), *elements(tets, "*ELEMENT,\nTYPE=C3D4H")],
        "shells too": [*mesh, "*Element, type=S3", "9001, 1, 2, 3", "*Element, type=MASS", "9002, 1"],
    }


@pytest.mark.parametrize("layout", layouts(np.zeros((60, 3)), np.zeros((1, 4), dtype=int)))
def test_one_body_is_read(layout: str, plain: tuple[np.ndarray, np.ndarray], tmp_path: Path) -> None:
    design = read(tmp_path / "bar.inp", layouts(*plain)[layout])
    assert design.length == 60
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-7)
    assert design.cavity_volume == pytest.approx(BAR_AIR, rel=1e-7)


def test_elements_with_ten_nodes_over_two_lines(tmp_path: Path) -> None:
    points, tets = meshed(tube, 4.0, order=2)
    lines = ["*Element, type=C3D10MH"]
    for k, tet in enumerate(tets + 1):
        lines += [f"{k + 1}, " + ", ".join(map(str, tet[:7])) + ",", ", ".join(map(str, tet[7:]))]
    (tmp_path / "tube.inp").write_text("\n".join([*nodes(points), *lines]), encoding="utf-8")
    design = MeshFile(str(tmp_path / "tube.inp"), curve=-6)
    assert design.solid_volume == pytest.approx(np.pi * 49 * 50 - np.pi * 25 * 44, rel=5e-4)


def test_several_parts_or_instances_are_refused(plain: tuple[np.ndarray, np.ndarray], tmp_path: Path) -> None:
    mesh = [*nodes(plain[0]), *elements(plain[1])]
    for lines, names in (
        ([*part("Arm", mesh), *part("Mount", mesh), *assembly("Arm-1 of Arm", "Mount-1 of Mount")], "Arm, Mount"),
        ([*part("Arm", mesh), *assembly("Arm-1 of Arm", "Arm-2 of Arm")], "Arm"),
        ([*mesh, *part("Mount", mesh)], "outside of parts, Mount"),
    ):
        with pytest.raises(DesignError, match=rf"file: .* several parts or instances with elements \({names}\)"):
            read(tmp_path / "several.inp", lines)
