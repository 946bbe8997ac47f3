"""Solids of a CAD file that are the air in the body, as programs save them that simulate the flow."""

from typing import Any

import numpy as np

from geometry.meshing.shapes import Volume

#: difference of two volumes, over the volume, and of their centres, over its cube root, that is rounding
SAME = 1e-6


def air_among(gmsh: Any, solids: list[Volume]) -> list[Volume]:
    """Those of several solids that fill a closed cavity of the others."""
    boxes = {solid: np.array(gmsh.model.getBoundingBox(*solid)).reshape(2, 3) for solid in solids}
    inner = {first for first in solids if any(_is_inside(boxes[first], boxes[second]) for second in solids)}
    walls = [solid for solid in solids if solid not in inner]
    if not inner:
        return []
    occ = gmsh.model.occ
    low, high = np.min([boxes[wall][0] for wall in walls], axis=0), np.max([boxes[wall][1] for wall in walls], axis=0)
    margin = 0.1 * (high - low)
    block = (3, occ.addBox(*(low - margin), *(high - low + 2 * margin)))
    cavities, _ = occ.cut([block], walls, removeObject=True, removeTool=False)
    air = [solid for solid in solids if solid in inner and any(_are_same(occ, solid, cavity) for cavity in cavities)]
    occ.remove(cavities, recursive=True)
    return air


def _is_inside(first: Any, second: Any) -> bool:
    """Whether a box (2, 3) lies in another one and touches none of its sides."""
    return bool((first[0] > second[0]).all() and (first[1] < second[1]).all())


def _are_same(occ: Any, first: Volume, second: Volume) -> bool:
    """Whether two volumes are equally large and have the same centre."""
    size, other = float(occ.getMass(*first)), float(occ.getMass(*second))
    apart = np.linalg.norm(np.subtract(occ.getCenterOfMass(*first), occ.getCenterOfMass(*second)))
    return abs(size - other) <= SAME * size and bool(apart <= SAME * size ** (1 / 3))
