"""The error of an exported arm: what a program has, against the finite elements of its run without load and under dead
forces."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from pipeline.config.validation import SMALL_FORCES
from pipeline.values.run import Curve, Run
from rod import ArmLaw, Load, Robot, RodError


@dataclass(frozen=True)
class Reference:
    """A state of the finite elements."""

    pressure_kPa: float
    force: tuple[float, float]  #: N, dead, on the end
    curve: Curve

    def points(self, s: Array) -> Array:
        """(m, 2) mm: the material curve at rest arc lengths s (m,), from its clamped end."""
        at = self.curve["s_mm"] - self.curve["s_mm"][0]
        columns = (self.curve[name] - self.curve[name][0] for name in ("x_mm", "y_mm"))
        return np.column_stack([np.interp(s, at, column) for column in columns])

    @property
    def load(self) -> str:
        """In words."""
        return f"{self.force[0]:g}, {self.force[1]:g} N" if any(self.force) else "free"


def references(run: Run) -> Iterator[Reference]:
    """The states of a run without load and under dead forces."""
    for curve in (*run.curves_of("II"), *run.validation_curves):
        if curve.force_N or curve.experiment == "II":
            yield Reference(curve.pressure_kPa, curve.force_N or (0.0, 0.0), curve)


def distance(points: Array, s: Array, reference: Reference, length: float) -> float:
    """The largest distance of points (m, 2) in mm at rest arc lengths s (m,) from a reference, over the length."""
    return float(np.hypot(*(points - reference.points(s)).T).max() / length)


def judged(robot: Robot, run: Run, law: ArmLaw | None) -> str:
    """How far the arm of a file is from the finite elements of its run at most, in words.

    law: that of the arm, with which the file is compared under dead forces where the run has none.
    """
    states = [state for state in references(run) if robot.has(state.pressure_kPa)]
    try:
        found = [_error(robot, state, (0.0, 0.0) if law is None else law.weight) for state in states]
        forces = [math.hypot(*state.force) for state in states if any(state.force)]
        if law is None or forces:
            return _sentence(found, states)
        return f"{_sentence(found, states)} {_against_rod(robot, law)}"
    except RodError as failure:
        return f"The error of the file is not known: {failure}"


def _error(robot: Robot, state: Reference, weight: tuple[float, float]) -> float:
    chain = robot.at(state.pressure_kPa)
    return distance(chain.curve(chain.solve(state.force, weight, _height(robot))), chain.s, state, robot.length)


def _height(robot: Robot) -> float:
    """mm, of the centre of mass above the material curve."""
    return 0.0 if robot.solid is None else robot.solid.section.centre


def _sentence(found: Sequence[float], states: Sequence[Reference]) -> str:
    if not found:
        return "The error of the file is not known: the run has no finite elements at its pressures."
    worst = states[int(np.argmax(found))]
    largest = max(math.hypot(*state.force) for state in states)
    under = f"free and under dead forces up to {largest:g} N" if largest else "free"
    return (
        f"Error of the file: {100 * max(found):.2g} % of the length at most, against the finite elements of the run "
        f"({under}), at {worst.pressure_kPa:g} kPa, {worst.load}."
    )


def _against_rod(robot: Robot, law: ArmLaw) -> str:
    """The largest distance from the rod itself under dead forces across the end that are small."""
    worst = 0.0
    for pressure in robot.known:
        chain, rod = robot.at(pressure), law.at(pressure)
        for part in (sign * part for part in SMALL_FORCES for sign in (1.0, -1.0)):
            force = (0.0, part * chain.rigidity / robot.length**2)
            turn = chain.solve(force, law.weight, _height(robot))
            apart = chain.curve(turn) - rod.under(Load(force)).positions(chain.s)
            worst = max(worst, float(np.hypot(*apart.T).max()) / robot.length)
    return (
        "The run has no dead forces at these pressures. Under small tip forces (EI/50l², EI/10l²) the file deviates "
        f"from its rod by at most {100 * worst:.2g} % of the length."
    )
