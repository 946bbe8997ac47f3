"""What the mesh contributes to the errors of the five numbers: the same experiments on a second, coarser mesh.

With the arm's own law, what two meshes make of that: the rod with a law is put under the loads of experiments II and
III, and its curves are identified as those of the finite elements are. Laws on two meshes differ in their prediction as
the whole arm on these meshes does.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from fem.elements import MOST_ACCURATE
from geometry import Reason
from pipeline.config.config import Config
from pipeline.identify.parameters import Parameters, has_one_rigidity, numbers_of_curves, sum_evidence, takes_two_lines
from pipeline.simulate.loadcase import LoadCase, schedule
from pipeline.simulate.outcome import Outcomes, Record
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.store.context import RunContext
from pipeline.store.parallel import TaskContext
from pipeline.values.errors import InputError
from pipeline.values.richardson import extrapolate_all
from rod import PARAMETER_NAMES, ArmLaw, Identification, Load, Rod, RodError, cell_averaged

#: elements whose error does not fall steadily with the size, so that a coarser mesh of them does not show it: p2p0 on
#: the gapped arm of the paper are off by 4 to 5 % in kappa_0 and F on meshes of 3 and of 2 mm (studies/accuracy.md)
UNSTEADY = "p2p0"
#: numbers whose error is given as a fraction: kappa_0(l/2), alpha2 and the end force of III
RELATIVE = ("kappa_0", "alpha2", "force")


def with_mesh_error(
    config: Config, context: RunContext, parameters: tuple[Parameters, ...]
) -> tuple[tuple[Parameters, ...], tuple[Reason, ...]]:
    """The parameters with the deviations that II and III on a mesh `config.mesh.coarser` times as coarse suggest,
    and reasons where that mesh gave none at some pressure.

    With UNSTEADY elements the difference from mixed ones counts as well. Unchanged where no such factor is configured,
    and where that mesh cannot be made or gives no number at any pressure: a mesh that is too coarse for the arm says
    nothing about the finer one. Raises RunFailed as `simulate` does.
    """
    factor = config.mesh.coarser
    if factor is None or not parameters:
        return parameters, ()
    second = config.with_mesh_size(factor * config.mesh.size_mm)
    try:
        scene = context.submit(_meshed, second).result()
    except InputError as failure:
        return parameters, (Reason("coarser_not_meshed", {"factor": factor, "why": str(failure)}),)
    outcomes = _solved(scene, context, "coarser", tuple(p.pressure_kPa for p in parameters))
    coarse, refused = _identify(parameters, outcomes, "coarser")
    fine = [_numbers(p) for p in parameters]
    on_coarse = [None if on is None else on.numbers(p) for on, p in zip(coarse, parameters, strict=True)]
    reasons = [Reason("on_coarser_mesh", {"factor": factor, "why": refused})] if refused else []
    others: dict[str, float] = {}
    compared = _of_half_the_highest(parameters)
    if config.mesh.formulation == UNSTEADY and any(on_coarse):
        others, not_compared = _from_mixed(second, context, compared)
        reasons += not_compared
    deviations = mesh_deviations(fine, on_coarse, config.mesh.size_mm, factor, others)
    every = zip(parameters, fine, deviations, _two_lines(parameters, coarse), strict=True)
    improved = (with_errors(*of_pressure) for of_pressure in every)
    mixed_at_kPa = compared.pressure_kPa if others else None
    return tuple(replace(p, mixed_at_kPa=mixed_at_kPa) for p in improved), tuple(reasons)


def _of_half_the_highest(parameters: Sequence[Parameters]) -> Parameters:
    """Those of the highest pressure that is at most half of the maximum, or of the lowest: mixed elements of St.
    Venant-Kirchhoff's law meet the limit of that law in the corner at the clamp (III of `pneunet`: 22.8 kPa with a mesh
    of 2 mm, 28 to 31 kPa with 4 mm) before p2p0 elements do."""
    lower = [p for p in parameters if p.pressure_kPa <= parameters[-1].pressure_kPa / 2]
    return lower[-1] if lower else parameters[0]


def _from_mixed(second: Config, context: RunContext, own: Parameters) -> tuple[dict[str, float], list[Reason]]:
    """By how much the numbers of one pressure differ from those of mixed elements as coarse as the second mesh, over
    `_scale`; and why there are none. Raises RunFailed as `simulate`."""
    grading = "walls" if second.design.has_drawing else second.mesh.grading
    mixed = replace(second, mesh=replace(second.mesh, formulation=MOST_ACCURATE, grading=grading))
    try:
        outcomes = _solved(context.submit(_meshed, mixed).result(), context, MOST_ACCURATE, (own.pressure_kPa,))
    except InputError as failure:
        return {}, [Reason("not_compared_with_mixed", {"why": str(failure)})]
    (on_mixed,), refused = _identify([own], outcomes, MOST_ACCURATE)
    if on_mixed is None:
        return {}, [Reason("not_compared_with_mixed", {"why": refused})]
    of_run, numbers = _numbers(own), on_mixed.numbers(own)
    return {name: abs(of_run[name] - value) / _scale(name, of_run) for name, value in numbers.items()}, []


def _solved(scene: Scene, context: RunContext, name: str, pressures_kPa: tuple[float, ...]) -> Outcomes:
    """III and II of another mesh under names that begin with `name`. Raises RunFailed as `simulate`."""
    pressures, end = schedule(scene.config, pressures_kPa), scene.config.end
    cases = [LoadCase(f"{name}_{experiment}", experiment, pressures, end) for experiment in ("III", "II")]
    return simulate(scene, context, cases)


def _numbers(parameters: Parameters) -> dict[str, float]:
    """The five numbers, kappa_0(l/2) and F on the mesh of the run."""
    own = OtherNumbers(parameters.by_cells, parameters.kappa_0.middle, parameters.loaded.load)
    return own.numbers(parameters)


def _meshed(context: TaskContext, config: Config) -> Scene:
    """A task, because Gmsh takes the output of its process."""
    return Scene.meshed(config)


def with_errors(
    parameters: Parameters, numbers: Mapping[str, float], stds: Mapping[str, float], two_lines: bool | None
) -> Parameters:
    """The parameters with deviations by name because of the mesh; numbers: the five, kappa_0 and F on their mesh.

    two_lines: whether two lines are taken on the other mesh; None where that is not known.
    """
    stds = stds if parameters.two_lines else of_single_line(stds)
    return replace(
        parameters,
        mesh_std={name: stds[name] for name in PARAMETER_NAMES if name in stds},
        mesh_errors={name: stds[name] / abs(numbers[name]) for name in RELATIVE if name in stds},
        two_lines_on_coarser=two_lines,
    )


def mesh_deviations(
    fine: Sequence[Mapping[str, float]],
    coarse: Sequence[Mapping[str, float] | None],
    size: float,
    factor: float,
    others: Mapping[str, float] | None = None,
) -> tuple[dict[str, float], ...]:
    """Standard deviations by name of the numbers at every pressure, from those on a mesh of `size` (mm) and on a mesh
    `factor` times as coarse; empty where there is nothing to compare with at any pressure.

    Two meshes may agree on a number by chance, so no number gets less than the root mean square over the pressures,
    of the relative errors for rigidities, which grow with the pressure; nor less than its difference from other
    elements, in `others` over `_scale`.
    """
    scaled: list[dict[str, float]] = []
    for on_fine, on_coarse in zip(fine, coarse, strict=True):
        found = extrapolate_all({size: on_fine, factor * size: on_coarse or {}})
        scaled.append({n: one.error_std / _scale(n, on_fine) for n, one in found.items()})
    available = [stds for stds in scaled if stds]
    if not available:
        return tuple({} for _ in scaled)
    rms = {n: math.sqrt(sum(stds[n] ** 2 for stds in available) / len(available)) for n in available[0]}
    least = {n: max(one, (others or {}).get(n, 0.0)) for n, one in rms.items()}
    return tuple(
        {n: max(stds.get(n, 0.0), least[n]) * _scale(n, on_fine) for n in least}
        for stds, on_fine in zip(scaled, fine, strict=True)
    )


def of_single_line(stds: Mapping[str, float]) -> dict[str, float]:
    """The deviations of a rod with a single line: rigidity and offset of both its pieces are the same numbers, whose
    errors are at least those at other pressures, where the pieces may have lines of their own."""
    second = {"alpha1": "alpha2", "m01": "m02"}
    return {name: stds[second.get(name, name)] for name in stds}


def _scale(name: str, numbers: Mapping[str, float]) -> float:
    return abs(numbers[name]) if name.startswith(("alpha", *RELATIVE)) else 1.0


@dataclass(frozen=True)
class OtherNumbers:
    """What experiments II and III at one pressure give otherwise: on another mesh, or of a rod in place of the arm."""

    lines: Identification
    kappa_0: float  #: 1/mm, in the middle
    load: Load  #: of III
    one_rigidity: bool = False  #: as in `Parameters`

    @staticmethod
    def of(fine: Parameters, free: Record, loaded: Record) -> "OtherNumbers":
        """The prediction on another mesh, at the pressure of the parameters on the first one. Raises RodError."""
        curves, pitch = (free.centreline, loaded.centreline), fine.kappa.pitch
        lines = numbers_of_curves(*curves, loaded.load, pitch, fine.given_d)
        is_one = has_one_rigidity(fine.equal_cells, free, loaded)
        return OtherNumbers(lines, cell_averaged(free.centreline, pitch).middle, loaded.load, is_one)

    def numbers(self, parameters: Parameters) -> dict[str, float]:
        """The five numbers with as many lines as the parameters have, kappa_0 in 1/mm and F, the size of a force."""
        five = {name: number.value for name, number in parameters.numbers_of(self.lines).items()}
        return five | {"kappa_0": self.kappa_0, "force": self.load.force_size}


def _identify(
    parameters: Sequence[Parameters], outcomes: Outcomes, name: str
) -> tuple[list[OtherNumbers | None], list[Reason]]:
    """What follows at each pressure from outcomes whose names begin with `name`; None where one was not reached or
    nothing follows, and why."""
    refused, found = list(outcomes.failures), list[OtherNumbers | None]()
    for p in parameters:
        free, loaded = (outcomes[f"{name}_{experiment}"].at(p.pressure_kPa) for experiment in ("II", "III"))
        found.append(None)
        if free is not None and loaded is not None:
            try:
                found[-1] = OtherNumbers.of(p, free, loaded)
            except RodError as failure:
                why = str(failure).removesuffix(".")
                refused.append(Reason("not_identified", {"pressure_kPa": p.pressure_kPa, "why": why}))
    return found, refused


def _two_lines(parameters: Sequence[Parameters], coarse: Sequence[OtherNumbers | None]) -> Sequence[bool | None]:
    """Whether two lines would be chosen on the coarser mesh; None where pressures to decide with are lacking."""
    known = [on for on in coarse if on is not None]
    if len(known) < len(coarse):
        return [None] * len(coarse)
    one_rigidity = [on.one_rigidity for on in known]
    decisive = sum_evidence([on.lines.evidence for on in known], one_rigidity)
    every = zip(decisive, one_rigidity, parameters, strict=True)
    return [takes_two_lines(evidence, is_one, p.given_d is not None) for evidence, is_one, p in every]


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
    """Predictions of the rods by pressure, or why there is none."""
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
