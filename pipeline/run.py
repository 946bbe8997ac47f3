"""A run from beginning to end: configuration, body, experiments, five parameters, rod, report."""

from dataclasses import replace
from functools import cache, partial
from pathlib import Path

from pipeline import stages
from pipeline.config.config import Config
from pipeline.identify.parameters import Identified
from pipeline.identify.validate import Validated
from pipeline.results.files import replace_draft
from pipeline.show.pictures import draw_all
from pipeline.show.saved import save_report
from pipeline.simulate.design_notes import check_design
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.simulate import begin_II
from pipeline.store.context import RunContext, run_context
from pipeline.store.parallel import Pending
from pipeline.store.progress import Progress
from pipeline.store.store import open_store
from pipeline.values.reasons import render


def run(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> stages.SolvedRun:
    """From a configuration to `out`/report.html, `jobs` tasks at a time; `fresh` replaces earlier results.

    A pressure that is not reached is among the `failures` of the results; everything finished is in `out` then, the
    report included. Raises InputError for a body that cannot be meshed, a folder that cannot be used,
    and RunFailed where nothing more can be solved (faces that cannot touch, a process that was ended from
    outside).
    """
    with open_store(out, config, fresh=fresh) as store:
        replace_draft(store, draft=config.draft)
        for reason in check_design(config):
            progress.remark(render(reason))
        with run_context(store, jobs, progress) as context:
            solved = _solved(config, context)
            return replace(solved, results=save_report(store, solved.results))


def _solved(config: Config, context: RunContext) -> stages.SolvedRun:
    """The stages of a run. One waits for what it needs; tasks of later ones are done meanwhile."""
    state = stages.mesh(config, context)
    if config.is_law_alone:
        pictures = context.workers.beside(draw_all, state.scene.body, Outcomes({}), context)
        state, arm = stages.deliver_law(state)
        _draw(state, pictures)
        return stages.conclude(state, Identified(Outcomes({}), ()), arm, (), Validated())
    begin_second = cache(partial(begin_II, state.scene, context))
    state, arm = stages.deliver_law(state, begin_second)
    state, outcomes, law = stages.solve_experiments(state, arm, begin_second())
    state, identified, improved = stages.identify(state, outcomes, arm)
    loads = stages.begin_validation(state, outcomes)
    pictures = context.workers.beside(draw_all, state.scene.body, identified.outcomes, context)
    state, arm, on_mesh = stages.complete_law(state, arm, law)
    state, identified = stages.add_mesh_error(state, identified, improved, arm, on_mesh)
    state, rods, comparisons = stages.compare_rods(state, identified, on_mesh)
    state, validated = stages.validate(state, loads, rods, comparisons)
    _draw(state, pictures)
    return stages.conclude(state, identified, arm, comparisons, validated)


def _draw(state: stages.RunState, pictures: Pending[None]) -> None:
    """Wait for the pictures of the body and its states."""
    with state.stages.timed("pictures"):
        pictures.result()
