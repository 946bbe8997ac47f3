"""What holds a piece of a periodic body: its start, and the plane of mirror symmetry at its end."""

from typing import Literal

import numpy as np

from fem.supports import Fixed, SharedPlane, Support
from geometry import Body
from geometry.arrays import Array

#: what holds the start of a piece: it is a plane of mirror symmetry too, it is clamped, or it is free
Boundary = Literal["mirror", "clamp", "free"]

#: the pieces in sentences, by what holds their start
BOUNDARY_NAMES: dict[Boundary, str] = {"mirror": "half cell", "clamp": "clamped end", "free": "free end"}
#: the faces of a piece that a layer meets at a right angle, by what holds the piece's start
UPRIGHT: dict[Boundary, tuple[str, ...]] = {"mirror": ("clamp", "tip"), "clamp": ("clamp", "tip"), "free": ("tip",)}


def supports_of(body: Body, curve: Array, start: Boundary, angle: float) -> list[Support]:
    """Supports of a piece whose plane at the end is at an angle in rad; curve: points (m, 3) of its material curve, mm.

    A piece with a free start is held at its end alone, which does not turn.
    """
    # of a body meshed on both sides: against motion along z and rotation about x, without force
    plane_z: list[Support] = [Fixed("sym", "z")] if body.half else [Fixed(curve[0], "z"), Fixed(body.top, "z")]
    normal = (float(np.cos(angle)), float(np.sin(angle)), 0.0)
    if start == "clamp":
        return [*plane_z, Fixed("clamp"), SharedPlane("tip", normal)]
    if start == "mirror":
        return [*plane_z, Fixed("clamp", "x"), Fixed(curve[0], "y"), SharedPlane("tip", normal)]
    return [*plane_z, Fixed("tip", "x"), Fixed(curve[-1], "y")]
