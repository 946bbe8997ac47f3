"""The five parameters predicted: identified from experiments II and III of the rod with the arm's own law.

Beside the parameters of the finite elements they tell which part of those comes from the cells and their ends, which
is all that the law contains.
"""

from collections.abc import Sequence

from geometry import Centreline
from geometry.arrays import Array
from pipeline.identification.parameters import NoFit, Parameters, numbers_of_curves
from rod import ArmLaw, Identification, Load, Rod, RodError, RodSolution


def predicted_numbers(parameters: Sequence[Parameters], law: ArmLaw) -> list[Identification | NoFit]:
    """The parameters at every identified pressure from the law alone, or why there are none."""
    predictions: list[Identification | NoFit] = []
    for p in parameters:
        try:
            predictions.append(_predicted(p, law))
        except RodError as failure:
            predictions.append(NoFit(str(failure)))
    return predictions


def _predicted(parameters: Parameters, law: ArmLaw) -> Identification:
    """Raises RodError where the law has no such rod."""
    curve = parameters.free.centreline
    rod = Rod(law.length, law=law.at(parameters.pressure_kPa), start=(float(curve.x[0]), float(curve.y[0])))
    end_x, end_y = parameters.loaded.held_end
    loaded = rod.under(Load(parameters.loaded.load.force), end_y, end_x)
    force = (float(loaded.force[0]), float(loaded.force[1]))
    lever = loaded.positions(loaded.s[-1:])[0] - [loaded.x[-1], loaded.y[-1]]
    # about the end of the material curve
    couple = float(loaded.moment[-1]) - lever[0] * force[1] + lever[1] * force[0]
    load = Load(force, couple)
    free = _centreline(rod.solve(), curve.s)
    return numbers_of_curves(free, _centreline(loaded, curve.s), load, parameters.kappa.pitch, parameters.given_d)


def _centreline(shape: RodSolution, s: Array) -> Centreline:
    """The material curve of a rod at the nodes s (n,), mm, of the finite elements."""
    x, y = shape.positions(s - s[0]).T
    return Centreline(s, x, y)
