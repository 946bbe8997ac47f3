"""What is suggested for bodies from files that lie along other axes: with it they are accepted."""

import re
from collections.abc import Callable
from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from geometry import CadFile, Design, DesignError, Directions, MeshFile, SurfaceFile
from geometry.files.frame import misplaced, rotation
from tests.foreign_bodies import OBLIQUE, bar, meshed, write_mesh, write_surface
from tests.step_bodies import Draw, box, save

#: rotations by a quarter of a turn about x, and then about another axis, of the bar with its base at y = 0
LYING: dict[str, tuple[tuple[float, float, float], ...]] = {
    "along x, z up": ((1, 0, 0),),
    "along y, z up": ((1, 0, 0), (0, 0, 1)),
    "along z, y up": ((0, -1, 0),),
}
KINDS: dict[str, tuple[Callable[..., Design], Callable[[Path, Draw], Path]]] = {
    "step": (CadFile, save),
    "stl": (SurfaceFile, lambda path, draw: write_surface(path, draw, 50)),
    "vtk": (MeshFile, lambda path, draw: write_mesh(path, *meshed(draw, 5.0))),
}


def lying(turns: tuple[tuple[float, float, float], ...], at_corner: bool) -> Draw:
    def draw(occ):
        solids = bar(occ)
        for axis in turns:
            occ.rotate(solids, 0, 0, 0, *axis, np.pi / 2)
        if at_corner:
            low = np.min([occ.getBoundingBox(*solid)[:3] for solid in solids], axis=0)
            occ.translate(solids, *(-low))
        return solids

    return draw


@pytest.mark.parametrize("at_corner", [False, True])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("words", LYING)
def test_what_is_suggested_is_accepted(words: str, kind: str, at_corner: bool, tmp_path: Path) -> None:
    family, write = KINDS[kind]
    path = str(write(tmp_path / f"bar.{kind}", lying(LYING[words], at_corner)))
    keys: dict[str, object] = {}
    for _ in range(3):
        try:
            design = family(path, 1.5, **keys)
            break
        except DesignError as refusal:
            turn = re.search(r"write axes: \[(.*?)\]", refusal.sentence)
            middle = re.search(r"write middle: (\S+) mm", refusal.sentence)
            if turn:
                keys["axes"] = tuple(turn[1].split(", "))
            elif middle:
                keys["middle"] = float(middle[1])
    assert design.extent == pytest.approx((60, 12, 15), rel=1e-6)


def test_every_turn_that_is_suggested_is_one() -> None:
    seen = set()
    for sides, aside in product(permutations((60.0, 15.0, 12.0)), product((0.0, 6.0), repeat=3)):
        low = np.array(aside) - np.array(sides) / 2
        sentence = misplaced(low, low + sides, 0.0, False).sentence
        if match := re.search(r"axes: \[(.*?)\]", sentence):
            turn = rotation(match[1].split(", "))
            assert (np.abs(turn) @ sides)[0] == 60.0, "x of the arm is along its longest side"
            assert np.abs(turn[1]) @ aside == max(aside * (np.array(sides) < 60.0)) or not any(aside)
            seen.add(match[1])
    assert len(seen) == 5
    assert "axes" not in misplaced(np.zeros(3), np.array([10.0, 60.0, 12.0]), 0.0, True).sentence


@pytest.mark.parametrize("width", [28.575, 15.00003, 14.0])
def test_the_middle_that_is_suggested_is_that_of_the_body(width: float, tmp_path: Path) -> None:
    """To the rounding of the file, so that both halves are equal."""

    def at_its_corner(occ):
        block, air = box(occ, (0, 0, 100), (60, 12, 100 + width)), box(occ, (3, 3, 103), (57, 10, 97 + width))
        return occ.cut([block], [air])[0]

    path = str(save(tmp_path / "bar.step", at_its_corner))
    with pytest.raises(DesignError, match="write middle") as refused:
        CadFile(path, 1.5)
    middle = float(re.search(r"write middle: (\S+) mm", refused.value.sentence)[1])
    assert CadFile(path, 1.5, middle=middle).extent == pytest.approx((60, 12, width))


@pytest.mark.parametrize("symmetric", [True, None])
def test_a_half_away_from_its_plane_is_told_where_that_is(symmetric: bool | None, tmp_path: Path) -> None:
    def half(occ):
        solids = occ.intersect(bar(occ), [box(occ, (-1, -1, 0), (61, 20, 8))])[0]
        occ.translate(solids, 0, 0, 2)
        return solids

    path = str(save(tmp_path / "half.step", half))
    with pytest.raises(DesignError, match=r"symmetric: true and middle: 2 mm or 9\.5 mm"):
        CadFile(path, 1.5, symmetric=symmetric)
    assert CadFile(path, 1.5, symmetric=True, middle=2.0).extent == pytest.approx((60, 12, 15))
    mesh = str(write_mesh(tmp_path / "half.vtk", *meshed(half, 5.0)))
    with pytest.raises(DesignError, match=r"symmetric: true and middle: 2 mm or 9\.5 mm"):
        MeshFile(mesh, 1.5, symmetric=True)
    assert MeshFile(mesh, 1.5, symmetric=True, middle=2.0).extent == pytest.approx((60, 12, 15))


@pytest.mark.parametrize("kind", ["stl", "vtk", pytest.param("step", marks=pytest.mark.slow)])
def test_an_oblique_body_is_turned(kind: str, tmp_path: Path) -> None:
    def oblique(occ):
        solids = bar(occ)
        occ.rotate(solids, 0, 0, 0, *OBLIQUE[0], OBLIQUE[1])
        return solids

    turn = Rotation.from_rotvec(OBLIQUE[1] * np.array(OBLIQUE[0])).as_matrix()
    family, write = KINDS[kind]
    path = str(write(tmp_path / f"bar.{kind}", oblique))
    with pytest.raises(DesignError):
        family(path, 1.5)
    assert family(path, 1.5, axes=Directions(*map(tuple, turn.T[:2]))).extent == pytest.approx((60, 12, 15), rel=1e-6)


def test_directions_of_any_length_and_angle_are_made_perpendicular() -> None:
    turn = rotation(Directions((0.0, 0.0, 3.0), (0.0, 2.0, 5.0)))
    np.testing.assert_allclose(turn, [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], atol=1e-15)
