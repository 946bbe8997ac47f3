"""Whether a CAD body is its own mirror image at z = 0: from its edges and faces, or from the difference of solids."""

from math import pi
from typing import Any

import numpy as np
import pytest

from geometry.files.cad import mirror
from geometry.files.cad.mirror import difference
from geometry.meshing.shapes import Volume
from geometry.meshing.solid import session
from tests.step_bodies import Draw, box


def bar(occ: Any, *holes: Volume) -> list[Volume]:
    body = [box(occ, (0, 0, -6), (40, 10, 6))]
    return [part for part in (occ.cut(body, list(holes))[0] if holes else body) if part[0] == 3]


def hole(occ: Any, x: float, z: float, r: float = 1.0, top: float | None = None) -> Volume:
    """Along y through the bar; a cone where top, its other radius, is given."""
    if top is None:
        return (3, occ.addCylinder(x, -1, z, 0, 12, 0, r))
    return (3, occ.addCone(x, -1, z, 0, 12, 0, r, top))


EQUAL: dict[str, Draw] = {
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


def lobes(occ: Any, count: int, phase: float) -> Volume:
    """Along x through the bar, with a spline around its section that has so many lobes, the first at an angle to y."""
    angles = phase + np.linspace(0.0, 2.0 * pi, 4 * count, endpoint=False)
    radii = 2.0 + 0.5 * np.cos(count * (angles - phase))
    corners = [occ.addPoint(-1, 5 + r * np.cos(t), r * np.sin(t)) for r, t in zip(radii, angles, strict=True)]
    face = occ.addPlaneSurface([occ.addCurveLoop([occ.addBSpline([*corners, corners[0]])])])
    return next(part for part in occ.extrude([(2, face)], 42, 0, 0) if part[0] == 3)


def twisted(occ: Any, sections: int = 33) -> Volume:
    """A chamber of 4 x 4 mm that is twisted by a whole turn on 30 mm, through squares."""
    loops = []
    for part in np.linspace(0.0, 1.0, sections):
        angles = 2.0 * pi * part + pi / 4 + 0.5 * pi * np.arange(4)
        corners = [occ.addPoint(5 + 30 * part, 5 + 8**0.5 * np.cos(t), 8**0.5 * np.sin(t)) for t in angles]
        loops.append(occ.addCurveLoop([occ.addLine(corners[k - 1], corners[k]) for k in range(4)]))
    return next(part for part in occ.addThruSections(loops, makeSolid=True) if part[0] == 3)


def ellipse(occ: Any, length: float, along: float, across: float) -> list[Volume]:
    """A long bar with an elliptical channel whose section is turned by 45 degrees."""
    turned = [0, 0.5**0.5, 0.5**0.5]
    curve = occ.addEllipse(-1, 5, 0, along, across, zAxis=[1, 0, 0], xAxis=turned)
    face = occ.addPlaneSurface([occ.addCurveLoop([curve])])
    air = [part for part in occ.extrude([(2, face)], length + 2, 0, 0) if part[0] == 3]
    return [part for part in occ.cut([box(occ, (0, 0, -6), (length, 10, 6))], air)[0] if part[0] == 3]


def filled(occ: Any) -> list[Volume]:
    """A bar with two holes of which one is filled by a solid that shares its faces."""
    holes = [box(occ, (5, 3, z - 1.5), (35, 7, z + 1.5)) for z in (-3, 3)]
    body = occ.cut(bar(occ), holes, removeTool=False)[0]
    return [part for part in occ.fragment(body, holes[:1])[0] if part[0] == 3]


@pytest.mark.parametrize(
    ("draw", "expected"),
    [
        (lambda occ: bar(occ, lobes(occ, 3, 0.0)), True),
        (lambda occ: bar(occ, lobes(occ, 3, pi / 2)), False),
        (lambda occ: bar(occ, lobes(occ, 2, pi / 4)), False),
        (lambda occ: bar(occ, twisted(occ)), False),
        (lambda occ: ellipse(occ, 1000, 1.0, 0.9), False),
        (lambda occ: ellipse(occ, 3000, 3.0, 2.6), False),
        (filled, False),
        (lambda occ: [(3, occ.addTorus(20, 5, 0, 3, 1))], True),
    ],
)
def test_splines_and_ellipses_are_compared_point_by_point(draw: Draw, expected: bool) -> None:
    """Centres, sizes and moments of all faces and edges are those of the mirror image in most of these."""
    with session() as gmsh:
        solids = draw(gmsh.model.occ)
        assert mirror.have_equal_boundaries(gmsh, solids, solids, 2, 0.0) is expected


def test_a_wavy_top_that_the_kernel_finds_no_difference_in() -> None:
    with session() as gmsh:
        occ = gmsh.model.occ
        heights = np.outer([0, 1, -1, 0], [0, 1, -1, 0])
        points = [occ.addPoint(40 / 3 * i, 10 + 2 * heights[i, k], -6 + 4 * k) for k in range(4) for i in range(4)]
        parts = occ.fragment([box(occ, (0, 0, -6), (40, 15, 6))], [(2, occ.addBSplineSurface(points, 4))])[0]
        below = min((part for part in parts if part[0] == 3), key=lambda part: occ.getCenterOfMass(*part)[1])
        assert 0.002 < difference(gmsh, [below], [below], 2, 0.0, 2e-6).fraction < 0.02


#: what is drawn, and the volume (mm3) of what it has and its mirror image has not
DIFFERENT: dict[str, tuple[Draw, float]] = {
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
        assert not mirror.have_equal_boundaries(gmsh, solids, solids, 2, 0.0)
        assert difference(gmsh, solids, solids, 2, 0.0, 2e-6).fraction < 1e-9
