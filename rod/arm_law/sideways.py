"""Small motions of a rod out of its plane, about a planar equilibrium.

Sections turn by theta (in the plane, about x and y) and move by w along z. With the planar moment m_1, force F and
position r(s), the frame t, n, and the change m of the moment and Q of the force along z,

    theta' = tau t + kappa_2 n,                 w' = gamma + (theta x r')_z,
    m' = -(w' e_z x F + r' x Q e_z),
    T = m . t - m_1 theta . n,                  M_2 = m . n + m_1 theta . t,
    kappa_2 = M_2 / B_2,                        (tau, gamma) = C (T, Q - (theta x F)_z),

linear equations whose determinant changes its sign where the rod buckles sideways. Each step has the propagator of its
middle: errors fall with the square of the step.
"""

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from geometry.arrays import Array
from rod.arm_law.curves import IN_SPACE

#: unknowns: theta about x and y, w, m about x and y, and Q
SIZE = 6
#: smallest determinant that counts as stable, over that of the rod without planar loads
STABLE = 1e-9


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class PlanarRod:
    """A planar state with the rigidities out of its plane, at rising positions."""

    s: Array  #: (n,) mm
    theta: Array  #: (n,) rad
    rate: Array  #: (n, 2) dr/ds
    moment: Array  #: (n,) m_1, N mm
    force: Array  #: (n, 2) F, N
    bending: Array  #: (n,) B_2, N mm2
    twisting: Array  #: (n, 2, 2) C: twist (1/mm) and shear angle per torque (N mm) and lateral force (N)

    def unloaded(self) -> "PlanarRod":
        """The same shape without planar moment and force."""
        none = np.zeros_like(self.moment), np.zeros_like(self.force)
        return PlanarRod(self.s, self.theta, self.rate, *none, self.bending, self.twisting)

    def from_end(self) -> Array:
        """(n, 6, 6): the unknowns at each position by those at the end."""
        middle = [0.5 * (a[1:] + a[:-1]) for a in (self.theta, self.rate, self.moment, self.force)]
        rigidities = [0.5 * (a[1:] + a[:-1]) for a in (self.bending, self.twisting)]
        step = -np.diff(self.s)[:, None, None] * _rates(*middle, *rigidities)
        propagator, power = np.broadcast_to(np.eye(SIZE), step.shape).copy(), np.eye(SIZE)
        for order in range(1, 5):
            power = power @ step / order
            propagator += power
        result = np.empty((len(self.s), SIZE, SIZE))
        result[-1] = np.eye(SIZE)
        for row in range(len(step) - 1, -1, -1):
            result[row] = propagator[row] @ result[row + 1]
        return result

    def compliance(self) -> Array:
        """(3, 3), symmetric without planar loads: turn about the tangent of the end (rad), tilt about its normal (rad)
        and lift (mm) of a rod that is held at its start, per torque, moment (N mm) and force (N) there."""
        to_start, cosine, sine = self.from_end()[0], math.cos(self.theta[-1]), math.sin(self.theta[-1])
        frame = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        moved = -np.linalg.solve(to_start[:3, :3], to_start[:3, 3:] @ frame)
        return np.asarray(frame.T @ moved)


def _rates(theta: Array, rate: Array, moment: Array, force: Array, bending: Array, twisting: Array) -> Array:
    """(n, 6, 6): the derivatives of the unknowns by s."""
    n, zero, one = len(theta), np.zeros(len(theta)), np.ones(len(theta))
    tangent = np.column_stack([np.cos(theta), np.sin(theta)])
    normal = np.column_stack([-np.sin(theta), np.cos(theta)])
    none = np.zeros((n, 2))
    torque = np.column_stack([-moment[:, None] * normal, zero, tangent, zero])
    across = np.column_stack([moment[:, None] * tangent, zero, normal, zero])
    shear = np.column_stack([-force[:, 1], force[:, 0], zero, none, one])
    loads = np.stack([torque, shear], axis=1)
    twist, slip = np.moveaxis(twisting @ loads, 1, 0)
    rates = np.zeros((n, SIZE, SIZE))
    rates[:, :2] = tangent[:, :, None] * twist[:, None] + normal[:, :, None] * (across / bending[:, None])[:, None]
    rates[:, 2] = slip
    rates[:, 2, 0] += rate[:, 1]
    rates[:, 2, 1] -= rate[:, 0]
    rates[:, 3] = force[:, 1, None] * rates[:, 2]
    rates[:, 4] = -force[:, 0, None] * rates[:, 2]
    rates[:, 3, 5] -= rate[:, 1]
    rates[:, 4, 5] += rate[:, 0]
    return rates


def twisting_compliance(torsion: Array, shear: Array, axis: Array) -> Array:
    """C (n, 2, 2) of rigidities GJ (n,) in N mm2 and GA (n,) in N, with the axis of twist above that of the rod, mm."""
    stiffness = np.empty((len(torsion), 2, 2))
    stiffness[:, 0, 0] = torsion + shear * axis**2
    stiffness[:, 0, 1] = stiffness[:, 1, 0] = shear * axis
    stiffness[:, 1, 1] = shear
    return np.asarray(np.linalg.inv(stiffness))


def arc(length: float, kappa: float, stretch: float, rigidities: dict[str, float], points: int) -> PlanarRod:
    """A rod without planar loads whose axis is an arc; rigidities by the names of `rod.arm_law.curves.IN_SPACE`."""
    s = np.linspace(0.0, length, points)
    theta = kappa * s
    B, GJ, GA, axis = (np.full(points, rigidities[name]) for name in IN_SPACE[:4])
    rate = stretch * np.column_stack([np.cos(theta), np.sin(theta)])
    none = np.zeros(points), np.zeros((points, 2))
    return PlanarRod(s, theta, rate, *none, B, twisting_compliance(GJ, GA, axis))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SidewaysResponse:
    """A planar equilibrium under a small force along z on its end, to first order."""

    s: Array  #: (n,) mm
    lift: Array  #: (n,) of the axis along z, mm/N
    turn: Array  #: (n, 2) of the sections about x and y, rad/N
    end_lift: float  #: of the point in which the force acts, mm/N
    is_stable: bool  #: whether it does not buckle sideways

    @property
    def end_turn(self) -> Array:
        """(2,) rad/N."""
        return np.asarray(self.turn[-1])


def sideways(rod: PlanarRod, clamp: Array, position: float, lever: Array) -> SidewaysResponse:
    """The rod under a force along z.

    clamp: (2, 2) turns of the clamped end about x and y per moment about them at s = position, rad/(N mm). lever: (2,)
    mm, from the end of the axis to the point in which that force acts. The force in the plane keeps its direction; it
    acts where it makes the moment of the end.
    """
    force = rod.force[-1]
    square, missing = float(force @ force), float(rod.moment[-1] - lever[0] * force[1] + lever[1] * force[0])
    acts_at = lever + missing / square * np.array([force[1], -force[0]]) if square else lever
    lifted, carried = (np.array([point[1], -point[0]]) for point in (lever, acts_at))  # along z by turns of the end

    def solve(state: PlanarRod, acting: Array) -> tuple[Array, Array, float]:
        from_end = state.from_end()
        start = np.zeros((SIZE, 4))  # by turns and lift of the end, and the force
        start[:3, :3] = np.eye(3)
        start[3, :2], start[4, :2] = -acting[1] * carried, acting[0] * carried
        start[3:, 3] = lever[1], -lever[0], 1.0
        at_clamp = from_end[0] @ start
        row = position / float(state.s[-1]) * (len(state.s) - 1)
        i = min(int(row), len(state.s) - 2)
        decides = ((1.0 - row + i) * from_end[i] + (row - i) * from_end[i + 1])[3:5] @ start
        missed = at_clamp[:3].copy()
        missed[:2] -= clamp @ decides
        ends = np.append(-np.linalg.solve(missed[:, :3], missed[:, 3]), 1.0)
        return from_end @ (start @ ends), ends, float(np.linalg.det(missed[:, :3]))

    unknowns, ends, determinant = solve(rod, force)
    _, _, without = solve(rod.unloaded(), np.zeros(2))
    stable = determinant / without > STABLE
    return SidewaysResponse(rod.s, unknowns[:, 2], unknowns[:, :2], float(ends[2] + lifted @ ends[:2]), stable)
