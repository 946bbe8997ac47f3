"""Threads wound about an arm: loops in its sections, or helices of two families, as a layer stiff along them alone.

With the direction d of the threads on a face the energy per area at rest is t/2 E (d . C d - 1)^2 / 4, C = F^T F, where
the thickness t times E is the axial rigidity EA of a thread over the distance of its windings. Loops run along the
tangent of the section, n x e_x with the normal n of the face; helices at an angle to it to both sides, each family with
half the thickness. Threads bend freely.
"""

from dataclasses import dataclass
from typing import final

import numpy as np

from fem.effects.membrane import LayerError, Membrane
from geometry.arrays import Array, Index

#: sine of the angle between the length of the arm and the normal of a face below which no thread runs on it
ALONG = 0.5
#: barycentric coordinates (q, 3) of the stress points of a triangle: one strain at three of them is half as many
#: conditions as a triangle has displacements. At one point alone a soft wall bulges between the points of a coarse
#: mesh: a thick tube with stiff loops widened by 3 %
POINTS = np.array([[2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]])


@final
@dataclass(frozen=True)
class Hoops(Membrane):
    """Threads about the x axis; E in MPa, angle to the section in rad, from 0 to less than pi / 2."""

    name = "hoops"
    noun = "hoops"

    E: float
    angle: float = 0.0

    def check(self) -> None:
        """Raise `LayerError` for constants that are not possible."""
        if not 0 < self.E < np.inf:
            raise LayerError(f"hoops: their modulus must be positive and finite, not {self.E:g} MPa")
        if not 0 <= self.angle < np.pi / 2:
            raise LayerError(f"hoops: their angle must be from 0 to less than pi/2, not {self.angle:g}")

    @property
    def stress_points(self) -> Array:
        return POINTS

    def law(self, frame: Array) -> Array:
        normal = np.cross(frame[:, :, 0], frame[:, :, 1])
        around = np.cross(normal, [1.0, 0.0, 0.0])
        around /= np.linalg.norm(around, axis=-1, keepdims=True)
        along = np.cross(around, normal)
        families = [np.cos(self.angle) * around + sign * np.sin(self.angle) * along for sign in (1.0, -1.0)]
        total = np.zeros((*frame.shape[:2], 3, 3))
        for direction in families:
            first, second = np.moveaxis(np.einsum("fqdi,fqi->fqd", frame, direction), 2, 0)
            parts = np.stack([first**2, second**2, first * second], axis=-1)
            total += 0.5 * self.E * parts[..., :, None] * parts[..., None, :]
        return total

    @property
    def bending(self) -> tuple[float, float]:
        return 0.0, 0.0

    def stretches(self, stress: Array) -> Array:
        """Stretch (f, q) of the threads from the stress (f, q, 3) of `LayerTerm`; of helices the mean of both."""
        return np.asarray(np.sqrt(1.0 + 2.0 * (stress[..., 0] + stress[..., 1]) / self.E))


def faces_along(points: Array, triangles: Index) -> Index:
    """The triangles out of (f, 3) on which threads about the x axis run: none across it; points (n, 3)."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return triangles[np.linalg.norm(normal[:, 1:], axis=1) > ALONG * np.linalg.norm(normal, axis=1)]
