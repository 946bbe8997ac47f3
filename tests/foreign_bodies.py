"""Bodies as other programs write them: meshes without names or a material curve, surfaces, solids in other frames."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from geometry.meshing.solid import session
from tests.step_bodies import box

Draw = Callable[[Any], Any]

#: the bar: 60 x 12 x 15 mm with a cavity of 54 x 7 x 10 mm, 3 mm over the base
BAR_VOLUME, BAR_AIR = 60 * 12 * 15 - 54 * 7 * 10, 54 * 7 * 10


def bar(occ: Any) -> Any:
    """A bar with one cavity, whole, about z = 0."""
    return occ.cut([box(occ, (0, 0, -7.5), (60, 12, 7.5))], [box(occ, (3, 3, -5), (57, 10, 5))])[0]


def half_bar(occ: Any) -> Any:
    """The half z >= 0 of the bar."""
    return occ.intersect(bar(occ), [box(occ, (-1, -1, 0), (61, 20, 8))])[0]


def tube(occ: Any) -> Any:
    """A round bar of radius 7 mm with a round cavity of radius 5 mm, 1 mm higher, 50 mm long."""
    outer, inner = (3, occ.addCylinder(0, 0, 0, 50, 0, 0, 7)), (3, occ.addCylinder(3, 0.5, 0, 44, 0, 0, 5))
    return occ.cut([outer], [inner])[0]


def two_chambers(occ: Any) -> Any:
    """The bar with a wall of 2 mm in the middle of its cavity."""
    air = [box(occ, (3, 3, -5), (29, 10, 5)), box(occ, (31, 3, -5), (57, 10, 5))]
    return occ.cut([box(occ, (0, 0, -7.5), (60, 12, 7.5))], air)[0]


def meshed(draw: Draw, size: float, order: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3), mm, and tetrahedra (m, 4) or (m, 10) of what is drawn, as any mesher would make them."""
    with session() as gmsh:
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 12)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        index = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        index[tags] = np.arange(len(tags))
        nodes = index[gmsh.model.mesh.getElementsByType(4 if order == 1 else 11)[1]].reshape(
            -1, 4 if order == 1 else 10
        )
    if order == 2:
        nodes = nodes[:, [*range(8), 9, 8]]  # Gmsh has the middle of 34 before that of 24
    return coordinates.reshape(-1, 3), nodes


def write_mesh(path: Path, points: np.ndarray, tets: np.ndarray, **options: Any) -> Path:
    """Write a mesh with meshio in the format of the suffix of `path`."""
    kind = "tetra" if tets.shape[1] == 4 else "tetra10"
    meshio.Mesh(points, [(kind, tets)]).write(path, **options)
    return path


def rounded_bar(occ: Any) -> Any:
    """The bar with edges along x rounded by 3 mm and a cavity of 54 x 6 x 10 mm."""
    block = occ.addBox(0, 0, -7.5, 60, 12, 15)
    occ.synchronize()
    boxes = {tag: occ.getBoundingBox(1, tag) for _, tag in occ.getEntities(1)}
    along = [tag for tag, ends in boxes.items() if ends[3] - ends[0] > 59]
    return occ.cut(occ.fillet([block], along, [3.0]), [box(occ, (3, 3, -5), (57, 9, 5))])[0]


#: volume of the material of the rounded bar, mm3
ROUNDED_VOLUME = 60 * (12 * 15 - (4 - np.pi) * 9) - 54 * 6 * 10


def write_surface(path: Path, draw: Draw, size: float, around: int = 24, binary: bool = True) -> Path:
    """Write the surface of what is drawn with triangles of at most `size` mm, `around` of them around a circle."""
    with session() as gmsh:
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", around)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))
    return path


def bar_with_inlet(occ: Any, x: float = -1.0) -> Any:
    """The bar with a round hole of radius 1.5 mm, 5 mm long, from `x` into its cavity: through the wall of one end."""
    return occ.cut(bar(occ), [(3, occ.addCylinder(x, 6, 0, 5, 0, 0, 1.5))])[0]


#: volume of the hole in the wall of 3 mm, mm3
INLET = np.pi * 1.5**2 * 3


def standing_bar(occ: Any) -> Any:
    """The bar with its length along z and its top towards -y, clamped at the larger z."""
    solids = bar(occ)
    occ.translate(solids, -60, 0, 0)
    occ.rotate(solids, 0, 0, 0, 0, 1, 0, -np.pi / 2)  # x becomes z
    occ.rotate(solids, 0, 0, 0, 0, 0, 1, np.pi)
    return solids


def two_solids(occ: Any) -> Any:
    """The bar from two solids that touch in the plane x = 20 mm."""
    whole = bar(occ)
    left = occ.intersect(whole, [box(occ, (-1, -1, -9), (20, 20, 9))], removeObject=False)[0]
    right = occ.intersect(whole, [box(occ, (20, -1, -9), (61, 20, 9))])[0]
    return left + right
