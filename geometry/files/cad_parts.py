"""Solids of a CAD file that are of another material, by a point in each; in a session of `geometry.meshing.solid`."""

from typing import Any

import numpy as np

from geometry.errors import DesignError
from geometry.files.cad_import import CadBody, Point
from geometry.meshing.shapes import Volume

#: name of the material outside of all parts
BODY = ""


def named_parts(gmsh: Any, body: CadBody, solids: list[Volume], low: Point, high: Point) -> dict[Volume, str]:
    """The name of the part of each solid, `BODY` for those without; of a symmetric body that of its mirror image too.

    Raises `DesignError` for a point in no solid, between two or in one that has a name already, and where all solids
    have one.
    """
    named = dict.fromkeys(solids, BODY)
    for name, point in body.parts.items():
        given = body.words(point)
        inner = body.within_half(point, low, high)
        holders = [solid for solid in solids if gmsh.model.isInside(3, solid[1], list(inner))]
        if len(holders) > 1:
            raise DesignError(
                f"parts.{name}",
                f"the point {given} lies in the boundary of {len(holders)} solids; give a point inside one",
            )
        if body.half:
            holders += [solid for solid in solids if holders and _are_images(gmsh, solid, holders[0])]
        if not holders:
            raise DesignError(
                f"parts.{name}", f"the point {given} lies in no solid of the file; give a point inside one"
            )
        if taken := [named[solid] for solid in holders if named[solid] != BODY]:
            raise DesignError(f"parts.{name}", f"the point {given} lies in the same solid as that of {taken[0]}")
        named |= dict.fromkeys(holders, name)
    if body.parts and BODY not in named.values():
        raise DesignError(
            "parts",
            f"all solids of the file ({len(solids)}) are named; leave out the one that has the walls of the cavity",
        )
    return named


def _are_images(gmsh: Any, first: Volume, second: Volume) -> bool:
    """Whether two solids have the same volume and centres that are mirror images of each other at z = 0."""
    volumes = [float(gmsh.model.occ.getMass(*solid)) for solid in (first, second)]
    centres = [np.array(gmsh.model.occ.getCenterOfMass(*solid)) for solid in (first, second)]
    apart = float(np.abs(centres[0] - centres[1] * [1, 1, -1]).max())
    same = abs(volumes[0] - volumes[1]) <= 1e-6 * volumes[0] and apart <= 1e-6 * volumes[0] ** (1 / 3)
    return first != second and same
