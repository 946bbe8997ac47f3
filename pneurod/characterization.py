"""A run from Python: what `pneurod run` does, with its results as values."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from pipeline.config.load import load_config
from pipeline.errors import InputError, RunFailed
from pipeline.processes import available_cores
from pipeline.progress import Silent, progress_for
from pipeline.run import run
from pipeline.simulation.simulate import EXPERIMENTS
from pneurod.reading import read_results
from pneurod.results import Results

#: what `--set` takes as text: numbers with their unit, plain numbers, words, and lists of them
Setting = str | float | bool | Sequence[str]


def characterize(
    config: Path | str,
    out: Path | str | None = None,
    *,
    settings: Mapping[str, Setting] | None = None,
    accuracy: str | None = None,
    jobs: int | None = None,
    fresh: bool = False,
    progress: bool = False,
) -> Results:
    """Mesh, experiments I, II and III, the five parameters, the rod and the report of one design.

    config: the YAML file of the design. out: the result folder, "results/NAME" by default; a run that was interrupted
    continues from what it holds. settings: values that replace those of the file, by dotted key and with their unit:
    {"mesh.size": "6 mm", "pressures": ["10 kPa", "20 kPa"], "geometry.chambers": 8}. accuracy: the error to aim for,
    such as "2 %" (with mesh.size "auto" the mesh is chosen for it). jobs: number of worker processes, by default the
    number of cores, at most 3. fresh: delete what `out` holds first. progress: report the stages on the terminal;
    nothing is printed otherwise.

    Raises `pneurod.InputError` for a wrong configuration or a folder that cannot be used, and `pneurod.RunFailed`
    when something could not be solved: its `directory` holds what was reached, for `pneurod.read_results`.
    """
    if jobs is not None and (isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1):
        raise InputError(f"jobs: {jobs!r} is not allowed; give a whole number from 1 on")
    if settings is not None and not isinstance(settings, Mapping):
        raise InputError('settings: give values by their keys, for example {"mesh.size": "6 mm"}')
    overrides = [f"{key}={_written(value)}" for key, value in (settings or {}).items()]
    design = load_config(config, [*overrides, *([f"accuracy={accuracy}"] if accuracy is not None else [])])
    folder = Path("results") / design.name if out is None else Path(out)
    listener = progress_for() if progress else Silent()
    try:
        run(design, folder, jobs or min(len(EXPERIMENTS), available_cores()), fresh, listener).raise_if_failed()
    except RunFailed as failure:
        raise RunFailed(str(failure), directory=folder) from None
    finally:
        listener.done()
    return read_results(folder)


def _written(value: Setting) -> str:
    """The value as it stands in YAML."""
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        return f"[{', '.join(map(_written, value))}]"
    return str(value).lower() if isinstance(value, bool) else str(value)
