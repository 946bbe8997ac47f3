"""One rung of the ladder of accuracy, measured in a process of its own so that its peak of memory is its own."""

import resource
from collections.abc import Sequence
from concurrent.futures import as_completed
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np

from fem import compile_kernels
from geometry import Body, Centreline
from pipeline.accuracy.ladder import Rung
from pipeline.context import RunContext
from pipeline.errors import InputError, RunFailed
from pipeline.identification.parameters import Parameters, identify_all
from pipeline.processes import process_pool
from pipeline.progress import Silent
from pipeline.simulation.outcome import Outcomes, Record
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import simulate
from pipeline.store.store import open_store


def measured_apart(rungs: Sequence[Rung], jobs: int, keep: Any) -> None:
    """Measure rungs in processes of one thread and one rung each, `jobs` at a time; `keep(rung, record)` gets each as
    soon as it is finished."""
    with process_pool(jobs, 1, max_tasks_per_child=1) as pool:
        asked = {pool.submit(measure, rung): rung for rung in rungs}
        for future in as_completed(asked):
            keep(asked[future], future.result())


def measure(rung: Rung) -> dict[str, Any]:
    """II and III of a rung: seconds, size and what users take home, by stride and pressure."""
    compile_kernels(rung.config.mesh.formulation)
    start, cpu = perf_counter(), _cpu_seconds()
    try:
        scene = Scene.meshed(rung.config)
        meshed = perf_counter() - start
        with TemporaryDirectory() as folder, open_store(Path(folder), rung.config) as store:
            outcomes = simulate(scene, RunContext(store, 1, Silent()), ("III", "II"))
    except (InputError, RunFailed) as failure:
        return {"failure": str(failure), "numbers": []}
    begin = perf_counter()
    found, refused = identify_all(outcomes, scene.body.pitch)
    fit = perf_counter() - begin
    wall, spent = perf_counter() - start, _cpu_seconds() - cpu
    stopped = [f"{outcome.name}: {outcome.failure.reason}" for outcome in outcomes if outcome.failure]
    numbers = [numbers_of(one, 1, fit) for one in found]
    for stride in rung.strides[1:]:
        begin = perf_counter()
        thinner, without = identify_all(_thinned(outcomes, stride), scene.body.pitch)
        numbers += [numbers_of(one, stride, perf_counter() - begin) for one in thinner]
        refused += tuple(f"every {stride} points: {sentence}" for sentence in without)
    return {
        "failure": "; ".join([*stopped, *refused]),
        "wall_seconds": wall,
        "cpu_seconds": spent,
        "seconds": {"mesh": meshed, **_stages(outcomes), "fit": fit},
        "peak_memory_MB": _peak_memory_MB(),
        **_size(scene.body, outcomes),
        "numbers": numbers,
    }


def numbers_of(found: Parameters, stride: int = 1, fit: float = 0.0) -> dict[str, Any]:
    """What users take home at one pressure; `null` for the break of a single line."""
    numbers = found.numbers
    return {
        "pressure_kPa": found.pressure_kPa,
        "stride": stride,
        "fit_seconds": fit,
        "points": len(found.free.centreline.s),
        "kappa_0_per_mm": found.kappa_0_middle,
        "alpha1_N_mm2": numbers["alpha1"].value,
        "alpha2_N_mm2": numbers["alpha2"].value,
        "d_mm": numbers["d"].value if found.by_cells.two_lines else None,
        "force_N": found.loaded.load.force[1],
        "end_mm": list(found.free.summary.end_mm),
        "alpha2_std_N_mm2": numbers["alpha2"].std,
        "stress_error": max(record.summary.stress_error for record in (found.free, found.loaded)),
    }


def _size(body: Body, outcomes: Outcomes) -> dict[str, Any]:
    return {
        "degrees_of_freedom": outcomes.degrees_of_freedom,
        "tetrahedra": len(body.mesh.tets),
        "radius_ratio": body.mesh.quality.minimum,
        "factorizations": outcomes.factorizations,
    }


def _stages(outcomes: Outcomes) -> dict[str, float]:
    """Seconds of the solver by what they were spent on."""
    seconds = outcomes.seconds_by_stage
    return {
        "set_up": seconds["set_up"] + seconds["analysis"],
        "assembly": seconds["assembly"],
        "factorization": seconds["factorization"] + seconds["solve"],
        "contact": seconds["contact"],
    }


def _thinned(outcomes: Outcomes, stride: int) -> Outcomes:
    """The outcomes with every so many-th node of their material curves, the last one always."""

    def thinned(records: tuple[Record, ...]) -> tuple[Record, ...]:
        return tuple(replace(record, centreline=_every(record.centreline, stride)) for record in records)

    return outcomes.with_records(thinned)


def _every(curve: Centreline, stride: int) -> Centreline:
    chosen = np.unique(np.append(np.arange(0, len(curve.s), stride), len(curve.s) - 1))
    return Centreline(curve.s[chosen], curve.x[chosen], curve.y[chosen])


def _cpu_seconds() -> float:
    """User and system seconds of this process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def _peak_memory_MB() -> float:
    """The most memory this process has held."""
    status = Path("/proc/self/status")
    if status.is_file():  # ru_maxrss of a started process begins with that of its parent
        peak = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return round(int(peak.split()[1]) / 1024.0, 1)
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0, 1)
