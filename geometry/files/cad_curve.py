"""Whether the material curve lies in the material of a CAD file; in a session of `geometry.meshing.solid`."""

from typing import Any

from geometry.errors import DesignError
from geometry.files.cad_import import CadBody, Point, is_in_material
from geometry.files.cad_position import goes_on
from geometry.files.curve_height import height_advice
from geometry.files.inlets import hole_advice
from geometry.meshing.shapes import Volume

#: distance from the surface, over the height of the body, that is rounding
ROUNDING = 1e-4
#: distance from the ends, over the length, that is rounding
NEAR_END = 1e-5


def check_curve(gmsh: Any, body: CadBody, solids: list[Volume], low: Point, high: Point) -> None:
    """Raise `DesignError` where the curve leaves the material between the ends, or the material goes on beyond one.

    low, high: bounds of the body, mm.
    """
    across = body.within_half((0.0, 0.0, 0.0), low, high)[2]
    rounding = ROUNDING * (high[1] - low[1])

    def gap(y: float) -> tuple[float, float] | None:
        return _first_gap(gmsh, body, solids, y, across)

    inside = [y for side in (1.0, -1.0) if gap(y := body.curve + side * rounding) is None]
    if inside:
        beyond = NEAR_END * (body.tip - body.clamp)
        for name, x in (("clamp", body.clamp - beyond), ("tip", body.tip + beyond)):
            if any(is_in_material(gmsh, solids, (x, y, across)) for y in inside):
                raise goes_on(name, getattr(body, name) * (-1 if body.turned else 1))
        return
    start, stop = gap(body.curve) or (body.clamp, body.tip)
    holes = hole_advice(gmsh, body, solids)
    through = f"; if the line crosses an inlet, fill it with plug: {{inlet: [x, y, z]}}{holes}" if holes else ""
    raise DesignError(
        "curve",
        f"the line y = {body.curve:g} mm, z = 0 is outside the material between {start - body.clamp:.4g} and "
        f"{stop - body.clamp:.4g} mm behind the clamp; "
        f"{height_advice(low[1], high[1], lambda y: gap(y) is None)}{through}",
    )


def _first_gap(gmsh: Any, body: CadBody, solids: list[Volume], y: float, across: float) -> tuple[float, float] | None:
    """From where to where (x, mm) the line at the height y between the ends lies outside the solids for the first time;
    None where it lies in them."""
    occ = gmsh.model.occ
    ends = [occ.addPoint(x, y, across) for x in (body.clamp, body.tip)]
    pieces, _ = occ.intersect([(1, occ.addLine(*ends))], solids, removeObject=True, removeTool=False)
    boxes = sorted(occ.getBoundingBox(*piece)[::3] for piece in pieces if piece[0] == 1)
    occ.remove(pieces, recursive=True)
    rounding, reached = NEAR_END * (body.tip - body.clamp), body.clamp
    for start, stop in boxes:
        if start > reached + rounding:
            return reached, start
        reached = max(reached, stop)
    return None if reached > body.tip - rounding else (reached, body.tip)
