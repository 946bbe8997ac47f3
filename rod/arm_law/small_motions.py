"""Small motions of a rod in space about an equilibrium, and its stability.

Sections turn by psi and move by u, and the moment and the force on the part before s change by m and f:

    psi' = R k,    u' = psi x r' + R v,    m' = -(u' x F + r' x f) - (psi x n) x c,    f' = 0,

with the changes k and v of the strains by those of moment and force in the frame, R^T (m - psi x M) and
R^T (f - psi x F), and the couple n x c of a weight beside the axis. The transfer matrices of the steps give the second
variation of the energy of the rod between its positions: what forces and moments small motions of both ends take.
A rod is unstable where its lowest eigenvalue, over that without loads, is negative.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from geometry.arrays import Array, read_only
from rod.arm_law.cosserat import StrainLaw, Strains, compliance, cross_matrix, in_frame, rotation
from rod.arm_law.curves import IN_SPACE, ClampCurve
from rod.errors import RodError
from rod.spatial import Stability

#: unknowns of a section: its turn and motion; moment and force
SIZE = 6
#: of them, about a planar state: turns about x and y, or t and n, and the motion along z
OUT_OF_PLANE = (0, 1, 5)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class LoadedRod:
    """A rod in equilibrium, at rising positions."""

    s: Array  #: (n,) mm
    frames: Array  #: (n, 3, 3)
    rate: Array  #: (n, 3) dr/ds
    moment: Array  #: (n, 3) N mm
    force: Array  #: (n, 3) N
    couple: Array  #: (n, 3) N, weight per length times its height beside the axis
    compliance: Array  #: (n, 6, 6) change of curvature and stretch in the frame by moment and force there

    def transfer(self, is_loaded: bool = True) -> Array:
        """(n - 1, 12, 12): turn, motion, moment and force (3 each) at a position by those at the one before.

        is_loaded: whether its moment and force act. Each step is that of S. Blanes and P. C. Moan (Appl. Num. Math. 56,
        2006, p. 1519), of fourth order, with rates in its middle from cubics through those at four positions.
        """
        rates, h = self._rates(float(is_loaded)), np.diff(self.s)[:, None, None]
        first, last = rates[:-1], rates[1:]
        before = np.concatenate([3.0 * rates[:1] - 3.0 * rates[1:2] + rates[2:3], rates[:-2]])
        beyond = np.concatenate([rates[2:], 3.0 * rates[-1:] - 3.0 * rates[-2:-1] + rates[-3:-2]])
        half = 0.25 * (first + last) + (first + last - before - beyond) / 48.0
        change = (last - first) / 6.0
        return _exponential(h * (half + change)) @ _exponential(h * (half - change))

    def _rates(self, acting: float) -> Array:
        """(n, 12, 12): derivatives by s."""
        force, moment, rate = acting * cross_matrix(self.force), acting * cross_matrix(self.moment), self.rate
        n = len(self.s)
        frame = np.zeros((n, SIZE, SIZE))
        frame[:, :3, :3] = frame[:, 3:, 3:] = self.frames
        # the changes of moment and force in the frame by the 12 unknowns
        inner = np.zeros((n, SIZE, 2 * SIZE))
        inner[:, :, SIZE:] = np.eye(SIZE)
        inner[:, :3, :3], inner[:, 3:, :3] = moment, force  # M x psi = -psi x M
        strains = frame @ self.compliance @ np.swapaxes(frame, 1, 2) @ inner
        along = cross_matrix(rate)
        rates = np.zeros((n, 2 * SIZE, 2 * SIZE))
        rates[:, :SIZE] = strains
        rates[:, 3:6, :3] -= along
        rates[:, 6:9] = force @ rates[:, 3:6]
        rates[:, 6:9, 9:] -= along
        # (psi x n) x c = c x (n x psi)
        rates[:, 6:9, :3] -= acting * cross_matrix(self.couple) @ cross_matrix(self.frames[:, :, 1])
        return rates


def loaded_rod(
    law: StrainLaw, s: Array, frames: Array, moment: Array, force: Array, weight: Array
) -> tuple[LoadedRod, Strains]:
    """A rod at positions s (n,) with frames (n, 3, 3) and moments (n, 3), and its strains.

    force: (3,) N, on the end. weight: (n, 6) as `rod.arm_law.cosserat.integrate` takes it.
    """
    acting = force + weight[:, :3]
    inner = in_frame(frames, acting), in_frame(frames, moment)
    strains = law.strains(*inner)
    rate = (frames @ strains.stretch[..., None])[..., 0]
    couple = np.gradient(-weight[:, 3:], s, axis=0)
    return LoadedRod(s, frames, rate, moment, acting, couple, compliance(law, *inner)), strains


def _exponential(step: Array) -> Array:
    """(n, k, k) of small matrices (n, k, k)."""
    result = power = np.broadcast_to(np.eye(step.shape[-1]), step.shape)
    for order in range(1, 7):
        power = power @ step / order
        result = result + power
    return result


def end_compliance(rod: LoadedRod) -> Array:
    """(6, 6): turn (rad) and motion (mm) of the end by moment (N mm) and force (N) there, of a rod that is held at its
    start, in the frame of the end."""
    whole = np.eye(2 * SIZE)
    for step in rod.transfer():
        whole = step @ whole
    frame = np.zeros((SIZE, SIZE))
    frame[:3, :3] = frame[3:, 3:] = rod.frames[-1]
    return np.asarray(frame.T @ whole[:SIZE, SIZE:] @ np.linalg.inv(whole[SIZE:, SIZE:]) @ frame)


def arc(length: float, kappa: float, stretch: float, rigidities: Mapping[str, float], points: int) -> LoadedRod:
    """A rod without loads whose axis is an arc, rigid in its plane; rigidities by the names of `IN_SPACE`."""
    s = np.linspace(0.0, length, points)
    frames = rotation(np.outer(kappa * s, [0.0, 0.0, 1.0]))
    B, GJ, GA, height = (rigidities[name] for name in IN_SPACE[:4])
    compliance = np.zeros((SIZE, SIZE))
    compliance[1, 1] = 1.0 / B
    compliance[np.ix_([0, 5], [0, 5])] = [[1.0, -height], [-height, height**2 + GJ / GA]]
    compliance[np.ix_([0, 5], [0, 5])] /= GJ
    none = np.zeros((points, 3))
    return LoadedRod(s, frames, stretch * frames[:, :, 0], none, none, none, np.tile(compliance, (points, 1, 1)))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Ends:
    """What holds a rod."""

    clamp: Array  #: (3, 3) turns of the clamped end by the moment where it turns, rad/(N mm)
    position: float  #: mm, where the clamped end turns in the plane; out of it at its start
    first: float  #: mm, how far the clamped end reaches
    lever: Array  #: (3,) mm, from the end of the axis to the point in which its force acts
    to_end: Array  #: (3,) mm, from there to the point of the end that is held
    held: Array  #: (3,) whether the end is held along x, y and z
    kept: tuple[int, ...] = tuple(range(SIZE))  #: which of the three turns and three motions are possible

    @staticmethod
    def of(clamp: ClampCurve, moment: Array, lever: Array, to_end: Array, held: Array) -> "Ends":
        """With the clamped end of a law, of a rod with moments (n, 3)."""
        turns = np.zeros((3, 3))
        turns[:2, :2] = clamp.lateral_compliance
        turns[2, 2] = np.interp(moment[0, 2], clamp.moment, clamp.rotation_by_moment)
        return Ends(turns, clamp.position, float(clamp.s[-1]), lever, to_end, held)

    def hinge(self) -> Array:
        """(6, 6): turn and motion of the start of the axis by moment and force there."""
        moved = np.zeros((3, 3))
        moved[1, 2] = -self.position
        by_turn = np.vstack([np.eye(3), moved])
        return np.asarray(by_turn @ self.clamp @ by_turn.T)


def stability_of(rod: LoadedRod, ends: Ends) -> Stability:
    """Of a rod between its ends.

    The clamped end and the part of the rod beside it are one element, which is drawn at rest. Raises `RodError` where
    the rod gives way to no load.
    """
    loaded, free = (_stiffness(rod, ends, is_loaded) for is_loaded in (True, False))
    end = np.zeros((len(loaded), len(loaded)))
    end[-SIZE:-3, -SIZE:-3] = -cross_matrix(rod.force[-1]) @ cross_matrix(ends.lever)
    loaded = loaded + end
    onto = _onto(len(loaded), np.hstack([-cross_matrix(ends.to_end), np.eye(3)])[ends.held])
    if len(ends.kept) < SIZE:
        onto = np.eye(len(loaded)).reshape(len(loaded), -1, SIZE)[:, :, list(ends.kept)].reshape(len(loaded), -1)
    loaded, free = (onto.T @ (0.5 * (matrix + matrix.T)) @ onto for matrix in (loaded, free))
    try:
        factor = np.linalg.cholesky(free)
    except np.linalg.LinAlgError:
        raise RodError("The rigidities of the law out of its plane are not all positive.") from None
    inverse = np.linalg.inv(factor)
    values, vectors = np.linalg.eigh(inverse @ loaded @ inverse.T)
    moving = (onto @ inverse.T @ vectors[:, 0]).reshape(-1, SIZE)[:, 3:]
    motion = np.vstack([np.zeros((len(rod.s) - len(moving), 3)), moving])
    return Stability(float(values[0]), read_only(motion / np.abs(motion).max()))


def _onto(size: int, tip: Array) -> Array:
    """(size, size - k): motions whose last six components a constraint (k, 6) makes zero."""
    _, _, rows = np.linalg.svd(tip)
    onto = np.eye(size)[:, : size - len(tip)]
    onto[-SIZE:, -SIZE + len(tip) :] = rows[len(tip) :].T
    return onto


def _stiffness(rod: LoadedRod, ends: Ends, is_loaded: bool) -> Array:
    """(6 m, 6 m): what motions of the positions beyond the clamped end take."""
    steps = rod.transfer(is_loaded)
    start = max(int(np.searchsorted(rod.s, ends.first)), 1)
    clamped = np.eye(2 * SIZE)
    clamped[:SIZE, SIZE:] = ends.hinge()
    for step in steps[:start]:
        clamped = step @ clamped
    result = np.zeros((SIZE * (len(steps) - start + 1),) * 2)
    result[:SIZE, :SIZE] = clamped[SIZE:, SIZE:] @ np.linalg.inv(clamped[:SIZE, SIZE:])
    for row, step in enumerate(steps[start:]):
        soft = np.linalg.inv(step[:SIZE, SIZE:])
        at = slice(SIZE * row, SIZE * (row + 2))
        turned = soft @ step[:SIZE, :SIZE]
        result[at, at] += np.block(
            [[turned, -soft], [step[SIZE:, :SIZE] - step[SIZE:, SIZE:] @ turned, step[SIZE:, SIZE:] @ soft]]
        )
    return result
