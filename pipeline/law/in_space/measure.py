"""The law of an arm that bends in space, from states of its cell and its ends."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import cos, degrees, hypot, pi, sin
from typing import Any, ClassVar, final

import numpy as np
from scipy.spatial.transform import Rotation

from fem.cell.piece import PieceFailed
from geometry.arrays import Array
from pipeline.law.in_space.fit import Fit, PressureBasis, fit_cell, fit_values
from pipeline.law.in_space.images import Images
from pipeline.law.in_space.states import (
    CellState,
    Curvatures,
    EndState,
    across_state,
    cell_state,
    clamped_state,
    free_state,
)
from pipeline.law.piece.pieces import ArmPieces, NoArmLaw
from pipeline.law.piece.tasks import ArmTasks
from pipeline.simulate.mass import mass_along
from pipeline.store.context import RunContext
from pipeline.store.parallel import Pending
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.law import LawMeshError
from rod.arm_law.polynomial import Basis, Polynomial, exponents_up_to
from rod.arm_law.space_law import SpaceLaw, SpaceRod
from rod.mechanics.unloaded import shape_under_moment
from rod.same_pressure import Pressures

#: parts of each row of pressures at which the cell is solved, where all rows have one ratio and where they have not
ONE_RATIO, RATIOS = (1 / 3, 2 / 3, 1.0), (0.5, 1.0)
#: how far the law reaches from the curvature without moment: over the largest one, and at least over 1/length
REACH, LOADED = 1.5, 0.7
#: rings of states around the curvature without moment: radius over the reach and number, for one ratio and for several
RINGS, FEW = ((0.5, 4), (1.0, 5)), ((0.6, 2), (1.0, 3))
#: parts of pressures between rows at which the cell is solved too
MIXED = (0.6, 1.0)
#: pressures between rows at which the law is checked: parts of neighbouring rows
BETWEEN = (0.65, 0.25)
#: rad, by which each ring is turned against the one before
TURN = 2.4
#: the ring at rest and for the clamped end, and change of the curvature there, over the reach
THREE, BENT = ((1.0, 3),), 0.25
#: size of a mesh on which the state without moment is compared, over that of the law
FINER = 0.7
#: steps of the axis through an end
STEPS = 24
#: effort of a state of an end, over that of a cell
END = 3.0


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class MeasuredInSpace:
    """The law, how it was measured, and how far it may be trusted."""

    law: SpaceLaw
    states: int  #: of the cell
    left: tuple[str, ...]  #: what could not be solved, a sentence each
    mesh_error: LawMeshError | None = None  #: None: there is no finer mesh
    changes: tuple[float, float] | None = None  #: relative, of curvature and rigidity on it, without sign
    failures: ClassVar[tuple[()]] = ()  #: it raises where a pressure is not reached


def measure_in_space(pieces: ArmPieces, rows: Sequence[Pressures], context: RunContext) -> MeasuredInSpace:
    """The law between rows of pressures (kPa, of all cavities) and 0 kPa.

    Raises `NoArmLaw` and InputError for pieces that cannot be made, and RunFailed where a row is not borne.
    """
    tasks, spanned = ArmTasks(pieces, context), PressureBasis(np.array(rows))
    count = spanned.onto.shape[1]
    parts, rings = (ONE_RATIO, RINGS) if count == 1 else (RATIOS, FEW)
    highest = [max(rows, key=lambda row: max(map(abs, row)))] if count == 1 else list(rows)
    between, images = [] if count == 1 else _between(rows), Images.of(tasks)
    around_rest = 1 if images.turns.count == 3 else 3  # of a ring that turns bring to itself one state is solved
    context.progress.expect(_steps(images.distinct(highest), images.distinct(between), parts, rings, around_rest))
    context.progress.stage("states without moment")
    middles = _followed(images, highest, parts)
    length = pieces.design.length
    context.progress.remark(_first_numbers(middles, length))
    mixed = _followed(images, between, MIXED)
    bends = [_without_moment(state) for row in middles for state in row]
    reach = max(REACH * max(hypot(*bend) for bend in bends), LOADED / length)
    context.progress.stage("bent states")
    around = {s.pressures: s for row in middles for s in row[:-1]}  # the last one is that before, without moment
    wanted = [
        one
        for n, pressures in enumerate(images.distinct(around))
        for one in images.around(pressures, _ring(_without_moment(around[pressures]), reach, n, rings))
    ]
    rest = tuple(0.0 for _ in pieces.design.cavities)
    wanted += [(rest, k) for k in ((0.0, 0.0), *_ring((0.0, 0.0), reach, 0, THREE))]
    begun = [images.submit(cell_state, *one) for one in wanted]
    found, left = _results(begun)
    states = [state for row in (*middles, *mixed) for state in row] + found
    fit = fit_cell(states, spanned, reach)
    context.progress.stage("twist, shear and ends")
    places = [rest, *(_scaled(row, part) for row in highest for part in parts[-2:])]
    law, missing = _law(images, fit, states, spanned, (reach, highest, places))
    law = replace(law, error=max(law.error, _error_between(images, law, highest)))
    return MeasuredInSpace(law, len(states), (*left, *missing), *_finer(tasks, law, highest))


def _steps(
    rows: Sequence[Pressures],
    between: Sequence[Pressures],
    parts: Sequence[float],
    rings: Sequence[tuple[float, int]],
    around_rest: int,
) -> dict[str, list[float]]:
    """Effort of the states that are solved, over that of a cell, by what they are called; a few more may follow."""
    places = 1 + len(rows) * len(parts[-2:])
    bent = len(rows) * (len(parts) + 1 + len(parts) * sum(number for _, number in rings)) + 1 + around_rest
    cells = bent + len(between) * (len(MIXED) + 1) + len(rows) - 1 + 2
    clamped = 3 * (places - 1) + around_rest
    ends = {"twist and shear": [2.0] * places, "clamped end": [END] * clamped, "tip": [END] * places}
    return {"cell": [1.0] * cells, **ends}


def _first_numbers(middles: Sequence[Sequence[CellState]], length: float) -> str:
    """The angle by which cells alone bend the arm at each row of pressures."""
    numbers = []
    for row in middles:
        state = row[-1]
        pressures, angle = "/".join(f"{p:g}" for p in state.pressures), degrees(hypot(*_without_moment(state)) * length)
        numbers.append(f"{angle:.0f}° at {pressures} kPa")
    return f"first numbers, from its cells alone: the arm bends by {', '.join(numbers)}"


def _between(rows: Sequence[Pressures]) -> list[Pressures]:
    """Means of neighbouring rows, and of all."""
    means = [*(np.mean(pair, axis=0) for pair in pairwise((*rows, rows[0]))), np.mean(rows, axis=0)]
    return list(dict.fromkeys(tuple(float(pressure) for pressure in mean) for mean in means))


def _scaled(row: Pressures, part: float) -> Pressures:
    return tuple(part * pressure for pressure in row)


def _followed(images: Images, rows: Sequence[Pressures], parts: Sequence[float]) -> list[list[CellState]]:
    """A state near that without moment at parts of each row, the last one twice. Raises RunFailed."""
    states: list[list[CellState]] = [[] for _ in rows]
    guesses: list[Curvatures] = [(0.0, 0.0)] * len(rows)
    for part in (*parts, parts[-1]):
        begun = [images.submit(cell_state, _scaled(row, part), k) for row, k in zip(rows, guesses, strict=True)]
        for k, (row, pending) in enumerate(zip(rows, begun, strict=True)):
            try:
                states[k].append(pending.result())
            except PieceFailed as failure:
                told = ", ".join(f"{pressure:g}" for pressure in row)
                raise RunFailed(f"the cell of the arm does not bear {told} kPa: {failure}") from None
            guesses[k] = _without_moment(states[k][-1])
    return states


def _without_moment(state: CellState) -> Curvatures:
    """Curvatures without moment, to first order from a state whose rigidity is taken as that along its curvature."""
    change = -state.vector / state.by_curvature[1]
    return state.curvature[0] + float(change[0]), state.curvature[1] + float(change[1])


def _ring(middle: Curvatures, reach: float, number: int, rings: Sequence[tuple[float, int]]) -> list[Curvatures]:
    points = []
    for k, (radius, count) in enumerate(rings):
        for i in range(count):
            angle = TURN * (len(rings) * number + k) + 2.0 * pi * i / count
            points.append((middle[0] + radius * reach * cos(angle), middle[1] + radius * reach * sin(angle)))
    return points


def _results(begun: Sequence[Pending[Any]]) -> tuple[list[Any], tuple[str, ...]]:
    found, left = [], []
    for pending in begun:
        try:
            found.append(pending.result())
        except PieceFailed as failure:
            left.append(str(failure))
    return found, tuple(dict.fromkeys(left))


def _law(
    images: Images,
    fit: Fit,
    states: Sequence[CellState],
    spanned: PressureBasis,
    reached: tuple[float, Sequence[Pressures], Sequence[Pressures]],
) -> tuple[SpaceLaw, tuple[str, ...]]:
    """The law of the fit, with twist, shear and both ends, and what could not be solved.

    reached: how far the law goes (1/mm), its rows of pressures, and the pressures at which ends are solved.
    """
    reach, highest, places = reached
    pieces, scale, onto, cavities = images.tasks.pieces, spanned.scale, spanned.onto, len(spanned.onto)
    quadratic = Basis(exponents_up_to(2, len(scale)), scale)
    across = [images.submit(across_state, pressures) for pressures in places]
    free = [images.submit(free_state, pressures) for pressures in places]
    x = np.column_stack([[state.curvature for state in states], np.array([s.pressures for s in states]) @ onto])
    EA = np.array([[state.axial_rigidity] for state in states])
    law = SpaceLaw(
        cavities=pieces.design.cavities,
        pressures=np.array(highest),
        onto=onto,
        pitch=2.0 * pieces.repetition.half_pitch,
        length=pieces.design.length,
        clamp_length=pieces.repetition.middle,
        reach=reach,
        error=fit.error,
        potential=fit.potential,
        stretch=fit.stretch,
        axial_rigidity=fit_values(x, EA, Basis(exponents_up_to(2, x.shape[1]), np.array([reach, reach, *scale]))),
        compliance=fit_values(np.array(places) @ onto, np.array([one.result() for one in across]), quadratic),
        volume=fit.volume,
        clamp=_nothing(6 + cavities, 2 + len(scale)),
        tip=_nothing(3 + cavities, len(scale)),
        mass=mass_along(pieces.design.of_pieces(pieces.repetition), pieces.config),
    )
    clamp, clamp_length, left = _clamp(images, law, places)
    beside = np.array(
        [_end_beside(law.at(p), one.result(), _nearest(states, p)) for p, one in zip(places, free, strict=True)]
    )
    tip = fit_values(np.array(places) @ onto, beside, quadratic)
    return replace(law, clamp=clamp, clamp_length=clamp_length, tip=tip), left


def _nothing(columns: int, variables: int) -> Polynomial:
    """Zero for all moments and pressures."""
    return Basis(np.zeros((1, variables), np.intp), np.ones(variables)).times(np.zeros((1, columns)))


def _clamp(images: Images, law: SpaceLaw, places: Sequence[Pressures]) -> tuple[Polynomial, float, tuple[str, ...]]:
    """Turn, shift and air of the clamped end, linear in the moments, the length (mm) of its piece, and what failed."""
    begun = []
    for pressures in images.distinct(places):
        k_y, k_z = law.at(pressures).kappa_0 if any(pressures) else (0.0, 0.0)
        wanted = images.around(pressures, _ring((float(k_y), float(k_z)), BENT * law.reach, 0, THREE))
        begun += [images.submit(clamped_state, *one) for one in wanted]
    found, left = _results(begun)
    if len(found) < 3:
        raise RunFailed("the clamped end of the arm bears none of the states that the law needs")
    moments, corrections = zip(*(_departure(law.at(end.pressures), end) for end in found), strict=True)
    x = np.column_stack([np.array(moments), np.array([end.pressures for end in found]) @ law.onto])
    largest = np.abs(x[:, :2]).max()
    powers = exponents_up_to(3, x.shape[1])
    powers = powers[(powers[:, :2].sum(axis=1) <= 1) & (powers[:, 2:].sum(axis=1) <= 2)]
    scale = np.array([largest, largest, *np.abs(x[:, 2:]).max(axis=0)])
    return fit_values(x, np.array(corrections), Basis(powers, scale)), found[0].length, left


def _departure(rod: SpaceRod, end: EndState) -> tuple[Array, Array]:
    """Moments (2,) about y and z at the clamp, and turn (rad) and shift (mm) (6,) of cells continued to it, with the
    air (mm3) in each cavity beyond that of cells."""
    frame, moment = Rotation.from_rotvec(end.turn).as_matrix(), np.array(end.moment)
    start, at_start = shape_under_moment(rod.section, end.length, frame, moment, STEPS)
    turn = Rotation.from_matrix(at_start).as_rotvec()
    kappa = rod.section.strains((moment @ at_start)[None], np.zeros((1, 3)))[0][0, 1:]
    air = np.array(end.volume) - end.length * rod.air(kappa)
    return (moment @ at_start)[1:], np.concatenate([turn, np.array(end.place) + start, air])


def _nearest(states: Sequence[CellState], pressures: Pressures) -> CellState:
    """The state at these pressures with the smallest moment, or the one whose pressures are nearest."""

    def far(state: CellState) -> tuple[float, float]:
        return float(np.abs(np.subtract(state.pressures, pressures)).max()), float(np.linalg.norm(state.vector))

    return min(states, key=far)


def _end_beside(rod: SpaceRod, end: EndState, near: CellState) -> Array:
    """(3 + c,): the end of the material curve beside the axis of cells continued to it, in the frame there (mm), and
    the air (mm3) in each cavity beyond that of cells.

    near: a state that tells where the material curve crosses the plane beside the axis.
    """
    # from the plane towards the end, which is the start of a rod of negative length
    start, frame = shape_under_moment(rod.section, -end.length, np.eye(3), np.zeros(3), STEPS)
    beside = frame.T @ (np.array([0.0, *near.beside]) + np.array(end.place) - start)
    return np.concatenate([beside, np.array(end.volume) - end.length * rod.air(rod.kappa_0)])


def _error_between(images: Images, law: SpaceLaw, rows: Sequence[Pressures]) -> float:
    """Moment that a cell has between rows at the curvature without moment of the law, over the largest moment."""
    pairs = [tuple(float(pressure) for pressure in np.array(BETWEEN) @ pair) for pair in pairwise(rows)]
    between = images.distinct(pairs)
    bends = [law.at(pressures).kappa_0 for pressures in between]
    begun = [images.submit(cell_state, p, (float(k[0]), float(k[1]))) for p, k in zip(between, bends, strict=True)]
    found, _ = _results(begun)
    largest = law.reach * max(law.at(row).section.rigidity for row in rows)
    return max((float(np.linalg.norm(state.vector)) / largest for state in found), default=0.0)


def _finer(
    tasks: ArmTasks, law: SpaceLaw, rows: Sequence[Pressures]
) -> tuple[()] | tuple[LawMeshError, tuple[float, float]]:
    """The errors of the curvature without moment and of the rigidity at the row that bends the cell most.

    They are taken as proportional to the size of the mesh, and follow from the changes on a finer one, which are
    returned as well, over their values.
    """
    pressures = max(rows, key=lambda row: float(np.linalg.norm(law.at(row).kappa_0)))
    bend = law.at(pressures).kappa_0
    middle = float(bend[0]), float(bend[1])
    try:
        size = tasks.pieces.config.mesh.size_mm
        finer = replace(tasks, pieces=tasks.pieces.with_mesh_size(FINER * size))
        own, other = (one.submit(cell_state, pressures, middle).result() for one in (tasks, finer))
    except (InputError, NoArmLaw, PieceFailed):
        return ()
    kappa_0, rigidity = hypot(*middle), own.by_curvature[1]
    change = float(np.linalg.norm(np.subtract(_without_moment(other), _without_moment(own))))
    stiffer, left = abs(other.by_curvature[1] - rigidity), 1.0 - FINER
    columns = (kappa_0,), (rigidity,), (), (change / left,), (stiffer / left,)
    changes = change / max(kappa_0, 1.0 / law.length), stiffer / rigidity
    return LawMeshError(size, FINER * size, (max(pressures),), *columns), changes
