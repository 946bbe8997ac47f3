"""Rods under the loads of the states: with the numbers of an estimate, and with the arm's own law."""

from dataclasses import dataclass

import numpy as np

from benchmarks.paper.states import State
from geometry.arrays import Array
from rod import ArmLaw, Load, Rod, RodSolution, TwoSlopes, rest_curvature, without_stretch


@dataclass(frozen=True)
class RodShape:
    """A rod in II or III beside the curve of the finite elements."""

    solution: RodSolution
    points: Array  #: (n, 2) mm, at the nodes of the curve
    largest: float  #: distance from the curve over the length
    rms: float  #: root mean square of the distances over the length; from the curve without its stretch if it has none
    force_error: float  #: of F_y over that of the finite elements; nan in II


def fitted(state: State, law: TwoSlopes, *, loaded: bool = True) -> RodShape:
    """The inextensible rod with kappa_0 of II, in III with the end at its height. Raises `RodError`."""
    theta0, profile = rest_curvature(state.curves.free)
    rod = Rod(state.length, profile, law, theta0, _start(state))
    return _shape(state, rod, Load(couple=state.couple), loaded)


def own(state: State, law: ArmLaw, *, loaded: bool = True) -> RodShape:
    """The rod with the arm's own law, to which nothing is fitted. Raises `RodError`."""
    rod = Rod(state.length, law=law.at(state.pressure, state.length), start=_start(state))
    return _shape(state, rod, Load(), loaded)


def _start(state: State) -> tuple[float, float]:
    return float(state.curves.loaded.x[0]), float(state.curves.loaded.y[0])


def _shape(state: State, rod: Rod, load: Load, loaded: bool) -> RodShape:
    curve = state.curves.loaded if loaded else state.curves.free
    solution = rod.under(load, end_y=float(curve.y[-1])) if loaded else rod.under(Load())
    points = solution.positions(state.curves.s)
    distances = [
        np.hypot(*(points - np.column_stack([shape.x, shape.y])).T) / state.length
        for shape in (curve, without_stretch(curve))
    ]
    of_rms = distances[0] if np.any(solution.stretch != 1.0) else distances[1]
    error = float(solution.force[1]) / state.curves.force[1] - 1.0 if loaded else float("nan")
    return RodShape(solution, points, float(distances[0].max()), float(np.sqrt(np.mean(of_rms**2))), error)


def under_force(state: State, law: TwoSlopes | ArmLaw, force: tuple[float, float]) -> Array:
    """(n, 2) mm: the material curve of a rod with a dead force (N) on its end. Raises `RodError`."""
    if isinstance(law, ArmLaw):
        rod = Rod(state.length, law=law.at(state.pressure, state.length), start=_start(state))
    else:
        theta0, profile = rest_curvature(state.curves.free)
        rod = Rod(state.length, profile, law, theta0, _start(state))
    return rod.under(Load(force)).positions(state.curves.s)
