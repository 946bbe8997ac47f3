"""How far apart the cavities of a body from a file are along the arm."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from geometry import CadFile, MeshFile, PneuNet, SurfaceFile
from geometry.families.from_file import FileDesign
from tests.foreign_bodies import meshed, two_chambers, write_mesh, write_surface
from tests.step_bodies import save

AIR = {"far": (40.0, 6.0, 0.0), "near": (20.0, 6.0, 0.0)}


def test_two_chambers_in_a_file_of_each_kind(tmp_path: Path) -> None:
    step = str(save(tmp_path / "two.step", two_chambers))
    mesh = str(write_mesh(tmp_path / "two.vtu", *meshed(two_chambers, 6.0)))
    surface = str(write_surface(tmp_path / "two.stl", two_chambers, 50))
    designs: list[FileDesign] = [
        CadFile(step, 1.5, air=AIR),
        CadFile(step, 1.5, clamp=60.0, tip=0.0, air=AIR),
        MeshFile(mesh, 1.5, air=AIR),
        SurfaceFile(surface, 1.5, air=AIR),
    ]
    assert [design.cavity_pitch for design in designs] == pytest.approx([28.0] * 4)
    assert PneuNet().cavity_pitch == 0.0
    within = {
        cell: CadFile(step, 1.5, air=AIR, cell=cell).averages_within_cavities for cell in (None, 27.0, 27.9, 28.0)
    }
    assert within == {None: True, 27.0: True, 27.9: False, 28.0: False}
    assert not PneuNet().averages_within_cavities


@pytest.mark.parametrize(
    ("ranges", "pitch"),
    [
        ([(3, 57)], 0),
        ([(3, 57), (3, 57)], 0),
        ([(3, 29), (3, 29), (31, 57)], 28),
        ([(3, 20), (22, 38), (40, 57), (22, 38)], 18.5),
        ([(3, 50), (52, 57)], 0),
        ([(3, 29), (20, 57)], 0),
    ],
    ids=["one", "beside one another", "two and one", "three and one", "almost all of the arm", "overlapping"],
)
def test_cavities_beside_one_another_are_one(ranges: list[tuple[float, float]], pitch: float) -> None:
    design: Any = SimpleNamespace(length=60.0, cavity_ranges=dict(enumerate(ranges)))
    assert FileDesign.cavity_pitch.fget(design) == pytest.approx(pitch)  # type: ignore[attr-defined]
