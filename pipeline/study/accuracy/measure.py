"""II and III of one configuration: the identified numbers, and what they cost in seconds and memory.

A measurement runs in a process of its own, so that its peak of memory is its own.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time

from fem import compile_kernels
from pipeline.config.config import Config
from pipeline.identify.parameters import Parameters, counts_as_equal_cells, identify_all
from pipeline.simulate.scene import Scene, material_of
from pipeline.simulate.simulate import simulate
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.reasons import render, render_all

#: the number whose meaning depends on whether the law has one slope or two
RIGIDITY = "alpha2_N_mm2"
#: the numbers whose largest relative error counts as the error of a configuration
HEADLINE = ("kappa_0_per_mm", RIGIDITY, "force_N")
#: stages of a measurement by the solver, and what the solver calls their parts
_SOLVER_STAGES = {
    "set_up": ("set_up", "analysis"),
    "assembly": ("assembly",),
    "factorization": ("factorization", "solve"),
    "contact": ("contact",),
}
#: stages of a measurement
STAGES = ("mesh", *_SOLVER_STAGES, "fit")


@dataclass(frozen=True)
class RodNumbers:
    """What II and III at one pressure give."""

    pressure_kPa: float
    kappa_0_per_mm: float  #: at half the length, from II
    alpha1_N_mm2: float
    alpha2_N_mm2: float
    d_mm: float | None  #: None where a single line suffices, which has no break
    force_N: float  #: y component of the end force of III
    end_mm: tuple[float, float]  #: x and y of the end in II
    alpha2_std_N_mm2: float
    stress_error: float  #: the larger error indicator of the two states (`fem.stress_error`)

    @property
    def scalars(self) -> dict[str, float | None]:
        """The numbers by name, the end by its coordinates."""
        end_x, end_y = self.end_mm
        names = ("kappa_0_per_mm", "alpha1_N_mm2", RIGIDITY, "d_mm", "force_N")
        return {**{name: getattr(self, name) for name in names}, "end_x_mm": end_x, "end_y_mm": end_y}

    @property
    def has_two_lines(self) -> bool:
        """Whether the law has two slopes."""
        return self.d_mm is not None


@dataclass(frozen=True)
class Cost:
    """What a configuration costs with one thread."""

    wall_seconds: float
    cpu_seconds: float
    seconds: Mapping[str, float]  #: wall time by the names of `STAGES`
    peak_memory_MB: float
    degrees_of_freedom: int
    tetrahedra: int
    radius_ratio: float  #: the smallest of all tetrahedra
    factorizations: int


@dataclass(frozen=True)
class RungResult:
    """Numbers and cost of one configuration."""

    failure: str  #: empty, or sentences
    numbers: tuple[RodNumbers, ...]
    cost: Cost | None  #: None where the body could not be meshed or no experiment could be started

    def at(self, pressure_kPa: float) -> RodNumbers | None:
        """The numbers at one pressure, None where it was not reached."""
        return next((numbers for numbers in self.numbers if numbers.pressure_kPa == pressure_kPa), None)


def measure(config: Config) -> RungResult:
    """Solve II and III and identify the numbers at every pressure that both reach."""
    compile_kernels(config.mesh.formulation, material_of(config))
    start, cpu = perf_counter(), process_time()
    try:
        scene = Scene.meshed(config)
        meshed = perf_counter() - start
        with TemporaryDirectory() as folder, open_store(Path(folder), config) as store:
            outcomes = simulate(scene, RunContext.alone(store, Silent()), ("III", "II"))
    except (InputError, RunFailed) as failure:
        return RungResult(str(failure), (), None)
    failures = [f"{outcome.name}: {render_all(outcome.failure.reasons)}" for outcome in outcomes if outcome.failure]
    fit_start = perf_counter()
    equal = counts_as_equal_cells(config.design)
    parameters, refused = identify_all(outcomes, scene.body.pitch, config.identification.d_mm, equal_cells=equal)
    end, solver = perf_counter(), outcomes.seconds_by_stage
    spent = {stage: sum(solver[part] for part in parts) for stage, parts in _SOLVER_STAGES.items()}
    cost = Cost(
        wall_seconds=end - start,
        cpu_seconds=process_time() - cpu,
        seconds={"mesh": meshed, **spent, "fit": end - fit_start},
        peak_memory_MB=_peak_memory_MB(),
        degrees_of_freedom=outcomes.degrees_of_freedom,
        tetrahedra=len(scene.body.mesh.tets),
        radius_ratio=scene.body.mesh.quality.minimum,
        factorizations=outcomes.factorizations,
    )
    numbers = tuple(map(numbers_of, parameters))
    return RungResult("; ".join((*failures, *map(render, refused))), numbers, cost)


def numbers_of(parameters: Parameters) -> RodNumbers:
    """The numbers that count, from the parameters at one pressure."""
    numbers, free, loaded = parameters.numbers, parameters.free, parameters.loaded
    return RodNumbers(
        pressure_kPa=parameters.pressure_kPa,
        kappa_0_per_mm=parameters.kappa_0.middle,
        alpha1_N_mm2=numbers["alpha1"].value,
        alpha2_N_mm2=numbers["alpha2"].value,
        d_mm=numbers["d"].value if parameters.two_lines else None,
        force_N=loaded.load.force[1] or loaded.load.force_size,  # that along x where none acts along y
        end_mm=free.state.end_mm,
        alpha2_std_N_mm2=numbers["alpha2"].std,
        stress_error=max(free.state.stress_error, loaded.state.stress_error),
    )


def _peak_memory_MB() -> float:
    """The largest resident memory of this process so far."""
    status = Path("/proc/self/status")
    if status.is_file():  # ru_maxrss of a started process begins with that of its parent
        peak = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return round(int(peak.split()[1]) / 1024.0, 1)
    import resource  # not on every system

    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0, 1)
