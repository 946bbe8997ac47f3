"""The equilibrium of a rod in space: Newton's method at its end, steps of the load from the inflated arm."""

from typing import Any, NamedTuple, Protocol, final

import numpy as np

from geometry.arrays import Array, read_only
from geometry.topology import cross
from rod.arm_law.cosserat import Shapes, StrainLaw, in_frame, integrate, rotation
from rod.arm_law.integration import DIFFERENCE, MAX_ITERATIONS, TOLERANCE
from rod.arm_law.small_motions import Ends, loaded_rod, stability_of
from rod.arm_law.solver import LARGEST_TURN, SMALLEST_STEP
from rod.errors import RodError, buckles_at
from rod.spatial import Position, SpatialLoad, SpatialSolution


class SpatialArm(Protocol):
    """An arm in space with its law and its ends, under one way of holding its end."""

    @property
    def law(self) -> StrainLaw:
        """The law of its sections."""

    @property
    def length(self) -> float:
        """mm"""

    @property
    def positions(self) -> Array:
        """(n + 1,) mm: where the integration steps end, from 0 to the length."""

    @property
    def rigidity(self) -> float:
        """Against bending, about, N mm2."""

    def weight(self, load: SpatialLoad) -> Array:
        """(n + 1, 6) N and N mm: the weight of a load beyond the positions, as `integrate` takes it."""

    def inflated(self) -> tuple[Array, Array, Array]:
        """Without loads, about: the frame (3, 3) and the force (3,) of the end, and the place (3,) of the curve's."""

    def tip(self, frame: Array, force: Array) -> tuple[Array, Array, Array]:
        """Of c ends with frames (c, 3, 3) and forces (c, 3): couples (N mm), and from the end of the axis the points in
        which the forces act, and the ends of the material curve (mm), (c, 3) each."""

    def clamped(self, shapes: Shapes, force: Array) -> tuple[Array, Array, float]:
        """Place (c, 3) and frame (c, 3, 3) of the axis at the clamp under forces (c, 3) there; by how much the moment
        leaves what is known of the clamped end."""

    def check(self, outside: float, moment: Array, is_weighed: bool) -> None:
        """Raise `RodError` where moments (n, 3) in the frames leave the law by so much."""

    def ends(self, moment: Array, lever: Array, to_end: Array, held: Array) -> Ends:
        """What holds the rod with moments (n, 3)."""


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

    def __init__(self, arm: SpatialArm, load: SpatialLoad, position: Position) -> None:
        self.arm, self.load = arm, load
        self.held = np.array([value is not None for value in position])
        self.unknown = np.flatnonzero([True, True, True, *self.held])
        self.weight = arm.weight(load)
        # a force that turns the end by about one radian
        self.size = np.array([1.0, 1.0, 1.0, *[arm.rigidity / arm.length**2] * 3])

    def loads(self, part: float, target: Array) -> _Loads:
        """A part of the loads, with the place at which the end is held meanwhile."""
        load = self.load
        return _Loads(part * np.array(load.force), part * np.array(load.couple), part * self.weight, target)

    def at(self, end: _End, loads: _Loads) -> _State:
        """Integrate from c ends."""
        frame, force = end
        couple, lever, to_end = self.arm.tip(frame, force)
        moment = loads.couple + couple + cross(lever, force)
        shapes = integrate(self.arm.law, self.arm.length, loads.weight, force, frame, moment)
        start, clamped, outside = self.arm.clamped(shapes, force + loads.weight[0, :3])
        turned = np.swapaxes(clamped, 1, 2) @ shapes.frames[0]
        missed = np.empty((len(frame), 6))
        missed[:, :3] = 0.5 * (turned[:, [2, 0, 1], [1, 2, 0]] - turned[:, [1, 2, 0], [2, 0, 1]])
        missed[:, 3:] = (start - shapes.axis[0] + to_end - loads.target) / self.arm.length
        return _State(end, shapes, start, lever, to_end, missed, max(outside, shapes.outside))

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


def spatial_equilibrium(arm: SpatialArm, load: SpatialLoad, position: Position) -> SpatialSolution:
    """The equilibrium on the path from the inflated arm without load to the full load.

    A step that leads to an unstable equilibrium is shortened. Raises `RodError` where the path ends or becomes
    unstable, and where a moment leaves the law.
    """
    shooting = _Shooting(arm, load, position)
    frame, force, begin = arm.inflated()
    goal = np.array([at if held is None else held for at, held in zip(begin, position, strict=True)])
    found = shooting.converge(_End(frame[None], force[None]), shooting.loads(0.0, begin))
    if found is None:
        raise RodError("The inflated arm has no equilibrium without loads.")
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
    arm, shapes, weight = shooting.arm, state.shapes, shooting.weight
    frames, moment, force = shapes.frames[:, 0], shapes.moment[:, 0], state.end.force[0]
    arm.check(state.outside, in_frame(frames, moment), bool(weight.any()))
    rod, strains = loaded_rod(arm.law, arm.positions, frames, moment, force, weight)
    ends = arm.ends(moment, state.lever[0], state.to_end[0], shooting.held)
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
