"""The motion of an arm under pressures over time, from an equilibrium."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from geometry.arrays import Array
from rod.arm.solver import Solver
from rod.checked import positive
from rod.errors import LoadError, RodError
from rod.frames import planar_frames, turn_of
from rod.in_time.air import Air, over_time
from rod.in_time.body import Body, arrays_of
from rod.in_time.equilibrium import elastic_forces, equilibrium
from rod.in_time.motion import Motion
from rod.in_time.steps import LAST, WITHIN, Joined, Memory, Moment, Stepper
from rod.load import Loading
from rod.mechanics.equilibrium import Arm

#: parts of the range of a law between whose pressures sections are joined by straight lines
PARTS = 48
#: how far a pressure may be from the line between two known ones, over their distance
BESIDE = 0.02
#: rounds for the pressure of air, and how exactly the logarithm of its amount is kept
ROUNDS, MISSED = 12, 1e-8
#: how much a step may grow, and shrink; how much it must grow to be changed, and shrink to be made again
GROW, SHRINK, WORTH, AGAIN = 1.5, 0.3, 1.2, 0.6
#: into how many parts a step is divided for Newton's method
MOST_PARTS = 64
#: a note
BEYOND = (
    "Cells bend by up to {:.3g} 1/mm beyond the curvatures of the law; their moment goes on there along its tangent."
)
#: the first step by error, which is the shortest too, over the time of the first vibration through one radian
CAREFUL = 0.02


#: makes a step of a length in s
Step: TypeAlias = Callable[[float], Moment | None]


class Start(NamedTuple):
    """The equilibrium from which a motion begins; all has relaxed there."""

    pressure: float | Sequence[float] | None = None  #: kPa; None: that of a table at its first time, else 0
    acting: Loading | None = None  #: what acts before; None: what acts during the motion


class Steps(NamedTuple):
    """How time is divided, and where the arm may go."""

    fixed: float | None = None  #: s, the length of all steps; None: by their error
    tolerance: float = 5e-3  #: error that a second of motion adds, about, of places over the length
    in_space: bool = False  #: whether the arm may leave its plane; it does where a load does


def move(
    body: Body,
    pressure: Any,
    seconds: float,
    acting: Loading = Loading(),  # noqa: B008  frozen
    start: Start = Start(),  # noqa: B008
    steps: Steps = Steps(),  # noqa: B008
) -> Motion:
    """The motion of an arm from an equilibrium, for a time in s.

    pressure: kPa from 0 s on, one for each cavity, or a table of rows t in s and pressures, joined by straight lines;
    any number for a `Rod`. Where the arm cannot be followed to the end the motion has a `reason`. Raises `RodError` for
    what cannot begin: no mass, times that do not rise, a start that is no equilibrium.
    """
    seconds = positive(seconds, "The time of a motion in s")
    for value, told in ((steps.fixed, "A step in s"), (steps.tolerance, "The tolerance of a second")):
        positive(1.0 if value is None else value, told)
    cavities = len(body.law.cavities)
    is_air = isinstance(pressure, Air)
    rows = over_time(0.0 if is_air else pressure, 1 if is_air else cavities, "The pressure of a motion", "kPa")
    first = rows[0, 1:] if np.ndim(pressure) == 2 else np.zeros(cavities)
    before = np.broadcast_to(np.asarray(first if start.pressure is None else start.pressure, float), cavities)
    moved = _Moved(body, acting, steps)
    moved.begin(before, before if is_air else rows[0, 1:], start.acting or acting)
    if not is_air:
        return moved.along(seconds, partial(moved.step, rows=rows))
    if moved.now.volume == 0.0:
        raise RodError("The law has no volumes of the air; measure it anew with `pneurod cell`.")
    return moved.along(seconds, partial(moved.blown, air=pressure))


class _Moved:
    """An arm on its way."""

    def __init__(self, body: Body, acting: Loading, steps: Steps) -> None:
        self.body, self.acting, self.steps = body, acting, steps
        known = [max(row) for row in body.law.rows]
        self.range = float(np.min(known)), float(np.max(known))
        self.rows: list[tuple[tuple[Arm, Arm], float, tuple[Any, ...]]] = []
        self.outside = 0.0
        self.felt: Array
        self.joined: Joined
        self.shortest = 0.0

    def begin(self, before: Array, first: Array, was: Loading) -> None:
        """In equilibrium at pressures (c,), which become the first ones at once."""
        body = self.body
        then = body.at(before)
        old, self.load = (body.loaded(one, then) for one in (was, self.acting))
        self.in_space = self.steps.in_space or not then.has_plane or old.leaves_plane or self.load.leaves_plane
        solver, state = equilibrium(then, old, self.load, self.in_space)
        creep = np.array(body.creep.shares)
        late = np.multiply.outer(creep, first - before)
        felt = first - late.sum(axis=0)
        self.arms = (body.at(felt),) * 2
        model, posed = self.arms[0].posed(self.load)
        own = Solver(model, solver.s, posed, in_space=self.in_space)
        if len(own.load.held) and not np.array_equal(own.load.held, solver.load.held):
            raise LoadError("What holds an arm in motion must hold it from the start.")
        earlier, elastic = (elastic_forces(one, state) for one in (solver, own))
        forces = np.multiply.outer(body.relaxing(self.arms[0]) * np.array(body.relaxation.shares), elastic - earlier)
        state = state._replace(reaction=state.reaction if len(own.load.held) else np.zeros(0))
        self.stepper = Stepper(own, body.inertia(self.acting, own), body.relaxation, body.creep)
        still = np.zeros((len(own.s), 6))
        memory = Memory(0.0, first, late, elastic, forces)
        self.now = Moment(0.0, state, still, still, memory, before)
        self._know(before, before)
        self.now = replace(self.now, volume=float(self._air(self.now).sum()))
        self._write()
        self._know(felt, felt)

    def along(self, seconds: float, step: Step) -> Motion:
        """By steps up to a time."""
        fixed = self.steps.fixed
        radian = self._radian()
        self.shortest = CAREFUL * radian
        dt, reason = fixed or self.shortest, ""
        if dt > radian:
            told = f"A step of {dt:.3g} s does not resolve a vibration of {0.5 / (math.pi * radian):.2g} Hz"
            return self._motion(f"{told}; take one of {0.1 * radian:.2g} s.")
        try:
            if trial := step(dt):
                self.now = replace(self.now, acceleration=(1.0 - LAST) * trial.acceleration)
            while not reason and (left := seconds - self.now.time) > 1e-12 * seconds:
                dt = left if left <= dt else min(dt, 0.5 * left) if left < 2.0 * dt and not fixed else dt
                dt, reason = self._go(dt, step)
        except RodError as error:
            reason = f"At t = {self.now.time:.4g} s the motion leaves what is known: {error}"
        return self._motion(reason)

    def _go(self, dt: float, step: Step) -> tuple[float, str]:
        """Make a step, and give the next one; and why there is none."""
        trial, fixed = step(dt), self.steps.fixed
        if trial is None:
            ends = dt < (fixed or self.shortest) / MOST_PARTS
            return 0.5 * dt, f"No motion was found beyond t = {self.now.time:.4g} s." if ends else ""
        part = 0.9 * math.sqrt(self.steps.tolerance * dt / max(trial.error, 1e-300))
        if part < AGAIN and not fixed and dt > self.shortest:
            return dt * max(part, SHRINK), ""
        self.now, self.outside = trial, max(self.outside, trial.outside)
        self._write()
        return fixed or (max(dt * min(part, GROW), self.shortest) if part < 1.0 or part > WORTH else dt), ""

    def step(self, dt: float, rows: Array) -> Moment | None:
        """The end of a step under pressures over time, rows (T, 1 + c); None where it is not found."""
        now = self.now
        times = now.time + WITHIN * dt, now.time + dt
        pressures = np.array([np.interp(times, rows[:, 0], values) for values in rows.T[1:]]).T
        felt, late = self.stepper.felt(now.memory, times[0], pressures[0])
        part, distance = self._place(felt)
        if not (-BESIDE <= part <= 1.0 + BESIDE and distance <= BESIDE):
            self._know(felt, self.felt)
        else:
            self.felt = felt
            self.joined.go(part)
        return self.stepper.step(now, dt, self.joined, pressures, late)

    def blown(self, dt: float, air: Air) -> Moment | None:
        """The end of a step under the pressure of air, which changes evenly in it."""
        now = self.now
        before = float(now.pressure[0])
        amount, growth = air.amount(before, now.volume), air.growth(now.time, before, now.volume)
        slope, last = 1.0 / (air.atmosphere + before), (0.0, 0.0)
        pressure = before
        for k in range(ROUNDS):
            trial = self.step(dt, np.array([[now.time, before], [now.time + dt, pressure]]))
            if trial is None:
                return None
            volume = float(self._air(trial)[0])
            more = 0.5 * dt * (growth + air.growth(trial.time, pressure, volume))
            missed = air.amount(pressure, volume) - amount - more
            if abs(missed) < MISSED:
                return replace(trial, volume=volume)
            if k and missed != last[1]:
                slope = (missed - last[1]) / (pressure - last[0])
            last, pressure = (pressure, missed), pressure - missed / slope
        return None

    def _air(self, now: Moment) -> Array:
        """(c,) mm3."""
        state = now.state
        kappa = self._curvatures(state.angle[None], state.frames[None])
        h = np.diff(self.stepper.solver.s)
        low, high = (arm.air_along(h, kappa)[0] for arm in self.arms)
        return np.asarray(low + self.joined.part * (high - low))

    def _curvatures(self, angle: Array, frames: Array) -> Array:
        """(t, n, 3) 1/mm of the elements, from angles (t, N) or frames (t, N, 3, 3) of the nodes."""
        h = np.diff(self.stepper.solver.s)[:, None]
        if self.in_space:
            return np.asarray(turn_of(np.swapaxes(frames[:, :-1], -1, -2) @ frames[:, 1:]) / h)
        return np.diff(angle, axis=1)[..., None] * [0.0, 0.0, 1.0] / h

    def _place(self, felt: Array) -> tuple[float, float]:
        """Where pressures are between the two known ones, and how far beside them, over their distance."""
        low, way = self.known
        size = float(way @ way)
        if size == 0.0:
            return 0.0, 0.0 if np.array_equal(felt, low) else math.inf
        part = float((felt - low) @ way) / size
        return part, float(np.abs(felt - low - part * way).max()) / math.sqrt(size)

    def _know(self, felt: Array, before: Array) -> None:
        """Take the arms at two pressures beside or beyond those that are felt."""
        lowest, highest = self.range
        step = (highest - lowest) / PARTS
        self.felt = felt
        if len(felt) == 1 and lowest <= felt[0] <= highest:
            i = min(math.floor((felt[0] - lowest) / step), PARTS - 1) if step else 0
            low, high = np.array([lowest + i * step]), np.array([min(lowest + (i + 1) * step, highest)])
        else:
            low, way = felt, felt - before
            high = felt + way * (step / max(float(np.abs(way).max()), 1e-300))
        arm = self.body.at(low)
        try:
            self.arms = arm, self.body.at(high)
        except RodError:
            self.arms, high = (arm, arm), low
        self.known = low, high - low
        s = tuple(self.stepper.solver.s.tolist())
        self.joined = Joined(*((*arrays_of(a, self.load, s, self.in_space), self.body.relaxing(a)) for a in self.arms))
        self.joined.go(self._place(felt)[0])

    def _radian(self) -> float:
        """s, of the first vibration through one radian, of a cantilever of the arm's mass, about."""
        solver = self.stepper.solver
        mass, length = float(self.stepper.bodies[0].sum()), solver.chain.length
        return math.sqrt(mass * length**3 / solver.arm.section.rigidity) / 3.516

    def _write(self) -> None:
        """Keep the state, and the end of the material curve beside the axis."""
        state, tip = self.now.state, self.joined.ends.tip[:, 4:]
        frame = state.frames[-1] if self.in_space else planar_frames(state.angle[-1])
        turn = math.atan2(frame[1, 0], frame[0, 0])
        at = (len(tip) - 1) * (0.5 + turn / (2.0 * math.pi))
        i = min(int(at), len(tip) - 2)
        beside = frame @ (tip[i] + (at - i) * (tip[i + 1] - tip[i]))
        row = self.now.time, self.now.pressure, turn, beside, state.reaction, state.place, state.angle, state.frames
        self.rows.append((self.arms, self.joined.part, row))

    def _motion(self, reason: str) -> Motion:
        parts = np.array([part for _, part, _ in self.rows])
        columns = (np.array(one) for one in zip(*(row for _, _, row in self.rows), strict=True))
        times, pressures, turns, beside, reactions, place, angle, frames = columns
        h, d = np.diff(self.stepper.solver.s), 3 if self.in_space else 2
        kappa = self._curvatures(angle, frames)
        airs, outside = [], self.outside
        for arms, group in groupby(range(len(parts)), key=lambda k: self.rows[k][0]):
            rows = list(group)
            low, high = (arm.air_along(h, kappa[rows]) for arm in arms)
            airs.append(low + parts[rows, None] * (high - low))
            outside = max(outside, arms[0].leaves_by(kappa[rows]))
        notes = (BEYOND.format(outside),) if outside > 0.0 else ()
        air, tips, angles = np.concatenate(airs), (place[:, -1] + beside)[:, :d], np.degrees(np.unwrap(turns))
        s = self.stepper.solver.s.copy()
        return Motion(times, pressures, air, tips, angles, reactions, s, place[..., :d], reason, notes)
