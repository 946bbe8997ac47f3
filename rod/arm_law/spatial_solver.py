"""The equilibrium of a rod in space: Newton's method at its end, steps of the load from the inflated arm."""

from dataclasses import replace
from typing import Any, NamedTuple, final

import numpy as np

from geometry.arrays import Array, read_only
from geometry.topology import cross
from rod.arm_law.cosserat import LawInSpace, Shapes, Strains, compliance, in_frame, integrate, rotation
from rod.arm_law.integration import DIFFERENCE, MAX_ITERATIONS, TOLERANCE
from rod.arm_law.small_motions import OUT_OF_PLANE, Ends, LoadedRod, stability_of
from rod.arm_law.solver import LARGEST_TURN, SMALLEST_STEP, EndConditions, Pieces, check_within_law, equilibrium
from rod.cubics import cubic, cubic_slope
from rod.errors import RodError, buckles_at
from rod.load import Load
from rod.solution import RodSolution
from rod.spatial import Position, SpatialLoad, SpatialSolution, Stability

ACROSS = np.array([0.0, 0.0, 1.0])


class _End(NamedTuple):
    """c ends."""

    frame: Array  #: (c, 3, 3)
    force: Array  #: (c, 3) N, on the end

    def moved(self, step: Array) -> "_End":
        """The ends after turns about x, y and z in rad and changes of the force in N, (c, 6)."""
        return _End(rotation(step[:, :3]) @ self.frame, self.force + step[:, 3:])


class _State(NamedTuple):
    """c rods."""

    end: _End
    shapes: Shapes
    start: Array  #: (c, 3) mm, of the axis at the clamp
    lever: Array  #: (c, 3) mm, from the end of the axis to the point in which a force acts
    to_end: Array  #: (c, 3) mm, from the end of the axis to that of the material curve
    missed: Array  #: (c, 6): turns at the clamp in rad, and prescribed coordinates of the end over the length
    outside: float  #: N mm, by how much a moment leaves the law


class _Loads(NamedTuple):
    """A part of the loads of a path."""

    force: Array  #: (3,) N
    couple: Array  #: (3,) N mm
    weight: Array  #: (n + 1, 6) as `integrate` takes it
    target: Array  #: (3,) mm, of the end where it is held


@final
class _Shooting:
    """The pieces of an arm under loads; an end is held along the axes with a prescribed position."""

    def __init__(self, pieces: Pieces, load: SpatialLoad, position: Position) -> None:
        self.pieces, self.load = pieces, load
        self.law = LawInSpace.of(pieces.section)
        self.held = np.array([value is not None for value in position])
        self.unknown = np.flatnonzero([True, True, True, *self.held])
        self.tip = EndConditions(Load(), position[:2]).tip_state(pieces.tip)
        columns = np.column_stack([self.tip.couple, self.tip.acts_at, self.tip.beside[:, -1]])
        self.tip_values = self.tip.over_turns(columns)
        self.weight = pieces.weight(load, pieces.positions)
        slope = pieces.section.kappa_slope[len(pieces.section.kappa_slope) // 2]
        # a force that turns the end by about one radian
        self.size = np.array([1.0, 1.0, 1.0, *[1.0 / (pieces.length**2 * slope)] * 3])

    def loads(self, part: float, target: Array) -> _Loads:
        """A part of the loads, with the place at which the end is held meanwhile."""
        load = self.load
        return _Loads(part * np.array(load.force), part * np.array(load.couple), part * self.weight, target)

    def at(self, end: _End, loads: _Loads) -> _State:
        """Integrate from c ends."""
        frame, force = end
        turn, axial = np.arctan2(frame[:, 1, 0], frame[:, 0, 0]), in_frame(frame, force)[:, 0]
        values = cubic(self.tip.turns, *self.tip_values, turn)
        pull = axial[:, None] * self.tip.by_pull[-1]
        lever, to_end = (self._in_space(frame, values[:, k : k + 2] + pull) for k in (1, 3))
        moment = loads.couple + values[:, :1] * ACROSS + cross(lever, force)
        shapes = integrate(self.law, self.pieces.length, loads.weight, force, frame, moment)
        start, clamped, outside = self._clamp(shapes, force + loads.weight[0, :3])
        turned = np.swapaxes(clamped, 1, 2) @ shapes.frames[0]
        missed = np.empty((len(frame), 6))
        missed[:, :3] = 0.5 * (turned[:, [2, 0, 1], [1, 2, 0]] - turned[:, [1, 2, 0], [2, 0, 1]])
        missed[:, 3:] = (start - shapes.axis[0] + to_end - loads.target) / self.pieces.length
        return _State(end, shapes, start, lever, to_end, missed, max(outside, shapes.outside))

    @staticmethod
    def _in_space(frame: Array, beside: Array) -> Array:
        """(c, 3) of lengths (c, 2) along a section's normal and its direction in the plane of symmetry."""
        return np.asarray(frame[:, :, 0] * beside[:, :1] + frame[:, :, 1] * beside[:, 1:])

    def _clamp(self, shapes: Shapes, force: Array) -> tuple[Array, Array, float]:
        """Place (c, 3) and frame (c, 3, 3) of the axis at the clamp under forces (c, 3) there; by how much the moment
        leaves the curve, N mm.

        Out of the plane the end turns about its start, by the moment there.
        """
        clamp, n = self.pieces.clamp, len(shapes.moment) - 1
        row = clamp.position / self.pieces.length * n
        i = min(int(row), n - 1)
        decides = shapes.moment[i] + (row - i) * (shapes.moment[i + 1] - shapes.moment[i])
        bending = decides[:, 2]
        inside = np.clip(bending, clamp.moment[0], clamp.moment[-1])
        by_moment = cubic_slope(clamp.moment, clamp.offset, clamp.offset_by_moment, inside)[:, 0]
        in_plane = clamp.rotation_at(bending) + force[:, 0] * by_moment
        across = shapes.moment[0, :, :2] @ clamp.lateral_compliance.T
        tilted = rotation(np.column_stack([across, np.zeros(len(bending))]))
        place = np.column_stack([clamp.offset_at(bending), np.zeros(len(bending))])
        return place, tilted @ rotation(in_plane[:, None] * ACROSS), float(np.abs(bending - inside).max())

    def converge(self, end: _End, loads: _Loads) -> tuple[_State, Array] | None:
        """The equilibrium near an end, and the matrix of the last step, whose determinant changes its sign where the
        path becomes unstable; None without convergence."""
        end = _End(end.frame, np.where(self.held, end.force, loads.force))
        trial = np.zeros((1 + len(self.unknown), 6))
        trial[1 + np.arange(len(self.unknown)), self.unknown] = DIFFERENCE
        for _ in range(MAX_ITERATIONS):
            with np.errstate(all="ignore"):
                state = self.at(end.moved(trial * self.size), loads)
            missed = state.missed[:, self.unknown]
            matrix = (missed[1:] - missed[0]).T / DIFFERENCE
            if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix)) < 1e-300:
                return None
            step = np.zeros(6)
            step[self.unknown] = np.linalg.solve(matrix, -missed[0])
            largest = float(np.abs(step).max())
            if not largest < 10.0:
                return None
            end = end.moved((step * self.size)[None])
            if largest < TOLERANCE:
                return self.at(end, loads), matrix
        return None


def spatial_equilibrium(pieces: Pieces, load: SpatialLoad, position: Position) -> SpatialSolution:
    """The equilibrium on the path from the inflated arm without load to the full load.

    Where the height of the end is prescribed, and its x is not, the path begins in experiment III. A step that leads to
    an unstable equilibrium is shortened. Raises `RodError` where the path ends or becomes unstable, and where a moment
    leaves the law.
    """
    x, y, _ = position
    inflated = EndConditions(Load(), (None, y if x is None else None))
    planar, tip = equilibrium(pieces, inflated), inflated.tip_state(pieces.tip)
    shooting = _Shooting(pieces, load, position)
    turn = float(planar.theta[-1])
    frame = rotation(turn * ACROSS)
    beside = tip.beside_at(turn, float(planar.force @ frame[:2, 0]))[-1]
    begin = np.array([planar.x[-1], planar.y[-1], 0.0]) + frame[:, :2] @ beside
    goal = np.array([at if held is None else held for at, held in zip(begin, position, strict=True)])
    start = _End(frame[None], np.array([[*planar.force, 0.0]]))
    found = shooting.converge(start, shooting.loads(0.0, begin))
    if found is None:
        raise RodError(f"The inflated arm has no equilibrium at {pieces.section.pressure:g} kPa.")
    (here, matrix), sign = found, np.sign(np.linalg.det(found[1]))
    reached, step, count, before = 0.0, 1.0, 0, np.zeros(6)
    while reached < 1.0:
        part = min(1.0, reached + step)
        ahead = here.end.moved((before * (part - reached))[None])
        found = shooting.converge(ahead, shooting.loads(part, begin + part * (goal - begin)))
        moved = _change(here.end, found[0].end) if found else np.zeros(6)
        is_near = found is not None and float(np.linalg.norm(moved[:3])) <= LARGEST_TURN
        if found is None or not is_near or np.linalg.det(found[1]) * sign < 0.0:
            step = 0.4 * (part - reached)
            if step < SMALLEST_STEP:
                raise RodError(_no_further(reached, matrix, is_near))
            continue
        step, before = 2.0 * (part - reached), moved / (part - reached)
        (here, matrix), reached, count = found, part, count + 1
    return _solution(shooting, here, count)


def _no_further(part: float, matrix: Array, is_near: bool) -> str:
    """Why a path ends beyond a part of the load, at the last matrix of Newton's method."""
    if not is_near:
        return f"No equilibrium was found beyond {100 * part:.3g} % of the load."
    softest = np.abs(np.linalg.svd(matrix)[2][-1])
    return buckles_at(part, out_of_plane=bool(softest[:2].max() > softest[2]))


def _change(first: _End, second: _End) -> Array:
    """(6,) that moves one end to another less than half a turn away."""
    turned = second.frame[0] @ first.frame[0].T
    axis = np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]])
    sine, cosine = 0.5 * float(np.linalg.norm(axis)), 0.5 * (float(np.trace(turned)) - 1.0)
    turn = axis * (0.5 * np.arctan2(sine, cosine) / sine if sine else 0.5)
    return np.concatenate([turn, second.force[0] - first.force[0]])


def _solution(shooting: _Shooting, state: _State, count: int) -> SpatialSolution:
    """The state with its strains and its stability, on the axis. Raises `RodError` beyond the law."""
    pieces, shapes, weight = shooting.pieces, state.shapes, shooting.weight
    frames, moment, force = shapes.frames[:, 0], shapes.moment[:, 0], state.end.force[0]
    check_within_law(pieces, state.outside, in_frame(frames, moment)[:, 2], bool(weight.any()))
    rod, strains = _loaded(shooting.law, pieces.positions, frames, moment, force, weight)
    ends = Ends.of(pieces.clamp, moment, state.lever[0], state.to_end[0], shooting.held)
    arrays: dict[str, Any] = {
        "s": rod.s,
        "axis": shapes.axis[:, 0] - shapes.axis[0, 0] + state.start[0],
        "frames": frames,
        "curvature": strains.curvature,
        "stretch": strains.stretch,
        "moment": moment,
        "force": force,
        "weight": weight[0, :3],
        "beside": np.zeros((len(frames), 2)),
    }
    frozen: dict[str, Any] = {name: read_only(array) for name, array in arrays.items()}
    return SpatialSolution(**frozen, stability=stability_of(rod, ends), load_steps=count, notes=())


def _loaded(
    law: LawInSpace, s: Array, frames: Array, moment: Array, force: Array, weight: Array
) -> tuple[LoadedRod, Strains]:
    """A rod at positions s (n,) with frames (n, 3, 3) and moments (n, 3), and its strains.

    force: (3,) N, on the end. weight: (n, 6) as `integrate` takes it.
    """
    acting = force + weight[:, :3]
    inner = in_frame(frames, acting), in_frame(frames, moment)
    strains = law.strains(*inner)
    rate = (frames @ strains.stretch[..., None])[..., 0]
    couple = np.gradient(-weight[:, 3:], s, axis=0)
    return LoadedRod(s, frames, rate, moment, acting, couple, compliance(law, *inner)), strains


def stability_across(pieces: Pieces, state: RodSolution) -> Stability:
    """Of a planar equilibrium against motions out of the plane; its end is free along z.

    The force on the end keeps its direction. It acts where it makes the moment of the end.
    """
    frames, moment = rotation(state.theta[:, None] * ACROSS), state.moment[:, None] * ACROSS
    x, y = (float(part) / pieces.length for part in state.weight)
    weight, force = pieces.weight(SpatialLoad(weight=(x, y, 0.0)), state.s), np.append(state.force, 0.0)
    rod, _ = _loaded(LawInSpace.of(pieces.section), state.s, frames, moment, force, weight)
    lever = frames[-1, :, :2] @ pieces.tip.edge
    if square := float(force @ force):
        lever = lever + cross(force, moment[-1] - cross(lever, force)) / square
    ends = Ends.of(pieces.clamp, moment, lever, lever, np.zeros(3, bool))
    return stability_of(rod, replace(ends, kept=OUT_OF_PLANE))
