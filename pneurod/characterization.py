"""A run from Python: what `pneurod run` does, with its results as values."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from pipeline.config.config import Config
from pipeline.config.document import Document, read_document
from pipeline.config.section import read
from pipeline.run import run
from pipeline.show.progress import progress_for
from pipeline.simulate.simulate import EXPERIMENTS
from pipeline.store.progress import Silent
from pipeline.store.worker import available_cores
from pipeline.values.errors import InputError, RunFailed, quoted
from pneurod.arguments import IN_PYTHON, Setting, given_choice, given_jobs, given_path, given_settings, setting_name
from pneurod.designs import Body, Material
from pneurod.results import Results


def characterize(
    config: Path | str | Body,
    out: Path | str | None = None,
    *,
    name: str | None = None,
    material: Material | None = None,
    pressures: Sequence[str] | None = None,
    settings: Mapping[str, Setting] | None = None,
    accuracy: str | None = None,
    jobs: int | None = None,
    fresh: bool = False,
    progress: bool = False,
) -> Results:
    """Mesh, experiments I, II and III, the five parameters, the rod and the report of one design.

    config: the YAML file of the design, or a body such as `pneurod.PneuNet(chambers=6, wall="1.2 mm")`. out: the
    result folder, "results/NAME" by default; a run that was interrupted continues from what it holds. name: of the
    design, by default its name in the file, or its family. material: such as `pneurod.NeoHooke(mu="0.1 MPa")`; a body
    needs one, and the material of a file is replaced. pressures: ["10 kPa", "20 kPa"]. settings: further values, by
    dotted key and with their unit: {"mesh.size": "6 mm", "geometry.chambers": 8}; they replace those of the file.
    accuracy: error that the mesh may make of the arm's own law, "1 %" by default, or "off". jobs: number of
    worker processes, by default the number of cores, at most 3. fresh: delete what `out` holds first. progress: report
    the stages on the terminal; nothing is printed otherwise.

    Raises `pneurod.InputError` for a wrong configuration, a wrong argument or a folder that cannot be used, and
    `pneurod.RunFailed` when something could not be solved: its `directory` holds what was reached, for
    `pneurod.read_results`.
    """
    if not isinstance(material, Material | None):
        raise InputError(
            f'material: {quoted(material)} is no material; give one such as pneurod.NeoHooke(mu="0.1 MPa")'
        )
    constants = None if material is None else material.values
    arguments = {"name": name, "material": constants, "pressures": pressures, "accuracy": accuracy}
    given = {key: value for key, value in arguments.items() if value is not None}
    values = given_settings(given, str) + given_settings(settings)
    replaces, shown = given_choice(fresh, "fresh"), given_choice(progress, "progress")
    document = _document(config).with_values(values, lambda key: key if key in given else setting_name(key))
    design = read(Config, document)
    folder = Path("results") / design.name if out is None else given_path(out, "out", "results/arm")
    at_once = given_jobs(jobs) or min(len(EXPERIMENTS), available_cores())
    listener = progress_for() if shown else Silent()
    try:
        results = run(design, folder, at_once, replaces, listener, IN_PYTHON).results
        results.raise_if_failed()
    except RunFailed as failure:
        raise RunFailed(str(failure), directory=folder) from None
    finally:
        listener.done()
    return Results(results)


def _document(config: Path | str | Body) -> Document:
    """The keys of a design in a file, or those of a body; a file that a body names is seen from the working folder."""
    if not isinstance(config, Body):
        return read_document(given_path(config, "config", "configs/pneunet.yaml"))
    name = str(config.values["family"])
    path = Path(type(config).__name__)
    keys = Document(path, {}, ()).with_values([("name", name), ("geometry", config.values)], str)
    return Document(path, keys.content, ())
