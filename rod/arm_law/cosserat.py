"""A rod in space with the arm's own law, integrated from its end to the clamp.

Frames R have as columns the normal t of a cross section, n in its plane of symmetry, and t x n. At rest arc length s,
with the force F and the moment m on the part before s,

    R' = R [k]x,    r' = R v,    m' = -r' x F.

The strains k = (tau, kappa_2, kappa) and v = (stretch, shear, lateral shear) are derivatives of the complementary
energy per length by the components of m and F in the frame. It is that of the planar law and

    M_2^2 / (2 B_2) + (T - a Q)^2 / (2 GJ) + Q^2 / (2 GA_3)

for a moment M_2 about n, a torque T and a force Q along t x n, and the twist axis at the height a. B_2, GJ, GA_3 and a
depend on the bending moment, so that motions out of the plane also bend the rod in it. Fourth-order Runge-Kutta steps:
of Munthe-Kaas (BIT 38, 1998, p. 92) for R. In the plane they are those of `rod.arm_law.integration`.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol, final

import numpy as np

from geometry.arrays import Array
from geometry.topology import cross
from rod.arm_law.curves import IN_SPACE
from rod.arm_law.integration import ITERATIONS, SETTLED
from rod.arm_law.section import SectionLaw
from rod.cubics import cubic_coefficients, parabola_slopes

#: that turns a vector into the matrix of its cross product
_CROSS = np.zeros((3, 3, 3))
_CROSS[[0, 1, 2], [2, 0, 1], [1, 2, 0]], _CROSS[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0, -1.0
#: step of difference quotients, over that of the law
DIFFERENCE = 1e-3


def cross_matrix(a: Array) -> Array:
    """(..., 3, 3): the matrix of a x, of vectors (..., 3)."""
    return np.asarray(a @ _CROSS.reshape(3, 9)).reshape(*a.shape, 3)


def rotation(turn: Array) -> Array:
    """(..., 3, 3) of rotation vectors (..., 3), rad."""
    angle = np.sqrt((turn * turn).sum(axis=-1))[..., None, None]
    turned = cross_matrix(turn)
    return np.asarray(
        np.eye(3) + np.sinc(angle / np.pi) * turned + 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2 * turned @ turned
    )


def in_frame(frame: Array, vector: Array) -> Array:
    """Components (..., 3) of vectors (..., 3) in frames (..., 3, 3)."""
    return np.asarray((vector[..., None, :] @ frame)[..., 0, :])


class Strains(NamedTuple):
    """What internal forces do to the rod, of shape (..., 3) each."""

    curvature: Array  #: k, 1/mm
    stretch: Array  #: v
    outside: float  #: N mm, by how much a moment leaves the law at the most


class StrainLaw(Protocol):
    """What forces and moments in the frame do to a rod."""

    @property
    def step(self) -> float:
        """N mm, over which moments are told apart."""

    def strains(self, force: Array, moment: Array) -> Strains:
        """Of internal forces (..., 3) in N and moments (..., 3) in N mm, in the frame."""


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class LawInSpace:
    """A `SectionLaw` with rigidities out of its plane, over equal steps of the moment."""

    first: float  #: N mm, smallest moment
    step: float  #: N mm
    #: (4, n - 1, 6): coefficients of the cubics over each interval of the moment, of curvature and stretch in the
    #: plane, of B_2, GJ and GA_3, and of the height of the twist axis
    cubics: Array
    in_plane: Array  #: (n, 2): EA and GA in N

    @staticmethod
    def of(law: SectionLaw) -> "LawInSpace":
        """The law of the cells at one pressure."""
        across = np.stack([law.in_space[name] for name in IN_SPACE[:4]], axis=1)
        ends = np.column_stack([law.kappa, law.stretch, across])
        slopes = np.column_stack([law.kappa_slope, law.stretch_slope, parabola_slopes(law.moment, across)])
        cubics = cubic_coefficients(law.moment, ends, slopes)
        rigidities = np.column_stack([law.axial_rigidity, law.shear_rigidity])
        return LawInSpace(float(law.moment[0]), float(law.moment[1] - law.moment[0]), cubics, rigidities)

    def strains(self, force: Array, moment: Array) -> Strains:
        """Of internal forces (..., 3) in N and moments (..., 3) in N mm, in the frame.

        Beyond the last moment of the law they are those there.
        """
        bending, axial = moment[..., 2], force[..., 0]
        effective, settled = bending, np.zeros(bending.shape, bool)
        for _ in range(ITERATIONS):
            position = (effective - self.first) / self.step
            i = np.clip(np.floor(position), 0, len(self.in_plane) - 2).astype(int)
            t = np.clip(position - i, 0.0, 1.0)[..., None]
            inside, (c0, c1, c2, c3) = self.step * t, self.cubics[:, i]
            slopes = c1 + inside * (2.0 * c2 + inside * (3.0 * c3))
            by_kappa = slopes[..., 1] / slopes[..., 0]
            moved = bending + axial * by_kappa
            settled = settled | (np.abs(moved - effective) < SETTLED * self.step)
            if settled.all():
                break
            effective = np.where(settled, effective, moved)
        last = self.first + self.step * (len(self.in_plane) - 1)
        outside = float(np.max(np.maximum(self.first - effective, effective - last), initial=0.0))
        kappa, stretch, B, GJ, GA_3, height = np.moveaxis(c0 + inside * (c1 + inside * (c2 + inside * c3)), -1, 0)
        low, high = self.in_plane[i], self.in_plane[i + 1]
        EA, GA = np.moveaxis(low + t * (high - low), -1, 0)
        lateral, across = moment[..., 1] / B, force[..., 2]
        twist = (moment[..., 0] - height * across) / GJ
        # the planar law changes with the energy of the motions out of the plane
        B_slope, GJ_slope, GA_slope, height_slope = np.moveaxis(slopes[..., 2:], -1, 0)
        energy = lateral**2 * B_slope + twist**2 * GJ_slope + (across / GA_3) ** 2 * GA_slope
        bends = -(0.5 * energy + twist * across * height_slope)
        curvature = np.stack([twist, lateral, kappa + bends], axis=-1)
        along = stretch + axial / EA + by_kappa * bends
        return Strains(curvature, np.stack([along, force[..., 1] / GA, across / GA_3 - height * twist], -1), outside)


def compliance(law: StrainLaw, force: Array, moment: Array) -> Array:
    """(n, 6, 6), symmetric: changes of curvature and stretch by those of moments (n, 3) and forces (n, 3), in the frame
    like these, by difference quotients."""
    step = DIFFERENCE * law.step
    moved = step * np.vstack([np.eye(6), -np.eye(6)])
    found = law.strains(force[:, None] + moved[:, 3:], moment[:, None] + moved[:, :3])
    strains = np.concatenate([found.curvature, found.stretch], axis=-1)
    by_load = (strains[:, :6] - strains[:, 6:]) / (2.0 * step)
    return np.asarray(0.5 * (by_load + np.swapaxes(by_load, 1, 2)))


class Shapes(NamedTuple):
    """c rods at n + 1 equally spaced positions."""

    axis: Array  #: (n + 1, c, 3) mm, from its end
    frames: Array  #: (n + 1, c, 3, 3)
    moment: Array  #: (n + 1, c, 3) N mm
    outside: float  #: N mm, by how much a moment leaves the law at the most


def integrate(law: StrainLaw, length: float, weight: Array, force: Array, frame: Array, moment: Array) -> Shapes:
    """From the end to the clamp, of c rods with frames (c, 3, 3) and moments (c, 3) in N mm at the end.

    force: (c, 3) N, on the end. weight: (n + 1, 6) of the part beyond each position, N, and that times the height of
    its mass above the curve, N mm.
    """
    n, h = len(weight) - 1, -length / (len(weight) - 1)
    axis, frames, moments = (np.empty((n + 1, *at.shape)) for at in (moment, frame, moment))
    place = np.zeros_like(moment)
    axis[n], frames[n], moments[n] = place, frame, moment
    outside = 0.0
    for step in range(n, 0, -1):
        before, beyond = weight[step], weight[step - 1]
        couple = (before[3:] - beyond[3:]) / h
        rates: list[tuple[Array, Array, Array]] = []
        for part in (0.0, 0.5, 0.5, 1.0):
            turn, moved = np.zeros_like(moment), moment
            if rates:
                turn, moved = part * h * rates[-1][0], moment + part * h * rates[-1][2]
            at = frame @ rotation(turn) if rates else frame
            acting = force + before[:3] + part * (beyond[:3] - before[:3])
            strains = law.strains(in_frame(at, acting), in_frame(at, moved))
            outside = max(outside, strains.outside)
            k, along = strains.curvature, (at @ strains.stretch[..., None])[..., 0]
            turned = cross(turn, k)
            rates.append(
                (
                    k + 0.5 * turned + cross(turn, turned) / 12.0,
                    along,
                    -cross(along, acting) - cross(at[..., 1], couple),
                )
            )
        turn, shift, change = (h / 6.0 * (a + 2.0 * b + 2.0 * c + d) for a, b, c, d in zip(*rates, strict=True))
        frame, place, moment = frame @ rotation(turn), place + shift, moment + change
        axis[step - 1], frames[step - 1], moments[step - 1] = place, frame, moment
    return Shapes(axis, frames, moments, outside)
