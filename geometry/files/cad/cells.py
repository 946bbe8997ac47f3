"""The cells of a solid from a CAD file: where they lie, and its ends and half a cell meshed to be repeated.

Two planes of mirror symmetry say where: x = start in the middle of a cell and x = stop between two cells. The space
between them and each of its neighbours must be mirror images of each other; further ones are cells as long as they are.
In the Gmsh session of `geometry.meshing.solid`.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import floor, pi
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.curved import CurvedEdges
from geometry.errors import DesignError
from geometry.files.cad.body import cad_session, in_frame_of, keep_material, mesh_session
from geometry.files.cad.mirror import Difference, are_same, box, difference, moments
from geometry.files.cad.solids import CadBody
from geometry.files.frame import CellPlanes
from geometry.grading import Grading
from geometry.meshing.mirror import Repetition
from geometry.meshing.shapes import Volume
from geometry.meshing.solid import SolidMesh, collect_mesh, walls_between

#: part of the volume of half a cell by which another one may differ from it
SAME = 1e-4
#: smallest length of half a cell over that of the body
SHORTEST = 1e-3


@dataclass(frozen=True)
class Cells:
    """Where equal cells lie in a body; lengths in mm from its clamp."""

    first: float  #: middle of the first cell
    half_pitch: float
    half_cells: int  #: between the middles of the first and of the last cell, even
    start: float  #: middle of the cell that was compared with its neighbours
    turned: tuple[str, ...] = ()  #: cavities, as in `Repetition`


def find_cells(body: CadBody, planes: CellPlanes) -> Cells:
    """All cells that equal the one of the planes. Raises `DesignError` on `cell` for planes that are none of mirror
    symmetry, with what differs and where."""
    half_pitch, length = planes.half_pitch, body.tip - body.clamp
    for key, x in (("from", planes.start), ("to", planes.stop)):
        if not body.clamp <= x <= body.tip:
            reach = f"which reaches from {body.clamp:g} to {body.tip:g} mm"
            raise DesignError(f"cell.{key}", f"x = {x:g} mm lies outside the arm, {reach}")
    if not half_pitch > SHORTEST * length:
        raise DesignError("cell", f"the planes are {half_pitch:g} mm apart; give two planes with half a cell between")
    with cad_session(body) as (gmsh, blocks, air, _):
        turned = () if body.half else _turned(gmsh, body, blocks, air)
        return replace(_cells(gmsh, body, blocks, planes), turned=turned)


def _cells(gmsh: Any, body: CadBody, blocks: Collection[Volume], planes: CellPlanes) -> Cells:
    low, half_pitch = min(planes.start, planes.stop), planes.half_pitch
    first, last = _Slots(gmsh, body, blocks, low, half_pitch).equal_to_the_first()
    odd = int(planes.stop < planes.start)  # of the numbers of the planes in the middle of a cell
    middles = first + (first + odd) % 2, last - (last + odd) % 2
    if middles[1] - middles[0] < 2:
        repeated = (last - first) * half_pitch
        raise DesignError("cell", f"the body repeats its cell only on {repeated:.4g} mm; two cells are needed")
    first_middle = low - body.clamp + middles[0] * half_pitch
    return Cells(first_middle, half_pitch, middles[1] - middles[0], planes.start - body.clamp)


def mesh_cells(body: CadBody, cells: Cells, size: float, grading: Grading) -> Repetition:
    """Both ends of the body and half a cell, meshed with element edges of about `size` mm at most.

    Raises `DesignError` for a cavity that does not go through the cells.
    """
    middle, length, h = cells.first, body.tip - body.clamp, cells.half_pitch
    edge, shift = middle + h, (cells.half_cells - 2) * h
    windows = {
        "end": (-length, middle, 0.0),
        "cell": (cells.start, cells.start + h, cells.start - middle),
        "far": (edge + shift, 2 * length, shift),
    }
    with cad_session(body) as (gmsh, blocks, air, _):
        owners = {**dict.fromkeys(blocks, ""), **air}
        material, cavities = _fragmented(gmsh, body, owners, windows)
        walls = walls_between(gmsh, material, cavities)
        keep_material(gmsh, list(material))
        mesh_session(gmsh, size, grading, body.half)
        mesh = collect_mesh(gmsh, material, walls, list(windows), body.cavities)
    points = in_frame_of(body, mesh.points, (0.0, middle, edge, length - shift))
    within = np.unique(mesh.regions["cell"])
    for name, triangles in mesh.walls.items():
        if not np.isin(triangles, within).all(axis=1).any():
            sentence = f"the cavity {name} does not go through the cell; equal cells are in the same cavities"
            raise DesignError(("cell", f"air.{name}"), sentence)
    origin = np.array([body.clamp, 0.0, 0.0])
    last = length - middle - cells.half_cells * h
    return Repetition(
        SolidMesh(points, mesh.regions, mesh.walls, CurvedEdges(mesh.curved.ends, mesh.curved.middles - origin)),
        *(middle, edge, cells.half_cells, last),
        half=body.half,
        turned=cells.turned,
    )


def _turned(gmsh: Any, body: CadBody, blocks: Mapping[Volume, str], air: Mapping[Volume, str]) -> tuple[str, ...]:
    """Cavities each of which comes to the place of the next one, with the whole body on itself, when it is turned about
    its material curve by a full turn over their number; empty where it does not."""
    occ, names = gmsh.model.occ, list(dict.fromkeys(air.values()))

    def comes_to(volumes: list[Volume], others: list[Volume]) -> bool:
        copies = occ.copy(volumes)
        occ.rotate(copies, 0, body.curve, 0, 1, 0, 0, 2.0 * pi / len(names))
        is_same = are_same(gmsh, others, copies, SAME)
        occ.remove(copies, recursive=True)
        occ.synchronize()
        return is_same

    def of(owners: Mapping[Volume, str], name: str) -> list[Volume]:
        return [volume for volume, owner in owners.items() if owner == name]

    order = names[:1]
    while len(names) > 1 and len(order) < len(names):
        left = [name for name in names if name not in order]
        following = (name for name in left if comes_to(of(air, order[-1]), of(air, name)))
        if (found := next(following, None)) is None:
            return ()
        order.append(found)
    whole = all(comes_to(part, part) for part in (of(blocks, name) for name in dict.fromkeys(blocks.values())))
    return tuple(order) if len(names) > 1 and whole else ()


def _fragmented(
    gmsh: Any, body: CadBody, owners: dict[Volume, str], windows: dict[str, tuple[float, float, float]]
) -> tuple[dict[Volume, str], dict[Volume, str]]:
    """Material by region and air by name, cut along x by the windows (low, high, shift in mm from the clamp).

    owners: the name of the air, empty for material. What is in a window is shifted back by its shift.
    """
    occ = gmsh.model.occ
    parts: list[tuple[Volume, str, str]] = []
    for region, (low, high, shift) in windows.items():
        for volume, name in owners.items():
            cut = _between(gmsh, [volume], body.clamp + low, body.clamp + high)
            if cut and shift:
                occ.translate(cut, -shift, 0, 0)
            parts += [(part, region, name) for part in cut]
    occ.remove(list(owners), recursive=True)
    _, children = occ.fragment([part for part, _, _ in parts], [])
    occ.synchronize()
    material: dict[Volume, str] = {}
    air: dict[Volume, str] = {}
    for (_, region, name), pieces in zip(parts, children, strict=True):
        for piece in pieces:
            if name:
                air[piece] = name
            else:
                material[piece] = region
    return material, air


def _between(gmsh: Any, volumes: list[Volume], low: float, high: float) -> list[Volume]:
    """Copies of what the volumes have between x = low and x = high, mm."""
    occ = gmsh.model.occ
    (_, y, z), (_, top, far) = box(gmsh, volumes) + np.array([[-1.0], [1.0]])
    window = (3, occ.addBox(low, y, z, high - low, top - y, far - z))
    parts, _ = occ.intersect(occ.copy(volumes), [window])  # a volume within the window would be returned itself
    return [part for part in parts if part[0] == 3]


class _Slots:
    """Half cells of a body one after the other, number 0 between the two planes."""

    def __init__(self, gmsh: Any, body: CadBody, blocks: Collection[Volume], start: float, half_pitch: float) -> None:
        self.gmsh = gmsh
        self.body = body
        self.start, self.h = start, half_pitch
        self.slots: dict[int, list[Volume]] = {}
        before, behind = start - body.clamp, body.tip - start
        numbers = range(-floor(before / half_pitch), floor(behind / half_pitch) + 1)
        for volume in _cut_at(gmsh, blocks, [self._position(number) for number in numbers]):
            x = gmsh.model.occ.getCenterOfMass(*volume)[0]
            self.slots.setdefault(floor((x - start) / half_pitch), []).append(volume)

    def equal_to_the_first(self) -> tuple[int, int]:
        """Numbers of the first and the last plane between which all slots equal number 0.

        Raises `DesignError` where one of its neighbours is not its mirror image.
        """
        ends = []
        for side in (-1, 1):
            if not self._is_within(side):
                raise DesignError("cell", f"beside x = {self._told(max(side, 0)):g} mm is no room for a half cell")
            self._check_neighbour(side)
            number = side
            while self._is_within(number + side) and self._is_equal(number + side):
                number += side
            ends.append(number)
        return ends[0], ends[1] + 1

    def _position(self, number: int) -> float:
        """x of a plane, mm."""
        return self.start + number * self.h

    def _told(self, number: int) -> float:
        """The same as the user knows it."""
        return (-1.0 if self.body.turned else 1.0) * self._position(number)

    def _is_within(self, number: int) -> bool:
        margin = 1e-6 * (self.body.tip - self.body.clamp)
        low, high = self._position(number), self._position(number + 1)
        return low >= self.body.clamp - margin and high <= self.body.tip + margin

    def _moments(self, number: int) -> Array:
        """Volume, first and second moments (10,) of a slot about its own middle, mm to mm5."""
        middle = [self._position(number) + 0.5 * self.h, 0.0, 0.0]
        return np.asarray(moments(self.gmsh, self.slots[number], middle)[np.triu_indices(4)])

    @cached_property
    def _first(self) -> Array:
        """The moments of slot 0."""
        return self._moments(0)

    def _is_equal(self, number: int) -> bool:
        """Whether a slot has the volume and the moments of number 0, or of its mirror image."""
        if number not in self.slots:
            return False
        sign = np.array([1.0, -1.0, 1.0, 1.0])[:, None] ** (number % 2)
        expected = self._first * (sign @ sign.T)[np.triu_indices(4)]
        size = np.array([1.0, *np.ptp(box(self.gmsh, self.slots[0]), axis=0)])
        allowed = SAME * self._first[0] * np.outer(size, size)[np.triu_indices(4)]
        return bool((np.abs(self._moments(number) - expected) <= allowed).all())

    def _check_neighbour(self, number: int) -> None:
        """Raise `DesignError` unless a neighbour of slot 0 is its mirror image."""
        slot, at = self.slots.get(number, []), self._position(max(number, 0))
        found = difference(self.gmsh, slot, self.slots[0], 0, at, SAME) if slot else Difference(True)
        if found.exists:
            around = f", around {self.body.words(found.centre, '.4')}" if found.centre else ""
            plane = f"the body is not symmetric about the plane x = {self._told(max(number, 0)):g} mm"
            raise DesignError("cell", f"{plane}: the material beside it differs{around}")


def _cut_at(gmsh: Any, blocks: Collection[Volume], positions: list[float]) -> list[Volume]:
    """The blocks, cut at the planes x = position (mm)."""
    occ = gmsh.model.occ
    (_, y, z), (_, top, far) = box(gmsh, blocks)
    height, width = 2 * (top - y), 2 * (far - z)
    planes = []
    for x in positions:
        sheet = occ.addRectangle(-width / 2, -height / 2, 0, width, height)
        occ.rotate([(2, sheet)], 0, 0, 0, 0, 1, 0, pi / 2)  # its sides were along x and y
        occ.translate([(2, sheet)], x, (y + top) / 2, (z + far) / 2)
        planes.append((2, sheet))
    _, children = occ.fragment(list(blocks), planes)
    # what lies around the blocks; parts of a sheet that have become faces of a block stay
    occ.remove([part for parts in children[len(blocks) :] for part in parts if part[0] == 2], recursive=True)
    return [part for parts in children[: len(blocks)] for part in parts if part[0] == 3]
