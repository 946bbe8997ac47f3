"""The discretisation for a requested accuracy, and the errors that are estimated before and after the run.

The errors of κ₀(l/2), α₂ and F count. `pipeline.accuracy.planning` makes the plan from two pilots. After the run the
errors are estimated again, from the largest indicator of its states: the larger of what the pilots alone and the pilots
with the run as a third mesh give.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from pipeline.accuracy.error_model import MeshErrorModel, SolvedMesh
from pipeline.accuracy.measure import numbers_of
from pipeline.accuracy.reference import NUMBERS
from pipeline.accuracy.result import HEADLINE
from pipeline.accuracy.sizes import Choice, Sizes
from pipeline.config.config import Config, MeshSettings, Newton
from pipeline.config.kinds import MOST_ACCURACY
from pipeline.errors import InputError
from pipeline.identification.parameters import Parameters
from pipeline.simulation.outcome import Indicator, Outcomes
from pipeline.store.json_values import JsonObject

#: angle (rad) by which an arm turns at the pressure of the pilots, below which errors are larger than estimated: of an
#: arm that turned by 0.003 rad, estimated at 7.8 %, kappa_0 still changed by more than 5 % on the next finer meshes
SMALLEST_TURN = 0.03
#: estimated error above which the pilots are too coarse for the model: it is linear in the error
RELIABLE = 0.5
#: most of a size that a next, smaller one has, to be suggested
SMALLER = 0.95


@dataclass(frozen=True)
class Estimate:
    """Estimated relative errors."""

    estimated: Mapping[str, float]  #: error of the mesh by the names of `HEADLINE`, the largest over the pressures
    estimated_of_contact: float
    identification: float  #: largest relative standard deviation of α₂ without the mesh

    @property
    def largest(self) -> float:
        """The largest error, contact included."""
        return max(self.estimated.values()) + self.estimated_of_contact

    def __str__(self) -> str:
        parts = ", ".join(f"{100 * error:.1f} % in {NUMBERS[name]}" for name, error in self.estimated.items())
        contact = f", plus {100 * self.estimated_of_contact:.1f} % from contact" if self.estimated_of_contact else ""
        return parts + contact


@dataclass(frozen=True)
class Review(Estimate):
    """The errors as estimated from the states of the run."""

    indicator: Indicator  #: of the state in which it is largest


@dataclass(frozen=True)
class Plan:
    """The discretisation for a requested accuracy; errors are relative."""

    size_was_given: bool
    replaced: tuple[str, ...]  #: what the configuration gives for elements and grading and is not used
    formulation: str
    grading: str
    newton_tolerance: float
    newton_given: float | None  #: tolerance of the configuration; None where it is the usual one
    sizes: Sizes
    choice: Choice
    pilots_kPa: float
    turn_rad: float  #: |kappa_0(l/2)| times the length on the finer pilot

    @property
    def requested(self) -> float:
        """The requested relative error."""
        return self.choice.accuracy

    @property
    def size_mm(self) -> float:
        """Of the mesh of the run."""
        return self.choice.size_mm

    @property
    def estimated_of_contact(self) -> float:
        """The error due to the activation distance, as estimated before the run."""
        return self.choice.estimated_of_contact

    @property
    def error_model(self) -> MeshErrorModel:
        """How errors fall with the mesh, from the pilots alone."""
        return self.sizes.model

    @property
    def estimate(self) -> Estimate:
        """The errors as estimated before the run."""
        fine = self.sizes.pilots[1].solved
        identification = fine.alpha2_std_N_mm2 / fine.numbers.alpha2_N_mm2
        return Estimate(self.error_model.at(self.size_mm), self.estimated_of_contact, identification)

    def applied(self, config: Config) -> Config:
        """The configuration with this discretisation."""
        mesh = MeshSettings(self.size_mm, self.formulation, config.mesh.coarser, self.grading)
        config = replace(config, mesh=mesh, newton=Newton(self.newton_tolerance))
        return config.with_contact_distance(self.choice.contact_dhat_mm)

    def is_reached(self, review: Review | None) -> bool:
        """Whether the errors are estimated to be within the request, and the estimate is reliable."""
        present = review or self.estimate
        return present.largest <= self.requested and not self._doubt(present)

    def record(self, review: Review | None) -> JsonObject:
        """The part of run.json about it."""
        before, finer = self.estimate, self._finer(review)
        return {
            "requested": self.requested,
            "is_reached": self.is_reached(review),
            "size_mm": self.size_mm,
            "size_was_given": self.size_was_given,
            "replaced": self.replaced,
            "formulation": self.formulation,
            "grading": self.grading,
            "newton_tolerance": self.newton_tolerance,
            "contact_dhat_mm": self.choice.contact_dhat_mm,
            "pilots": [
                {
                    "size_mm": pilot.size_mm,
                    "degrees_of_freedom": pilot.degrees_of_freedom,
                    "cpu_seconds": pilot.cpu_seconds,
                    **asdict(pilot.solved),
                }
                for pilot in self.sizes.pilots
            ],
            "pilots_kPa": self.pilots_kPa,
            "turn_rad": self.turn_rad,
            "order": self.error_model.order,
            "choices": [
                {**asdict(choice), "is_reached": choice.is_reached} for choice in self.sizes.compared(self.requested)
            ],
            "estimated": before.estimated,
            "estimated_of_contact": before.estimated_of_contact,
            "estimated_error": before.largest,
            "identification": before.identification,
            "after": {**asdict(review), "estimated_error": review.largest} if review else None,
            "finer": None if finer is None else asdict(finer),
            "sentence": self.sentence(review),
        }

    def sentence(self, review: Review | None) -> str:
        """Requested accuracy, discretisation and estimated errors, for the terminal and the report."""
        given = " (mesh.size was given and is kept)" if self.size_was_given else ""
        if self.replaced:
            given += f" (instead of {' and '.join(self.replaced)}: the estimates hold for these elements alone)"
        graded = "of one size" if self.grading == "off" else f"graded to {self.grading}"
        sentences = [
            f"requested accuracy {100 * self.requested:g} %: element {self.formulation}, {graded}, "
            f"mesh size {self.size_mm:.3g} mm{given}",
            *self._tolerance(),
            f"errors estimated before the run: {self.estimate}",
        ]
        if review:
            sentences.append(
                f"errors estimated from the error indicator of the run: {review} (the indicator is largest "
                f"{review.indicator.location()})"
            )
        present = review or self.estimate
        doubt = self._doubt(present)
        reached = (
            "is not reached" if present.largest > self.requested else "may not be reached" if doubt else "is reached"
        )
        sentences += [f"the requested accuracy {reached}", *([doubt] if doubt else [])]
        if present.identification > self.requested:
            sentences.append(
                f"the identification of α₂ alone is uncertain by ± {100 * present.identification:.2g} %, on every mesh"
            )
        return "; ".join(sentences)

    def announcement(self, config: Config) -> str:
        """What the run will take and what other accuracies would, in one sentence before it begins."""
        own = f"mesh size {self.size_mm:.3g} mm, {self.choice.cost(config)}"
        if config.law == "both":
            own += ", the arm's own law several times as much"
        doubt = self._doubt(self.estimate)
        less = "" if self.choice.is_reached else ", which is more than requested"
        return (
            f"accuracy {100 * self.requested:g} %: {own} with one worker process; estimated errors: "
            f"{self.estimate}{less}{f'; {doubt}' if doubt else ''}; {self._table(config)}"
        )

    def check(self, config: Config) -> None:
        """Raise InputError where the size was to be chosen and none reaches the request."""
        if self.size_was_given or self.choice.is_reached:
            return
        best = self.sizes.best_accuracy
        ask = (
            f"request {100 * best:.3g} % or more"
            if best <= MOST_ACCURACY
            else f"not even {100 * MOST_ACCURACY:g} % can be reached; leave accuracy out"
        )
        doubt = self._doubt(self.estimate)
        raise InputError(
            f"{config.source}: accuracy: {100 * self.requested:g} % cannot be reached: with {self.size_mm:.3g} mm, the "
            f"smallest size that is tried, the estimated errors are {self.estimate}{f' ({doubt})' if doubt else ''}; "
            f"{ask}, or give mesh.size, whose error is estimated then; {self._table(config)}"
        )

    def _table(self, config: Config) -> str:
        """Accuracies and what they take, in words."""
        rows = [
            f"{100 * choice.accuracy:g} %: {choice.size_mm:.3g} mm, {choice.cost(config)}"
            if choice.is_reached
            else f"{100 * choice.accuracy:g} %: not reached with any size that is tried"
            for choice in self.sizes.compared(self.requested)
        ]
        best = self.sizes.best_accuracy
        if best <= MOST_ACCURACY:
            finest = self.sizes.choice(best)
            rows.append(f"{100 * best:.3g} %, the least: {finest.size_mm:.3g} mm, {finest.cost(config)}")
        return f"sizes and cost by accuracy: {'; '.join(rows)}"

    def _tolerance(self) -> list[str]:
        """A clause on Newton's tolerance where the configuration gives one."""
        given = self.newton_given
        if given is None:
            return []
        kept = "as given" if given <= self.newton_tolerance else f"instead of {given:g}"
        return [f"newton.tolerance {self.newton_tolerance:g}, {kept}"]

    def _doubt(self, present: Estimate) -> str:
        """Why an estimate is not reliable; empty where it is."""
        doubts = []
        if self.turn_rad < SMALLEST_TURN:
            doubts.append(
                f"the arm hardly bends (at {self.pilots_kPa:g} kPa its curvature adds up to {self.turn_rad:.1g} rad "
                "over the length), so that the estimate is not reliable; give higher pressures or thinner walls"
            )
        if present.largest > RELIABLE:
            doubts.append(
                f"errors above {100 * RELIABLE:g} % are not estimated reliably, because the pilots are too coarse for "
                "this arm"
            )
        return "; ".join(doubts)

    def _finer(self, review: Review | None) -> Choice | None:
        """The size that would reach the request after all; None where it is reached, or where no smaller size would."""
        if review is None or review.largest <= self.requested:
            return None
        allowed = (self.requested - review.estimated_of_contact) / max(review.estimated.values())
        if allowed <= 0.0:
            return None
        own = self.error_model.at(self.size_mm)
        size = self.error_model.size_for(allowed * max(own.values()))
        size = float(f"{size:.2g}")
        if not self.sizes.smallest_mm <= size <= SMALLER * self.size_mm:
            return None
        return self.sizes.with_size(size, self.requested)


def review(
    plan: Plan, outcomes: Outcomes, parameters: Sequence[Parameters], indicator: Indicator | None
) -> Review | None:
    """The errors as estimated from the states of a run; None where there are none.

    A contact that never acted has no error.
    """
    if indicator is None:
        return None
    touched = any("self_contact" in record.effects for record in outcomes.records)
    rigidities = [at_pressure.numbers_without_mesh["alpha2"] for at_pressure in parameters]
    models = [plan.error_model]
    models += [
        MeshErrorModel.fit(*plan.sizes.pilots, SolvedMesh.of(numbers_of(at_pressure)))
        for at_pressure in parameters
        if at_pressure.pressure_kPa == plan.pilots_kPa
    ]
    estimates = [model.with_indicator(indicator.stress_error) for model in models]
    return Review(
        estimated={name: max(estimate[name] for estimate in estimates) for name in HEADLINE},
        estimated_of_contact=plan.estimated_of_contact if touched else 0.0,
        identification=max((alpha2.std / alpha2.value for alpha2 in rigidities), default=plan.estimate.identification),
        indicator=indicator,
    )
