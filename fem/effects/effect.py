"""Effects: what acts on the body besides its elasticity. One object each; an effect that is off is not in the sum.

An `Effect` is a value the user writes; bound to a discretisation it becomes a `Term` of the total potential with
energy, gradient and second derivative.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from fem.discretisation import Discretisation, Faces
from fem.kernels.surface import surface_pressure, surface_pressure_tangent
from fem.materials.material import Material
from fem.supports import Line, nodes_at
from geometry.arrays import Array, Index, Mask


@dataclass(frozen=True)
class Blocks:
    """Second derivative of a term by node pairs rows <= columns; the mirror image of off-diagonal blocks is implied."""

    rows: Index  #: (m,)
    columns: Index  #: (m,)
    values: Array  #: (m, 3, 3), N/mm


class Term(ABC):
    """A term of the total potential; x (n, 3) are current positions in mm, factor is the load factor."""

    effect: str  #: name of the effect as in a config
    forgiving = True  #: whether Newton's method may begin at a state that the term objects to

    @abstractmethod
    def energy(self, x: Array, factor: float) -> float:
        """Potential, N mm."""

    @abstractmethod
    def gradient(self, x: Array, factor: float, out: Array) -> None:
        """Add d Pi / d x (n, 3), N, to out."""

    @abstractmethod
    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        """Second derivative; `convex` asks for a positive semi-definite substitute where the term can give one."""

    @abstractmethod
    def step_limit(self, x: Array, dx: Array) -> float:
        """Largest share of the step dx (n, 3) in (0, 1] that the term admits."""

    @abstractmethod
    def wanted(self, x: Array) -> bool:
        """Whether the term must be in the sum once a state without it was found at x (n, 3)."""

    @abstractmethod
    def objection(self, x: Array) -> str:
        """Why a converged state x (n, 3) cannot be accepted, in a clause; empty where it can."""

    @abstractmethod
    def stricter(self, x: Array) -> "Term":
        """The term to try where this one objected to the state x (n, 3); the term itself where there is no other."""

    @abstractmethod
    def gap(self, x: Array) -> float:
        """Smallest distance in mm between parts of the body that the term keeps apart; infinity for other terms."""

    @abstractmethod
    def touching(self, x: Array) -> bool:
        """Whether the term keeps parts of the body apart at x (n, 3)."""

    @abstractmethod
    def at(self, share: float) -> "Term":
        """The term while what does not grow with the load factor has come to `share` of its size."""

    @abstractmethod
    def advanced(self, x: Array, dx: Array) -> "Term":
        """The term after Newton's step dx (n, 3) from x, with the stress carried on; itself where it carries none."""


class Acting(Term):
    """A term that is in the sum from the start and that no state can violate."""

    @final
    def step_limit(self, x: Array, dx: Array) -> float:
        """1: any step."""
        return 1.0

    @final
    def wanted(self, x: Array) -> bool:
        """True."""
        return True

    @final
    def objection(self, x: Array) -> str:
        """None."""
        return ""

    @final
    def stricter(self, x: Array) -> Term:
        """The term itself."""
        return self

    @final
    def gap(self, x: Array) -> float:
        """Infinity: it keeps nothing apart."""
        return np.inf

    @final
    def touching(self, x: Array) -> bool:
        """False."""
        return False


class Effect(ABC):
    """What a user asks to be simulated."""

    @abstractmethod
    def bind(self, space: Discretisation, material: Material) -> Term:
        """The term of the potential this effect adds on the given discretisation."""


@final
@dataclass(frozen=True)
class Pressure(Effect):
    """Pressure in MPa at load factor 1 on a named face, following the surface: Pi = -p V(x).

    With ramp=False it is whole from the first asked factor on.
    """

    where: str
    value: float
    ramp: bool = True

    def bind(self, space: Discretisation, material: Material) -> Term:
        faces = space.surface(self.where)
        a, b = np.triu_indices(faces.nodes.shape[1])
        first, second = faces.nodes[:, a], faces.nodes[:, b]
        return PressureTerm(
            faces,
            self.value,
            np.minimum(first, second).ravel(),
            np.maximum(first, second).ravel(),
            (first > second).ravel(),
            None if self.ramp else 0.0,
        )


@final
@dataclass(frozen=True, eq=False)  # arrays inside: two terms are the same one or not
class PressureTerm(Acting):
    """-p V(x), V enclosed by the faces and symmetry planes through the origin."""

    effect = "pressure"

    faces: Faces
    value: float
    rows: Index  #: (m f,), of the m = 21 or 6 pairs of nodes of each face
    columns: Index  #: (m f,)
    swapped: Mask  #: (m f,) pairs whose first node has the larger number
    held: float | None  #: share of the value reached so far; None where it grows with the load factor

    def energy(self, x: Array, factor: float) -> float:
        return -self._pressure(factor) * enclosed_volume(self.faces, x)

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out -= self._pressure(factor) * volume_gradient(self.faces, x)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        values = np.empty((self.rows.shape[0], 3, 3))
        surface_pressure_tangent(self.faces.arrays, x, values.reshape(self.faces.nodes.shape[0], -1, 3, 3))
        values *= self._pressure(factor)
        values[self.swapped] = values[self.swapped].transpose(0, 2, 1)
        return Blocks(self.rows, self.columns, values)

    def at(self, share: float) -> Term:
        return self if self.held is None else replace(self, held=share)

    def advanced(self, x: Array, dx: Array) -> Term:
        return self

    def _pressure(self, factor: float) -> float:
        return self.value * (factor if self.held is None else self.held)


def enclosed_volume(faces: Faces, x: Array) -> float:
    """Volume enclosed by faces whose normals point into it (mm3), closed by planes through the origin."""
    volume = np.empty(faces.nodes.shape[0])
    surface_pressure(faces.arrays, x, np.zeros_like(x), volume)
    return -float(volume.sum())


def volume_gradient(faces: Faces, x: Array) -> Array:
    """Derivative (n, 3) of the enclosed volume by the positions x (n, 3), mm2."""
    normals = np.zeros_like(x)
    surface_pressure(faces.arrays, x, normals, np.empty(faces.nodes.shape[0]))
    # the faces' normals leave the solid, so the cavity's volume falls along them
    return -normals


@final
@dataclass(frozen=True)
class Gravity(Effect):
    """Weight of the body: density in tonne/mm3, acceleration (3,) in mm/s2 at load factor 1.

    With ramp=False it is whole from the first asked factor on.
    """

    density: float
    acceleration: tuple[float, float, float] = (0.0, -9810.0, 0.0)
    ramp: bool = True

    def bind(self, space: Discretisation, material: Material) -> Term:
        volume = space.weight[:, :4].sum(axis=1)
        mass = np.zeros(space.points.shape[0])
        # exact integrals of the shape functions over a tetrahedron: quadratic -V/20 at vertices, V/5 at mid-edges
        share = np.array([-0.05] * 4 + [0.2] * 6 if space.has_middles else [0.25] * 4)
        np.add.at(mass, space.nodes, self.density * volume[:, None] * share)
        return DeadForceTerm("gravity", mass[:, None] * np.asarray(self.acceleration), None if self.ramp else 0.0)


@final
@dataclass(frozen=True)
class LineForce(Effect):
    """A force that keeps its direction, spread evenly over a line of edges.

    force: (3,) N on the meshed part at load factor 1. With ramp=False it is whole from the first asked factor on.
    """

    where: Line
    force: tuple[float, float, float]
    ramp: bool = True

    def bind(self, space: Discretisation, material: Material) -> Term:
        forces = np.zeros_like(space.points)
        weights = self.where.nodal_weights(space)
        np.add.at(forces, nodes_at(self.where, space), weights[:, None] * np.asarray(self.force))
        return DeadForceTerm("line_force", forces, None if self.ramp else 0.0)


@final
@dataclass(frozen=True, eq=False)  # arrays inside: two terms are the same one or not
class DeadForceTerm(Acting):
    """-f . x with nodal forces that keep their direction."""

    effect: str
    force: Array  #: (n, 3) whole, N
    held: float | None  #: share of the force reached so far; None where it grows with the load factor

    def energy(self, x: Array, factor: float) -> float:
        return -self._share(factor) * float(np.vdot(self.force, x))

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out -= self._share(factor) * self.force

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        return Blocks(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3, 3)))

    def at(self, share: float) -> Term:
        return self if self.held is None else replace(self, held=share)

    def advanced(self, x: Array, dx: Array) -> Term:
        return self

    def _share(self, factor: float) -> float:
        return factor if self.held is None else self.held
