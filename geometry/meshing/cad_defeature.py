"""CAD solids without faces that are narrower than a given length: fillets, chamfers, dimples, steps and letters.

Gmsh's defeaturing removes a set of faces and extends their neighbours until they meet. It loses cavities all of whose
edges are rounded, so that each closed surface of a solid is treated as a solid of its own.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias, final

from geometry.meshing.shapes import Volume

#: part of its boundary that a face has in common with narrow faces to be the top of a step or a letter
SURROUNDED = 0.5
#: decimals (mm) by which a face is known again after others have been removed
DECIMALS = 4

#: rounded centre of each face of a set
_Key: TypeAlias = frozenset[tuple[float, ...]]


def without_narrow_faces(gmsh: Any, solids: Iterable[Volume], length: float) -> list[Volume]:
    """The solids of the session without faces narrower than `length` mm, as far as their neighbours can be extended.

    The width of a face is twice its area over the length of its boundary: nearly that of a strip, and the radius of a
    disc. A step goes with its narrow sides. The solids are replaced.
    """
    return [_simplified_solid(gmsh, solid, length) for solid in solids]


def _simplified_solid(gmsh: Any, solid: Volume, length: float) -> Volume:
    occ = gmsh.model.occ
    _, surfaces = occ.getSurfaceLoops(solid[1])
    shells = [(3, int(occ.addVolume([occ.addSurfaceLoop(list(faces))]))) for faces in surfaces]
    occ.synchronize()
    if not any(_Faces(gmsh, shell).narrow(length) for shell in shells):
        occ.remove(shells)
        occ.synchronize()
        return solid
    occ.remove([solid])
    shells = sorted((_simplified(gmsh, shell, length) for shell in shells), key=lambda shell: -occ.getMass(*shell))
    if len(shells) > 1:
        occ.cut(shells[:1], shells[1:])
    occ.synchronize()
    return shells[0]


def _simplified(gmsh: Any, volume: Volume, length: float) -> Volume:
    """A volume with one closed surface, without narrow faces; replaces it."""
    kept: set[_Key] = set()
    together = True
    while True:
        faces = _Faces(gmsh, volume)
        groups = [group for group in faces.connected(faces.narrow(length)) if faces.key(group) not in kept]
        together = together and len(groups) > 1
        trials = [groups] if together else []
        trials += [[group] for group in groups]
        for trial in trials:
            if (changed := _without(gmsh, volume, trial, faces, length)) is not None:
                volume = changed
                break
            if len(trial) > 1:
                together = False
            else:
                kept.add(faces.key(trial[0]))
        else:
            return volume


def _without(
    gmsh: Any, volume: Volume, groups: Sequence[Sequence[int]], faces: "_Faces", length: float
) -> Volume | None:
    """The volume without sets of faces, or without these and what they surround, in place of it; None and the volume
    as it was where Gmsh cannot remove them."""
    occ = gmsh.model.occ
    narrow = {face for group in groups for face in group}
    for removed in (narrow, narrow.union(*(faces.surrounded(group) for group in groups))):
        copy = occ.copy([volume])[0]
        occ.synchronize()
        of_copy = dict(zip(faces.tags, _Faces(gmsh, copy).tags, strict=True))
        try:
            results = occ.defeature([copy[1]], [of_copy[face] for face in sorted(removed)], True)
        except Exception:  # Gmsh raises nothing more special
            results = []
        occ.synchronize()
        # no face moves by more than the length
        most = length * sum(faces.area(face) for face in removed)
        is_near = len(results) == 1 and abs(occ.getMass(*results[0]) - occ.getMass(*volume)) <= most
        if is_near and len(_Faces(gmsh, results[0]).tags) < len(faces.tags):
            occ.remove([volume], recursive=True)
            occ.synchronize()
            return (3, int(results[0][1]))
        occ.remove(results or [copy], recursive=True)
        occ.synchronize()
    return None


@final
@dataclass(frozen=True)
class _Faces:
    """The faces of a volume."""

    gmsh: Any
    volume: Volume

    @cached_property
    def tags(self) -> list[int]:
        boundary = self.gmsh.model.getBoundary([self.volume], combined=False, oriented=False)
        return [int(tag) for _, tag in boundary]

    @cached_property
    def curves(self) -> dict[int, dict[int, float]]:
        """Lengths (mm) of the curves around each face, by their tags."""
        model, lengths = self.gmsh.model, dict[int, float]()
        around: dict[int, dict[int, float]] = {}
        for face in self.tags:
            around[face] = {}
            for _, curve in model.getBoundary([(2, face)], combined=False, oriented=False):
                if curve not in lengths:
                    lengths[curve] = float(model.occ.getMass(1, curve))
                around[face][curve] = lengths[curve]
        return around

    def area(self, face: int) -> float:
        """mm2"""
        return float(self.gmsh.model.occ.getMass(2, face))

    def narrow(self, length: float) -> list[int]:
        """The faces narrower than a length."""
        return [face for face in self.tags if 2.0 * self.area(face) < length * sum(self.curves[face].values())]

    def connected(self, faces: Iterable[int]) -> list[list[int]]:
        """Sets of faces that are neighbours."""
        left, groups = set(faces), list[list[int]]()
        while left:
            group, front = list[int](), [min(left)]
            left -= set(front)
            while front:
                face = front.pop()
                group.append(face)
                near = {other for other in left if self.curves[other].keys() & self.curves[face].keys()}
                left -= near
                front += sorted(near)
            groups.append(group)
        return groups

    def surrounded(self, group: Sequence[int]) -> Iterator[int]:
        """Other faces most of whose boundary is that of a set of faces."""
        edges = {curve for face in group for curve in self.curves[face]}
        for face in set(self.tags) - set(group):
            lengths = self.curves[face]
            common = sum(length for curve, length in lengths.items() if curve in edges)
            if common > SURROUNDED * sum(lengths.values()):
                yield face

    def key(self, faces: Iterable[int]) -> _Key:
        """By which a set of faces is known again."""
        centre = self.gmsh.model.occ.getCenterOfMass
        return frozenset(tuple(round(float(x), DECIMALS) for x in centre(2, face)) for face in faces)
