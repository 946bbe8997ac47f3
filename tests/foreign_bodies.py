"""Bodies as other programs write them: meshes without names or a material curve, surfaces, solids in other frames."""

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from geometry.meshing.solid import session
from tests.step_bodies import Draw, box, save

TWIN_BELLOWS = Path(__file__).parent / "data" / "twin_bellows.stl"
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


def finger(occ: Any) -> Any:
    """A bar of 70 x 12 x 14 mm with upper edges rounded by 3 mm and a cavity of 64 x 6 x 9 mm, 4 mm over the base."""
    block = occ.addBox(0, 0, -7, 70, 12, 14)
    occ.synchronize()
    boxes = {tag: occ.getBoundingBox(1, tag) for _, tag in occ.getEntities(1)}
    upper = [tag for tag, ends in boxes.items() if ends[3] - ends[0] > 69 and ends[1] > 11]
    return occ.cut(occ.fillet([block], upper, [3.0]), [box(occ, (3, 4, -4.5), (67, 10, 4.5))])[0]


def finger_from_its_corner(occ: Any) -> Any:
    """The finger with the origin at a corner, as programs draw boxes: z from 0 to 14 mm."""
    solids = finger(occ)
    occ.translate(solids, 0, 0, 7)
    return solids


def finger_in_two(occ: Any) -> Any:
    """The finger from two solids that touch in the plane y = 4 mm, as a cast upper part on a base plate."""
    whole = finger(occ)
    base = occ.intersect(whole, [box(occ, (-1, -1, -9), (71, 4, 9))], removeObject=False)[0]
    return base + occ.intersect(whole, [box(occ, (-1, 4, -9), (71, 20, 9))])[0]


def finger_with_inlet(occ: Any) -> Any:
    """The finger with z up, and a hole of radius 1.5 mm in the wall at its clamp."""
    solids = occ.cut(finger(occ), [(3, occ.addCylinder(-1, 7, 0, 5, 0, 0, 1.5))])[0]
    occ.rotate(solids, 0, 0, 0, 1, 0, 0, np.pi / 2)
    return solids


def finger_with_inlet_below(occ: Any) -> Any:
    """The finger with a hole of radius 1.5 mm in the middle of its base."""
    return occ.cut(finger(occ), [(3, occ.addCylinder(35, -1, 0, 0, 6, 0, 1.5))])[0]


def finger_with_air(occ: Any) -> Any:
    """The finger and its air, which some programs write as a solid of its own."""
    return [*finger(occ), box(occ, (3, 4, -4.5), (67, 10, 4.5))]


#: axis and angle (rad) of the rotation of the oblique finger
OBLIQUE = ((0.36, -0.48, 0.8), 1.2)


def oblique_finger(occ: Any) -> Any:
    """The finger turned about an oblique axis through the origin."""
    solids = finger(occ)
    occ.rotate(solids, 0, 0, 0, *OBLIQUE[0], OBLIQUE[1])
    return solids


def oblique_axes() -> str:
    """The key `axes` of the oblique finger."""
    axis, angle = np.array(OBLIQUE[0]), OBLIQUE[1]

    def turned(direction: np.ndarray) -> str:
        side = np.cos(angle) * direction + np.sin(angle) * np.cross(axis, direction)
        return ", ".join(f"{part:.9g}" for part in side + (1 - np.cos(angle)) * (axis @ direction) * axis)

    return f"axes: {{along: [{turned(np.eye(3)[0])}], up: [{turned(np.eye(3)[1])}]}}"


def half_finger(occ: Any) -> Any:
    """The half z >= 0 of the finger."""
    return occ.intersect(finger(occ), [box(occ, (-1, -1, 0), (71, 20, 8))])[0]


def finger_from_the_right(occ: Any) -> Any:
    """The finger with its clamped end at x = 70 mm."""
    solids = finger(occ)
    occ.translate(solids, -70, 0, 0)
    occ.rotate(solids, 0, 0, 0, 0, 1, 0, np.pi)
    return solids


@dataclass(frozen=True)
class Tried:
    """A file as another program writes it."""

    file: str
    words: str
    keys: str  #: of its geometry in YAML, besides `family` and `file`


def write_tried(folder: Path) -> list[Tried]:
    """Write the files of studies/own_bodies.md; all but the last two are the finger."""
    points, tets = meshed(finger, 4.0)
    write_mesh(folder / "finger.vtk", points, tets)
    write_mesh(folder / "finger10.msh", *meshed(finger, 4.0, order=2), file_format="gmsh22")
    write_mesh(folder / "finger_half.inp", *meshed(half_finger, 4.0))
    write_mesh(folder / "finger_right.mesh", *meshed(finger_from_the_right, 4.0))
    save(folder / "finger.step", finger)
    save(folder / "finger_in_two.step", finger_in_two)
    save(folder / "finger_corner.step", finger_from_its_corner)
    save(folder / "finger_inlet.step", finger_with_inlet)
    save(folder / "finger_inlet_below.step", finger_with_inlet_below)
    save(folder / "half.brep", half_finger)
    save(folder / "finger_with_air.step", finger_with_air)
    save(folder / "finger_oblique.step", oblique_finger)
    write_surface(folder / "finger_oblique.stl", oblique_finger, 50)
    shutil.copy(TWIN_BELLOWS, folder)
    write_surface(folder / "finger.stl", finger, 50)
    write_surface(folder / "finger_inlet_below.stl", finger_with_inlet_below, 50)
    content = meshio.read(folder / "finger.stl")
    meshio.Mesh(content.points, content.cells).write(folder / "finger.obj")
    x, y, z = content.points.astype(float).T
    content.points = np.column_stack([x, -z, y]) / 25.4
    content.write(folder / "finger_inch.stl", binary=True)
    write_surface(folder / "chambers.stl", two_chambers, 50)
    return [
        Tried("finger.step", "STEP, y up", "curve: 2 mm"),
        Tried("finger_corner.step", "STEP, origin at a corner", "curve: 2 mm, middle: 7 mm"),
        Tried("finger_in_two.step", "STEP of two solids that touch", "curve: 2 mm, unite: true"),
        Tried(
            "finger_inlet.step",
            "STEP, z up, open inlet at the clamp (no experiment I)",
            "curve: 2 mm, axes: [x, z, -y], plug: true",
        ),
        Tried(
            "finger_inlet_below.step",
            "STEP, open inlet in the base, filled",
            "curve: 2 mm, plug: {inlet: [35 mm, 0 mm, 0 mm]}",
        ),
        Tried("half.brep", "BREP, half z ≥ 0", "curve: 2 mm, symmetric: true"),
        Tried("finger_with_air.step", "STEP, air as a solid of its own", "curve: 2 mm"),
        Tried("finger_oblique.step", "STEP, oblique", f"curve: 2 mm, {oblique_axes()}"),
        Tried("finger.stl", "STL", "curve: 2 mm"),
        Tried("finger_oblique.stl", "STL, oblique", f"curve: 2 mm, {oblique_axes()}"),
        Tried(
            "finger_inlet_below.stl",
            "STL, open inlet in the base, filled",
            "curve: 2 mm, plug: {inlet: [35 mm, 0 mm, 0 mm]}",
        ),
        Tried("finger_inch.stl", "STL in inches, z up", "curve: 2 mm, unit: inch, axes: [x, z, -y]"),
        Tried("finger.obj", "OBJ", "curve: 2 mm"),
        Tried("finger.vtk", "VTK, 4 nodes", "curve: 2 mm"),
        Tried("finger10.msh", "Gmsh without names, 10 nodes", "curve: 2 mm"),
        Tried("finger_half.inp", "Abaqus, half z ≥ 0", "curve: 2 mm, symmetric: true"),
        Tried("finger_right.mesh", "Medit, clamped at the larger x", "curve: 2 mm, clamp: 70 mm, tip: 0 mm"),
        Tried(
            "chambers.stl",
            "STL, two cavities",
            "curve: 1.5 mm, air: {near: [20 mm, 5 mm, 0 mm], far: [40 mm, 5 mm, 0 mm]}",
        ),
        Tried(
            TWIN_BELLOWS.name,
            "STL of two bellows",
            "curve: -11 mm, air: {left: [20 mm, 0 mm, -12 mm], right: [20 mm, 0 mm, 12 mm]}",
        ),
    ]
