"""A body from a CAD file: its measures and its mesh. Works in the Gmsh session of `geometry.meshing.solid`.

The body is drawn in its frame: x along the length, y up, z across. The air is a box around the body minus the body; the
component of it at the corners of the box is the outside, every other component is a cavity and must be named by a point
in it. Solids of another material are parts, named by a point in each.
"""

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.curved import CurvedEdges
from geometry.errors import DesignError
from geometry.files.cad.checks import BODY, check_curve, check_ends, check_position, check_symmetric, named_parts
from geometry.files.cad.inlets import fill_cad_inlets, hole_advice
from geometry.files.cad.solids import CadBody, bounds, import_solids, is_in_material
from geometry.files.cad.triangles import chambers, gaps
from geometry.files.chambers import Range
from geometry.files.frame import Point, no_end_face
from geometry.files.shells import NOTHING_OPEN
from geometry.grading import Grading
from geometry.mesh import Mesh
from geometry.meshing.mirror import name_faces
from geometry.meshing.shapes import Volume
from geometry.meshing.size_field import find_graded, set_size_field, thinnest_wall
from geometry.meshing.solid import SolidMesh, collect_mesh, generate, optimize, session, walls_between

#: A mesh with a tetrahedron of a smaller radius ratio than this is optimized once more.
FLAT = 0.05
#: Length (mm) of an edge below which it is a point, such as the pole of a sphere.
SHORTEST = 1e-6


@dataclass(frozen=True)
class CadMeasures:
    """Measures of the body, both halves even if only one is meshed."""

    low: Point  #: smallest x, y and z, mm
    high: Point  #: largest x, y and z, mm
    solid_volume: float  #: mm3
    air_volumes: Mapping[str, float]  #: by the name of the cavity, mm3
    chambers: Mapping[str, tuple[Range, ...]]  #: smallest and largest x of each, mm, by the name of the cavity
    part_volumes: Mapping[str, float]  #: by the name of the part, mm3
    plug_depths: Mapping[str, float]  #: of the inlets that are filled, by their names, mm


def measure(body: CadBody) -> CadMeasures:
    """Read the file and check all that can be checked without a mesh. Raises `DesignError` with the config key."""
    with cad_session(body, checked=False) as (gmsh, blocks, air, plug_depths):
        occ = gmsh.model.occ
        halves = 2 if body.half else 1
        volumes = {name: halves * float(occ.getMass(*volume)) for volume, name in air.items()}
        low, high = bounds(gmsh, list(blocks))
        if body.half:
            low = (low[0], low[1], -high[2])
        parts = dict.fromkeys([BODY, *body.parts], 0.0)
        for block, name in blocks.items():
            parts[name] += halves * float(occ.getMass(*block))
        solid_volume = sum(parts.values())
        del parts[BODY]
        of_cavity = chambers(gmsh, air, body.tip - body.clamp)
        return CadMeasures(low, high, solid_volume, volumes, of_cavity, parts, plug_depths)


def measure_gaps(body: CadBody) -> bool:
    """Whether the body has gaps on its outside, as between chambers."""
    with cad_session(body) as (gmsh, blocks, air, _):
        return gaps(gmsh, [*blocks, *air], body.tip - body.clamp)


def edges_of(body: CadBody) -> tuple[tuple[float, str], ...]:
    """Length (mm) of each edge of the solids in the file, and where its middle is, the shortest first."""
    with session() as gmsh:
        import_solids(gmsh, body.source)
        occ = gmsh.model.occ
        edges = [
            (float(occ.getMass(1, tag)), body.words(occ.getCenterOfMass(1, tag), ".3")) for _, tag in occ.getEntities(1)
        ]
    return tuple(sorted(edge for edge in edges if edge[0] > SHORTEST))


def measure_thinnest_wall(body: CadBody) -> float:
    """Thickness of the thinnest wall, mm."""
    with cad_session(body) as (gmsh, blocks, _, _):
        keep_material(gmsh, blocks)
        return thinnest_wall(gmsh, half=body.half)


def keep_material(gmsh: Any, blocks: Collection[Volume]) -> None:
    """Remove the air from the session."""
    gmsh.model.occ.remove([v for v in gmsh.model.getEntities(3) if v not in blocks], recursive=True)
    gmsh.model.occ.synchronize()


def mesh_cad(body: CadBody, size: float, grading: Grading) -> Mesh:
    """Mesh the body with element edges of about `size` mm at most, moved along x so that it is clamped at x = 0.

    Faces: clamp, tip, sym (of a half), the cavities by their names, outer. Regions: the parts.
    """
    with cad_session(body) as (gmsh, blocks, air, _):
        walls = walls_between(gmsh, blocks, air)
        keep_material(gmsh, blocks)
        mesh_session(gmsh, size, grading, body.half, several=bool(body.parts))
        mesh = collect_mesh(gmsh, blocks, walls, [BODY, *body.parts], body.cavities)
    return _named_mesh(body, mesh)


def mesh_session(gmsh: Any, size: float, grading: Grading, half: bool, several: bool = False) -> None:
    """Mesh the volumes of the session with element edges of about `size` mm at most."""
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 16)  # chords of at most pi/8
    gmsh.option.setNumber("Mesh.OptimizeThreshold", 0.2)  # above it HXT tries for seconds what thin walls do not allow
    gmsh.model.mesh.setSize(gmsh.model.getEntities(0), size)
    set_size_field(gmsh, size, grading, find_graded(gmsh, grading, half, mirrored=False))
    generate(gmsh, several)
    optimize(gmsh, FLAT)


def _named_mesh(body: CadBody, mesh: SolidMesh) -> Mesh:
    """The mesh with its clamp at x = 0 and named faces."""
    length = body.tip - body.clamp
    points = in_frame_of(body, mesh.points, (0.0, length))
    planes = {"clamp": (0, 0.0), "tip": (0, length)} | ({"sym": (2, 0.0)} if body.half else {})
    curved = CurvedEdges(mesh.curved.ends, mesh.curved.middles - [body.clamp, 0, 0])
    tets = np.vstack(list(mesh.regions.values()))
    named = name_faces(points, tets, mesh.walls, planes, curved)
    for name in ("clamp", "tip"):
        if name not in named.faces:
            raise no_end_face(name, body.x_in_file(name))
    ends = np.cumsum([len(region) for region in mesh.regions.values()])
    numbers = np.split(np.arange(len(tets)), ends[:-1])
    regions = {name: of_name for name, of_name in zip(mesh.regions, numbers, strict=True) if name != BODY}
    return replace(named, regions=regions)


def in_frame_of(body: CadBody, points: Array, planes: Collection[float]) -> Array:
    """Points (n, 3), mm, moved so that the clamp is at x = 0; those near a plane (x, mm), the height of the curve or
    z = 0 lie there exactly."""
    moved = points - [body.clamp, 0, 0]
    tolerance = 1e-6 * (body.tip - body.clamp)  # files carry about seven digits
    for axis, position in (*((0, x) for x in planes), (1, body.curve), (2, 0.0)):
        moved[np.abs(moved[:, axis] - position) < tolerance, axis] = position
    return moved


@contextmanager
def cad_session(
    body: CadBody, checked: bool = True
) -> Iterator[tuple[Any, dict[Volume, str], dict[Volume, str], dict[str, float]]]:
    """A session with the body: its blocks, cut at the planes of the material curve, with the names of their parts, its
    named cavities, and the depths (mm) of the plugs in its inlets.

    checked: whether `measure` has compared its halves before, which may take seconds.
    """
    with session() as gmsh:
        solids = import_solids(gmsh, body.source)
        low, high = bounds(gmsh, solids)
        check_position(gmsh, body, solids, low, high)
        rounding = 1e-6 * (high[0] - low[0])
        if body.half and abs(high[2]) <= rounding:
            gmsh.model.occ.mirror(solids, 0, 0, 1, 0)  # the half z <= 0, of the file or turned to there
            gmsh.model.occ.synchronize()
            low, high = bounds(gmsh, solids)
        solids, plug_depths = fill_cad_inlets(gmsh, body, solids)
        check_ends(gmsh, body, solids)
        check_curve(gmsh, body, solids, low, high)
        parts = named_parts(gmsh, body, solids, low, high)
        if body.half and low[2] < -rounding:
            for name in () if checked else dict.fromkeys(parts.values()):
                check_symmetric(gmsh, [solid for solid in solids if parts[solid] == name])
            low = (low[0], low[1], 0.0)
        blocks, air = _fragments(gmsh, body, parts, low, high)
        yield gmsh, blocks, _named_air(gmsh, body, blocks, air, low, high), plug_depths


def _fragments(
    gmsh: Any, body: CadBody, parts: Mapping[Volume, str], low: Point, high: Point
) -> tuple[dict[Volume, str], list[Volume]]:
    """The blocks of the body, cut along its material curve, with the names of their parts, and the components of the
    air in a box around it."""
    occ = gmsh.model.occ
    margin = 0.1 * max(np.subtract(high, low))
    start, stop = np.subtract(low, margin), np.add(high, margin)
    if body.half:
        start[2] = 0.0
    # without air before the clamp what is open there is closed
    behind = np.array([body.clamp, *start[1:]]) if body.plug_at_clamp else start
    air, _ = occ.cut([(3, _box(occ, behind, stop))], list(parts), removeObject=True, removeTool=False)
    cuts_y = [start[1], body.curve, stop[1]]
    cuts_z = [0.0, stop[2]] if body.half else [start[2], 0.0, stop[2]]
    windows = [
        ((start[0], y, z), (stop[0], cuts_y[i + 1], cuts_z[k + 1]))
        for i, y in enumerate(cuts_y[:-1])
        for k, z in enumerate(cuts_z[:-1])
    ]
    blocks: list[tuple[Volume, str]] = []
    for corners in windows:
        for solid, name in parts.items():
            window = (3, _box(occ, *corners))
            pieces, _ = occ.intersect(occ.copy([solid]), [window])  # a solid within the window would be returned itself
            blocks += [(volume, name) for volume in pieces if volume[0] == 3]
    occ.remove(list(parts), recursive=True)
    _, children = occ.fragment([volume for volume, _ in blocks] + air, [])
    occ.synchronize()
    inside = {
        child: name for (_, name), pieces in zip(blocks, children, strict=False) for child in pieces if child[0] == 3
    }
    around = {child for pieces in children[len(blocks) :] for child in pieces if child[0] == 3} - inside.keys()
    return dict(sorted(inside.items())), sorted(around)


def _box(occ: Any, low: Any, high: Any) -> int:
    return int(occ.addBox(*low, *np.subtract(high, low)))


def _named_air(
    gmsh: Any, body: CadBody, blocks: Collection[Volume], air: list[Volume], low: Point, high: Point
) -> dict[Volume, str]:
    """The name of each cavity. Raises `DesignError` unless every cavity has exactly one of the given points in it, or
    there is one cavity alone and no point."""
    corner = np.add(high, 0.05 * max(np.subtract(high, low)))
    inner = [volume for volume in air if not gmsh.model.isInside(3, volume[1], list(corner))]
    named: dict[Volume, str] = {}
    for name, point in body.air.items():
        within = body.within_half(point, low, high)
        holder = next((volume for volume in inner if gmsh.model.isInside(3, volume[1], list(within))), None)
        given = f"the point {body.words(point)}"
        if holder is None and is_in_material(gmsh, blocks, within):
            raise DesignError(f"air.{name}", f"{given} lies in the material; give a point in the cavity")
        if holder is None:
            raise DesignError(f"air.{name}", f"{given} lies in no closed cavity; {_remedy(gmsh, body)}")
        if holder in named:
            raise DesignError(f"air.{name}", f"{given} lies in the same cavity as that of {named[holder]}")
        named[holder] = name
    if not body.air and not inner:
        raise DesignError(("air", "file"), f"the body has no closed cavity: {_remedy(gmsh, body)}")
    if not body.air and len(inner) == 1:
        named[inner[0]] = "cavity"
    nameless = [volume for volume in inner if volume not in named and not (body.air and _at_plug(gmsh, body, volume))]
    if nameless:
        places = "; ".join(_middle(gmsh, body, volume) for volume in nameless)
        raise DesignError("air", f"no name for {len(nameless)} cavities, around {places}; give a point in each")
    if body.plug_at_clamp and not any(_at_plug(gmsh, body, volume) for volume in named):
        raise DesignError("plug", NOTHING_OPEN)
    return named


def _remedy(gmsh: Any, body: CadBody) -> str:
    """What to do where the air is open to the outside. The session is of no use afterwards."""
    gmsh.model.occ.remove(gmsh.model.getEntities(3), recursive=True)
    gmsh.model.occ.synchronize()
    solids, _ = fill_cad_inlets(gmsh, body, import_solids(gmsh, body.source))
    ways = ["close its inlet in CAD"]
    if not body.plugs and not body.plug_at_clamp:
        ways.append("write plug: true if it lies in the plane of the clamp")
    ways.append("give a point in its mouth, plug: {inlet: [x, y, z]}")
    return f"{', or '.join(ways)}{hole_advice(gmsh, body, solids)}"


def _at_plug(gmsh: Any, body: CadBody, volume: Volume) -> bool:
    """Whether air without a name is a hole in the face of the clamp, which is not pressurised."""
    return body.plug_at_clamp and gmsh.model.getBoundingBox(*volume)[0] < body.clamp + 1e-5 * (body.tip - body.clamp)


def _middle(gmsh: Any, body: CadBody, volume: Volume) -> str:
    """The centre of a volume, in the frame that the user knows."""
    return body.words(gmsh.model.occ.getCenterOfMass(*volume), ".4")
