"""Small vibrations of an arm about an equilibrium."""

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import LinearOperator, eigsh, splu

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
#: modes in space that are looked at, for each that is asked for in the plane and across
IN_SPACE = 12


class Mode(NamedTuple):
    """A natural vibration, exp(rate t)."""

    frequency_hz: float  #: abs(rate) / (2 pi)
    damping_ratio: float  #: part of the critical damping
    in_plane: bool  #: whether it moves the arm in its plane rather than across


class Undamped(NamedTuple):
    """A vibration without the loss of its rubber."""

    stiff: float  #: 1/s2, stiffness over mass
    relaxing: float  #: 1/s2, the part of it that is the rubber's
    in_plane: bool

    def damped(self, relaxation: Relaxation) -> Mode:
        """These vibrations of a rubber that relaxes."""
        rate = _decaying(self.stiff, self.relaxing, relaxation)
        return Mode(abs(rate) / (2.0 * math.pi), max(0.0, -rate.real / abs(rate)), self.in_plane)


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
    return tuple(sorted(mode.damped(body.relaxation) for mode in undamped(body, pressure, acting, count)))


def undamped(body: Body, pressure: Any, acting: Loading, count: int, *, across: bool = True) -> tuple[Undamped, ...]:
    """These vibrations without damping; across: those across the plane too. Raises `RodError` as `frequencies`."""
    arm = body.at(np.atleast_1d(np.asarray(pressure, float)))
    load = body.loaded(acting, arm)
    in_space = load.leaves_plane or (across and arm.is_in_space)
    less, more = (_modes(body, acting, *equilibrium(arm, load, load, in_space, size), count) for size in (1, 0))
    found, relaxing = [], body.relaxing(arm)
    for (low, *_), (high, elastic, is_flat) in zip(less, more, strict=True):
        stiff = high + (high - low) / 3.0  # at the limit of the elements
        found.append(Undamped(stiff, relaxing * elastic / high * stiff, is_flat))
    return tuple(found)


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
    modes = _lowest(solver, loaded, whole, root, count)
    flat = np.isin(np.arange(len(whole)) % m, (0, 1, 5) if m == 6 else (0, 1, 2))
    shares = np.linalg.norm(root.T @ (flat[:, None] * modes), axis=0)
    found = []
    for is_flat in (True, False):
        for k in np.flatnonzero((shares > math.sqrt(0.5)) == is_flat)[:count]:
            mode = modes[:, k]
            stiff = float(mode @ whole @ mode)
            found.append((stiff, float(mode @ elastic @ mode), is_flat))
    return found


def _lowest(solver: Solver, loaded: Tangent, whole: Array, root: Array, count: int) -> Array:
    """(n, k) modes of a stiffness and the root of a mass (n, n), the lowest first, each with a mass of 1."""
    n, m, held = len(whole), len(loaded.start), solver.load.held
    if not (solver.chain.in_space or len(held)):
        lu, sparse = splu(csc_matrix(whole)), csc_matrix(root)
        soft = LinearOperator((n, n), lambda v: sparse.T @ lu.solve(sparse @ v), dtype=float)
        values, vectors = eigsh(soft, count, which="LA", v0=np.ones(n))
        return np.asarray(lu.solve(sparse @ (vectors / values)[:, np.argsort(-values)]))
    holds = np.zeros((len(held), n))
    for row, (node, _), by_motion in zip(holds, held, loaded.by_motion, strict=True):
        row[m * (node - 1) : m * node] = by_motion[:m]
    kept = np.linalg.svd(holds)[2][len(held) :].T if len(held) else np.eye(n)
    moved = kept @ np.linalg.solve(kept.T @ whole @ kept, kept.T @ root)
    values, vectors = (a[..., : -1 - IN_SPACE * count : -1] for a in np.linalg.eigh(root.T @ moved))
    return np.asarray(moved @ (vectors / values))


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
    heavy, n = np.flatnonzero(mass), len(mass) - 1
    turned = frames[heavy]
    x, y, z = (turned @ first[heavy, :, None])[..., 0].T
    matrices = np.zeros((len(heavy), 6, 6))
    matrices[:, range(3), range(3)] = mass[heavy, None]
    for (i, j), lever in zip(((0, 1), (0, 2), (1, 2)), (z, -y, x), strict=True):
        matrices[:, i, 3 + j] = matrices[:, 3 + j, i] = lever
        matrices[:, j, 3 + i] = matrices[:, 3 + i, j] = -lever
    matrices[:, 3:, 3:] = turned @ second[heavy] @ turned.swapaxes(1, 2)
    kept = [0, 1, 2, 3, 4, 5] if m == 6 else [0, 1, 5]
    root = np.zeros((n, m, n, m))
    root[heavy - 1, :, heavy - 1] = np.linalg.cholesky(matrices[:, kept][:, :, kept])
    return root.reshape(n * m, n * m)
