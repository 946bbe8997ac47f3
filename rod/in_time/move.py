"""The motion of an arm under pressures over time, from an equilibrium: for a time, or step by step in a loop."""

import math
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import partial
from itertools import groupby
from typing import Any, NamedTuple, TypeAlias, final

import numpy as np

from geometry.arrays import Array
from rod.along import triple
from rod.arm import step_kernels
from rod.arm.nodes import StateArrays
from rod.arm.solver import Solver
from rod.checked import positive
from rod.errors import LoadError, RodError
from rod.frames import planar_frames, rotation, turn_of
from rod.in_time.air import Air, over_time
from rod.in_time.body import Body, arrays_of
from rod.in_time.equilibrium import elastic_forces, equilibrium
from rod.in_time.motion import Instant, Motion
from rod.in_time.steps import Joined, Moment, Stepper
from rod.load import Loading
from rod.mechanics.equilibrium import Arm

#: parts of the range of a law between whose pressures sections are joined by straight lines
PARTS = 48
#: rounds for the pressure of air, and how exactly the logarithm of its amount is kept
ROUNDS, MISSED = 12, 1e-8
#: how much a step may grow, and shrink; how much it must grow to be changed, and shrink to be made again
GROW, SHRINK, WORTH, AGAIN = 1.5, 0.3, 1.2, 0.6
#: into how many parts a step is divided for Newton's method
MOST_PARTS = 64
#: a note
BEYOND = (
    "Cells bend by up to {:.3g} 1/mm beyond the curvatures of the law, first at {:.3g} s; their moment goes on there "
    "along its tangent."
)
#: the first step by error, which is the shortest too, over the time of the first vibration through one radian; the same
#: in a loop; and how many such times a speed is remembered
CAREFUL, IN_LOOP, REMEMBERED = 0.03, 0.0625, 12.0
#: error of a step that is no motion, over the length
STILL = 1e-9
#: part of the curvatures of a law by which cells may leave it, and s for which they may leave it farther, in a wave
SLIGHT, BRIEF = 0.1, 5e-3
#: part of the curvatures of a law that is rounded
ROUNDED = 1e-6
#: power of a place along a cantilever that is as its first mode squared, in the kinetic energy
LIKE_MODE = 3.12
#: numbers of a moment that belong to the state of a motion
KEPT = ("time", "within", "felt_then", "late", "pressure", "fast", "volume")


#: makes a step of a length in s
Step: TypeAlias = Callable[[float], Moment | None]
#: is told the time in s
Listener: TypeAlias = Callable[[float], None]


class Start(NamedTuple):
    """The equilibrium from which a motion begins; all has relaxed there."""

    pressure: float | Sequence[float] | None = None  #: kPa; None: that of a table at its first time, else 0
    acting: Loading | None = None  #: what acts before; None: what acts during the motion


class Steps(NamedTuple):
    """How time is divided, and where the arm may go."""

    fixed: float | None = None  #: s, the length of all steps; None: by their error
    tolerance: float = 3e-4  #: error of a step, over the amplitude of the motion
    in_space: bool = False  #: whether the arm may leave its plane; it does where a load does


def move(
    body: Body,
    pressure: Any,
    seconds: float,
    acting: Loading = Loading(),  # noqa: B008  frozen
    start: Start = Start(),  # noqa: B008
    steps: Steps = Steps(),  # noqa: B008
    tell: Listener | None = None,
) -> Motion:
    """The motion of an arm from an equilibrium, for a time in s.

    pressure: kPa from 0 s on, one for each cavity, or a table of rows t in s and pressures, joined by straight lines;
    any number for a `Rod`. tell: is called after each step. Where the arm cannot be followed to the end, or an
    interrupt stops it, the motion has a `reason`. Raises `RodError` for what cannot begin: no mass, times that do not
    rise, a start that is no equilibrium.
    """
    seconds = positive(seconds, "The time of a motion in s")
    for value, told in ((steps.fixed, "A step in s"), (steps.tolerance, "The tolerance of a step")):
        positive(1.0 if value is None else value, told)
    cavities = len(body.law.cavities)
    is_air = isinstance(pressure, Air)
    rows = over_time(0.0 if is_air else pressure, 1 if is_air else cavities, "The pressure of a motion", "kPa")
    first = rows[0, 1:] if np.ndim(pressure) == 2 else np.zeros(cavities)
    before = np.broadcast_to(np.asarray(first if start.pressure is None else start.pressure, float), cavities)
    moved = MovingArm(body, acting, steps)
    moved.begin(before, before if is_air else rows[0, 1:], start.acting or acting)
    if not is_air:
        return moved.along(seconds, partial(moved.forward, rows=rows), tell)
    if moved.now.volume == 0.0:
        raise RodError("The law has no volumes of the air; measure it anew with `pneurod cell`.")
    return moved.along(seconds, partial(moved.blown, air=pressure), tell)


@final
class MovingArm:
    """An arm on its way."""

    def __init__(self, body: Body, acting: Loading, steps: Steps) -> None:
        self.body, self.acting, self.steps = body, acting, steps
        self.range = float(np.min(body.law.rows)), float(np.max(body.law.rows))
        self.rows: list[tuple[tuple[Arm, ...], Array, tuple[Any, ...]]] = []
        self.side = 1.0  #: of the angle of the end

    @classmethod
    def at_rest(
        cls,
        body: Body,
        pressure: float | Sequence[float] = 0.0,
        acting: Loading = Loading(),  # noqa: B008  frozen
        steps: Steps = Steps(),  # noqa: B008
    ) -> "MovingArm":
        """An arm in equilibrium at a pressure (kPa, one for each cavity), to be moved by `step`. Raises as `move`."""
        arm = cls(body, acting, steps)
        at = np.broadcast_to(np.asarray(pressure, float), len(body.law.cavities))
        arm.begin(at, at, acting)
        arm.shortest = IN_LOOP * arm.radian
        return arm

    def begin(self, before: Array, first: Array, was: Loading) -> None:
        """Begin in equilibrium at pressures (c,), which become the first ones at once."""
        body = self.body
        then = body.at(before)
        old, self.load = (body.loaded(one, then) for one in (was, self.acting))
        self.in_space = self.steps.in_space or not then.has_plane or old.leaves_plane or self.load.leaves_plane
        solver, state = equilibrium(then, old, self.load, self.in_space, 2)
        creep = np.array(body.creep.shares)
        late = np.multiply.outer(creep, first - before)
        felt = first - late.sum(axis=0)
        arm = body.at(felt)
        model, posed = arm.posed(self.load)
        own = Solver(model, solver.s, posed, in_space=self.in_space)
        if len(own.load.held) and not np.array_equal(own.load.held, solver.load.held):
            raise LoadError("What holds an arm in motion must hold it from the start.")
        earlier, elastic = (elastic_forces(one, state) for one in (solver, own))
        forces = np.multiply.outer(body.relaxing(arm) * np.array(body.relaxation.shares), elastic - earlier)
        state = state._replace(reaction=state.reaction if len(own.load.held) else np.zeros(0))
        self.stepper = Stepper(own, body.inertia(self.acting, own), body.relaxation, body.creep)
        still = np.zeros((len(own.s), 6))
        self.now = Moment(0.0, step_kernels.Moving(state, still, still, elastic, forces), 0.0, first, late, before)
        self.radian = self._radian()
        self.shortest = CAREFUL * self.radian
        self.next = self.steps.fixed or self.shortest
        self._know(before)
        self.now = replace(self.now, volume=float(self._air(self.now).sum()))
        self._write()
        self.inside = self.now, 1
        self._know(felt)

    def step(self, dt: float, pressure_kPa: Any = None, force: Any = None) -> Instant:
        """Move for a time dt in s; where the arm is then.

        pressure_kPa: at the end of it, to which it goes evenly, one for each cavity; None: as it is. force: N, dead, on
        the end all the time, as `Rod.solve` takes it; None: as it is. Raises `RodError` for what is none of these, and
        where the arm cannot be followed; it then stays where it was.
        """
        begun, load = self._begun(), self.stepper.solver.load
        self.rows.clear()
        now, end = self.now, self.now.time + positive(dt, "A time in s")
        try:
            if force is not None:
                self._push(force)
            after = now.pressure if pressure_kPa is None else np.atleast_1d(np.asarray(pressure_kPa, float))
            if after.shape != now.pressure.shape or not np.isfinite(after).all():
                raise RodError(f"pressure_kPa is a number for each of {', '.join(self.body.law.cavities)}.")
            rows = np.array([[now.time, *now.pressure], [end, *after]])
            if reason := self._until(end, partial(self.forward, rows=rows)):
                raise RodError(reason)
        except (RodError, ValueError, TypeError) as failure:
            self.__dict__.update(begun)
            self.rows.clear()
            self.stepper.solver.load = load
            raise RodError(str(failure)) from None
        return self.seen

    @property
    def seen(self) -> Instant:
        """Where the arm is."""
        if not self.rows:
            self._write()
        *_, (time, pressure, turn, beside, _, outside, place, angle, frames) = self.rows[-1]
        d = 3 if self.in_space else 2
        kappa = self._curvatures(angle[None], frames[None])[0]
        tip, volume = (place[-1] + beside)[:d], self._volumes(self.arms, self.joined.parts[None], kappa[None])[0]
        bent = kappa if self.in_space else kappa[:, 2]
        return Instant(time, place[:, :d], tip, self.side * math.degrees(turn), bent, pressure, volume, outside)

    def copy(self) -> "MovingArm":
        """Another one, in the same state."""
        other = copy(self)
        other.stepper, other.rows = copy(self.stepper), []
        other.stepper.solver = copy(self.stepper.solver)
        return other

    @property
    def state(self) -> dict[str, Array]:
        """All that decides how it goes on, as copied arrays by their names; may be stored, and put back into this arm
        or one that began in the same way."""
        now, load = self.now, self.stepper.solver.load
        moving = now.moving._asdict() | now.moving.state._asdict()
        del moving["state"]
        rest = {name: getattr(now, name) for name in KEPT} | {"force": load.force, "step": self.next}
        return {name: np.array(value) for name, value in (moving | rest).items()}

    @state.setter
    def state(self, given: Mapping[str, Array]) -> None:
        known = self.state
        if set(given) != set(known) or any(np.shape(given[name]) != known[name].shape for name in known):
            raise RodError("This is no state of this arm.")
        now = {name: np.array(given[name], float) for name in known}
        state = StateArrays(*(now[name] for name in StateArrays._fields))
        moving = step_kernels.Moving(state, *(now[name] for name in step_kernels.Moving._fields[1:]))
        values: dict[str, Any] = {name: now[name] if now[name].ndim else float(now[name]) for name in KEPT}
        self.now = replace(self.now, moving=moving, **values)
        self.rows.clear()
        self.inside, self.next = (self.now, 0), float(now["step"])
        self.stepper.solver.load = self.stepper.solver.load._replace(force=now["force"])
        self._know(self.stepper.felt(self.now, self.now.time, self.now.pressure)[0])

    def _begun(self) -> dict[str, Any]:
        """What a step that fails puts back."""
        return {name: getattr(self, name) for name in ("now", "inside", "next", "known", "joined", "arms")}

    def _push(self, force: Any) -> None:
        """Let another dead force act on the end."""
        after = replace(self.acting, force=force, end=None)
        change = np.array(triple(after.force, "force", "N"))
        change -= triple(self.acting.force or (0.0, 0.0), "force", "N")
        if not self.in_space and after.is_spatial:
            raise RodError("A force across its plane needs an arm that moves in space from the start.")
        if self.load.end_at(self.stepper.solver.chain.length) != (None, None, None):
            raise RodError("The end is held; no other force acts on it.")
        load = self.stepper.solver.load
        self.stepper.solver.load = load._replace(force=np.array(self.load.force) + change)

    def along(self, seconds: float, step: Step, tell: Listener | None = None) -> Motion:
        """Go on by steps up to a time."""
        fixed = self.steps.fixed
        if fixed and fixed > self.radian:
            told = f"A step of {fixed:.3g} s does not resolve a vibration of {0.5 / (math.pi * self.radian):.2g} Hz"
            return self._motion(f"{told}; take one of {0.1 * self.radian:.2g} s.")
        return self._motion(self._until(seconds, step, tell))

    def _until(self, end: float, step: Step, tell: Listener | None = None) -> str:
        """Go on to a time; why it is not reached, a sentence."""
        fixed, reason = self.steps.fixed, ""
        try:
            if self.now.within == 0.0 and (trial := step(self.next)):
                begun = self.now.moving._replace(acceleration=(1.0 - step_kernels.LAST) * trial.moving.acceleration)
                self.now = replace(self.now, moving=begun)
            while not reason and (left := end - self.now.time) > 1e-12 * end:
                dt = self.next
                dt = left if left <= dt else min(dt, 0.5 * left) if left < 2.0 * dt and not fixed else dt
                reason = self._go(dt, step, is_last=dt < self.next)
                if tell is not None:
                    tell(self.now.time)
        except RodError as error:
            reason = f"At t = {self.now.time:.4g} s the motion leaves what is known: {error}"
        except KeyboardInterrupt:
            if tell is None:
                raise
            reason = f"The motion was interrupted at t = {self.now.time:.4g} s, and is kept up to there."
        return reason

    def _go(self, dt: float, step: Step, *, is_last: bool) -> str:
        """Make a step, and choose the next one; is_last: this one is shorter than chosen. Why there is none."""
        trial, fixed = step(dt), self.steps.fixed
        if trial is None:
            self.next = 0.5 * dt
            return self._stopped("") if dt < (fixed or self.shortest) / MOST_PARTS else ""
        fast = max(trial.fast, self.now.fast * math.exp(-dt / (REMEMBERED * self.radian)))
        allowed = self.steps.tolerance * fast * self.radian + STILL
        part = 0.9 * math.cbrt(allowed / max(trial.error, 1e-300))
        if part < AGAIN and not fixed and dt > self.shortest:
            self.next = dt * max(part, SHRINK)
            return ""
        if not is_last or part < 1.0:
            changed = dt * min(part, GROW) if part < 1.0 or part > WORTH else dt
            self.next = fixed or max(changed, self.shortest)
        self.now = replace(trial, fast=fast)
        self._write()
        if trial.outside <= SLIGHT * self.joined.width:
            self.inside = self.now, len(self.rows)
        elif self.now.time - self.inside[0].time > BRIEF:
            return self._stopped(f"cells bend by {trial.outside:.3g} 1/mm beyond")
        return ""

    def _stopped(self, left: str) -> str:
        """A sentence on why a motion ends; it goes back to where it was inside the law, which cells have left."""
        time, outside = self.now.time, self.now.outside
        if not left and outside > SLIGHT * self.joined.width:
            left = f"cells bend by {outside:.3g} 1/mm beyond"
        self.now, count = self.inside
        del self.rows[count:]
        if not left:
            return f"No motion was found beyond t = {time:.4g} s."
        low, high = self.joined.curvatures
        return (
            f"At t = {time:.4g} s {left} the law, which is known from {low:.3g} to {high:.3g} 1/mm. "
            "A smaller load, or a pressure that comes more slowly, bends them less."
        )

    def forward(self, dt: float, rows: Array) -> Moment | None:
        """The end of a step under pressures over time, rows (T, 1 + c); None where it is not found."""
        now = self.now
        times = now.time + step_kernels.WITHIN * dt, now.time + dt
        pressures = np.array([np.interp(times, rows[:, 0], values) for values in rows.T[1:]]).T
        felt, late = self.stepper.felt(now, times[0], pressures[0])
        self._feel(felt)
        return self.stepper.step(now, dt, self.joined, pressures, late)

    def blown(self, dt: float, air: Air) -> Moment | None:
        """The end of a step under the pressure of air, which changes evenly in it."""
        now = self.now
        before = float(now.pressure[0])
        amount, growth = air.amount(before, now.volume), air.growth(now.time, before, now.volume)
        slope, last = 1.0 / (air.atmosphere + before), (0.0, 0.0)
        pressure = before
        for k in range(ROUNDS):
            trial = self.forward(dt, np.array([[now.time, before], [now.time + dt, pressure]]))
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
        state = self._shown(now)
        return self._volumes(
            self.arms, self.joined.parts[None], self._curvatures(state.angle[None], state.frames[None])
        )[0]

    def _volumes(self, arms: Sequence[Arm], parts: Array, kappa: Array) -> Array:
        """(t, c) mm3, between arms at parts (t, c) of the ways to them, from curvatures (t, n, 3)."""
        h = np.diff(self.stepper.solver.s)
        low, *others = (arm.air_along(h, kappa) for arm in arms)
        return np.asarray(low + sum(part[:, None] * (one - low) for part, one in zip(parts.T, others, strict=True)))

    def _shown(self, now: Moment) -> StateArrays:
        """The state at the end of a step: nodes without mass, which are known within it, go on as they went."""
        place, angle, frames = (values.copy() for values in now.moving.state[:3])
        massless = self.stepper.bodies.mass == 0.0
        motion = (now.time - now.within) * now.moving.speed[massless]
        place[massless] += motion[:, :3]
        angle[massless] += motion[:, 5]
        if self.in_space:
            frames[massless] = rotation(motion[:, 3:]) @ frames[massless]
        return now.moving.state._replace(place=place, angle=angle, frames=frames)

    def _curvatures(self, angle: Array, frames: Array) -> Array:
        """(t, n, 3) 1/mm of the elements, from angles (t, N) or frames (t, N, 3, 3) of the nodes."""
        h = np.diff(self.stepper.solver.s)[:, None]
        if self.in_space:
            return np.asarray(turn_of(np.swapaxes(frames[:, :-1], -1, -2) @ frames[:, 1:]) / h)
        return np.diff(angle, axis=1)[..., None] * [0.0, 0.0, 1.0] / h

    def _feel(self, felt: Array) -> None:
        """Take the arm at pressures (c,) that are felt."""
        low, size = self.known
        parts = (felt - low) / size
        if not (parts.min() >= 0.0 and parts.max() <= 1.0):
            self._know(felt)
        else:
            self.joined.go(parts)

    def _know(self, felt: Array) -> None:
        """Take the arms about pressures that are felt: at the lower ones, and with each of them higher by a step."""
        lowest, highest = self.range
        size = (highest - lowest) / PARTS or 1.0
        is_inside = lowest <= felt.min() and felt.max() <= highest and highest > lowest
        cells = np.clip(np.floor((felt - lowest) / size), 0, PARTS - 1)
        low = lowest + size * cells if is_inside else felt.copy()
        arms = [self.body.at(low)]
        for k in range(len(felt)):
            try:
                arms.append(self.body.at(low + size * (np.arange(len(felt)) == k)) if is_inside else arms[0])
            except RodError:
                arms.append(arms[0])
        self.arms, self.known = tuple(arms), (low, size)
        s = tuple(self.stepper.solver.s.tolist())
        self.joined = Joined(*((*arrays_of(a, self.load, s, self.in_space), self.body.relaxing(a)) for a in arms))
        self.joined.go((felt - low) / size)

    def _radian(self) -> float:
        """s, of the first vibration through one radian, of a cantilever with its masses, about."""
        s, mass = self.stepper.solver.s, self.stepper.bodies.mass
        moved = float(mass @ (s / s[-1]) ** LIKE_MODE)
        return math.sqrt(moved * float(s[-1]) ** 3 / (3.0 * self.stepper.solver.arm.section.rigidity))

    def _write(self) -> None:
        """Keep the state, and the end of the material curve beside the axis."""
        state, tip, now = self._shown(self.now), self.joined.ends.tip[:, 4:], self.now
        frame = state.frames[-1] if self.in_space else planar_frames(state.angle[-1])
        turn = math.atan2(frame[1, 0], frame[0, 0])
        at = (len(tip) - 1) * (0.5 + turn / (2.0 * math.pi))
        i = min(int(at), len(tip) - 2)
        beside = frame @ (tip[i] + (at - i) * (tip[i + 1] - tip[i]))
        outside = max(now.outside, 0.0)
        row = now.time, now.pressure, turn, beside, state.reaction, outside, state.place, state.angle, state.frames
        self.rows.append((self.arms, self.joined.parts, row))

    def _motion(self, reason: str) -> Motion:
        parts = np.array([part for _, part, _ in self.rows])
        columns = (np.array(one) for one in zip(*(row for _, _, row in self.rows), strict=True))
        times, pressures, turns, beside, reactions, outside, place, angle, frames = columns
        d, kappa, airs = 3 if self.in_space else 2, self._curvatures(angle, frames), []
        for arms, group in groupby(range(len(parts)), key=lambda k: self.rows[k][0]):
            rows = list(group)
            airs.append(self._volumes(arms, parts[rows], kappa[rows]))
        left = outside > ROUNDED * self.joined.width
        notes = (BEYOND.format(outside.max(), times[left][0]),) if left.any() else ()
        air, tips, angles = np.concatenate(airs), (place[:, -1] + beside)[:, :d], np.degrees(np.unwrap(turns))
        s = self.stepper.solver.s.copy()
        return Motion(times, pressures, air, tips, angles, reactions, outside, s, place[..., :d], reason, notes)
