"""STEP files of bodies that the program's own families draw as well."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from geometry import PneuNet
from geometry.meshing.solid import session

Corner = tuple[float, float, float]
#: draws with the CAD kernel of a Gmsh session
Draw = Callable[[Any], Any]


def box(occ: Any, low: Corner, high: Corner) -> tuple[int, int]:
    """A box between two corners, mm."""
    return (3, occ.addBox(*low, *np.subtract(high, low)))


def save(path: Path, draw: Draw) -> Path:
    """Write what is drawn with the CAD kernel of a Gmsh session."""
    with session() as gmsh:
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    return path


def in_inches(draw: Draw, path: Path) -> Path:
    """Write what is drawn in mm with its lengths in inches, into a BREP file, or a STEP file that says they are mm."""
    drawn = save(path.with_name(f"{path.name}.mm.step"), draw)
    with session() as gmsh:
        gmsh.option.setNumber("Geometry.OCCScaling", 1 / 25.4)  # dilated planes would be splines
        gmsh.model.occ.importShapes(str(drawn))
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    return path


def pneunet_as_step(path: Path, net: PneuNet, knob: tuple[Corner, Corner] | None = None) -> Path:
    """Write a whole pneu-net, with a block between two corners (mm) fused to it."""
    return save(path, pneunet_drawn(net, knob))


def pneunet_drawn(net: PneuNet, knob: tuple[Corner, Corner] | None = None) -> Draw:
    """The same, drawn."""
    width, top = net.width / 2, net.base + net.strip + net.chamber_height
    near, far = net.gap + net.wall, net.length - net.gap - net.wall

    def draw(occ: Any) -> None:
        material = [box(occ, (0, 0, -width), (net.length, net.base + net.strip, width))]
        air = [box(occ, (near, net.base, -net.channel / 2), (far, net.base + net.channel, net.channel / 2))]
        for k in range(net.chambers):
            x, across = net.gap + k * net.pitch, width - net.side_wall
            material.append(box(occ, (x, 0, -width), (x + net.chamber_length, top, width)))
            inner = x + net.wall, x + net.chamber_length - net.wall
            air.append(box(occ, (inner[0], net.base, -across), (inner[1], top - net.roof, across)))
        material += [box(occ, *knob)] if knob else []
        solid, _ = occ.fuse(material[:1], material[1:])
        occ.cut(solid, air)

    return draw
