"""The measurement of the convergence study: II and III of one configuration, with seconds and memory.

It runs in a process of its own, so that its peak of memory is its own.
"""

import resource
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from fem import compile_kernels
from geometry import Body, Centreline
from pipeline.accuracy.ladder import Rung
from pipeline.accuracy.result import Cost, RodNumbers, RungResult
from pipeline.context import RunContext
from pipeline.errors import InputError, RunFailed
from pipeline.identification.parameters import Parameters, counts_as_equal_cells, identify_all
from pipeline.progress import Silent
from pipeline.simulation.outcome import Outcomes, Record
from pipeline.simulation.scene import Scene, material_of
from pipeline.simulation.simulate import simulate
from pipeline.store.store import open_store


def measure(rung: Rung) -> RungResult:
    """Solve II and III and identify the numbers, from all nodes of the material curve and from every n-th."""
    compile_kernels(rung.config.mesh.formulation, material_of(rung.config))
    start, cpu = perf_counter(), _cpu_seconds()
    try:
        scene = Scene.meshed(rung.config)
        meshed = perf_counter() - start
        with TemporaryDirectory() as folder, open_store(Path(folder), rung.config) as store:
            outcomes = simulate(scene, RunContext.alone(store, Silent()), ("III", "II"))
    except (InputError, RunFailed) as failure:
        return RungResult(str(failure), (), None)
    fit_start, d = perf_counter(), rung.config.identification.d_mm
    equal = counts_as_equal_cells(rung.config.design)
    parameters, failures = identify_all(outcomes, scene.body.pitch, d, equal_cells=equal)
    fit = perf_counter() - fit_start
    seconds = {"mesh": meshed, **_stages(outcomes), "fit": fit}
    cost = _cost(perf_counter() - start, _cpu_seconds() - cpu, seconds, scene.body, outcomes)
    failures = (*(f"{outcome.name}: {outcome.failure.reason}" for outcome in outcomes if outcome.failure), *failures)
    numbers = [numbers_of(at_pressure, 1, fit) for at_pressure in parameters]
    for stride in rung.strides[1:]:
        fit_start = perf_counter()
        thinned, failed = identify_all(_thinned(outcomes, stride), scene.body.pitch, d, equal_cells=equal)
        numbers += [numbers_of(at_pressure, stride, perf_counter() - fit_start) for at_pressure in thinned]
        failures += tuple(f"every {stride} points: {sentence}" for sentence in failed)
    return RungResult("; ".join(failures), tuple(numbers), replace(cost, peak_memory_MB=_peak_memory_MB()))


def numbers_of(parameters: Parameters, stride: int = 1, fit_seconds: float = 0.0) -> RodNumbers:
    """The numbers that count, from the parameters at one pressure."""
    numbers, free, loaded = parameters.numbers, parameters.free, parameters.loaded
    return RodNumbers(
        pressure_kPa=parameters.pressure_kPa,
        stride=stride,
        fit_seconds=fit_seconds,
        points=len(free.centreline.s),
        kappa_0_per_mm=parameters.kappa_0_middle,
        alpha1_N_mm2=numbers["alpha1"].value,
        alpha2_N_mm2=numbers["alpha2"].value,
        d_mm=numbers["d"].value if parameters.two_lines else None,
        force_N=loaded.load.force[1] or loaded.load.force_size,  # that along x where none acts along y
        end_mm=free.summary.end_mm,
        alpha2_std_N_mm2=numbers["alpha2"].std,
        stress_error=max(free.summary.stress_error, loaded.summary.stress_error),
    )


def _cost(wall: float, cpu: float, seconds: Mapping[str, float], body: Body, outcomes: Outcomes) -> Cost:
    return Cost(
        wall_seconds=wall,
        cpu_seconds=cpu,
        seconds=seconds,
        peak_memory_MB=_peak_memory_MB(),
        degrees_of_freedom=outcomes.degrees_of_freedom,
        tetrahedra=len(body.mesh.tets),
        radius_ratio=body.mesh.quality.minimum,
        factorizations=outcomes.factorizations,
    )


def _stages(outcomes: Outcomes) -> dict[str, float]:
    """Seconds of the solver by stage of `pipeline.accuracy.table.STAGES`."""
    seconds = outcomes.seconds_by_stage
    return {
        "set_up": seconds["set_up"] + seconds["analysis"],
        "assembly": seconds["assembly"],
        "factorization": seconds["factorization"] + seconds["solve"],
        "contact": seconds["contact"],
    }


def _thinned(outcomes: Outcomes, stride: int) -> Outcomes:
    """The outcomes with every `stride`-th node of their material curves, the last one always."""

    def thinned(records: tuple[Record, ...]) -> tuple[Record, ...]:
        return tuple(replace(record, centreline=_every(record.centreline, stride)) for record in records)

    return outcomes.with_records(thinned)


def _every(curve: Centreline, stride: int) -> Centreline:
    kept = np.unique(np.append(np.arange(0, len(curve.s), stride), len(curve.s) - 1))
    return Centreline(curve.s[kept], curve.x[kept], curve.y[kept])


def _cpu_seconds() -> float:
    """User and system seconds of this process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def _peak_memory_MB() -> float:
    """The largest resident memory of this process so far."""
    status = Path("/proc/self/status")
    if status.is_file():  # ru_maxrss of a started process begins with that of its parent
        peak = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return round(int(peak.split()[1]) / 1024.0, 1)
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0, 1)
