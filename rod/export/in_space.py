"""How the hinges of a chain turn out of its plane: each about two axes in the plane, with straight springs.

A part of an arm that turns by C m under a moment m moves along z what is behind it, as turns about axes through one
point do: the point in which a force along z does not turn it. The axes are the principal ones of C. All is that of the
arm without load.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from geometry.arrays import Array
from rod.arm_law.curves import IN_SPACE
from rod.arm_law.law_rod import LawRod

#: points of the integrals along a part
POINTS = 33


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SpaceHinges:
    """The axes of the m hinges of a chain. Directions and positions are those without load, in the piece before."""

    axis: Array  #: (m,) rad, direction of the axis of twist; that of sideways bending is a quarter turn further
    centre: Array  #: (m, 2) mm, where the axes meet, from the hinge
    twist: Array  #: (m,) N mm/rad, stiffness against twist
    bend: Array  #: (m,) N mm/rad, against sideways bending
    shear: float  #: N, rigidity of the arm against shear across the plane

    def between(self, other: "SpaceHinges", t: float) -> "SpaceHinges":
        """Hinges between these (t = 0) and others (t = 1), by straight lines."""
        names = ("axis", "centre", "twist", "bend", "shear")
        return SpaceHinges(**{name: (1.0 - t) * getattr(self, name) + t * getattr(other, name) for name in names})


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Part:
    """A part of an arm without load: an arc from a point with a direction in the frame of the piece before."""

    start: Array  #: (2,) mm
    direction: float  #: rad
    length: float  #: mm, at rest
    kappa: float  #: 1/mm, rotation per rest length
    stretch: float
    hinge: Array  #: (2,) mm, where the chain has its hinge

    def turns(self, known: dict[str, float], gives: Array) -> tuple[Array, Array]:
        """C (2, 2) in rad/(N mm), and the point (2,) mm in which the axes of its turns meet.

        known: rigidities by the names of `IN_SPACE`. gives: (2, 2) rad/(N mm), how its start turns by the moment.
        """
        step = self.length / POINTS
        angles = self.direction + self.kappa * step * (np.arange(POINTS) + 0.5)
        tangents = np.column_stack([np.cos(angles), np.sin(angles)])
        normals = np.column_stack([-tangents[:, 1], tangents[:, 0]])
        middles = self.start + self.stretch * step * (np.cumsum(tangents, axis=0) - 0.5 * tangents)
        axes = np.vstack([tangents, normals])
        through = np.vstack([middles + known["twist_axis"] * normals, middles])
        by = step / np.repeat([known["torsional_rigidity"], known["lateral_rigidity"]], POINTS)
        # a turn about an axis a through p moves the origin along z by a_y p_x - a_x p_y
        lift = axes.T @ (by * (axes[:, 1] * through[:, 0] - axes[:, 0] * through[:, 1]))
        lift += self.start[0] * gives[1] - self.start[1] * gives[0]
        compliance = axes.T @ (by[:, None] * axes) + gives
        y, x = np.linalg.solve(compliance.T, lift) * [-1.0, 1.0]
        return compliance, np.array([x, y])


def space_hinges(rod: LawRod, parts: Sequence[Part], in_clamped: Array, by_shear: Array) -> SpaceHinges | None:
    """Hinges of the m parts of an arm; None for a law of the plane alone, and for an unloaded arm that is not stable
    out of its plane.

    in_clamped: (m,) how much of the compliance of the clamped end a part has. by_shear: (m,) what its hinge turns, over
    the length by the shear rigidity, 1/mm2.
    """
    section = rod.section
    if not rod.is_in_space:
        return None
    known = {name: float(np.interp(0.0, section.moment, section.in_space[name])) for name in IN_SPACE}
    shear = known["lateral_shear_rigidity"]
    rows = np.empty((len(parts), 5))
    for k, part in enumerate(parts):
        compliance, centre = part.turns(known, in_clamped[k] * rod.clamp.lateral_compliance)
        compliance[1, 1] += by_shear[k] * rod.length / shear
        rows[k] = _row(part, compliance, centre)
    if not (rows[:, 3:] > 0.0).all():
        return None
    return SpaceHinges(rows[:, 0], rows[:, 1:3], rows[:, 3], rows[:, 4], shear)


def _row(part: Part, compliance: Array, centre: Array) -> Array:
    """(5,): axis, centre and both stiffnesses."""
    values, vectors = np.linalg.eigh(compliance)
    middle = part.direction + 0.5 * part.kappa * part.length
    along = np.array([np.cos(middle), np.sin(middle)]) @ vectors
    twist = int(np.argmax(np.abs(along)))
    x, y = vectors[:, twist] * np.sign(along[twist])
    return np.array([np.arctan2(y, x), *(centre - part.hinge), 1.0 / values[twist], 1.0 / values[1 - twist]])
