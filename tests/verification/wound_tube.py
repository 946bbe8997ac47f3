"""A quarter of a tube along x about the x axis, with round walls, for tests of hoops."""

import numpy as np

from geometry import Mesh
from geometry.arrays import Array, Mask
from geometry.curved import curved_edges
from tests.bodies import bricks


def tube(inner: float, outer: float, length: float, counts: tuple[int, int, int]) -> Mesh:
    """Of radii and length in mm, with (wall, quarter, length) bricks; faces `inside`, `outside`, `clamp` (x = 0), `tip`
    (x = length), `sym` (z = 0) and `floor` (y = 0)."""
    lines = [
        np.linspace(low, high, n + 1)
        for (low, high), n in zip(((inner, outer), (0, 1), (0, length)), counts, strict=True)
    ]
    return bent(np.ones(counts, dtype=bool), lines)


def bent(filled: Mask, lines: list[Array]) -> Mesh:
    """The filled bricks of a grid with these radii, parts of the quarter and positions along x."""
    flat = bricks(filled, lines)
    corners = flat.points[flat.boundary]
    low, high = flat.points.min(axis=0), flat.points.max(axis=0)

    def on(axis: int, value: float) -> Mask:
        return np.asarray(np.isclose(corners[..., axis], value).all(axis=1))

    walls = {
        "inside": on(0, low[0]),
        "sym": on(1, 0.0),
        "floor": on(1, 1.0),
        "clamp": on(2, 0.0),
        "tip": on(2, high[2]),
    }
    walls["outside"] = ~np.any(list(walls.values()), axis=0)

    def turned(points: Array) -> Array:
        radius, angle = points[:, 0], 0.5 * np.pi * points[:, 1]
        return np.column_stack([points[:, 2], radius * np.cos(angle), radius * np.sin(angle)])

    points = turned(flat.points)
    curved = curved_edges(points, flat.edges, turned(flat.points[flat.edges].mean(axis=1)))
    return Mesh(points, flat.tets, {name: flat.boundary[marked] for name, marked in walls.items()}, curved)
