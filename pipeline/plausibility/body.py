"""Sentences on the body and its mesh, known before anything is solved."""

import numpy as np

from geometry import Body, Design, Mesh, position_text
from geometry.files.orientation import TURNS
from geometry.topology import OUTWARD, find_rows, normals
from pipeline.config.config import AUTO, Config
from pipeline.identification.too_short import too_coarse

#: smallest radius ratio of an element that is not mentioned: meshes of the families have 0.1 to 0.3, and below this one
#: a mesh of a CAD file is optimized once more
FLAT_ELEMENT = 0.05
#: length of an edge of a CAD file, over the size of the elements, below which it is mentioned
SMALL_EDGE = 1 / 3
#: width of the faces whose removal is suggested then, over the length of the shortest edge
WIDER = 1.1
#: volume of the mesh over that of the drawing, minus 1, from which it is mentioned, and the size that is suggested then
#: over the given one. Curved edges follow round walls to 1e-5; where they would tangle an element, edges are straight
VOLUME_DIFFERS, SMALLER_SIZE = 0.01, 0.7
#: distance of a cavity from the plane of symmetry, over the length of the arm, that is more than rounding
APART = 1e-5
#: difference of two sides of a body, or distance from a plane, over their length or that of the arm, that is rounding
ROUNDING = 1e-6
#: part of the end face of a body outside of its face clamp that is mentioned
FREE_PART = 0.01


def of_half(body: Body) -> str:
    """The sentence on cavities that have a mirror image apart from themselves in a half that is meshed; else empty."""
    if not body.half:
        return ""
    points, faces = body.mesh.points, body.mesh.faces
    away = [name for name in body.cavities if points[faces[name], 2].min() > APART * body.length]
    if not away:
        return ""
    names, verb, them = ", ".join(away), "does" if len(away) == 1 else "do", "it" if len(away) == 1 else "them"
    return (
        f"of the half z >= 0 of the body, {names} {verb} not reach the plane z = 0: the whole body has a mirror image "
        f"of {them} at z < 0, with the same pressure; if it has not, leave geometry.symmetric out where the file holds "
        "the whole arm on one side of z = 0, and write false otherwise"
    )


def of_clamp(body: Body) -> str:
    """The sentence on a face clamp, as a mesh file may name it, that is a part of the end face alone; else empty."""
    mesh = body.mesh
    in_plane = mesh.boundary[(np.abs(mesh.points[mesh.boundary, 0]) <= ROUNDING * body.length).all(axis=1)]
    free = in_plane[find_rows(in_plane, mesh.faces["clamp"], len(mesh.points)) < 0]
    areas = np.linalg.norm(normals(mesh.points[free]), axis=1) / 2
    held = mesh.area("clamp")
    if areas.sum() <= FREE_PART * (areas.sum() + held):
        return ""
    where = position_text(mesh.points[free[int(np.argmax(areas))]].mean(axis=0))
    return (
        f"the face clamp of the mesh leaves out {areas.sum():.3g} of {areas.sum() + held:.3g} mm2 in its plane, such "
        f"as near {where}, where the arm is not held; if all of that end is clamped, name all of it clamp"
    )


def of_directions(design: Design) -> str:
    """The sentence on a body from a file that is shorter than it is high or wide; else empty."""
    if not design.is_from_file:
        return ""
    length, height, width = design.extent
    if length > (1.0 - ROUNDING) * max(height, width):
        return ""
    axis, up = ("y", "x") if height > width else ("z", "y")
    example = "" if design.is_reoriented else f": {TURNS[axis, up]}"
    return (
        f"the body is {length:.3g} mm long along x, which is the direction of the arm from its clamp, and "
        f"{max(height, width):.3g} mm along {axis}; if that is its length, turn it with geometry.axes{example}; "
        "all positions are in the new directions then"
    )


def of_straightened(design: Design) -> str:
    """The sentence on curved edges of a mesh file with which elements would fold; else empty."""
    if not len(middles := design.straightened):
        return ""
    count = f"{len(middles)} curved edges" if len(middles) > 1 else "one curved edge"
    verb, them = ("are", "them") if len(middles) > 1 else ("is", "it")
    return (
        f"{count} of the mesh file {verb} taken as straight, near {position_text(middles[0])}, because an element "
        f"would fold or nearly be flat with {them}; check the middle nodes there, and the volume of the body"
    )


def of_edges(config: Config) -> str:
    """The sentence on edges of a CAD file that are short for the size of the elements, known before meshing; else
    empty."""
    design = config.design
    if config.mesh.size_mm is AUTO or not design.edges:
        return ""
    size = config.mesh.element_size_mm
    small = [edge for edge in design.edges if edge[0] < SMALL_EDGE * size]
    if not small:
        return ""
    length, where = small[0]
    width = round(WIDER * length, 2)
    how = f"with geometry.defeature, for example {width:g} mm, or " if design.can_lose_features(width) else ""
    return (
        f"{len(small)} of the {len(design.edges)} edges in the CAD file are shorter than a third of mesh.size, "
        f"{size:g} mm, the shortest {length:.2g} mm near {where}: elements there are as small, and meshing may take "
        f"minutes; if small fillets, holes and steps do not matter, remove them {how}in the CAD program"
    )


def of_volume(body: Body, config: Config) -> str:
    """The sentence on a mesh that does not follow the round walls of a drawing; else empty."""
    differs = body.volume / config.design.solid_volume - 1.0
    if abs(differs) < VOLUME_DIFFERS:
        return ""
    size = config.mesh.element_size_mm
    or_none = "" if "size" in config.mesh.chosen else ", or leave it out"
    return (
        f"the mesh has {100 * abs(differs):.2g} % {'more' if differs > 0 else 'less'} material than the drawing, "
        f"because elements of {size:.3g} mm cannot follow its round walls; give a smaller mesh.size, for example "
        f"{SMALLER_SIZE * size:.2g} mm{or_none}"
    )


def of_parts(body: Body, config: Config) -> str:
    """The sentence on a solid of a CAD file that has most of the walls of the cavities and is a part; else empty."""
    mesh = body.mesh
    if not config.design.has_parts or not mesh.regions:
        return ""
    walls = np.vstack([mesh.faces[name] for name in body.cavities])
    areas = np.linalg.norm(normals(mesh.points[walls]), axis=1)
    sides = {name: mesh.tets[rows][:, OUTWARD].reshape(-1, 3) for name, rows in mesh.regions.items()}
    within = {name: find_rows(walls, triangles, len(mesh.points)) >= 0 for name, triangles in sides.items()}
    shares = {name: float(areas[inside].sum() / areas.sum()) for name, inside in within.items()}
    name = max(shares, key=lambda part: shares[part])
    of_material = 1.0 - sum(shares.values())
    if shares[name] <= of_material:
        return ""
    volume = config.design.region_volumes[name]
    return (
        f"the solid in which the point of geometry.parts.{name} lies ({volume:.4g} mm3) has "
        f"{100 * shares[name]:.0f} % of the walls of the cavities, and the solids of `material`, which is meant for "
        f"these walls, have {100 * of_material:.0f} %; unless that is right, give a point in another solid"
    )


def of_mesh(mesh: Mesh, design: Design) -> tuple[str, ...]:
    """The sentences on the mesh of a design, known before anything is solved."""
    quality = mesh.quality
    if quality.minimum >= FLAT_ELEMENT:
        return ()
    where = position_text(quality.position)
    return (
        f"the flattest of the {quality.count} elements has a radius ratio of {quality.minimum:.2g} (a regular one "
        f"has 1), near {where}, where stresses may be inaccurate and large deformation may end early; "
        f"{design.against_flat_elements}",
    )


def of_body(body: Body, config: Config) -> tuple[str, ...]:
    """All sentences on the body that was meshed."""
    design = config.design
    of_solids = of_volume(body, config), of_half(body), of_clamp(body), of_parts(body, config), of_directions(design)
    of_elements = *of_mesh(body.mesh, design), of_straightened(design), too_coarse(config, body)
    return tuple(filter(None, (*of_elements, *of_solids)))
