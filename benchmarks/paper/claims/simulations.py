"""The main result of the paper's abstract: three simulations give the rod at every pressure."""

from collections.abc import Iterator, Sequence
from dataclasses import astuple, replace
from typing import Any

import numpy as np

from benchmarks.paper.claims.common import AT_MOST, NOT_RUN, claim, single
from benchmarks.paper.data import ARMS, LAWS, Data
from benchmarks.paper.reading import Claim, Reading
from benchmarks.paper.rods import RodShape, fitted
from benchmarks.paper.states import State
from geometry import Centreline
from pipeline.identify.parameters import numbers_of_curves
from rod import FiveParameters, RodError, TwoSlopes

#: kPa: of III, at the higher of which II is taken as well; and those at which the rod is tested
GIVEN, TESTED = (17.0, 37.0), (5.0, 10.0, 24.0, 31.0, 45.0)


def three_simulations(data: Data) -> Claim:
    readings: list[Reading] = []
    for law in LAWS:
        states = {state.pressure: state for state in data.states("pneunet", law, ARMS[0])}
        if set(GIVEN) <= set(states):
            readings += _errors(states[GIVEN[0]], states[GIVEN[1]], [states[p] for p in TESTED if p in states])
    says = "Three simulations, II and two of III, give the five parameters at every pressure (abstract, section 4.1)"
    why = (
        "κ₀ of one II, scaled by p/p₀, is right with Hencky's law (claim 15). Straight lines between the rigidities of "
        "17 and 37 kPa are right from 17 kPa on; below, where walls do not touch, the force of the end is too large."
    )
    return claim("19", says, readings, why, NOT_RUN["pneunet"])


def _errors(low: State, high: State, tested: Sequence[State]) -> Iterator[Reading]:
    """Of the rod with II of the higher pressure and III of both, at other pressures."""
    numbers = [_numbers(scaled_by_pressure(state, high)) for state in (low, high)]
    beside = [_numbers(state) for state in (low, high)]
    for state in tested:
        pressure = f"{state.pressure:g} kPa"
        for name, given, at in (
            ("three simulations", numbers, scaled_by_pressure(state, high)),
            ("κ₀ of II at the pressure itself", beside, state),
        ):
            counts = given is numbers
            law = between(given[0], given[1], (state.pressure - low.pressure) / (high.pressure - low.pressure))
            for part, loaded in (("II", False), ("III", True)):
                try:
                    shape = _beside_elements(at, state, law, loaded=loaded)
                except RodError:
                    continue
                required = AT_MOST if counts else None
                kind: dict[str, Any] = {"unit": "%", "law": state.law, "pressure": pressure}
                what = f"distance over l in {part} at {pressure}, {name}"
                yield single(what, 100.0 * shape.largest, part=part, required=required, **kind)
                if loaded:
                    force = None if required is None else (-AT_MOST[1], AT_MOST[1])
                    what = f"error of F_y at {pressure}, {name}"
                    yield single(what, 100.0 * shape.force_error, part="force", required=force, **kind)


def scaled_by_pressure(state: State, reference: State) -> State:
    """The state with the curve without load that follows from that of another pressure by p/p0 (eq. 9)."""
    free, factor = reference.curves.free, state.pressure / reference.pressure
    chords = np.hypot(np.diff(free.x), np.diff(free.y))
    angle = factor * free.angle
    x, y = (np.concatenate([[0.0], np.cumsum(chords * f(angle))]) for f in (np.cos, np.sin))
    return replace(state, curves=replace(state.curves, free=Centreline(free.s, free.x[0] + x, free.y[0] + y)))


def between(low: TwoSlopes, high: TwoSlopes, part: float) -> FiveParameters:
    """The numbers on the straight lines through those of two pressures. Raises `RodError`."""
    first, second = (np.array(astuple(numbers)) for numbers in (low, high))
    return FiveParameters(*(first + part * (second - first)))


def _numbers(state: State) -> TwoSlopes:
    curves = state.curves
    return numbers_of_curves(curves.free, curves.loaded, state.load, state.pitch).law


def _beside_elements(rod: State, elements: State, law: TwoSlopes, *, loaded: bool) -> RodShape:
    """The rod of one state beside the curve of the finite elements of another."""
    shape = fitted(rod, law, loaded=loaded)
    if loaded:
        return shape
    free = elements.curves.free
    points = shape.solution.positions(free.s)
    return replace(shape, largest=float(np.hypot(points[:, 0] - free.x, points[:, 1] - free.y).max()) / rod.length)
