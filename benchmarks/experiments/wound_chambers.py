"""The axial force of a chamber wound with loops: a cell with three of them against what its authors needed.

    make experiments
    python -m benchmarks.experiments.wound_chambers

The arm is that of match-SoRo/soft-continuum-robot-modelling a80e308, scripts/simulate_and_visualise_contact_env.m; no
licence is stated, and only these numbers are used. Its authors' rod, whose modulus is fitted, needs 6.54e-5 m2 times
the pressure beside the force on the area of a chamber. Here one chamber of a cell without moment is under pressure: the
curvature times the rigidity of the cell, over pressure and lever, is the whole area. Nothing is fitted.

Statics says as much. Loops of radius b that do not stretch, about incompressible rubber around a chamber of radius a,
leave the chamber the volume pi b^2 per length less that of the rubber, which is constant. A stretch adds pi b^2.
"""

import sys
from math import cos, pi, sin

import numpy as np

from benchmarks.markdown import table, write_made
from fem import Hoops, NeoHooke
from fem.cell.piece import BendingPiece
from geometry import Body
from geometry.arrays import Array, Index
from geometry.meshing.mirror import name_faces
from geometry.meshing.solid import session
from pipeline.law.piece.measure import cell_without_moment
from pipeline.values.pressure import in_MPa

#: mm: outer radius, chambers, their loops, their distance from the axis, and the channel along it
RADIUS, CHAMBER, LOOPS, LEVER, CHANNEL = 21.1, 5.15, 6.7, 12.0, 3.5
#: MPa, as fitted by the authors; mm2, what they need beside the area of the chamber
MODULUS, NEEDED = 0.17348, 65.401
#: mm, half a cell, its elements and those at the loops; N/mm of loops that hardly stretch; kPa
HALF, SIZE, FINE, STIFFNESS, PRESSURES = 2.0, 3.0, 0.9, 200.0, (5.0, 30.0)
CENTRES = [(LEVER * cos(turn), LEVER * sin(turn)) for turn in (0.0, 2.0 * pi / 3.0)]  # the third one is an image
COMMAND = "python -m benchmarks.experiments.wound_chambers"


def meshed() -> tuple[Array, Index, dict[str, Index], dict[float, Index]]:
    """Points, tetrahedra, walls of the air by name, and the faces about both chambers by their radius."""
    with session() as gmsh:
        occ = gmsh.model.occ
        air = [(y, z, CHAMBER) for y, z in CENTRES] + [(0.0, 0.0, CHANNEL)]
        solid = [(3, occ.addCylinder(0, 0, 0, HALF, 0, 0, RADIUS))]
        solid, _ = occ.cut(solid, [(3, occ.addCylinder(0, y, z, HALF, 0, 0, r)) for y, z, r in air])
        solid, _ = occ.intersect(solid, [(3, occ.addBox(0, -30, 0, HALF, 60, 30))])
        sleeves = [(3, occ.addCylinder(0, y, z, HALF, 0, 0, LOOPS)) for y, z in CENTRES]
        sleeves, _ = occ.intersect(sleeves, solid, removeTool=False)
        occ.fragment(solid, sleeves)
        occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", SIZE)
        for entity in gmsh.model.getEntities(0):
            gmsh.model.mesh.setSize([entity], FINE)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 40)
        gmsh.model.mesh.generate(3)
        tags, flat, _ = gmsh.model.mesh.getNodes()
        points = np.asarray(flat).reshape(-1, 3)
        number = np.full(int(max(tags)) + 1, -1)
        number[np.asarray(tags, int)] = np.arange(len(tags))
        tets = number[np.asarray(gmsh.model.mesh.getElementsByType(4)[1], int)].reshape(-1, 4)
        faces = number[np.asarray(gmsh.model.mesh.getElementsByType(2)[1], int)].reshape(-1, 3)
    used = np.unique(tets)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    points, tets, faces = points[used], number[tets], number[faces]

    def about(centre: tuple[float, float], radius: float) -> Index:
        away = np.hypot(*(points[:, 1:] - centre).T)
        return faces[(np.abs(away - radius)[faces] < 1e-6).all(axis=1)]

    walls = {"inflated": about(CENTRES[0], CHAMBER)}
    return points, tets, walls, {r: np.concatenate([about(c, r) for c in CENTRES]) for r in (CHAMBER, LOOPS)}


def areas(body: Body, loops: Index | None) -> list[float]:
    """mm2, the axial force of a chamber over the pressure, at PRESSURES; loops: faces that are wound."""
    effects = [] if loops is None else [Hoops(loops, 1.0, STIFFNESS)]
    material = NeoHooke.from_uniaxial({"mu": MODULUS / 3.0}, 0.499)
    piece = BendingPiece(body, material, "mirror", "mixed", {"inflated": 1.0}, effects=effects)
    found = []
    for pressure in PRESSURES:
        point = cell_without_moment(piece, in_MPa(pressure))
        rigidity = cell_without_moment(piece, 0.0).slopes.moment_by_angle
        found.append(float(rigidity * -point.state.angle / (in_MPa(pressure) * LEVER)))
    return found


def main() -> None:
    """Print the table."""
    points, tets, walls, wound = meshed()
    planes = {"clamp": (0, 0.0), "tip": (0, HALF), "sym": (2, 0.0)}
    mesh = name_faces(points, tets, walls, planes)
    body = Body(mesh, "cell", HALF, 2.0 * HALF, -CHANNEL, cavities=("inflated",))
    own = pi * CHAMBER**2
    rows = [["statics, loops of 6.7 mm", *[f"{pi * LOOPS**2 - own:.1f}"] * len(PRESSURES)]]
    for name, loops in (
        ("no loops", None),
        ("loops on the walls of the chambers", wound[CHAMBER]),
        ("loops of 6.7 mm", wound[LOOPS]),
    ):
        rows.append([f"cell, {name}", *(f"{area - own:.1f}" for area in areas(body, loops))])
    rows.append(["needed by the authors", *[f"{NEEDED:.1f}"] * len(PRESSURES)])
    text = table(["mm2 beside the area of the chamber", *(f"at {p:g} kPa" for p in PRESSURES)], rows)
    write_made(COMMAND, text)
    sys.stdout.write(text + "\n")


if __name__ == "__main__":
    main()
