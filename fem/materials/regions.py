"""A body of several materials: a law for each region of the mesh, evaluated for the elements of that region."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar, final

import numpy as np

from fem.materials.material import Dilatation, Material, MaterialError, Response
from geometry.arrays import Array, Index

Evaluated = TypeVar("Evaluated", Response, Dilatation)


@final
@dataclass(frozen=True)
class ByRegion:
    """A law for the body, and others for some regions of its mesh (`geometry.Mesh.regions`) by their names.

    Raises `MaterialError` where no region is named.
    """

    body: Material
    regions: Mapping[str, Material]

    def __post_init__(self) -> None:
        if not self.regions:
            raise MaterialError("a body of several materials needs at least one region with a law of its own")


def elements_of(name: str, regions: Mapping[str, Index]) -> Index:
    """The numbers (m,) of a region's elements; raises `MaterialError` for a region that the mesh does not have."""
    if name not in regions:
        known = ", ".join(sorted(regions)) or "no regions"
        raise MaterialError(f"the mesh has no region {name!r}; it has {known}")
    return regions[name]


#: what a body can be made of
Solid = Material | ByRegion


def laws_of(solid: Solid) -> dict[str, Material]:
    """All laws by the name of their region, that of the body first, whose name is empty."""
    return {"": solid.body, **solid.regions} if isinstance(solid, ByRegion) else {"": solid}


@dataclass(frozen=True, eq=False)  # arrays inside
class Laws:
    """The laws of the elements of a mesh: each for some elements. Elements are the first axis of all arrays.

    Regions with equal laws are one part.
    """

    parts: tuple[tuple[Material, Index], ...]  #: laws with the numbers (m,) of their elements
    elements: int

    @classmethod
    def on(cls, solid: Solid, regions: Mapping[str, Index], elements: int) -> "Laws":
        """The laws on a mesh whose regions have these elements.

        Raises `MaterialError` for a region that the mesh does not have.
        """
        if not isinstance(solid, ByRegion):
            return cls(((solid, np.arange(elements)),), elements)
        of_element = np.zeros(elements, dtype=np.int64)
        laws = [solid.body]
        for name, law in solid.regions.items():
            if law not in laws:
                laws.append(law)
            of_element[elements_of(name, regions)] = laws.index(law)
        members = [(law, np.flatnonzero(of_element == number)) for number, law in enumerate(laws)]
        return cls(tuple((law, elements) for law, elements in members if len(elements)), elements)

    @property
    def first(self) -> Material:
        """The law of the body."""
        return self.parts[0][0]

    @cached_property
    def part_of_element(self) -> Index:
        """(e,) number of the part of each element."""
        number = np.empty(self.elements, dtype=np.int64)
        for part, (_, members) in enumerate(self.parts):
            number[members] = part
        return number

    def per_element(self, value: Callable[[Material], float]) -> Array | float:
        """A number of the law of each element, (e, 1); one number where there is one law."""
        if len(self.parts) == 1:
            return value(self.first)
        return np.array([value(law) for law, _ in self.parts])[self.part_of_element][:, None]

    def shear(self, strain: Array) -> Response:
        """Response of the shear part to strain (e, q, 6)."""
        return self._evaluated(strain, lambda law, strain: law.shear(strain))

    def volumetric(self, strain: Array) -> Response:
        """Response of the volumetric part to strain (e, q, 6)."""
        return self._evaluated(strain, lambda law, strain: law.volumetric(strain))

    def dilatation(self, strain: Array) -> Dilatation:
        """theta at strain (e, q, 6)."""
        return self._evaluated(strain, lambda law, strain: law.dilatation(strain))

    def _evaluated(self, strain: Array, evaluate: Callable[[Material, Array], Evaluated]) -> Evaluated:
        if len(self.parts) == 1:
            return evaluate(self.first, strain)
        parts, points = [evaluate(law, strain[members]) for law, members in self.parts], strain.shape[1]
        values = zip(*(vars(part).values() for part in parts), strict=True)
        shapes = (points,), (points, 6), (points, 6, 6)
        return type(parts[0])(*(self._joined(*pair) for pair in zip(values, shapes, strict=True)))

    def _joined(self, values: Sequence[Array], shape: tuple[int, ...]) -> Array:
        """(e, *shape) from the values of each part, which may be the same for all its elements and points."""
        joined = np.empty((self.elements, *shape))
        for (_, members), value in zip(self.parts, values, strict=True):
            joined[members] = value
        return joined
