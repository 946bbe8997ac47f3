"""Shapes of which solids are put together, and how they are drawn in a session of Gmsh."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Any, TypeAlias

import numpy as np

#: (3, tag) and (2, tag), as Gmsh identifies a volume and a face.
Volume: TypeAlias = tuple[int, int]
Face: TypeAlias = tuple[int, int]


@dataclass(frozen=True)
class Fillet:
    """What rounds a re-entrant edge along z: the prism between two planes at right angles and an arc tangent to both.

    It lies above the edge (larger y), and beyond it (larger x) for side = 1, before it for side = -1; all in mm.
    """

    x: float  #: of the edge
    y: float  #: of the edge
    radius: float
    side: int
    end: float  #: it reaches from z = 0 to here


@dataclass(frozen=True)
class Box:
    """The box between two opposite corners, mm, without the fillets of its own edges."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    fillets: Sequence[Fillet] = ()  #: that are cut out of it


@dataclass(frozen=True)
class RoundBar:
    """The part z >= 0 of a cylinder along x about (y, z) = (centre, 0), cut to bottom <= y <= top; all in mm."""

    start: float
    end: float
    centre: float
    radius: float
    bottom: float = -inf
    top: float = inf


Shape: TypeAlias = Box | RoundBar | Fillet


def drawn(occ: Any, shape: Shape) -> Volume:
    """Draw a shape with the OpenCASCADE kernel `occ` of a Gmsh session."""
    if isinstance(shape, Box):
        sides = np.subtract(shape.high, shape.low)
        box = (3, occ.addBox(*shape.low, *sides))
        fillets = [drawn(occ, fillet) for fillet in shape.fillets]
        return occ.cut([box], fillets)[0][0] if fillets else box
    if isinstance(shape, Fillet):
        return _drawn_fillet(occ, shape)
    length, radius = shape.end - shape.start, shape.radius
    cylinder = (3, occ.addCylinder(shape.start, shape.centre, 0, length, 0, 0, radius))
    bottom = max(shape.bottom, shape.centre - 2 * radius)
    top = min(shape.top, shape.centre + 2 * radius)
    window = (3, occ.addBox(shape.start, bottom, 0, length, top - bottom, 2 * radius))
    return occ.intersect([cylinder], [window])[0][0]


def _drawn_fillet(occ: Any, fillet: Fillet) -> Volume:
    """Its section in the plane z = 0, extruded along z."""
    beside, above = fillet.x + fillet.side * fillet.radius, fillet.y + fillet.radius
    edge, foot, top, centre = (
        occ.addPoint(x, y, 0) for x, y in ((fillet.x, fillet.y), (beside, fillet.y), (fillet.x, above), (beside, above))
    )
    sides = [occ.addLine(edge, foot), occ.addCircleArc(foot, centre, top), occ.addLine(top, edge)]
    section = occ.addPlaneSurface([occ.addCurveLoop(sides)])
    occ.remove([(0, centre)])
    extruded = occ.extrude([(2, section)], 0, 0, fillet.end)
    return next(entity for entity in extruded if entity[0] == 3)
