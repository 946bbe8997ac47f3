"""What the mesh contributes to the errors of the five numbers: the same experiments on a second, coarser mesh."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from pipeline.config.config import Config
from pipeline.context import RunContext
from pipeline.errors import InputError
from pipeline.identification.parameters import Parameters, numbers_of_cells
from pipeline.identification.richardson import extrapolated
from pipeline.simulation.loadcase import LoadCase, schedule
from pipeline.simulation.outcome import Record
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import simulate
from rod import PARAMETER_NAMES, Identification, RodError


def with_mesh_error(config: Config, context: RunContext, found: tuple[Parameters, ...]) -> tuple[Parameters, ...]:
    """The same numbers with the deviations that II and III on a mesh `config.mesh.coarser` times as coarse suggest.

    Unchanged where no such factor is configured, and where that mesh cannot be made or gives no number at any pressure:
    a mesh that is too coarse for the arm says nothing about the finer one, and the report says so. Raises RunFailed as
    `simulate` does.
    """
    factor = config.mesh.coarser
    if factor is None or not found:
        return found
    second = replace(config, mesh=replace(config.mesh, size_mm=factor * config.mesh.size_mm))
    try:
        scene = Scene.meshed(second)
    except InputError:
        return found
    pressures = schedule(config, tuple(p.pressure_kPa for p in found))
    cases = [LoadCase(f"coarser_{name}", name, pressures, config.end_y_mm) for name in ("III", "II")]
    outcomes = simulate(scene, context, cases)
    free, loaded = outcomes["coarser_II"], outcomes["coarser_III"]
    others = [_numbers(p, free.at(p.pressure_kPa), loaded.at(p.pressure_kPa)) for p in found]
    values = [{name: one.value for name, one in p.numbers_without_mesh.items()} for p in found]
    deviations = mesh_deviations(values, others, config.mesh.size_mm, factor)
    return tuple(replace(p, mesh_std=stds) for p, stds in zip(found, deviations, strict=True))


def mesh_deviations(
    fine: Sequence[Mapping[str, float]], coarse: Sequence[Mapping[str, float] | None], size: float, factor: float
) -> tuple[dict[str, float], ...]:
    """Standard deviations by name of the numbers at every pressure, from those on a mesh of `size` (mm) and one
    `factor` times as coarse; empty where there is nothing to compare with at any pressure.

    Two meshes may agree on a number by chance, so none gets less than the root mean square over the pressures, of the
    relative errors for rigidities, which grow with the pressure.
    """
    sizes = (size, factor * size)
    own: list[dict[str, float]] = []
    for here, there in zip(fine, coarse, strict=True):
        stds = {} if there is None else {n: extrapolated(sizes, (here[n], there[n])).error_std for n in here}
        own.append({n: std / _scale(n, here) for n, std in stds.items()})
    known = [stds for stds in own if stds]
    if not known:
        return tuple({} for _ in own)
    usual = {n: math.sqrt(sum(stds[n] ** 2 for stds in known) / len(known)) for n in known[0]}
    return tuple(
        {n: max(stds.get(n, 0.0), usual[n]) * _scale(n, here) for n in usual}
        for stds, here in zip(own, fine, strict=True)
    )


def _scale(name: str, numbers: Mapping[str, float]) -> float:
    return abs(numbers[name]) if name.startswith("alpha") else 1.0


def _numbers(fine: Parameters, free: Record | None, loaded: Record | None) -> dict[str, float] | None:
    """The numbers on the coarser mesh, of as many lines as on the fine one."""
    if free is None or loaded is None:
        return None
    try:
        found: Identification = numbers_of_cells(free, loaded, fine.kappa.pitch)
    except RodError:
        return None
    if fine.by_cells.two_lines:
        return {name: getattr(found.law, name) for name in PARAMETER_NAMES}
    alpha, m0 = found.single_line.alpha.value, found.single_line.m0.value
    return {"alpha1": alpha, "alpha2": alpha, "m01": m0, "m02": m0, "d": fine.shortest_break}
