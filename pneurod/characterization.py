"""A run from Python: what `pneurod run` does, with its results as values."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from pipeline.config.config import Config
from pipeline.config.document import read_document
from pipeline.config.section import read
from pipeline.errors import InputError, RunFailed
from pipeline.processes import available_cores
from pipeline.progress import Silent, progress_for
from pipeline.run import run
from pipeline.simulation.simulate import EXPERIMENTS
from pipeline.store.result_folder import FolderWords
from pneurod.arguments import given_choice, given_path, given_settings, setting_name
from pneurod.results import Results, read_results

#: numbers with their unit and words as texts, plain numbers, and lists of them
Setting = str | float | bool | Sequence[str]
#: how the refusal of a result folder names what was given here
_WORDS = FolderWords(out="out", joint="=", fresh="fresh=True")


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

    Raises `pneurod.InputError` for a wrong configuration, a wrong argument or a folder that cannot be used, and
    `pneurod.RunFailed` when something could not be solved: its `directory` holds what was reached, for
    `pneurod.read_results`.
    """
    if jobs is not None and (isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1):
        raise InputError(f"jobs: {jobs!r} is not allowed; give a whole number from 1 on")
    values = given_settings(settings)
    if accuracy is not None:
        values.append(("accuracy", accuracy))
    replaces, shown = given_choice(fresh, "fresh"), given_choice(progress, "progress")
    given = read_document(given_path(config, "config", "configs/pneunet.yaml"))
    design = read(Config, given.with_values(values, _argument if accuracy is not None else setting_name))
    folder = Path("results") / design.name if out is None else given_path(out, "out", "results/arm")
    at_once = jobs or min(len(EXPERIMENTS), available_cores())
    listener = progress_for() if shown else Silent()
    try:
        run(design, folder, at_once, replaces, listener, _WORDS).raise_if_failed()
    except RunFailed as failure:
        raise RunFailed(str(failure), directory=folder) from None
    finally:
        listener.done()
    return read_results(folder)


def _argument(key: str) -> str:
    """The name of a setting where the accuracy is an argument of its own."""
    return key if key == "accuracy" else setting_name(key)
