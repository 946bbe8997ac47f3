"""Whether the material curve lies in the material of a CAD file; in a session of `geometry.meshing.solid`."""

from typing import Any

import numpy as np

from geometry.curve_height import height_advice
from geometry.design import DesignError
from geometry.meshing.cad_import import CadBody, Point, is_in_material
from geometry.meshing.shapes import Volume

#: points of the curve that are looked at
SAMPLES = 100
#: distance from the surface, over the height of the body, that is rounding
ROUNDING = 1e-4
#: distance of the first and last of these points from the ends, over the length
JUST_WITHIN = 1e-5


def check_curve(gmsh: Any, body: CadBody, solids: list[Volume], low: Point, high: Point, holes: str) -> None:
    """Raise `DesignError` where the curve leaves the material.

    low, high: bounds of the body, mm; holes: where there are some in flat faces, as the end of a sentence.
    """
    along = np.linspace(body.clamp, body.tip, SAMPLES)
    along[[0, -1]] += [JUST_WITHIN * (body.tip - body.clamp), JUST_WITHIN * (body.clamp - body.tip)]
    across = body.within_half((0.0, 0.0, 0.0), low, high)[2]
    rounding = ROUNDING * (high[1] - low[1])

    def inside(y: float) -> bool:
        points = np.column_stack([along, np.full(SAMPLES, y), np.full(SAMPLES, across)])
        count = sum(gmsh.model.isInside(3, solid[1], points.ravel()) for solid in solids)
        # a point in a face of two solids is found in both; one by one the points take far longer
        return count >= SAMPLES and (len(solids) == 1 or all(is_in_material(gmsh, solids, point) for point in points))

    if any(inside(body.curve + side * rounding) for side in (1.0, -1.0)):
        return
    outside = [x for x in along if not is_in_material(gmsh, solids, np.array([x, body.curve, across]))] or list(along)
    through = f"; if the line crosses an inlet, fill the inlet with plug: {{inlet: [x, y, z]}}{holes}" if holes else ""
    raise DesignError(
        "curve",
        f"the line y = {body.curve:g} mm, z = 0 is outside the material between {outside[0] - body.clamp:.3g} and "
        f"{outside[-1] - body.clamp:.3g} mm behind the clamp; {height_advice(low[1], high[1], inside)}{through}",
    )
