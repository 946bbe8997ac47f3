"""A bar of quadratic tetrahedra, bent, and the file of its surfaces."""

from pathlib import Path
from typing import Any

import numpy as np

from pipeline.show.pictures import SURFACES, boundary

EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


def bar() -> tuple[np.ndarray, np.ndarray]:
    """A half bar 0 <= x <= 8, 0 <= y <= 1, 0 <= z <= 1 of quadratic tetrahedra."""
    corners = [(x, y, z) for x in range(9) for y in range(2) for z in range(2)]
    points = [np.array(corner, dtype=float) for corner in corners]
    number = {corner: index for index, corner in enumerate(corners)}
    middles: dict[frozenset[int], int] = {}
    tets = []
    for x in range(8):
        for path in [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]:
            corner, tet = [x, 0, 0], [number[x, 0, 0]]
            for axis in path:
                corner[axis] += 1
                tet.append(number[corner[0], corner[1], corner[2]])
            sides = np.array([points[node] - points[tet[0]] for node in tet[1:]])
            if np.linalg.det(sides) < 0:
                tet[2], tet[3] = tet[3], tet[2]
            for a, b in EDGES:
                pair = frozenset((tet[a], tet[b]))
                if pair not in middles:
                    middles[pair] = len(points)
                    points.append((points[tet[a]] + points[tet[b]]) / 2)
            tets.append([*tet, *(middles[frozenset((tet[a], tet[b]))] for a, b in EDGES)])
    return np.array(points), np.array(tets)


def bent(points: np.ndarray) -> np.ndarray:
    angle = -points[:, 0] / 5
    radius = 5 - points[:, 1]
    x, y = -radius * np.sin(angle), 5 - radius * np.cos(angle)
    return np.column_stack([x, -y, points[:, 2]]) - points


def write_surfaces(folder: Path, half: bool = True) -> dict[str, Any]:
    """The surfaces of a bar in two states of II and one of I; the arrays."""
    points, tets = bar()
    faces, in_plane = boundary(points, tets)
    shown, numbers = np.unique(faces, return_inverse=True)
    arrays: dict[str, Any] = {
        "half": np.array(half),
        "points": points[shown],
        "faces": numbers.reshape(faces.shape),
        "in_plane": in_plane,
        "experiments": np.array(["II", "II", "I"]),
        "pressures_kPa": np.array([10.0, 20.0, 20.0]),
        "displacement": np.array([0.5 * bent(points), bent(points), bent(points)])[:, shown],
        "stretch": np.linspace(1.0, 1.5, 3 * len(shown)).reshape(3, -1),
        "von_mises_MPa": np.linspace(2.0, 0.0, 3 * len(shown)).reshape(3, -1),
    }
    (folder / SURFACES).parent.mkdir(parents=True)
    np.savez_compressed(folder / SURFACES, **arrays)
    return {**arrays, "body": (points, tets)}
