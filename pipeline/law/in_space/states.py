"""States of the pieces of an arm without a plane of symmetry; each is a task of a worker, solved once and kept."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from math import atan2, ceil, hypot, pi
from time import perf_counter
from typing import TypeVar

import numpy as np
from scipy.spatial.transform import Rotation

from fem.cell.across import Straight, twist_and_shear
from fem.cell.air import air_volumes
from fem.cell.any_plane import bent_from_straight, bent_state, frame_of, moment_beside
from fem.cell.boundary import Boundary, spread
from fem.cell.inflation import inflated
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import slopes
from geometry.arrays import Array
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.point import stable
from pipeline.law.piece.tasks import PieceCurves
from pipeline.store.kept import KeptFile
from pipeline.values.pressure import KPA_PER_MPA, in_MPa
from rod.same_pressure import Pressures

#: how far an end reaches into the cells, over the largest side of a section
INTO = 0.6
#: part of the largest pressure from which on a straight piece is inflated from its state at half of the pressure
FAR = 0.65
#: what each kind of states is called where they are told
TOLD = {"cell": "cell", "across": "twist and shear", "clamp": "clamped end", "tip": "tip"}
Curvatures = tuple[float, float]  #: about y and z, 1/mm
State = TypeVar("State")


@dataclass(frozen=True)
class CellState:
    """A bent half cell. Vectors are those about y and z; slopes are those along the curvature and the pressures."""

    pressures: Pressures
    curvature: Curvatures
    across: tuple[float, float]  #: the direction across that of the curvature
    along: tuple[float, float]  #: the direction of the curvature
    moment: tuple[float, float]  #: N mm, across and along, and so are the others
    by_curvature: tuple[float, float]  #: N mm2
    by_pressure: tuple[float, float]  #: N mm per kPa of the largest pressure, with all in proportion
    stretch: float
    stretch_by_curvature: float  #: mm
    stretch_by_pressure: float  #: 1/kPa
    axial_rigidity: float  #: N
    beside: tuple[float, float]  #: mm, the material curve beside the axis between two cells, along y and z there
    volume: tuple[float, ...]  #: mm2, air per rest length in each cavity

    @property
    def vector(self) -> Array:
        """(2,) N mm: the moments about y and z."""
        return np.asarray(self.moment[0] * np.array(self.across) + self.moment[1] * np.array(self.along))


@dataclass(frozen=True)
class EndState:
    """The clamped end under a moment, or the other end without."""

    pressures: Pressures
    length: float  #: mm, of the piece at rest
    moment: tuple[float, float, float]  #: N mm, along x, y and z
    turn: tuple[float, float, float]  #: rotation vector of its plane, rad
    place: tuple[float, float, float]  #: mm, from the clamped end of the material curve, or from the plane to its end
    volume: tuple[float, ...]  #: mm3, air in each cavity of the piece


def cell_state(curves: PieceCurves, pressures: Pressures, curvature: Curvatures) -> CellState:
    """Half a cell that is bent; a task. Raises `PieceFailed`, as the others, where there is no such state."""

    def solve() -> CellState:
        angle, size = _direction(curvature)
        piece, at = _inflated(curves, "mirror", angle, pressures, size)
        with stable(piece, at):
            found = bent_state(piece, at, slopes(piece, at))
        across, along = frame_of(angle)
        return CellState(
            pressures,
            curvature,
            _pair(across),
            _pair(along),
            _pair(found.moment),
            _pair(found.by_curvature),
            _pair(found.by_pressure / KPA_PER_MPA),
            found.stretch,
            found.stretch_by_curvature,
            found.stretch_by_pressure / KPA_PER_MPA,
            found.axial_rigidity,
            _pair(_beside(piece, at, found.stretch) @ frame_of(angle)),
            _air(piece, at, piece.body.length),
        )

    return _kept(curves, CellState, "cell", solve, pressures, curvature)


def across_state(curves: PieceCurves, pressures: Pressures) -> list[float]:
    """The six upper components of the compliance against twist and shear, of the straight cell; a task."""

    def solve() -> list[float]:
        states = []
        for angle in (0.0, pi / 2):  # as `twist_and_shear` takes it
            piece, at = _inflated(curves, "mirror", angle, pressures, 0.0)
            with stable(piece, at):
                states.append(Straight(piece, at, slopes(piece, at)))
        with stable(states[0].piece, states[0].at):
            return [float(value) for value in twist_and_shear(*states)[np.triu_indices(3)]]

    return _kept(curves, list[float], "across", solve, pressures)


def clamped_state(curves: PieceCurves, pressures: Pressures, curvature: Curvatures) -> EndState:
    """The clamped end, its plane turned about as cells of that curvature turn; a task."""

    def solve() -> EndState:
        angle, size = _direction(curvature)
        piece, at = _inflated(curves, "clamp", angle, pressures, size)
        with stable(piece, at):
            moments = np.array([moment_beside(piece, at), at.moment])
        about_z = Rotation.from_rotvec([0.0, 0.0, at.angle])
        beside, across = about_z.apply([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
        turn = (about_z * Rotation.from_rotvec([_turn(piece, at, about_z), 0.0, 0.0])).as_rotvec()
        x = piece.space.points[piece.curve] + at.state.displacement[piece.curve]
        place = x[-1] - piece.space.points[piece.curve[0]]
        moment = moments[0] * beside + moments[1] * across
        acting, turned, moved = (_in_body(vector, angle) for vector in (moment, turn, place))
        return EndState(pressures, piece.body.length, acting, turned, moved, _air(piece, at))

    return _kept(curves, EndState, "clamp", solve, pressures, curvature)


def free_state(curves: PieceCurves, pressures: Pressures) -> EndState:
    """The other end, without moment; a task."""

    def solve() -> EndState:
        piece, at = _inflated(curves, "free", 0.0, pressures, 0.0)
        x = piece.space.points[piece.curve] + at.state.displacement[piece.curve]
        place = (x[0] - x[-1]) * [-1.0, 1.0, 1.0]  # the piece is the mirror image of the end
        none = (0.0, 0.0, 0.0)
        return EndState(pressures, piece.body.length, none, none, _in_body(place, 0.0), _air(piece, at))

    return _kept(curves, EndState, "tip", solve, pressures)


def _kept(
    curves: PieceCurves,
    kind: type[State],
    name: str,
    solve: Callable[[], State],
    pressures: Pressures,
    curvature: Sequence[float] = (),
) -> State:
    """The state, which is told; one without equilibrium is told too, because it is no longer waited for."""
    key = sha256(repr([f"{number:.12g}" for number in (*pressures, *curvature)]).encode()).hexdigest()[:16]
    file = f"law_in_space/{curves.pieces.mesh_name}/{name}_{key}.json"
    kept: KeptFile[State] = KeptFile.of_run(curves.store, file, kind)
    seconds = 0.0

    def solved() -> State:
        nonlocal seconds
        begin = perf_counter()
        try:
            return solve()
        finally:
            seconds = perf_counter() - begin

    try:
        return kept.read_or_make(solved)
    finally:
        curves.progress.step_done(TOLD[name], max(pressures), seconds)


def _inflated(
    curves: PieceCurves, start: Boundary, angle: float, pressures: Pressures, curvature: float
) -> tuple[BendingPiece, PieceState]:
    """A piece, turned by an angle, at pressures and with its plane turned by a curvature times its length.

    It is bent from its straight state, which is solved once for all directions.
    """
    pieces, largest = curves.pieces, max(map(abs, pressures))
    fractions = tuple(pressure / largest if largest else 1.0 for pressure in pressures)
    own = start, _half_cells(pieces, start), fractions
    from_half = largest > FAR * max(pieces.config.pressures_kPa)
    straight = pieces.straight(*own, in_MPa(largest), from_half)
    piece = pieces.turned(*own, angle)
    bend = curvature * piece.body.length
    with suppress(PieceFailed):
        return piece, bent_from_straight(piece, angle, straight, bend)
    return piece, inflated(piece, in_MPa(largest), bend)


def _half_cells(pieces: ArmPieces, start: Boundary) -> int:
    """In a piece: of the clamped end an even number, of the other end an odd one."""
    repetition = pieces.repetition
    far = ceil(INTO * max(pieces.design.extent[1:]) / repetition.half_pitch)
    count = {"mirror": 0, "clamp": far + far % 2, "free": far + 1 - far % 2}[start]
    return min(count, repetition.half_cells - (start == "free"))


def _direction(curvature: Curvatures) -> tuple[float, float]:
    """The angle by which the body is turned to bend about z, and the size of the curvature."""
    return atan2(-curvature[0], curvature[1]), hypot(*curvature)


def _turn(piece: BendingPiece, at: PieceState, about_z: Rotation) -> float:
    """How far the plane has turned about its normal on the average, rad."""
    nodes, weights, lever = spread(piece.space, "tip")
    x = about_z.inv().apply(piece.space.points[nodes] + at.state.displacement[nodes])
    moved = x - piece.space.points[nodes]
    around = lever[:, 1] * moved[:, 2] - lever[:, 2] * moved[:, 1]
    return float(weights @ around / (weights @ (lever[:, 1:] ** 2).sum(axis=1)))


def _beside(piece: BendingPiece, at: PieceState, stretch: float) -> Array:
    """(2,) mm: the material curve beside the arc through it in the middle of cells, in the plane at the end."""
    phi, node = at.angle, piece.curve[-1]
    x = piece.space.points[node] + at.state.displacement[node]
    risen = 0.5 * stretch * piece.body.length * phi * float(np.sinc(phi / (2.0 * np.pi))) ** 2
    along = stretch * piece.body.length * float(np.sinc(phi / np.pi))
    away = x[:2] - np.array([along, piece.body.curve_y + risen])
    return np.array([away @ [-np.sin(phi), np.cos(phi)], x[2]])


def _air(piece: BendingPiece, at: PieceState, per: float = 1.0) -> tuple[float, ...]:
    """Air in each cavity of a piece over a length."""
    return tuple((air_volumes(piece.body, piece.space, at.state.displacement) / per).tolist())


def _in_body(vector: Array, angle: float) -> tuple[float, float, float]:
    """A vector (3,) of the turned body in the body."""
    x, (y, z) = vector[0], vector[1:] @ frame_of(angle)
    return float(x), float(y), float(z)


def _pair(values: Array) -> tuple[float, float]:
    first, second = values
    return float(first), float(second)
