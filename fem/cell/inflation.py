"""How a piece comes to a pressure: in increments, and along the volume of its air where these do not lead on.

The energy W(V, phi) of a piece by the volume V of its air and the angle phi of its plane has the pressure and the
moment as its derivatives. Without moment the piece is stable under a given pressure while the Hessian of W is positive.
On the way along the volume the pressure has a maximum where it stops being so, the limit pressure, and perhaps a
minimum from which on the piece is stable again: between both it snaps from one form to the other. All states are
regular points of this way, with the volume prescribed. Its parameter is ln V.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import count, pairwise
from math import exp, inf, log
from typing import final

import numpy as np
from numpy.polynomial import Polynomial

from fem.cell.piece import ROUGH, BendingPiece, PieceFailed, PieceState
from fem.cell.response import slopes
from fem.equations.linear import SingularMatrix
from fem.equations.state import State
from fem.path.limit import difference
from fem.path.predictor import PathPoint, extrapolate, small_step_under_load, weighted_sum
from geometry import Reason, Values

#: how often an increment to a pressure may fail, and the smallest one, as a part of the pressure
MAX_FAILURES, SMALLEST_INCREMENT = 12, 1 / 64
#: growth of the air over that to first order from which on a pressure is reached along the air after a failure
SWELLS = 1.5
#: first step of ln V, the smallest and the largest one
FIRST, SMALLEST, LARGEST = 0.15, 0.003, 0.4
#: difference of a state from the predicted one, relative, and iterations for which steps are made
ERROR, ITERATIONS = 1e-2, 4
#: change of the step after a state, least and most
SHRINKS, GROWS = 0.4, 2.0
#: air over that at rest beyond which no piece is followed, and pressure over the largest one below which none is
MOST_AIR, FALLEN = 400.0, 0.7
#: pressure over the largest one that a body has borne from which on a piece, such as an end, is taken not to have
#: snapped with it; meshes differ by less
ONLY_FORM = 1.05
#: largest error of a pressure on the way, relative: where the last iterations are made under it, and of an extreme one
NEAR, EXACT = 1e-3, 1e-6
#: largest distance of a state under a pressure from the volume at which it was expected, over the step of ln V
NEAR_AIR = 0.25
#: states that are solved for one of these at the most
MOST_STATES = 12
#: change of ln V in a first step to another angle, and the smallest one
BENT, LEAST_BENT = 0.2, 0.015


def inflated(piece: BendingPiece, pressure: float, angle: float, begin: PieceState | None = None) -> PieceState:
    """Equilibrium at a pressure in MPa and an angle in rad, from the piece at rest, as `unloaded`.

    Raises `PieceFailed`.
    """
    reached = unloaded(piece, pressure, angle, begin=begin)
    if reached.angle == angle:
        return reached
    turned = piece.solve(pressure, angle, reached)
    return replace(turned, factorizations=reached.factorizations + turned.factorizations)


def unloaded(
    piece: BendingPiece,
    pressure: float,
    angle: float,
    failures: int = MAX_FAILURES,
    begin: PieceState | None = None,
) -> PieceState:
    """Equilibrium at a pressure in MPa, from the piece at rest: at an angle in rad, or about without moment.

    Pressure and angle change together, at once where that converges: an increment that fails is halved, and one that
    converges is doubled. Newton's method starts a small step along the slopes of the last state, but under the whole
    pressure of the increment and the stress that goes with it to first order, as on a load path
    (`fem.path.predictor`). Where this has failed beyond the first state, it starts on the cubic through the last two
    states with their slopes. failures: how often an increment may fail. Where one fails and the piece swells, or it is
    wanted after the snap, the pressure is reached along the air, without moment. begin: a state on the way, from which
    the first increment is half of what is left, on the cubic. Raises `PieceFailed`.
    """
    last, way = piece.rest(), (pressure, angle)
    if way == (0.0, 0.0):  # at rest there is nothing to balance but rounding, of a stiff layer too
        return last
    if piece.after_snap:
        return along_air(piece, pressure)
    increment, failed, spent = 1.0, 0, 0
    extrapolates = False  #: whether Newton's method starts on the cubic
    points = [_inflation_point(piece, last, 0.0, way)]
    if begin is not None:
        last, part, extrapolates = begin, begin.pressure / pressure, True
        increment, points = 0.5 * (1.0 - part), [*points, _inflation_point(piece, begin, part, way)]
    while (fraction := points[-1].value) < 1.0:
        target = min(1.0, fraction + increment)
        predicted = _inflation_start(points, target, extrapolates)
        try:
            at, rough = (target * pressure, target * angle), ROUGH * (target < 1.0)
            last = piece.solve_near(*at, predicted, last, fraction > 0.0, pressure, rough)
        except PieceFailed:
            if swells(piece, last, pressure):
                return along_air(piece, pressure)
            failed, increment, extrapolates = failed + 1, (target - fraction) / 2.0, fraction > 0.0
            if failed > failures or increment < SMALLEST_INCREMENT:
                raise
            continue
        increment, spent = 2.0 * increment, spent + last.factorizations
        points = [points[-1], _inflation_point(piece, last, target, way)]
    return replace(last, factorizations=spent)


def swells(piece: BendingPiece, at: PieceState, pressure: float) -> bool:
    """Whether the air of a piece has grown far more than to first order, or to first order swells it under a pressure
    in MPa."""
    known, rest = slopes(piece, piece.rest()), piece.volume(piece.rest().state)
    linear = known.volume_by_pressure * at.pressure + abs(known.moment_by_pressure * at.angle)
    grown = piece.volume(at.state) - rest
    return (at.pressure > 0.0 and grown > SWELLS * linear) or piece.is_swollen(
        rest + known.volume_by_pressure * pressure
    )


def bent(
    piece: BendingPiece, angle: float, start: PieceState, before: PathPoint | None, last: PathPoint | None
) -> PieceState:
    """The piece at another angle in rad under the pressure of a state, as `BendingPiece.solve`.

    before, last: on the path of the angle, which is extrapolated to where Newton's method starts. A swollen piece is
    bent in steps that change its air little. Raises `PieceFailed`.
    """
    predicted = None if last is None else extrapolate(before, last, angle)
    if last is None or predicted is None or not piece.is_swollen(piece.volume(start.state)):
        return piece.solve(start.pressure, angle, start, predicted)
    at, allowed, spent = start, BENT, 0
    while at.angle != angle:
        part = _part_of_air(piece, at, predicted, allowed)
        target = angle if part == 1.0 else at.angle + part * (angle - at.angle)
        near = extrapolate(before, last, target) or predicted
        try:
            reached = piece.solve_near(start.pressure, target, near, at, rough=ROUGH * (target != angle))
        except PieceFailed:
            allowed = SHRINKS * min(allowed, abs(log(piece.volume(near) / piece.volume(at.state))))
            if allowed < LEAST_BENT:
                raise
            continue
        if reached.negative_pivots:
            raise PieceFailed(piece.where(reached), Reason("tangent_indefinite"))
        allowed *= float(np.clip(ITERATIONS / max(reached.factorizations, 1), SHRINKS, GROWS))
        at, spent = reached, spent + reached.factorizations
        if at.angle != angle:
            before, last = last, bent_point(piece, at)
            predicted = extrapolate(before, last, angle) or at.state
    return replace(at, factorizations=spent)


def _part_of_air(piece: BendingPiece, at: PieceState, predicted: State, allowed: float) -> float:
    """The part of the way to a predicted state on which ln V changes by no more than is allowed."""
    least = exp(-10.0) * piece.volume(at.state)
    change = abs(log(max(piece.volume(predicted), least) / piece.volume(at.state)))
    return 1.0 if change <= allowed else allowed / change


def bent_point(piece: BendingPiece, at: PieceState) -> PathPoint:
    """A state on the way of the angle, with its change by it, for `bent`. Raises `PieceFailed`."""
    try:
        return PathPoint(at.angle, 1.0, at.state, at.touches, slopes(piece, at).angle_rate)
    except SingularMatrix as failure:
        raise PieceFailed(piece.where(at), Reason("tangent_singular", {"why": str(failure)})) from None


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class FreePoint:
    """A state of a piece on the way along its air, about without moment, and how that goes on, to first order."""

    state: PieceState
    air: float  #: ln of the volume in mm3
    lack: float  #: rad, from its angle to that without moment at this volume
    pressure: float  #: MPa, without moment at this volume
    turn: float  #: rad, change of the angle without moment by ln V
    rise: float  #: MPa, change of the pressure without moment by ln V
    rate: State = field(repr=False)  #: change of the state without moment by ln V
    factorizations: int = 0  #: spent on it

    @classmethod
    def of(cls, piece: BendingPiece, state: PieceState) -> "FreePoint":
        """One factorization. Raises `PieceFailed` where the tangent is singular."""
        try:
            known, volume = slopes(piece, state), piece.volume(state.state)
        except SingularMatrix as failure:
            raise PieceFailed(piece.where(state), Reason("tangent_singular", {"why": str(failure)})) from None
        (by_volume, coupled), (_, by_angle) = known.energy_hessian.tolist()
        turns = piece.start != "free"  # whose plane never bears a moment
        lack, turn = (-state.moment / by_angle, -coupled / by_angle * volume) if turns else (0.0, 0.0)
        rise, rates = by_volume * volume + coupled * turn, known.rates_at_volume
        rate = weighted_sum([(volume, rates[0]), (turn, rates[1])])
        return cls(state, log(volume), lack, state.pressure + coupled * lack, turn, rise, rate)

    @property
    def is_stable(self) -> bool:
        """Whether the piece is stable here under a given pressure."""
        return self.rise > 0.0 and not self.state.negative_pivots

    @property
    def path_point(self) -> PathPoint:
        """The state as a point of the way along the air."""
        return PathPoint(self.air, 1.0, self.state.state, self.state.touches, self.rate)


def free_at(
    piece: BendingPiece, air: float, before: FreePoint | None, last: FreePoint, *, rough: float = 0.0
) -> tuple[FreePoint, float]:
    """The piece at another volume, ln V, about without moment, and how far it is from the predicted state.

    rough: as in `BendingPiece.solve_near`. Raises `PieceFailed`.
    """
    step = air - last.air
    bend = 0.0 if before is None else (last.turn - before.turn) / (last.air - before.air)
    angle = last.state.angle + last.lack + step * (last.turn + 0.5 * step * bend)
    predicted = extrapolate(None if before is None else before.path_point, last.path_point, air) or last.state.state
    state = piece.solve_at_volume(exp(air), angle, predicted, last.state, rough)
    return FreePoint.of(piece, state), difference(state.state, predicted)


def _followed(piece: BendingPiece) -> Iterator[FreePoint]:
    """States by growing volume, from rest on. Raises `PieceFailed` where no state follows."""
    spent, before, last = piece.factorizations, None, FreePoint.of(piece, piece.rest())
    most, step, top = last.air + log(MOST_AIR), FIRST, 0.0
    while True:
        yield replace(last, factorizations=piece.factorizations - spent)
        spent, reached = piece.factorizations, last
        while last is reached:
            try:
                point, error = free_at(piece, last.air + step, before, last, rough=ROUGH)
            except PieceFailed:
                step *= SHRINKS
                if step < SMALLEST:
                    raise
                continue
            before, last = last, point
            easy = min((ERROR / error) ** 0.25, ITERATIONS / max(point.state.factorizations, 1))
            step = min(LARGEST, step * float(np.clip(easy, SHRINKS, GROWS)))
        top = max(top, last.pressure)
        if last.air > most or last.pressure < FALLEN * top:
            return


class AirPath:
    """The way of a piece along its air, as far as it was asked for. It depends on the piece alone."""

    def __init__(self, piece: BendingPiece) -> None:
        self._piece, self._ahead = piece, _followed(piece)
        self._points: list[FreePoint] = []
        self._failure: PieceFailed | None = None

    @classmethod
    def of(cls, piece: BendingPiece) -> "AirPath":
        """The way along the air that the piece keeps."""
        return piece.kept("along the air", lambda: cls(piece))

    def points(self) -> Iterator[FreePoint]:
        """From rest on. Raises `PieceFailed` where no state follows."""
        for k in count():
            if k < len(self._points):
                self._piece.count_again(self._points[k].factorizations)
            elif not self._advanced():
                return
            yield self._points[k]

    def _advanced(self) -> bool:
        """Whether there is one more point."""
        if self._failure:
            raise self._failure
        try:
            self._points.extend(point := [next(self._ahead)])
        except PieceFailed as failure:
            self._failure = failure
            raise
        except StopIteration:
            return False
        return bool(point)


def along_air(piece: BendingPiece, pressure: float) -> PieceState:
    """The first stable state about without moment at a pressure in MPa; that after a snap if the piece is wanted there.

    A piece that has no snap up to the pressure at which the body snaps, such as a clamped end, has not left its form
    from rest. Raises `PieceFailed`, which names the limit pressure where the pressure is beyond it and all further
    states.
    """
    fallen, falls, top, only = False, False, -inf, list[tuple[float, FreePoint, FreePoint]]()
    reached = piece.rest()
    try:
        for before, last in pairwise(AirPath.of(piece).points()):
            fallen, falls, top = fallen or before.rise <= 0.0, last.rise <= 0.0, max(top, last.pressure)
            reached = last.state
            for air in _risings(before, last, pressure):
                if piece.after_snap and not fallen:
                    only.append((air, before, last))
                    continue
                with suppress(PieceFailed):
                    return _under_pressure(piece, pressure, air, before, last)
            if only and not fallen and last.pressure > ONLY_FORM * max(pressure, piece.after_snap):
                break
    except PieceFailed as failure:
        if not fallen and not only:
            raise PieceFailed(piece.where(reached, pressure), *failure.reasons) from None
    if only and not fallen:
        return _under_pressure(piece, pressure, *only[0])
    values: Values = {"piece": piece.name, "pressure_kPa": 1e3 * pressure, "limit_kPa": 1e3 * top}
    raise PieceFailed(Reason("beyond_limit_pressure" if falls else "beyond_air", values))


def _risings(before: FreePoint, last: FreePoint, pressure: float) -> list[float]:
    """ln V at which the cubic of the pressure between two points passes a pressure in MPa upwards."""
    step = last.air - before.air
    cubic = _between(step, (before.pressure, before.rise), (last.pressure, last.rise))
    roots = np.asarray((cubic - pressure).roots(), dtype=complex)
    parts = [float(root.real) for root in roots if abs(root.imag) < 1e-12 and 0.0 <= root.real <= 1.0]
    return [before.air + part * step for part in sorted(parts) if cubic.deriv()(part) > 0.0]


def _between(step: float, first: tuple[float, float], second: tuple[float, float]) -> Polynomial:
    """The cubic over the part of a step of ln V through two values, with their changes by ln V."""
    (start, rate), (end, last_rate) = first, second
    change, rates = end - start, step * (rate + last_rate)
    return Polynomial([start, step * rate, 3.0 * change - rates - step * rate, rates - 2.0 * change])


def _under_pressure(piece: BendingPiece, pressure: float, air: float, before: FreePoint, last: FreePoint) -> PieceState:
    """The state at a pressure in MPa near a volume between two points, ln V: from the cubic between both where that
    leads to this volume, else from a state with this volume. Raises `PieceFailed`."""
    step, ends = last.air - before.air, [(one.state.angle + one.lack, one.turn) for one in (before, last)]
    between = extrapolate(before.path_point, last.path_point, air)
    if between is not None:
        angle = float(_between(step, *ends)((air - before.air) / step))
        with suppress(PieceFailed):
            reached = piece.solve_near(pressure, angle, between, last.state)
            if abs(log(piece.volume(reached.state)) - air) < NEAR_AIR * step and not reached.negative_pivots:
                return reached
    for _ in range(MOST_STATES):
        point, _ = free_at(piece, air, before, last)
        step = (pressure - point.pressure) / point.rise
        if abs(pressure - point.pressure) < NEAR * pressure:
            break
        air = float(np.clip(air + step, before.air, last.air))
    predicted = extrapolate(None, point.path_point, point.air + step)
    angle = point.state.angle + point.lack + step * point.turn
    return piece.solve_near(pressure, angle, predicted or point.state.state, point.state)


def extremum(piece: BendingPiece, before: FreePoint, last: FreePoint) -> FreePoint:
    """Where the pressure without moment has a maximum or a minimum between two points. Raises `PieceFailed`."""
    ends = [before, last]
    for _ in range(MOST_STATES):
        part = ends[0].rise / (ends[0].rise - ends[1].rise)
        point, _ = free_at(piece, ends[0].air + part * (ends[1].air - ends[0].air), *ends)
        if abs(point.rise * (ends[1].air - ends[0].air)) < EXACT * point.pressure:
            break
        ends[int((point.rise > 0.0) == (ends[1].rise > 0.0))] = point
    return point


def extreme_pressures(piece: BendingPiece, pressure: float) -> tuple[list[FreePoint], list[FreePoint]]:
    """The largest pressure without moment on the way along the air and the least one beyond, and states between both.

    None where there is no largest one up to a pressure in MPa, and only the first where none is found beyond.
    """
    found, way = list[FreePoint](), list[FreePoint]()
    with suppress(PieceFailed):
        for before, last in pairwise(AirPath.of(piece).points()):
            if (before.rise > 0.0) != (last.rise > 0.0):
                found.append(extremum(piece, before, last))
                way.append(found[-1])
            if len(found) == 2 or (not found and last.pressure > pressure):
                break
            way += [last] if found else []
    return found, way


def _inflation_start(points: Sequence[PathPoint], target: float, extrapolates: bool) -> State:
    """Where Newton's method starts; points: the last two, or the one at rest. Walls that touch make kinks."""
    before, last = points[0], points[-1]
    is_smooth = extrapolates and not last.touching and last.rate is not None
    cubic = extrapolate(before, last, target) if is_smooth else None
    return cubic or small_step_under_load(last, target) or last.state


def _inflation_point(piece: BendingPiece, at: PieceState, part: float, way: tuple[float, float]) -> PathPoint:
    """A state at a part of the way, with its change per part of it; one factorization.

    way: changes of the pressure in MPa and of the angle in rad. Without this change where the tangent is singular, and
    at the end of the way, where it is not needed.
    """
    rate: State | None = None
    if part < 1.0:
        with suppress(SingularMatrix):
            known = slopes(piece, at)
            rate = weighted_sum([(way[0], known.pressure_rate), (way[1], known.angle_rate)])
    return PathPoint(part, 1.0, at.state, at.touches, rate)
