"""What is suggested for bodies from files that lie along other axes: with it they are accepted."""

import re
from collections.abc import Callable
from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest

from geometry import CadFile, Design, DesignError, MeshFile, SurfaceFile
from geometry.foreign.frame import rotation
from geometry.orientation import turn_advice
from tests.foreign_bodies import bar, meshed, write_mesh, write_surface
from tests.step_bodies import Draw, save

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
        sentence = turn_advice(low, low + sides, turned=False)
        if match := re.search(r"axes: \[(.*?)\]", sentence):
            turn = rotation(match[1].split(", "))
            assert (np.abs(turn) @ sides)[0] == 60.0, "x of the arm is along its longest side"
            assert np.abs(turn[1]) @ aside == max(aside * (np.array(sides) < 60.0)) or not any(aside)
            seen.add(match[1])
    assert len(seen) == 5
    assert turn_advice(np.zeros(3), np.array([10.0, 60.0, 12.0]), turned=True).endswith(
        "check axes if that is the arm's length"
    )
