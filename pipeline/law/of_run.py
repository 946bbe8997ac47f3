"""The arm's own law as a part of a run: made where the arm and its effects have one, else the reason why not.

A run has two laws. The one that it delivers comes from pieces on the mesh that the requested accuracy needs. The other
comes from pieces on the mesh of the whole arm: the difference between its rod and the whole arm is the error of the
rod's theory alone.
"""

from collections.abc import Callable
from dataclasses import dataclass

from geometry import Reason, Values
from pipeline.law.build import MeasuredLaw, build_law, deliver_law
from pipeline.law.piece.pieces import ArmPieces, NoArmLaw
from pipeline.law.study import check_plane
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.store.context import RunContext
from pipeline.store.parallel import Pending
from pipeline.values.errors import InputError, RunFailed, WorkerLost
from pipeline.values.reasons import render_all
from pipeline.values.run import Effect
from rod import ArmLaw


@dataclass(frozen=True)
class LawOfRun:
    """The law of a run, or why there is none."""

    measured: MeasuredLaw | None
    reasons: tuple[Reason, ...]  #: how it was made and where it ends, or why it was not made
    failures: tuple[Reason, ...] = ()  #: what a run with `law: cell` was to make and did not

    def remarks(self, outcomes: Outcomes) -> tuple[Reason, ...]:
        """A remark where the law goes to pressures that the whole arm has not borne in an experiment."""
        ended = outcomes.first_to_end
        if self.law is None or ended is None or self.law.pressures[-1] <= ended[1]:
            return ()
        values: Values = {"highest_kPa": self.law.pressures[-1], "experiment": ended[0], "end_kPa": ended[1]}
        return (Reason("law_beyond_end", values),)

    @property
    def law(self) -> ArmLaw | None:
        """None where there is none."""
        return None if self.measured is None else self.measured.law

    @property
    def effect(self) -> Effect:
        """The row of effects.json."""
        return Effect("arm_law", "off" if self.measured is None else "on", render_all(self.reasons), None)


def deliver_law_of_run(
    scene: Scene, context: RunContext, begin_others: Callable[[], object] = lambda: None
) -> LawOfRun:
    """The law that the configuration requests, on the mesh that its accuracy needs; waits until it is measured.

    With `law: both` an arm without one keeps its five parameters. begin_others: as for `deliver_law`.
    """
    return _begin(scene, context, lambda pieces: deliver_law(pieces, context, begin_others)).result()


def law_on_mesh_of_arm(scene: Scene, context: RunContext, highest_kPa: Callable[[], float]) -> Pending[LawOfRun]:
    """The law from pieces on the mesh of the whole arm, at the pressures at which it is compared with experiments.

    highest_kPa: gives the pressure that the law need not exceed, as soon as that is known.

    Its tasks are done beside those that are submitted later. Whatever Gmsh has to look at in this process is looked at
    before this function returns, because Gmsh takes the process's output and signals.
    """
    pressures = sorted({*scene.config.pressures_kPa, *scene.config.validation.pressures_kPa})
    return _begin(scene, context, lambda pieces: build_law(pieces, pressures, context, highest_kPa, between=False))


def _begin(scene: Scene, context: RunContext, build: Callable[[ArmPieces], MeasuredLaw]) -> Pending[LawOfRun]:
    is_needed = scene.config.is_law_alone
    if scene.config.law == "five":
        return Pending.done(LawOfRun(None, (Reason("law_not_wanted"),)))
    try:
        pieces = ArmPieces.of(scene)
        pieces.repetition  # noqa: B018 - meshed here, or refused
    except (NoArmLaw, InputError) as refusal:
        return Pending.done(_refused(is_needed, refusal))
    return context.workers.beside(_measured, is_needed, pieces, build)


def _refused(is_needed: bool, why: Exception) -> LawOfRun:
    because = {"why": str(why).rstrip(".")}
    failures = (Reason("no_arm_law", because),) if is_needed else ()
    return LawOfRun(None, (Reason("law_not_possible", because),), failures)


def _measured(is_needed: bool, pieces: ArmPieces, build: Callable[[ArmPieces], MeasuredLaw]) -> LawOfRun:
    try:
        check_plane(pieces)
        measured = build(pieces)
    except WorkerLost:
        raise
    except (NoArmLaw, InputError, RunFailed) as failure:
        return _refused(is_needed, failure)
    lowest, *_, highest = measured.law.pressures
    made = Reason("law_measured", {"lowest_kPa": lowest, "highest_kPa": highest})
    reasons = (made, *measured.failures, *measured.limits)
    return LawOfRun(measured, reasons, measured.failures if is_needed else ())
