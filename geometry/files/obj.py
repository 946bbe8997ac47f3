"""Surfaces in Wavefront OBJ files: vertices and the corners of faces, without normals, textures, groups and materials.

meshio refuses files that have not as many normals, or texture coordinates, as vertices, and vertices with a colour; it
misreads corners that count backwards.
"""

from pathlib import Path

import numpy as np

from geometry.arrays import Array, Index
from geometry.errors import MeshError

#: largest number of a vertex, which fits into an array of numbers
MOST_VERTICES = 2**62


def read_obj(path: Path) -> tuple[Array, list[Index]]:
    """Vertices (n, 3) and faces, those with equally many corners together, (k, corners). Raises `MeshError`."""
    if not path.is_file():
        raise MeshError(f"the surface file {path} does not exist")
    vertices: list[list[float]] = []
    faces: dict[int, list[list[int]]] = {}
    text = path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ")  # a line may go on in the next one
    for number, line in enumerate(text.splitlines(), start=1):
        key, *items = line.split() or [""]
        try:
            if key == "v":
                x, y, z = map(float, items[:3])  # a weight or a colour may follow
                vertices.append([x, y, z])
            elif key == "f":
                corners = [int(item.partition("/")[0]) for item in items]
                if 0 in corners or max(map(abs, corners), default=0) > MOST_VERTICES:
                    raise ValueError
                # vertices count from 1, or from the latest one back: -1
                faces.setdefault(len(corners), []).append([c - 1 if c > 0 else len(vertices) + c for c in corners])
        except ValueError as error:
            raise MeshError(f"the surface file {path} cannot be read: line {number} is '{line.strip()}'") from error
    blocks = [np.array(block, dtype=np.int64) for block in faces.values()]
    if any(block.min() < 0 or block.max() >= len(vertices) for block in blocks if block.size):
        raise MeshError(f"a face in the surface file {path} uses a vertex that the file does not have")
    return np.array(vertices, dtype=np.float64).reshape(-1, 3), blocks
