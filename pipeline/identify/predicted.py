"""The five parameters as the arm's own law predicts them, and what the mesh makes of them by two laws.

The rod with a law is put under the loads of experiments II and III, and its curves are identified as those of the
finite elements are. Laws on two meshes differ in their prediction as the whole arm on these meshes does.
"""

from collections.abc import Sequence

from pipeline.identify.mesh_error import OtherNumbers, with_errors
from pipeline.identify.parameters import Parameters, numbers_of_curves
from rod import ArmLaw, Load, Rod, RodError


def predicted(parameters: Parameters, law: ArmLaw) -> OtherNumbers:
    """At the pressure and under the loads of the parameters. Raises RodError where the law has no such rod."""
    curve, at = parameters.free.centreline, law.at(parameters.pressure_kPa)
    rod = Rod(law.length, law=at, start=(float(curve.x[0]), float(curve.y[0])))
    end_x, end_y = parameters.loaded.held_end
    loaded = rod.under(Load(parameters.loaded.load.force), end_y, end_x)
    force = (float(loaded.force[0]), float(loaded.force[1]))
    lever = loaded.positions(loaded.s[-1:])[0] - [loaded.x[-1], loaded.y[-1]]
    # about the end of the material curve
    couple = float(loaded.moment[-1]) - lever[0] * force[1] + lever[1] * force[0]
    curves = rod.under(Load()).along(curve), loaded.along(curve)
    load = Load(force, couple)
    lines = numbers_of_curves(*curves, load, parameters.kappa.pitch, parameters.given_d)
    return OtherNumbers(lines, at.section.kappa_0, load)


def predictions(parameters: Sequence[Parameters], law: ArmLaw) -> list[OtherNumbers | str]:
    """By pressure, or why there is none."""
    found: list[OtherNumbers | str] = []
    for p in parameters:
        try:
            found.append(predicted(p, law))
        except RodError as failure:
            found.append(str(failure))
    return found


def with_mesh_error_of_laws(
    parameters: Sequence[Parameters], limit: Sequence[OtherNumbers | str], on_mesh: Sequence[OtherNumbers | str]
) -> tuple[Parameters, ...]:
    """The parameters with the differences between what the law in the limit of its mesh predicts and what the law on
    the mesh of the experiments does, as standard deviations; unchanged at a pressure at which one has no rod."""
    found = []
    for p, first, second in zip(parameters, limit, on_mesh, strict=True):
        if isinstance(first, str) or isinstance(second, str):
            found.append(p)
            continue
        numbers, own = first.numbers(p), second.numbers(p)
        found.append(with_errors(p, own, {name: abs(numbers[name] - own[name]) for name in own}, None))
    return tuple(found)
