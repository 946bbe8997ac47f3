"""Whether a CAD body is its own mirror image at z = 0."""

from math import pi
from typing import Any

import numpy as np
import pytest

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
    "three lobes": lambda occ: bar(occ, lobes(occ, 3, 0.0)),
}


@pytest.mark.parametrize("name", EQUAL)
def test_mirror_images_are_known(name: str) -> None:
    with session() as gmsh:
        solids = EQUAL[name](gmsh.model.occ)
        for axis, at in ((2, 0.0), (0, 20.0) if name not in ("two holes", "cones") else (2, 0.0)):
            assert not difference(gmsh, solids, solids, axis, at, 2e-6).exists


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


def filled(occ: Any) -> list[Volume]:
    """A bar with two holes of which one is filled by a solid that shares its faces."""
    holes = [box(occ, (5, 3, z - 1.5), (35, 7, z + 1.5)) for z in (-3, 3)]
    body = occ.cut(bar(occ), holes, removeTool=False)[0]
    return [part for part in occ.fragment(body, holes[:1])[0] if part[0] == 3]


DIFFERENT: dict[str, Draw] = {
    "a hole 3 um away": lambda occ: bar(occ, hole(occ, 9, 3), hole(occ, 9, -3.003)),
    "a wider hole": lambda occ: bar(occ, hole(occ, 9, 3), hole(occ, 9, -3, 1.01)),
    "holes across from each other": lambda occ: bar(occ, hole(occ, 9, 3), hole(occ, 31, -3)),
    "a cone turned round": lambda occ: bar(occ, hole(occ, 9, 3, 2, 1), hole(occ, 9, -3, 1, 2)),
    "three lobes on end": lambda occ: bar(occ, lobes(occ, 3, pi / 2)),
    "a twisted chamber": lambda occ: bar(occ, twisted(occ)),
    "one hole filled": filled,
}


@pytest.mark.parametrize("name", DIFFERENT)
def test_what_is_no_mirror_image_differs(name: str) -> None:
    """The moments of lobes and of the twisted chamber are those of their mirror images."""
    with session() as gmsh:
        solids = DIFFERENT[name](gmsh.model.occ)
        assert difference(gmsh, solids, solids, 2, 0.0, 2e-6).exists
