"""The arm's own law as a part of a run: made where the arm and its effects have one, else a sentence why not."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from geometry import Reason, Values
from pipeline.cell.build import MeasuredLaw, build_law
from pipeline.cell.pieces import ArmPieces, NoArmLaw
from pipeline.cell.study import save_law
from pipeline.context import RunContext
from pipeline.errors import InputError, RunFailed, WorkerLost
from pipeline.parallel import Pending
from pipeline.results.values import Effect, Law
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.scene import Scene
from pipeline.store.store import Store
from rod import ArmLaw


@dataclass(frozen=True)
class LawOfRun:
    """The law of a run, or why there is none."""

    measured: MeasuredLaw | None
    reason: str  #: why it was made or not, one sentence without its full stop
    failures: tuple[Reason, ...]  #: what a run with `law: cell` was to make and did not
    not_borne: bool = False  #: whether a piece of the arm does not bear a pressure of the configuration

    def beside(self, outcomes: Outcomes) -> "LawOfRun":
        """The same law, whose reason names where the experiments on the whole arm have ended, if a piece did too.

        Nothing is measured anew.
        """
        ended = outcomes.first_to_end
        if ended is None or not self.not_borne:
            return self
        return replace(self, reason=f"{self.reason}; {_ends(*ended)}")

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

    def save(self, store: Store) -> Law | None:
        """Write law.json where there is a law, and return the part of it that the report reads."""
        return None if self.measured is None else save_law(store, self.measured)

    @property
    def effect(self) -> Effect:
        """The row of effects.json."""
        return Effect("arm_law", "off" if self.measured is None else "on", self.reason, None)


def law_of_run(scene: Scene, context: RunContext, highest_kPa: Callable[[], float] | None = None) -> Pending[LawOfRun]:
    """The law that the configuration requests; with `law: both` an arm without one keeps its five parameters.

    highest_kPa: gives the pressure that the law need not exceed, as soon as that is known.

    Its tasks are done beside those that are submitted later. Whatever Gmsh has to look at in this process is looked at
    before this function returns, because Gmsh takes the process's output and signals.
    """
    choice = scene.config.law
    if choice == "five":
        return Pending.done(LawOfRun(None, "switched off in the config", ()))
    try:
        pieces = ArmPieces.of(scene)
        pieces.repetition  # noqa: B018 - meshed here, or refused
    except (NoArmLaw, InputError) as refusal:
        return Pending.done(_none(choice, refusal))
    return context.workers.beside(_law, choice, pieces, context, highest_kPa)


def _none(choice: str, why: Exception) -> LawOfRun:
    reason = str(why).rstrip(".")
    failures = (Reason("no_arm_law", {"why": reason}),) if choice == "cell" else ()
    return LawOfRun(None, reason, failures, not_borne=isinstance(why, RunFailed))


def _ends(experiment: str, pressure_kPa: float) -> str:
    return f"experiment {experiment} of the whole arm ends at {pressure_kPa:.4g} kPa"


def _law(choice: str, pieces: ArmPieces, context: RunContext, highest_kPa: Callable[[], float] | None) -> LawOfRun:
    try:
        measured = build_law(pieces, context, highest_kPa)
    except WorkerLost:
        raise
    except (NoArmLaw, InputError, RunFailed) as failure:
        return _none(choice, failure)
    law = measured.law
    between = "between pressures the curvature is interpolated"
    if measured.error_between is None:
        between += ", which could not be checked"
    else:
        between += f" to {100 * measured.error_between:.2g} % of the largest one"
    reason = (
        f"moment, stretch and rigidities of one cell from {law.pressures[0]:g} to {law.pressures[-1]:g} kPa, "
        f"and of both ends; nothing is fitted to the arm as a whole; {between}"
    )
    remarks = "; ".join((*measured.failures, *measured.limits))
    incomplete = (Reason("law_incomplete", {"why": why}) for why in measured.failures)
    failures = tuple(incomplete) if choice == "cell" else ()
    not_borne = bool(measured.failures)
    return LawOfRun(measured, f"{reason}; {remarks}" if remarks else reason, failures, not_borne)
