"""The solids of a CAD file, in mm and in the directions of the arm, in the session of `geometry.meshing.solid`."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.errors import DesignError, position_text
from geometry.files.frame import Point
from geometry.meshing.solid import Volume, session

STEP = (".step", ".stp")
SUFFIXES = (*STEP, ".brep", ".brp")
#: difference of two volumes, over the volume, and of their centres, over its cube root, that is rounding
SAME = 1e-6
#: part of the volume of several solids that two of them may have in common, which is rounding
OVERLAP = 1e-6
#: mm by the names of STEP: of units, or of prefixes of the metre
_UNITS = {"INCH": 25.4, "FOOT": 304.8, "$": 1e3, ".DECI.": 100.0, ".CENTI.": 10.0, ".MILLI.": 1.0, ".MICRO.": 1e-3}
#: the end of a BREP file: that of the last shape in the list, and which shape is the whole, its orientation first
_END_OF_BREP = re.compile(rb"\*\s+[+-]\d+ \d+\s*\Z")


@dataclass(frozen=True, eq=False)
class CadSource:
    """A CAD file and how its solids are turned."""

    path: Path
    unit: float | None  #: mm per unit of length of the file; None: mm, and of STEP files the one that they store
    turn: Array  #: (3, 3) rotation into the frame of the arm
    unite: bool  #: whether several solids that touch become one
    apart: bool  #: whether they stay several that have their faces in common, because they are of other materials
    shift: float = 0.0  #: along z, after the rotation, mm


@dataclass(frozen=True)
class CadBody:
    """The solids of a CAD file and how to read them; lengths in mm."""

    source: CadSource
    clamp: float  #: x of the clamped face
    tip: float  #: x of the other end
    curve: float  #: y of the material curve
    half: bool  #: mesh z >= 0 only
    air: Mapping[str, Point]  #: name of a cavity -> a point in it; empty for one cavity alone
    parts: Mapping[str, Point]  #: name of a solid of another material -> a point in it
    plug_at_clamp: bool  #: whether what is open in the plane of the clamp is closed there
    plugs: Mapping[str, Point]  #: name of an inlet that is filled -> a point in its mouth
    turned: bool  #: whether x and z have the other sign than in the file, because the arm is clamped at its larger x
    says_half: bool  #: whether the user has written that the half z >= 0 is to be meshed

    @property
    def middle(self) -> float:
        """z of the plane of the file that becomes z = 0, in the directions of the arm, mm."""
        return self.source.shift if self.turned else -self.source.shift

    def x_in_file(self, end: str) -> float:
        """x of clamp or tip as the user gave it, mm."""
        return float(getattr(self, end)) * (-1 if self.turned else 1)

    @property
    def cavities(self) -> list[str]:
        """Names of the cavities."""
        return list(self.air) or ["cavity"]

    def words(self, point: Point, digits: str = "") -> str:
        """A point of this frame in the one that the user knows; digits: as in a format, such as .4."""
        x, y, z = point
        upright = (-x, y, z if self.half else -z) if self.turned else point
        return position_text((coordinate + 0.0 for coordinate in upright), f"{digits}g")

    def within_half(self, point: Point, low: Point, high: Point) -> Point:
        """A point, or its mirror image in the half z > 0 if that alone is meshed; low, high: bounds of the body, mm."""
        return (point[0], point[1], max(abs(point[2]), 1e-5 * (high[2] - low[2]))) if self.half else point


def import_solids(gmsh: Any, source: CadSource) -> list[Volume]:
    """The solids of the file, in mm: one, or several that touch where they stay apart. Raises `DesignError`."""
    from scipy.spatial.transform import Rotation  # here: what reads no CAD file does not wait for its import

    occ = gmsh.model.occ
    solids = _of_file(gmsh, source)
    turn = Rotation.from_matrix(source.turn).as_rotvec()
    if turn.any():
        occ.rotate(solids, 0, 0, 0, *turn, float(np.linalg.norm(turn)))
    if source.shift:
        occ.translate(solids, 0, 0, source.shift)
    occ.synchronize()
    return solids


def _air(gmsh: Any, source: CadSource, solids: list[Volume]) -> list[Volume]:
    """Those that are left out; none where the user says what several solids are."""
    return _air_among(gmsh, solids) if len(solids) > 1 and not (source.unite or source.apart) else []


def _air_among(gmsh: Any, solids: list[Volume]) -> list[Volume]:
    """Those of several solids that fill a closed cavity of the others, as programs save them that simulate the flow."""
    boxes = {solid: np.array(gmsh.model.getBoundingBox(*solid)).reshape(2, 3) for solid in solids}
    inner = {first for first in solids if any(_is_inside(boxes[first], boxes[second]) for second in solids)}
    walls = [solid for solid in solids if solid not in inner]
    if not inner:
        return []
    occ = gmsh.model.occ
    low, high = np.min([boxes[wall][0] for wall in walls], axis=0), np.max([boxes[wall][1] for wall in walls], axis=0)
    margin = 0.1 * (high - low)
    block = (3, occ.addBox(*(low - margin), *(high - low + 2 * margin)))
    cavities, _ = occ.cut([block], walls, removeObject=True, removeTool=False)
    air = [solid for solid in solids if solid in inner and any(_are_same(occ, solid, cavity) for cavity in cavities)]
    occ.remove(cavities, recursive=True)
    return air


def _is_inside(first: Any, second: Any) -> bool:
    """Whether a box (2, 3) lies in another one and touches none of its sides."""
    return bool((first[0] > second[0]).all() and (first[1] < second[1]).all())


def _are_same(occ: Any, first: Volume, second: Volume) -> bool:
    """Whether two volumes are equally large and have the same centre."""
    size, other = float(occ.getMass(*first)), float(occ.getMass(*second))
    apart = np.linalg.norm(np.subtract(occ.getCenterOfMass(*first), occ.getCenterOfMass(*second)))
    return abs(size - other) <= SAME * size and bool(apart <= SAME * size ** (1 / 3))


def air_left_out(source: CadSource) -> str:
    """The centres of the solids of the file that are left out because they are air, for sentences; empty without."""
    with session() as gmsh:
        return _centres(gmsh, _air(gmsh, source, _all_of_file(gmsh, source)))


def _all_of_file(gmsh: Any, source: CadSource) -> list[Volume]:
    """In mm and in the directions of the file."""
    occ, path = gmsh.model.occ, source.path
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    # `dilate` would make planes and cylinders splines
    is_brep = path.suffix.lower() not in STEP
    scaling = 1.0 if source.unit is None else source.unit / (1.0 if is_brep else _stored_unit(path))
    gmsh.option.setNumber("Geometry.OCCScaling", scaling)
    if is_brep:
        _refuse_truncated(path)
    try:
        occ.importShapes(str(path), format="brep" if is_brep else "step")
    except Exception as error:
        raise DesignError("file", f"{path} cannot be read as STEP or BREP: {error}") from error
    occ.synchronize()
    solids: list[Volume] = gmsh.model.getEntities(3)
    return solids


def _stored_unit(path: Path) -> float:
    """mm, of a STEP file. Raises `DesignError` where it stores none that is known, or several."""
    text = re.sub(r"\s", "", path.read_text(encoding="utf-8", errors="replace")).upper()
    names = re.findall(r"CONVERSION_BASED_UNIT\('(INCH|FOOT)'", text) or re.findall(r"(\$|\.\w+\.),\.METRE\.\)", text)
    if len(set(names)) != 1 or names[0] not in _UNITS:
        raise DesignError("unit", f"{path.name} stores no single unit of length; save it in mm, and leave unit out")
    return _UNITS[names[0]]


def _of_file(gmsh: Any, source: CadSource) -> list[Volume]:
    """In mm and in the directions of the file, without those that are air."""
    occ, path, solids = gmsh.model.occ, source.path, _all_of_file(gmsh, source)
    if air := _air(gmsh, source, solids):
        occ.remove(air, recursive=True)
        occ.synchronize()
        solids = gmsh.model.getEntities(3)
    if not solids:
        raise DesignError("file", f"{path} holds no solid, only surfaces or curves; close them to one solid")
    if any(occ.getMass(*solid) <= 0 for solid in solids):
        raise DesignError("file", f"{path} holds a solid without a volume, which may pass through itself; repair it")
    if len(solids) > 1 and not (source.unite or source.apart):
        ways = "leave out one of air, write unite: true if they touch, or parts: a point in each of another material"
        raise DesignError("file", f"{path} holds {len(solids)} solids, around {_centres(gmsh, solids)}; {ways}")
    if len(solids) > 1:
        solids = _touching(gmsh, solids) if source.apart else _united(gmsh, solids)
    return solids


def _refuse_truncated(path: Path) -> None:
    """Raise `DesignError` for a BREP file that does not end with the shape that it holds: the CAD kernel would wait for
    the rest forever."""
    content = path.read_bytes()
    if b"TShapes" not in content or not _END_OF_BREP.search(content):
        raise DesignError("file", f"{path} is not a complete BREP file; save it again")


def _touching(gmsh: Any, solids: list[Volume]) -> list[Volume]:
    """The solids themselves. Raises `DesignError` where some overlap or do not touch."""
    occ = gmsh.model.occ
    together = sum(float(occ.getMass(*volume)) for volume in solids)
    image = _united(gmsh, occ.copy(solids), "parts")
    common = together - sum(float(occ.getMass(*volume)) for volume in image)
    occ.remove(image, recursive=True)
    occ.synchronize()
    if common > OVERLAP * together:
        raise DesignError("parts", f"the solids overlap in {common:.3g} mm3; subtract one from the other in CAD")
    return solids


def _united(gmsh: Any, solids: list[Volume], key: str = "unite") -> list[Volume]:
    """The one solid that several are together. Raises `DesignError` on `key` where some of them do not touch."""
    occ = gmsh.model.occ
    united, _ = occ.fuse(solids[:1], solids[1:])
    occ.synchronize()
    united = [volume for volume in united if volume[0] == 3]
    if len(united) > 1:
        apart = f"the {len(solids)} solids of the file are {len(united)} parts that do not touch"
        raise DesignError(key, f"{apart}, around {_centres(gmsh, united)}; save the body alone")
    return united


def _centres(gmsh: Any, solids: list[Volume]) -> str:
    """The centres of solids, for sentences."""
    centres = (gmsh.model.occ.getCenterOfMass(*solid) for solid in solids)
    return "; ".join("(" + ", ".join(f"{round(x, 6) + 0.0:.4g}" for x in centre) + ")" for centre in centres)


def file_bounds(source: CadSource) -> tuple[Point, Point]:
    """Corners of the bounding box of the solids of the file, mm. Raises `DesignError` as `import_solids`."""
    with session() as gmsh:
        return bounds(gmsh, import_solids(gmsh, source))


def is_in_material(gmsh: Any, solids: Iterable[Volume], point: Sequence[float] | Array) -> bool:
    """Whether a point (3,), mm, lies in one of the solids or on its surface."""
    return any(gmsh.model.isInside(*solid, list(point)) for solid in solids)


def bounds(gmsh: Any, volumes: list[Volume]) -> tuple[Point, Point]:
    """Corners of the bounding box of some volumes, mm, rounded because the CAD kernel adds a margin of 1e-7.

    Those of splines are the bounds of triangles on them, a few parts in 10^4 of the size too small: the kernel's own
    hold the poles of the splines, which may lie far outside.
    """
    faces = gmsh.model.getBoundary(volumes, combined=False, oriented=False)
    if any("spline" in gmsh.model.getType(*face).lower() for face in faces):
        boxes = _boxes_of_triangles(gmsh, volumes)
    else:
        boxes = np.array([gmsh.model.getBoundingBox(*volume) for volume in volumes])
    left, bottom, near = (round(float(x), 6) + 0.0 for x in boxes[:, :3].min(axis=0))
    right, top, far = (round(float(x), 6) + 0.0 for x in boxes[:, 3:].max(axis=0))
    return (left, bottom, near), (right, top, far)


def _boxes_of_triangles(gmsh: Any, volumes: list[Volume]) -> Array:
    """Bounding boxes (k, 6) of triangles on the volumes. On copies, because the kernel crashes where it moves a volume
    that has triangles."""
    occ = gmsh.model.occ
    copies = occ.copy(volumes)
    occ.synchronize()
    gmsh.option.setNumber("Geometry.OCCBoundsUseStl", 1)
    boxes = np.array([gmsh.model.getBoundingBox(*volume) for volume in copies])
    gmsh.option.setNumber("Geometry.OCCBoundsUseStl", 0)
    occ.remove(copies, recursive=True)
    occ.synchronize()
    return boxes
