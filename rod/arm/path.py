"""The path of an arm from its inflated shape to the full load, in steps that shrink and grow.

A step whose numbers of unstable directions both differ from those of the inflated arm is shortened: the path ends
where the arm buckles. A small force in its softest motion leads along the path of an arm that is not quite perfect.
Where that ends in a stable state without this force, the arm falls there, and the path says so.
Where supports hold heights alone the path is that of experiment III:
the curvature without moment and the heights grow together from the straight arm, which selects among several
equilibria.
The end of the path is solved on elements of half the length too, and both give the limit (`extrapolated`).
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from rod.along import APART, are_heights, check_inside, check_supports
from rod.arm.chain import Nodes, extrapolated, halved
from rod.arm.newton import NewtonResult
from rod.arm.nodes import StateArrays
from rod.arm.solver import ArmModel, Solver
from rod.errors import LoadError, RodError
from rod.frames import planar_frames, rotation, turn_of
from rod.load import Load

#: smallest part of the load in one step
SMALLEST_STEP = 1e-5
#: how exactly the part of the load is known at which an arm buckles, relative, and the smallest such step
EXACTLY, TINIEST = 1e-4, 1e-12
#: of a buckling arm: inverse iterations for its softest motion; by how much of its length it is pushed; pushes at most
INVERSE, PUSH, PUSHES = 4, 1e-3, 2
#: softness of a motion from which on it ends the path; part of the length beyond which a place is the tip
SOFT, TIP = 30.0, 0.97
#: part of the load that is none; motion of a straight arm over its length that is rounding
ONCE, ASIDE = 1e-4, 1e-9
#: rad, largest change of an angle in one step of the load
LARGEST_TURN = 1.0
#: largest distance of a state from the line through the two before, over its distance from the last one; rad, a change
#: that is small on any path
SMOOTH, SMALL = 0.5, 1e-2


class Path(NamedTuple):
    """The end of a path."""

    nodes: Nodes  #: at the limit of the elements
    chains: tuple[Nodes, Nodes]  #: in equilibrium on the elements, and on those of half the length
    steps: int  #: of the load
    fall: str = ""  #: how the arm buckles on the way, a sentence; the nodes are then those of its fallen shape

    @property
    def notes(self) -> tuple[str, ...]:
        """A note on an arm that has fallen; none on others."""
        return (f"{self.fall} This is the stable shape to which it falls; to which side is chance.",) * bool(self.fall)


class NoEquilibrium(RodError):
    """The end of a path beyond which there is no equilibrium, for another reason than that the arm buckles."""

    def __init__(self, part: float) -> None:
        super().__init__(f"No equilibrium was found beyond {100 * part:.3g} % of the load.")
        self.part = part


class Buckles(RodError):
    """The end of a path at which an arm becomes unstable."""

    def __init__(self, told: str, force: Array) -> None:
        super().__init__(told)
        self.force = force  #: (N, 3) N, that pushes the arm in its softest motion


class PathOptions(NamedTuple):
    """How the loads grow."""

    together: bool = False  #: the path begins with the straight arm, and its curvature grows with the load
    in_space: bool = False


#: largest change of the end over the length by halving the elements, and how often they are halved for it
COARSEST, MOST_HALVINGS = 1e-3, 3


def follow(arm: ArmModel, load: Load, how: PathOptions) -> Path:
    """The equilibrium on the path from the inflated arm to the full load.

    Raises `RodError` where the path ends or becomes unstable, and for a load or a support off the arm.
    """
    together, in_space = how
    if in_space and any(one.angle is not None for one in load.supports):
        raise LoadError("A support holds an angle in the plane alone; in space it holds x, y and z.")
    coarse = Solver(arm, positions_under(arm, load), load, in_space=in_space)
    state, found, steps, fall = _fallen(coarse, load, together)
    for _ in range(MOST_HALVINGS):
        fine = Solver(arm, halved(coarse.s), load, in_space=in_space)
        finer = _refined(state, in_space)
        there = fine.converge(finer, 1.0, fine.load.target)
        if not (there.converged and there.is_as_stable_as(found)):
            finer, there, steps, fall = _fallen(fine, load, together)
        chains = coarse.nodes(state, found), fine.nodes(finer, there)
        if float(np.abs(finer.place[-1] - state.place[-1]).max()) <= COARSEST * float(fine.s[-1]):
            return Path(extrapolated(*chains, in_space=in_space), chains, steps, fall)
        coarse, state, found = fine, finer, there
    raise RodError("The load bends the rod within less than a two-hundredth of its length; this solver ends there.")


def positions_under(arm: ArmModel, load: Load) -> Array:
    """(N,) mm: the nodes of an arm under a load. Raises `LoadError` for a load or a support off the arm."""
    length = float(arm.positions(())[-1])
    for one in load.along:
        check_inside(one, length)
    check_supports(load.supports, max(arm.clamp_reach, APART * length), length)
    breaks = {s for one in (*load.along, *load.supports) for s in one.breaks if APART < s / length < 1.0 - APART}
    return arm.positions(tuple(breaks))


def beside(arm: ArmModel, load: Load, near: tuple[Nodes, Nodes], *, in_space: bool) -> Path:
    """The equilibrium beside another one, with as many unstable directions. Raises `RodError` where there is none."""
    s, chains = positions_under(arm, load), []
    while 1.5 * len(s) < len(near[0].s):
        s = halved(s)
    for known, places in zip(near, (s, halved(s)), strict=True):
        solver, begun = Solver(arm, places, load, in_space=in_space), known.on(places)
        state = StateArrays(*(column.copy() for column in begun))
        found = solver.converge(state, 1.0, solver.load.target)
        turn = np.abs(_turns(begun, state, in_space)).max()
        if not (found.converged and turn <= LARGEST_TURN) or not found.is_as_stable_as(known.found):
            raise RodError("No equilibrium that is as stable was found beside the one that is known.")
        chains.append(solver.nodes(state, found))
    coarse, fine = chains
    return Path(extrapolated(coarse, fine, in_space=in_space), (coarse, fine), 0)


def _fallen(solver: Solver, load: Load, together: bool) -> tuple[StateArrays, NewtonResult, int, str]:
    """As `_followed`; where the arm buckles on the way the state to which it falls, and the sentence on it."""
    pushed, told = solver, ""
    for _ in range(1 + PUSHES):
        try:
            state, found, steps = _followed(pushed, load, together)
        except Buckles as buckles:
            pushed, told = pushed.pushed(buckles.force), told or str(buckles)
            continue
        except RodError:
            if told:
                break
            raise
        there = solver.converge(state, 1.0, solver.load.target) if told else found
        if there.converged and there.is_as_stable_as(found):
            return state, there, steps, told
        break
    raise RodError(f"{told} No stable shape was found beyond.")


def _followed(solver: Solver, load: Load, together: bool) -> tuple[StateArrays, NewtonResult, int]:
    """The state at the end of the path, how it was found, and the number of steps."""
    grown, in_space = (0.0 if together else 1.0), solver.chain.in_space
    here = _inflated(solver, load, grown)
    begin, goal = solver.held(here), solver.load.target
    found = solver.converge(here, 0.0, begin, grown)
    if not found.converged:
        raise RodError("The inflated arm has no equilibrium without loads.")
    rest, before, behind, reached, count = found, here, 0.0, 0.0, 0
    step = 1.0
    if together:
        turn = float(np.abs(solver.arm.section.rest(solver.s)[:, :3]).sum(axis=1) @ np.diff(solver.s))
        step = 1.0 / max(1.0, turn)
    while reached < 1.0:
        factor = min(1.0, reached + step)
        part = 0.0 if reached == behind else (factor - reached) / (reached - behind)
        there = _ahead(before, here, part, in_space)
        trial = solver.converge(there, factor, begin + factor * (goal - begin), factor if together else 1.0)
        near = trial.converged and _is_near(before, here, there, part, in_space)
        if not (near and trial.is_as_stable_as(rest)):
            step = 0.4 * (factor - reached)
            if step < min(SMALLEST_STEP, max(EXACTLY * factor, TINIEST)):
                state, part = (there, factor) if near else (here, reached)
                raise _ended(solver, state, part, part if together else 1.0, is_there=near)
            continue
        before, behind, here, found, reached, count = here, reached, there, trial, factor, count + 1
        step = 2.0 * (reached - behind)
    return here, found, count


def _ended(solver: Solver, state: StateArrays, part: float, grown: float, *, is_there: bool) -> RodError:
    """Why a path ends near a state under a part of the loads; is_there: an equilibrium, which is unstable."""
    motion, force, softness = _softest(solver, state, part, grown)
    if is_there or softness > SOFT:
        reached = f"at {100 * part:.3g} % of the load" if part > ONCE else "at once"
        return Buckles(f"The rod buckles {'out of its plane ' * ('along z' in motion)}{reached}: {motion}.", force)
    return NoEquilibrium(part)


def _softest(solver: Solver, state: StateArrays, part: float, grown: float) -> tuple[str, Array, float]:
    """The softest motion of a state in words, forces (N, 3) in N that push the arm a little, and its softness.

    Softness: by how much more such forces move the state than the arm without loads.
    """
    places, length, rest = (3 if solver.chain.in_space else 2), float(solver.s[-1]), solver.rest(grown)
    force, largest = np.tile(solver.s[:, None] / length, 3), 1.0
    for _ in range(INVERSE):
        force = force / largest
        motion = solver.moved_by(before := force, state, part, grown)
        force = np.zeros_like(force)
        force[:, :places] = motion[:, :places]
        at, axis = np.unravel_index(int(np.abs(force).argmax()), force.shape)
        largest = float(force[at, axis])
    twist = np.abs((motion[:, 3:] * state.frames[:, :, 0]).sum(axis=1)).max() if solver.chain.in_space else 0.0
    along, where = f"moves along {'xyz'[axis]}", f" at s = {solver.s[at]:.3g} mm"
    told = f"its tip {along}" if solver.s[at] > TIP * length else f"it {along}{where}"
    told += ", and it twists" * bool(twist * length > abs(largest))
    at_rest = float(np.abs(solver.moved_by(before, rest, 0.0, grown)[:, :places]).max())
    # an arm that is not quite straight falls to the side to which it bends
    side = -1.0 if (before * (state.place - rest.place)).sum() < -ASIDE * length else 1.0
    return told, side * PUSH * length / at_rest * before, abs(largest) / at_rest


def _inflated(solver: Solver, load: Load, grown: float) -> StateArrays:
    """The arm without loads. In space one whose heights alone are held is first held as in experiment III."""
    has_plane = solver.chain.in_space and not solver.ends.is_polynomial
    if not (has_plane and are_heights(load.supports)):
        return solver.rest(grown)
    heights = tuple(replace(one, z=None) for one in load.supports if one.y is not None)
    planar = Load(supports=heights)
    state, _, _ = _followed(Solver(solver.arm, solver.s, planar, in_space=False), planar, together=True)
    reaction = np.zeros(len(solver.load.held))
    reaction[solver.load.held[:, 1] == 1] = state.reaction
    return state._replace(frames=planar_frames(state.angle), reaction=reaction)


def _ahead(before: StateArrays, here: StateArrays, part: float, in_space: bool) -> StateArrays:
    """The state as far from the last one as the one before is behind it, times a part; arrays of its own."""
    frames = here.frames.copy()
    if part and in_space:
        frames = rotation(part * turn_of(here.frames @ np.swapaxes(before.frames, 1, 2))) @ frames
    return StateArrays(
        here.place + part * (here.place - before.place),
        here.angle + part * (here.angle - before.angle),
        frames,
        here.inner.copy(),
        here.reaction + part * (here.reaction - before.reaction),
    )


def _is_near(before: StateArrays, here: StateArrays, there: StateArrays, part: float, in_space: bool) -> bool:
    """Whether a state may follow two others on a smooth path: near a buckling load Newton's method may leave it."""
    change = _turns(here, there, in_space)
    size = float(np.abs(change).max())
    if size > LARGEST_TURN or part == 0.0:
        return size <= LARGEST_TURN
    return float(np.abs(change - part * _turns(before, here, in_space)).max()) <= max(SMOOTH * size, SMALL)


def _turns(here: StateArrays, there: StateArrays, in_space: bool) -> Array:
    """(N,) or (N, 3) of all nodes between two states, rad."""
    if not in_space:
        return np.asarray(there.angle - here.angle)
    return turn_of(there.frames @ np.swapaxes(here.frames, 1, 2))


def _refined(state: StateArrays, in_space: bool) -> StateArrays:
    """The state with a node in the middle of all elements but the first."""
    n = len(state.angle) - 1
    frames = state.frames if in_space else planar_frames(state.angle)
    middle = frames[1:-1]
    if in_space:
        middle = middle @ rotation(0.5 * turn_of(np.swapaxes(frames[1:-1], 1, 2) @ frames[2:]))
    distance = np.linalg.norm(np.diff(state.place[1:], axis=0), axis=1)[:, None]
    place = 0.5 * (state.place[1:-1] + state.place[2:])
    place += distance / 8.0 * (frames[1:-1, :, 0] - frames[2:, :, 0])

    def mixed(old: Array, new: Array) -> Array:
        both = np.empty((2 * n, *old.shape[1:]))
        both[0], both[1::2], both[2::2] = old[0], old[1:], new
        return both

    inner = np.concatenate([state.inner[:1], np.repeat(state.inner[1:], 2, axis=0)])
    angle = mixed(state.angle, 0.5 * (state.angle[1:-1] + state.angle[2:]))
    return StateArrays(mixed(state.place, place), angle, mixed(state.frames, middle), inner, state.reaction.copy())
