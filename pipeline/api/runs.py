"""From a configuration to results: the whole story, or a part of it."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from pipeline.api.course import (
    MOST_JOBS,
    course_of,
    design_of,
    document_of,
    error_of,
    given_folder,
    load_notes,
    reached,
)
from pipeline.api.described import Material
from pipeline.api.options import Accuracy, ConfigFile, Draft, Fresh, Out, Settings, jobs_option, out_option
from pipeline.store.progress import Progress
from pipeline.values.errors import InputError, RunFailed, quoted

__all__ = ["cell", "characterize", "characterize_pairs", "mesh"]

if TYPE_CHECKING:
    from pipeline.api.results import Results
    from pipeline.law.build import MeasuredLaw
    from pipeline.law.in_space.measure import MeasuredInSpace
    from pipeline.law.study import LawReport
    from pipeline.simulate.meshed import MeshedArm
    from pipeline.study.pairs.run import PairRuns


def characterize(
    config: ConfigFile,
    out: Out = None,
    *,
    name: str | None = None,
    material: "Material | None" = None,
    pressures: Sequence[str] | None = None,
    settings: Settings = None,
    accuracy: Accuracy = None,
    draft: Draft = False,
    jobs: Annotated[int | None, jobs_option("number of cores, at most 3")] = None,
    fresh: Fresh = False,
    progress: "bool | Progress" = False,
) -> "Results":
    """Run a design: mesh, experiments I, II and III, the five parameters, the rod, the report.

    config: the YAML file of the design, or a body such as `pneurod.PneuNet(chambers=6, wall="1.2 mm")`. out: the
    result folder, "results/NAME" by default; a run that was interrupted continues from what it holds. name: of the
    design, by default its name in the file, or its family. material: such as `pneurod.NeoHooke(mu="0.1 MPa")`; a body
    needs one, and the material of a file is replaced. pressures: ["10 kPa", "20 kPa"]. settings: further values, by
    dotted key and with their unit: {"mesh.size": "6 mm", "geometry.chambers": 8}; they replace those of the file.
    accuracy: error that the mesh may make of the arm's own law, "1 %" by default, or "off". draft: make only
    the arm's own law on one mesh, whose error is unknown; a later full run in `out` uses it again. jobs: number of
    worker processes, by default the number of cores, at most 3. fresh: delete what `out` holds first. progress: report
    the stages on the terminal; nothing is printed otherwise.

    Raises `pneurod.InputError` for a wrong configuration, a wrong argument or a folder that cannot be used, and
    `pneurod.RunFailed` when something could not be solved: its `reached` are the results, and its `directory` holds
    them.
    """
    from pipeline.api.results import Results
    from pipeline.run import run

    if not isinstance(material, Material | None):
        raise InputError(
            f'material: {quoted(material)} is no material; give one such as pneurod.NeoHooke(mu="0.1 MPa")'
        )
    constants = None if material is None else material.values
    arguments = {"name": name, "material": constants, "pressures": pressures, **error_of(accuracy, draft)}
    design, folder, notes = design_of(config, arguments, settings, out)
    course = course_of(jobs, MOST_JOBS, fresh, progress)
    try:
        made = course.solve(run, design, folder, notes).results
    except RunFailed as failure:
        failure.directory = folder
        raise
    return reached(Results(made), made.raise_if_failed)


def characterize_pairs(
    config: ConfigFile,
    out: Out = None,
    *,
    settings: Settings = None,
    accuracy: Accuracy = None,
    draft: Draft = False,
    jobs: Annotated[int | None, jobs_option("number of cores, at most 3")] = None,
    fresh: Fresh = False,
    progress: "bool | Progress" = False,
) -> "PairRuns":
    """Run an arm with two cavities at pairs of pressures, and find its law over both.

    Arguments and errors as those of `characterize`. Raises InputError also where the pressures are no pairs.
    """
    from pipeline.law.rows import read_pairs
    from pipeline.study.pairs import run, table

    document = document_of(config, error_of(accuracy, draft), settings)
    if (spec := read_pairs(document)) is None:
        raise InputError(
            document.sentence(("pressures",), "are no pairs; for example [[10 kPa, 0 kPa], [20 kPa, 5 kPa]]")
        )
    made = course_of(jobs, MOST_JOBS, fresh, progress).solve(run.run_pairs, spec, given_folder(out, spec.name))
    table.save_page(made)
    return reached(made, made.raise_if_failed)


def mesh(
    config: ConfigFile,
    out: Annotated[Path | str | None, out_option("_mesh")] = None,
    *,
    settings: Settings = None,
    progress: "bool | Progress" = False,
) -> "MeshedArm":
    """Mesh the body alone: DIR/mesh.vtu, volumes and the quality of the elements.

    Raises InputError for a wrong configuration, a body that cannot be meshed and a folder that cannot be used.
    """
    from pipeline.simulate.meshed import mesh_alone

    design, folder, notes = design_of(config, {}, settings, out, "_mesh", "mesh")
    return course_of(None, 1, False, progress).solve(mesh_alone, design, folder, (*notes, *load_notes(design)))


def cell(
    config: ConfigFile,
    out: Annotated[Path | str | None, out_option("_cell")] = None,
    *,
    settings: Settings = None,
    accuracy: Accuracy = None,
    draft: Draft = False,
    jobs: Annotated[int | None, jobs_option("1")] = None,
    fresh: Fresh = False,
    progress: "bool | Progress" = False,
) -> "LawReport[MeasuredLaw] | LawReport[MeasuredInSpace]":
    """Measure the arm's own law from one cell and its two ends, for every load and length.

    The law of an arm that leaves its plane is one in space. Raises InputError for a wrong configuration or folder and
    for an arm without such a law, and RunFailed, which has the report as `reached`, where a pressure is not reached.
    """
    from pipeline.law import rows, study
    from pipeline.show import saved

    document = document_of(config, error_of(accuracy, draft), settings)
    course = course_of(jobs, 1, fresh, progress)
    given, notes = rows.for_cell(document)
    design = given.config if isinstance(given, rows.RowSpec) else given
    notes = notes if isinstance(given, rows.RowSpec) else (*notes, *load_notes(given))
    report = course.solve(study.measure_any_law, given, given_folder(out, f"{design.name}_cell"), notes)
    saved.save_page(report.directory)
    return reached(report, report.raise_if_failed)
