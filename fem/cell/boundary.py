"""What holds a piece of a periodic body: its start, and the plane of mirror symmetry at its end."""

from dataclasses import dataclass
from typing import Literal, final

import numpy as np

from fem.discretisation import Discretisation
from fem.effects.loads import volume_gradient
from fem.supports import Equations, Fixed, SharedPlane, Support
from geometry import Body
from geometry.arrays import Array, Index

#: areas over the largest one that count as none
TINY = 1e-9

#: what holds the start of a piece: it is a plane of mirror symmetry too, it is clamped, or it is free
Boundary = Literal["mirror", "clamp", "free"]

#: the pieces in sentences, by what holds their start
BOUNDARY_NAMES: dict[Boundary, str] = {"mirror": "half cell", "clamp": "clamped end", "free": "free end"}
#: the faces of a piece that a layer meets at a right angle, by what holds the piece's start
UPRIGHT: dict[Boundary, tuple[str, ...]] = {"mirror": ("clamp", "tip"), "clamp": ("clamp", "tip"), "free": ("tip",)}


@final
@dataclass(frozen=True)
class NotTurned(Support):
    """A plane x = constant whose nodes do not turn about its normal on the average, weighted by area."""

    where: str

    def equations(self, space: Discretisation) -> Equations:
        """sum w (r_y u_z - r_z u_y) = 0 with the positions r from the centre of the plane."""
        nodes, weights, lever = spread(space, self.where)
        turn = np.concatenate([-weights * lever[:, 2], weights * lever[:, 1]])
        components = np.concatenate([3 * nodes + 1, 3 * nodes + 2])[None]
        return Equations.of(components, turn / np.abs(turn).max(), np.zeros(1), ramp=False)


def spread(space: Discretisation, plane: str) -> tuple[Index, Array, Array]:
    """Nodes (k,) of a plane, their areas (k,) in mm2, and positions (k, 3) at rest from their centre, mm."""
    face = space.surface(plane)
    areas = np.abs(volume_gradient(face, space.points)[:, 0])
    nodes = face.unique_nodes[areas[face.unique_nodes] > TINY * areas.max()]
    weights, x = areas[nodes], space.points[nodes]
    return nodes, weights, x - np.average(x, axis=0, weights=weights)


def supports_of(body: Body, curve: Array, start: Boundary, angle: float) -> list[Support]:
    """Supports of a piece whose plane at the end is at an angle in rad; curve: points (m, 3) of its material curve, mm.

    A piece with a free start is held at its end alone, which does not turn. A body that is meshed on both sides is held
    against motion along z and rotation about x, without force where it is symmetric.
    """
    normal = (float(np.cos(angle)), float(np.sin(angle)), 0.0)
    plane: Support = Fixed("tip", "x") if start == "free" else SharedPlane("tip", normal)
    if start == "clamp":
        return [*([Fixed("sym", "z")] if body.half else []), Fixed("clamp"), plane]
    face, end = ("tip", curve[-1]) if start == "free" else ("clamp", curve[0])
    held = [plane] if start == "free" else [Fixed("clamp", "x"), plane]
    if body.half:
        return [Fixed("sym", "z"), *held, Fixed(end, "y")]
    return [*held, Fixed(end, "yz"), NotTurned(face)]
