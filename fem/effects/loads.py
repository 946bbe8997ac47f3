"""Loads: pressure that follows the surface, weight, and forces of constant direction; and the volume behind faces."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import final

import numpy as np

from fem.discretisation import Discretisation, Faces
from fem.effects.effect import NO_BLOCKS, Blocks, Effect, LoadTerm
from fem.finite import check_finite
from fem.kernels.surface import FaceArrays, surface_pressure, surface_pressure_tangent
from fem.materials.material import Material
from fem.materials.regions import elements_of
from fem.supports import Line, nodes_at
from geometry.arrays import Array


@final
@dataclass(frozen=True)
class Pressure(Effect):
    """Pressure in MPa at load factor 1 on a named face, following the surface: Pi = -p V(x).

    With ramp=False it is applied in full from the first target on. Raises ValueError for a value that is not finite.
    """

    where: str
    value: float
    ramp: bool = True

    def __post_init__(self) -> None:
        check_finite(f"pressure on {self.where!r}: value (MPa)", self.value)

    def bind(self, space: Discretisation, material: Material) -> "PressureTerm":
        """The potential of the pressure; raises ValueError for a face that does not exist."""
        faces = space.surface(self.where)
        return PressureTerm(faces, self.value, constant_fraction=None if self.ramp else 0.0)


#: adds the derivative (n, 3) of minus the volume behind faces by the positions (n, 3), mm2, and gives minus that volume
#: by face (f,), mm3
Flux = Callable[[FaceArrays, Array, Array, Array], None]
#: fills the blocks (f, pair, 3, 3) of the second derivative of minus the volume
FluxTangent = Callable[[FaceArrays, Array, Array], None]


@final
@dataclass(frozen=True, eq=False)  # arrays inside: two terms are the same one or not
class PressureTerm(LoadTerm):
    """-p V(x), V behind faces whose normals point into it; closed by planes through the origin unless `flux` is another
    one."""

    effect = "pressure"

    faces: Faces
    value: float  #: MPa at load factor 1
    flux: Flux = surface_pressure
    tangent: FluxTangent = surface_pressure_tangent

    def energy(self, x: Array, factor: float) -> float:
        return -self._pressure(factor) * enclosed_volume(self.faces, x, self.flux)

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out -= self._pressure(factor) * volume_gradient(self.faces, x, self.flux)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        rows, columns, swapped = self.faces.node_pairs
        values = np.empty((rows.shape[0], 3, 3))
        self.tangent(self.faces.arrays, x, values.reshape(self.faces.nodes.shape[0], -1, 3, 3))
        values *= self._pressure(factor)
        values[swapped] = values[swapped].transpose(0, 2, 1)
        return Blocks(rows, columns, values)

    def _pressure(self, factor: float) -> float:
        return self.value * self.scale(factor)


def enclosed_volume(faces: Faces, x: Array, flux: Flux = surface_pressure) -> float:
    """Volume behind faces whose normals point into it (mm3), closed by planes through the origin by default."""
    volume = np.empty(faces.nodes.shape[0])
    flux(faces.arrays, x, np.zeros_like(x), volume)
    return -float(volume.sum())


def volume_gradient(faces: Faces, x: Array, flux: Flux = surface_pressure) -> Array:
    """Derivative (n, 3) of that volume by the positions x (n, 3), mm2."""
    normals = np.zeros_like(x)
    flux(faces.arrays, x, normals, np.empty(faces.nodes.shape[0]))
    # the faces' normals leave the solid, so the cavity's volume falls along them
    return -normals


@final
@dataclass(frozen=True)
class Gravity(Effect):
    """Weight of the body: density in tonne/mm3, acceleration (3,) in mm/s2 at load factor 1.

    regions: densities of regions of the mesh, by their names.

    With ramp=False it is applied in full from the first target on. Raises ValueError for numbers that are not finite.
    """

    density: float
    acceleration: tuple[float, float, float] = (0.0, -9810.0, 0.0)
    ramp: bool = True
    regions: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_finite("gravity: density (tonne/mm3)", self.density)
        check_finite("gravity: acceleration (mm/s2)", self.acceleration)
        for name, density in self.regions.items():
            check_finite(f"gravity: density of region {name!r} (tonne/mm3)", density)

    def bind(self, space: Discretisation, material: Material) -> "DeadForceTerm":
        """The potential of the consistent nodal weights; raises `MaterialError` for a region that does not exist."""
        mass, density = np.zeros(space.points.shape[0]), np.full(space.nodes.shape[0], self.density)
        for name, of_region in self.regions.items():
            density[elements_of(name, space.regions)] = of_region
        nodal = np.array(space.element.shape.nodal_weights)
        np.add.at(mass, space.nodes, (density * space.volume)[:, None] * nodal)
        force = mass[:, None] * np.asarray(self.acceleration)
        return DeadForceTerm("gravity", force, constant_fraction=None if self.ramp else 0.0)


@final
@dataclass(frozen=True)
class LineForce(Effect):
    """A force that keeps its direction, spread evenly over a line of edges.

    force: (3,) N on the meshed part at load factor 1. With ramp=False it is applied in full from the first target on.
    Raises ValueError for a force that is not finite.
    """

    where: Line
    force: tuple[float, float, float]
    ramp: bool = True

    def __post_init__(self) -> None:
        check_finite("line force: force (N)", self.force)

    def bind(self, space: Discretisation, material: Material) -> "DeadForceTerm":
        """The potential of the nodal forces; raises `fem.supports.SupportError` where the line has no nodes."""
        force = np.zeros_like(space.points)
        np.add.at(force, nodes_at(self.where, space), self.where.nodal_weights(space)[:, None] * np.asarray(self.force))
        return DeadForceTerm("line_force", force, constant_fraction=None if self.ramp else 0.0)


@final
@dataclass(frozen=True, eq=False)  # arrays inside: two terms are the same one or not
class DeadForceTerm(LoadTerm):
    """-f . x with nodal forces that keep their direction."""

    effect: str
    force: Array  #: (n, 3) at load factor 1, N

    def energy(self, x: Array, factor: float) -> float:
        return -self.scale(factor) * float(np.vdot(self.force, x))

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out -= self.scale(factor) * self.force

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        return NO_BLOCKS
