"""The free body of experiment I: the constraints that keep it from moving, and the place that they give it."""

from dataclasses import dataclass, replace
from math import acos, atan2, hypot, pi, sqrt
from typing import final

import numpy as np

from fem.solution import Step
from fem.supports import Fixed, Support, nodes_at
from geometry import Body
from geometry.arrays import Array


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class FreeBody:
    """Three constraints take the rigid motion of half a body, six that of a whole one; none carries a force.

    They are in the middle of the material curve, where the body turns least. Positions at rest, (3,) in mm.
    """

    middle: Array  #: of the curve
    neighbour: Array  #: on the curve, one pitch further
    top: Array | None  #: above the curve; None for half a body

    @classmethod
    def of(cls, body: Body, curve: Array) -> "FreeBody":
        """curve: vertices (k, 3) of the material curve."""
        middle = int(np.argmin(np.abs(curve[:, 0] - body.length / 2)))
        neighbour = int(np.argmin(np.abs(curve[:, 0] - body.length / 2 - body.pitch)))
        return cls(curve[middle], curve[neighbour], None if body.half else body.top)

    @property
    def supports(self) -> tuple[Support, ...]:
        """The constraints."""
        in_plane: tuple[Support, ...] = (Fixed(self.middle, "xy"), Fixed(self.neighbour, "y"))
        if self.top is None:
            return in_plane
        return (*in_plane, Fixed(self.middle, "z"), Fixed(self.neighbour, "z"), Fixed(self.top, "z"))

    def placed(self, step: Step) -> Step:
        """A state of the same mesh with other supports, moved as a rigid body to where the constraints have it.

        Its displacement alone is that of the free body: forces and rates keep their directions.
        """
        rest, now = step.space.points, step.positions
        middle, neighbour = (int(nodes_at(point, step.space)[0]) for point in (self.middle, self.neighbour))
        rotation = _aligning(now[neighbour] - now[middle], rest[neighbour] - rest[middle])
        if self.top is not None:
            top = int(nodes_at(self.top, step.space)[0])
            axis = rotation @ (now[neighbour] - now[middle])
            lever = rotation @ (now[top] - now[middle])
            rotation = _rolling(axis / np.linalg.norm(axis), lever, rest[top, 2] - rest[middle, 2]) @ rotation
        return replace(step, displacement=(now - now[middle]) @ rotation.T + rest[middle] - rest)


def _aligning(now: Array, rest: Array) -> Array:
    """The rotation (3, 3) that gives a vector the y and z that it has at rest: about z first, then the shortest way."""
    length = float(np.linalg.norm(now))
    y, z = float(rest[1]), float(rest[2])
    target = np.array([sqrt(max(length**2 - y**2 - z**2, 0.0)), y, z]) / length
    about_z = _about(np.array([0.0, 0.0, 1.0]), atan2(target[1], target[0]) - atan2(now[1], now[0]))
    turned = about_z @ now / length
    axis = np.cross(turned, target)
    sine = float(np.linalg.norm(axis))
    return about_z if sine == 0.0 else _about(axis / sine, atan2(sine, float(turned @ target))) @ about_z


def _rolling(axis: Array, lever: Array, height: float) -> Array:
    """The smallest rotation (3, 3) about an axis (unit length) that brings the end of a lever to the height z.

    As near to it as the lever is long.
    """
    along = float(axis @ lever) * axis
    across = lever - along
    rise, fall = float(across[2]), float(np.cross(axis, across)[2])
    if (reach := hypot(rise, fall)) == 0.0:
        return np.eye(3)
    middle, half = atan2(fall, rise), acos(min(max((height - float(along[2])) / reach, -1.0), 1.0))
    angles = [(angle + pi) % (2 * pi) - pi for angle in (middle - half, middle + half)]
    return _about(axis, min(angles, key=abs))


def _about(axis: Array, angle: float) -> Array:
    """The rotation (3, 3) by an angle in rad about an axis of unit length."""
    from scipy.spatial.transform import Rotation  # loaded where it is needed: most states are not released

    return np.asarray(Rotation.from_rotvec(angle * axis).as_matrix())
