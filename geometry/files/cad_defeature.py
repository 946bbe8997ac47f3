"""CAD solids without faces that are narrower than a given length: fillets, chamfers, dimples, ribs and letters.

Gmsh's defeaturing removes a set of faces and extends their neighbours until they meet. It loses cavities all of whose
edges are rounded, so that each closed surface of a solid is treated as a solid of its own.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Set
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias, final

import numpy as np

from geometry.arrays import Array
from geometry.meshing.shapes import Volume

#: part of its boundary that a face has in common with narrow faces to be the top of a rib or a letter
SURROUNDED = 0.5
#: how often the seam of a closed face counts in the length of its boundary: as in two halves, whose width is then the
#: same however the CAD program divides a hole
SEAM = 4
#: decimals (mm, mm2) by which a face is known again after others have been removed
DECIMALS = 4

#: rounded centre and area of each face of a set
_Key: TypeAlias = frozenset[tuple[float, ...]]
#: sets of faces to remove, in the order in which this is tried
_Trials: TypeAlias = Callable[["Faces", float], Iterator[Set[int]]]


def without_narrow_faces(gmsh: Any, solid: Volume, length: float) -> list[Volume]:
    """The solid of the session without faces narrower than `length` mm, as far as their neighbours can be extended.

    The width of a face is twice its area over the length of its boundary, round faces being divided into halves: for a
    long strip nearly its own width. A rib or a letter goes with its narrow sides. The solid is replaced by those
    returned, of which there is one unless Gmsh has failed.
    """
    occ = gmsh.model.occ
    _, surfaces = occ.getSurfaceLoops(solid[1])
    shells = [(3, int(occ.addVolume([occ.addSurfaceLoop(list(faces))]))) for faces in surfaces]
    occ.synchronize()
    if not any(Faces(gmsh, shell).narrow(length) for shell in shells):
        occ.remove(shells)
        occ.synchronize()
        return [solid]
    occ.remove([solid])
    shells = sorted((_simplified(gmsh, shell, length) for shell in shells), key=lambda shell: -occ.getMass(*shell))
    if len(shells) > 1:
        shells, _ = occ.cut(shells[:1], shells[1:])
    occ.synchronize()
    return [(int(dim), int(tag)) for dim, tag in shells]


def _simplified(gmsh: Any, volume: Volume, length: float) -> Volume:
    """A volume with one closed surface, without narrow faces; replaces it."""
    for trials in (_all_at_once, _one_after_another):
        kept: set[_Key] = set()
        while (changed := _first_without(gmsh, volume, length, trials, kept)) is not None:
            volume = changed
    return volume


def _first_without(gmsh: Any, volume: Volume, length: float, trials: _Trials, kept: set[_Key]) -> Volume | None:
    """The volume without the first set of faces that can be removed, in place of it; None where none can be.

    kept: those that cannot be removed, which are not tried again.
    """
    faces = Faces(gmsh, volume)
    for removed in trials(faces, length):
        if (key := faces.key(removed)) not in kept:
            if (changed := _without(volume, removed, faces, length)) is not None:
                return changed
            kept.add(key)
    return None


def _all_at_once(faces: "Faces", length: float) -> Iterator[Set[int]]:
    """All narrow faces, with what connected sets of them surround, and with what they surround together."""
    narrow = faces.narrow(length)
    if narrow:
        yield narrow
        yield narrow.union(*map(faces.surrounded, faces.connected(narrow)))
        yield narrow | faces.surrounded(narrow)


def _one_after_another(faces: "Faces", length: float) -> Iterator[Set[int]]:
    """Connected sets of narrow faces, each without and with what it surrounds, and several around the same face."""
    narrow = faces.narrow(length)
    groups = faces.connected(narrow)
    for group in groups:
        yield group
        yield group | faces.surrounded(group)
    for top in sorted(faces.surrounded(narrow)):
        yield {top}.union(*(group for group in groups if faces.touch(top, group)))


def _without(volume: Volume, removed: Set[int], faces: "Faces", length: float) -> Volume | None:
    """The volume without a set of faces, in place of it; None, and the volume as it was, where that fails."""
    occ = faces.gmsh.model.occ
    # as much as if each of the faces had moved by the length
    most = length * sum(faces.area(face) for face in removed)
    return without_faces(faces, removed, lambda result: abs(occ.getMass(*result) - occ.getMass(*volume)) <= most)


def without_faces(faces: "Faces", removed: Set[int], accepts: Callable[[Volume], bool]) -> Volume | None:
    """The volume of some faces without a set of them, its other faces extended; it replaces the volume.

    None, and the volume as it was, where Gmsh fails or the result is not accepted.
    """
    gmsh, volume = faces.gmsh, faces.volume
    occ = gmsh.model.occ
    copy = occ.copy([volume])[0]
    occ.synchronize()
    of_copy = dict(zip(faces.tags, Faces(gmsh, copy).tags, strict=True))
    try:
        results = occ.defeature([copy[1]], [of_copy[face] for face in sorted(removed)], True)
    except Exception:  # Gmsh raises nothing more special
        results = []
    occ.synchronize()
    if len(results) == 1 and len(Faces(gmsh, results[0]).tags) < len(faces.tags) and accepts(results[0]):
        occ.remove([volume], recursive=True)
        occ.synchronize()
        return (3, int(results[0][1]))
    occ.remove(results or [copy], recursive=True)
    occ.synchronize()
    return None


@final
@dataclass(frozen=True)
class Faces:
    """The faces of a volume."""

    gmsh: Any
    volume: Volume

    @cached_property
    def tags(self) -> list[int]:
        boundary = self.gmsh.model.getBoundary([self.volume], combined=False, oriented=False)
        return [int(tag) for _, tag in boundary]

    @cached_property
    def curves(self) -> dict[int, dict[int, float]]:
        """Lengths (mm) of the curves around each face, by their tags; a seam counts `SEAM` times."""
        model, lengths = self.gmsh.model, dict[int, float]()
        around: dict[int, dict[int, float]] = {}
        for face in self.tags:
            boundary = Counter(tag for _, tag in model.getBoundary([(2, face)], combined=False, oriented=False))
            for curve in boundary.keys() - lengths.keys():
                lengths[curve] = float(model.occ.getMass(1, curve))
            around[face] = {curve: lengths[curve] * (SEAM if n > 1 else 1) for curve, n in boundary.items()}
        return around

    def area(self, face: int) -> float:
        """mm2"""
        return float(self.gmsh.model.occ.getMass(2, face))

    def middle(self, face: int) -> tuple[float, ...]:
        """Its centre of area (3,), mm."""
        return tuple(float(x) for x in self.gmsh.model.occ.getCenterOfMass(2, face))

    def box(self, face: int) -> Array:
        """Corners (2, 3) of the box around a face, mm."""
        return np.reshape(self.gmsh.model.occ.getBoundingBox(2, face), (2, 3))

    def narrow(self, length: float) -> set[int]:
        """The faces narrower than a length."""
        return {face for face in self.tags if 2.0 * self.area(face) < length * sum(self.curves[face].values())}

    def touch(self, face: int, others: Iterable[int]) -> bool:
        """Whether a face has a curve in common with one of the others."""
        return any(self.curves[face].keys() & self.curves[other].keys() for other in others)

    def connected(self, faces: Iterable[int]) -> list[set[int]]:
        """Sets of faces that are neighbours."""
        left, groups = set(faces), list[set[int]]()
        while left:
            group, front = set[int](), {min(left)}
            while front:
                group |= front
                left -= front
                front = {face for face in left if self.touch(face, front)}
            groups.append(group)
        return groups

    def surrounded(self, group: Set[int]) -> set[int]:
        """Other faces most of whose boundary is that of a set of faces."""
        edges = {curve for face in group for curve in self.curves[face]}
        return {
            face
            for face in set(self.tags) - group
            if sum(size for curve, size in self.curves[face].items() if curve in edges)
            > SURROUNDED * sum(self.curves[face].values())
        }

    def key(self, faces: Iterable[int]) -> _Key:
        """By which a set of faces is known again."""
        return frozenset(tuple(round(x, DECIMALS) for x in (*self.middle(face), self.area(face))) for face in faces)
