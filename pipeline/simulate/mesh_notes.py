"""Rules on a meshed body, known before anything is solved."""

import numpy as np

from geometry import Body, Design, Mesh, Reason
from geometry.arrays import Array
from geometry.files.frame import TURNS
from geometry.topology import OUTWARD, find_rows, normals
from pipeline.config.config import Config
from pipeline.simulate.too_short import too_coarse

#: smallest radius ratio of an element that is not mentioned: meshes of the families have 0.1 to 0.3, and below this one
#: a mesh of a CAD file is optimized once more
FLAT_ELEMENT = 0.05
#: volume of the mesh over that of the drawing, minus 1, from which it is mentioned, and the size that is suggested then
#: over the given one. Curved edges follow round walls to 1e-5; where they would tangle an element, edges are straight
VOLUME_DIFFERS, SMALLER_SIZE = 0.01, 0.7
#: distance of a cavity from the plane of symmetry, over the length of the arm, that is more than rounding
APART = 1e-5
#: difference of two sides of a body, or distance from a plane, over their length or that of the arm, that is rounding
ROUNDING = 1e-6
#: part of the end face of a body outside of its face clamp that is mentioned
FREE_PART = 0.01


def check_body(body: Body, config: Config) -> tuple[Reason, ...]:
    """What is unusual about the body that was meshed."""
    design = config.design
    of_mesh = check_mesh(body.mesh), straightened_edges(design), too_coarse(config, body), volume_differs(body, config)
    of_file = mirrored_cavity(body), partial_clamp(body), part_with_walls(body, config), not_along_x(design)
    return tuple(filter(None, (*of_mesh, *of_file)))


def check_mesh(mesh: Mesh) -> Reason | None:
    """Flat elements, where stresses may be inaccurate and large deformation may end early."""
    quality = mesh.quality
    if quality.minimum >= FLAT_ELEMENT:
        return None
    return Reason("flat_element", {"radius_ratio": quality.minimum, "count": quality.count}, quality.position)


def straightened_edges(design: Design) -> Reason | None:
    """Curved edges of a mesh file with which elements would fold."""
    if not len(middles := design.straightened):
        return None
    return Reason("straightened_edges", {"count": len(middles)}, _place(middles[0]))


def volume_differs(body: Body, config: Config) -> Reason | None:
    """A mesh that does not follow the round walls of a drawing."""
    differs, size = body.volume / config.design.solid_volume - 1.0, config.mesh.size_mm
    if abs(differs) < VOLUME_DIFFERS:
        return None
    return Reason("volume_differs", {"percent": 100 * differs, "size_mm": float(f"{SMALLER_SIZE * size:.2g}")})


def mirrored_cavity(body: Body) -> Reason | None:
    """Cavities of a meshed half that do not reach its plane of symmetry."""
    points, faces = body.mesh.points, body.mesh.faces
    away = [name for name in body.cavities if body.half and points[faces[name], 2].min() > APART * body.length]
    return Reason("mirrored_cavity", {"cavities": away}) if away else None


def partial_clamp(body: Body) -> Reason | None:
    """A face clamp, as a mesh file may name it, that is a part of the end face alone."""
    mesh = body.mesh
    in_plane = mesh.boundary[(np.abs(mesh.points[mesh.boundary, 0]) <= ROUNDING * body.length).all(axis=1)]
    free = in_plane[find_rows(in_plane, mesh.faces["clamp"], len(mesh.points)) < 0]
    areas = np.linalg.norm(normals(mesh.points[free]), axis=1) / 2
    plane = areas.sum() + mesh.area("clamp")
    if areas.sum() <= FREE_PART * plane:
        return None
    where = mesh.points[free[int(np.argmax(areas))]].mean(axis=0)
    return Reason("partial_clamp", {"free_mm2": float(areas.sum()), "plane_mm2": float(plane)}, _place(where))


def part_with_walls(body: Body, config: Config) -> Reason | None:
    """A solid of a CAD file that is a part of another material and has most of the walls of the cavities."""
    mesh = body.mesh
    if not config.design.has_parts or not mesh.regions:
        return None
    walls = np.vstack([mesh.faces[name] for name in body.cavities])
    areas = np.linalg.norm(normals(mesh.points[walls]), axis=1)
    sides = {name: mesh.tets[rows][:, OUTWARD].reshape(-1, 3) for name, rows in mesh.regions.items()}
    within = {name: find_rows(walls, triangles, len(mesh.points)) >= 0 for name, triangles in sides.items()}
    percents = {name: float(100 * areas[inside].sum() / areas.sum()) for name, inside in within.items()}
    name = max(percents, key=lambda part: percents[part])
    of_material = 100.0 - sum(percents.values())
    if percents[name] <= of_material:
        return None
    shares = {"percent": percents[name], "percent_of_material": of_material}
    return Reason("part_has_walls", {"part": name, "volume_mm3": config.design.region_volumes[name], **shares})


def not_along_x(design: Design) -> Reason | None:
    """A body from a file, not turned by its user, that is shorter along x than it is high or wide."""
    if not design.is_from_file or design.is_reoriented:
        return None
    length, height, width = design.extent
    if length > (1.0 - ROUNDING) * max(height, width):
        return None
    axis, up = ("y", "x") if height > width else ("z", "y")
    sides = {"length_mm": length, "longest_mm": max(height, width)}
    return Reason("not_along_x", {**sides, "axis": axis, "axes": TURNS[axis, up]})


def _place(point: Array) -> tuple[float, float, float]:
    x, y, z = map(float, point)
    return x, y, z
