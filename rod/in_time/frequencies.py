"""Small vibrations of an arm about an equilibrium."""

import math
from typing import Any, NamedTuple

import numpy as np

from geometry.arrays import Array
from rod.arm.nodes import StateArrays, Tangent
from rod.arm.small_motions import tangent_of
from rod.arm.solver import Solver
from rod.frames import planar_frames
from rod.in_time.body import Body
from rod.in_time.equilibrium import equilibrium
from rod.in_time.relaxation import Relaxation
from rod.load import Loading

#: iterations of Newton's method for a decaying vibration
ITERATIONS = 30


class Mode(NamedTuple):
    """A natural vibration, exp(rate t)."""

    frequency_hz: float  #: abs(rate) / (2 pi)
    damping_ratio: float  #: part of the critical damping
    in_plane: bool  #: whether it moves the arm in its plane rather than across


def frequencies(
    body: Body,
    pressure: Any,
    acting: Loading = Loading(),  # noqa: B008  frozen
    count: int = 3,
) -> tuple[Mode, ...]:
    """The lowest vibrations about the equilibrium at a pressure (kPa, one for each cavity), lowest first.

    `count` of them in the plane, and as many across where the law knows that. Moduli are those at the frequency, the
    shape that at long times. Raises `RodError` where the arm has no mass, or no such equilibrium.
    """
    arm = body.at(np.atleast_1d(np.asarray(pressure, float)))
    load = body.loaded(acting, arm)
    in_space = load.leaves_plane or arm.is_in_space
    less, more = (_modes(body, acting, *equilibrium(arm, load, load, in_space, size), count) for size in (1, 0))
    found, relaxing = [], body.relaxing(arm)
    for (low, *_), (high, elastic, is_flat) in zip(less, more, strict=True):
        stiff = high + (high - low) / 3.0  # at the limit of the elements
        rate = _decaying(stiff, relaxing * elastic / high * stiff, body.relaxation)
        found.append(Mode(abs(rate) / (2.0 * math.pi), max(0.0, -rate.real / abs(rate)), is_flat))
    return tuple(sorted(found))


def _decaying(stiff: float, elastic: float, relaxation: Relaxation) -> complex:
    """The rate of a mode by its stiffness over its mass (1/s2), and the part of it that relaxes."""
    rate = 1j * math.sqrt(abs(stiff))
    for _ in range(ITERATIONS):
        rate = 1j * np.sqrt(stiff + elastic * complex(relaxation.dynamic(rate) - 1.0))
    return complex(rate)


def _modes(
    body: Body, acting: Loading, solver: Solver, state: StateArrays, count: int
) -> list[tuple[float, float, bool]]:
    """Stiffnesses over masses and their elastic part in 1/s2 of the lowest modes, in the plane and then across."""
    m = 6 if solver.chain.in_space else 3
    loaded, free = (tangent_of(solver, solver.load, state, is_loaded=is_loaded) for is_loaded in (True, False))
    whole, elastic = _matrix(loaded), _matrix(free)
    frames = state.frames if solver.chain.in_space else planar_frames(state.angle)
    root = _roots(*body.inertia(acting, solver), frames, m)
    kept = np.eye(len(whole))
    if count_held := len(solver.load.held):
        holds = np.zeros((count_held, len(whole)))
        for row, (node, _), by_motion in zip(holds, solver.load.held, loaded.by_motion, strict=True):
            row[m * (node - 1) : m * node] = by_motion[:m]
        kept = np.linalg.svd(holds)[2][count_held:].T
    soft = kept @ np.linalg.solve(kept.T @ whole @ kept, kept.T @ root)
    values, vectors = np.linalg.eigh(root.T @ soft)
    modes = soft @ vectors[:, ::-1]
    flat = np.isin(np.arange(len(whole)) % m, (0, 1, 5) if m == 6 else (0, 1, 2))
    shares = np.linalg.norm(root.T @ (flat[:, None] * modes[:, : 12 * count]), axis=0) / values[::-1][: 12 * count]
    found = []
    for is_flat in (True, False):
        for k in np.flatnonzero((shares > math.sqrt(0.5)) == is_flat)[:count]:
            mode = modes[:, k] / values[::-1][k]
            stiff = float(mode @ whole @ mode)
            found.append((stiff, float(mode @ elastic @ mode), is_flat))
    return found


def _matrix(tangent: Tangent) -> Array:
    """The symmetric matrix of a tangent, of the nodes beyond the clamp."""
    rows, width = tangent.band.shape
    wide = np.zeros((rows, rows + width))
    for k in range(rows):
        wide[k, k : k + width] = tangent.band[k]
    matrix = wide[:, width // 2 : width // 2 + rows]
    return np.asarray(0.5 * (matrix + matrix.T))


def _roots(mass: Array, first: Array, second: Array, frames: Array, m: int) -> Array:
    """L (m (N - 1), m (N - 1)) of the mass matrix L L^T of all nodes but the first."""
    root = np.zeros((m * (len(mass) - 1),) * 2)
    kept = [0, 1, 2, 3, 4, 5] if m == 6 else [0, 1, 5]
    for node in np.flatnonzero(mass):
        x, y, z = frames[node] @ first[node]
        lever = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        turning = frames[node] @ second[node] @ frames[node].T
        matrix = np.block([[mass[node] * np.eye(3), -lever], [lever, turning]])[np.ix_(kept, kept)]
        at = slice(m * (node - 1), m * node)
        root[at, at] = np.linalg.cholesky(matrix)
    return root
