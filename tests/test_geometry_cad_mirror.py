"""Whether a CAD body is its own mirror image at z = 0: from its edges and faces, or from the difference of solids."""

from collections.abc import Callable
from math import pi
from typing import Any

import pytest

from geometry.meshing import cad_mirror
from geometry.meshing.cad_mirror import difference
from geometry.meshing.shapes import Volume
from geometry.meshing.solid import session
from tests.step_bodies import box

Drawn = Callable[[Any], list[Volume]]


def bar(occ: Any, *holes: Volume) -> list[Volume]:
    body = [box(occ, (0, 0, -6), (40, 10, 6))]
    return [part for part in (occ.cut(body, list(holes))[0] if holes else body) if part[0] == 3]


def hole(occ: Any, x: float, z: float, r: float = 1.0, top: float | None = None) -> Volume:
    """Along y through the bar; a cone where top, its other radius, is given."""
    if top is None:
        return (3, occ.addCylinder(x, -1, z, 0, 12, 0, r))
    return (3, occ.addCone(x, -1, z, 0, 12, 0, r, top))


EQUAL: dict[str, Drawn] = {
    "a bar": bar,
    "two holes": lambda occ: bar(occ, hole(occ, 9, 3), hole(occ, 9, -3)),
    "a hole along x": lambda occ: bar(occ, (3, occ.addCylinder(-1, 5, 0, 42, 0, 0, 2))),
    "a ball of air": lambda occ: bar(occ, (3, occ.addSphere(20, 5, 0, 3))),
    "half a ball": lambda occ: bar(occ, (3, occ.addSphere(20, 10, 0, 3))),
    "cones": lambda occ: bar(occ, hole(occ, 9, 3, 2, 1), hole(occ, 9, -3, 2, 1)),
    "a torus": lambda occ: bar(occ, (3, occ.addTorus(20, 5, 0, 3, 1))),
}


@pytest.mark.parametrize("name", EQUAL)
def test_mirror_images_are_known_without_a_difference_of_solids(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with session() as gmsh:
        solids = EQUAL[name](gmsh.model.occ)
        monkeypatch.setattr(gmsh.model.occ, "cut", None)
        for axis, at in ((2, 0.0), (0, 20.0) if name not in ("two holes", "cones") else (2, 0.0)):
            assert difference(gmsh, solids, solids, axis, at, 2e-6).fraction == 0.0


#: what is drawn, and the volume (mm3) of what it has and its mirror image has not
DIFFERENT: dict[str, tuple[Drawn, float]] = {
    "a hole 2 um away": (lambda occ: bar(occ, hole(occ, 9, 3), hole(occ, 9, -3.002)), 2 * 2 * 0.002 * 10),
    "a wider hole": (lambda occ: bar(occ, hole(occ, 9, 3), hole(occ, 9, -3, 1.01)), pi * 0.0201 * 10),
    "one hole": (lambda occ: bar(occ, hole(occ, 9, 3)), pi * 10),
    "holes across from each other": (lambda occ: bar(occ, hole(occ, 9, 3), hole(occ, 31, -3)), 2 * pi * 10),
    "a cone turned round": (lambda occ: bar(occ, hole(occ, 9, 3, 2, 1), hole(occ, 9, -3, 1, 2)), 2 * pi * 6.25),
}


@pytest.mark.parametrize("name", DIFFERENT)
def test_what_is_no_mirror_image_differs_by_about_its_volume(name: str) -> None:
    draw, volume = DIFFERENT[name]
    with session() as gmsh:
        solids = draw(gmsh.model.occ)
        whole = sum(gmsh.model.occ.getMass(*solid) for solid in solids)
        # of a thin ring with faces that are splines in the image the kernel's volume is 1.5 times as large as it is
        assert 0.5 < difference(gmsh, solids, solids, 2, 0.0, 2e-6).fraction * whole / (2 * volume) < 2.0


def test_faces_that_are_divided_on_one_side_alone_leave_the_difference_to_decide() -> None:
    with session() as gmsh:
        occ = gmsh.model.occ
        solids = bar(occ)
        sheet = occ.addRectangle(3, 2, 6, 5, 5)
        solids = [part for part in occ.fragment(solids, [(2, sheet)])[0] if part[0] == 3]
        assert not cad_mirror.have_equal_boundaries(gmsh, solids, solids, 2, 0.0)
        assert difference(gmsh, solids, solids, 2, 0.0, 2e-6).fraction < 1e-9
