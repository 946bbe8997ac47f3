"""The discretisation for a requested accuracy, and the errors that are estimated before and after the run.

The errors of κ₀(l/2), α₂ and F count. `pipeline.accuracy.planning` makes the plan from two pilots. After the run the
errors are estimated again, from the largest indicator of its states: the larger of what the pilots alone and the pilots
with the run as a third mesh give.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from pipeline.accuracy.error_model import MeshErrorModel
from pipeline.accuracy.measure import HEADLINE, numbers_of
from pipeline.accuracy.reference import NUMBERS
from pipeline.accuracy.sizes import Choice, Sizes
from pipeline.config.config import Config, MeshSettings, Newton
from pipeline.config.kinds import MOST_ACCURACY
from pipeline.errors import InputError
from pipeline.identification.parameters import Parameters
from pipeline.results.record import Indicator
from pipeline.simulation.outcome import Outcomes
from pipeline.store.json_values import JsonObject
from rod.same_pressure import is_same

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
    indicator: Indicator | None = None  #: of the state of the run in which it is largest; None before the run

    @property
    def largest(self) -> float:
        """The largest error, contact included."""
        return max(self.estimated.values()) + self.estimated_of_contact

    def __str__(self) -> str:
        parts = ", ".join(f"{100 * error:.1f} % in {NUMBERS[name]}" for name, error in self.estimated.items())
        contact = f", plus {100 * self.estimated_of_contact:.1f} % from contact" if self.estimated_of_contact else ""
        return parts + contact


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
    def estimate(self) -> Estimate:
        """The errors as estimated before the run."""
        errors = self.sizes.model.at(self.choice.size_mm)
        return Estimate(errors, self.choice.estimated_of_contact, self.sizes.pilots[1].numbers.alpha2_relative_std)

    def applied(self, config: Config) -> Config:
        """The configuration with this discretisation."""
        mesh = MeshSettings(self.choice.size_mm, self.formulation, config.mesh.coarser, self.grading)
        config = replace(config, mesh=mesh, newton=Newton(self.newton_tolerance))
        return config.with_contact_distance(self.choice.contact_dhat_mm)

    def is_reached(self, review: Estimate | None) -> bool:
        """Whether the errors are estimated to be within the request, and the estimate is reliable."""
        present = review or self.estimate
        return present.largest <= self.requested and not self._doubts(present)

    def record(self, review: Estimate | None) -> JsonObject:
        """The part of run.json about it."""
        before, finer = self.estimate, self._finer(review)
        return {
            "requested": self.requested,
            "is_reached": self.is_reached(review),
            "size_mm": self.choice.size_mm,
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
                    "numbers": pilot.numbers.headline,
                    "alpha2_std_N_mm2": pilot.numbers.alpha2_std_N_mm2,
                    "two_lines": pilot.numbers.has_two_lines,
                    "stress_error": pilot.numbers.stress_error,
                }
                for pilot in self.sizes.pilots
            ],
            "pilots_kPa": self.pilots_kPa,
            "turn_rad": self.turn_rad,
            "order": self.sizes.model.order,
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

    def sentence(self, review: Estimate | None) -> str:
        """Requested accuracy, discretisation and estimated errors, for the terminal and the report."""
        kept = " (given)" if self.size_was_given else ""
        instead = f" instead of {' and '.join(self.replaced)}" if self.replaced else ""
        graded = "of one size" if self.grading == "off" else f"graded to {self.grading}"
        present = review or self.estimate
        doubts = self._doubts(present)
        reached = "may not be reached" if doubts else "is reached"
        parts = [
            f"requested accuracy {100 * self.requested:g} %: element {self.formulation}, {graded}{instead}, mesh size "
            f"{self.choice.size_mm:.3g} mm{kept}"
        ]
        if self.newton_given is not None:
            parts.append(f"newton.tolerance {self.newton_tolerance:g} (given: {self.newton_given:g})")
        parts.append(f"errors estimated before the run: {self.estimate}")
        if review and review.indicator:
            parts.append(f"after it: {review} (the error indicator is largest {review.indicator.location})")
        parts += [
            f"the requested accuracy {'is not reached' if present.largest > self.requested else reached}",
            *doubts,
        ]
        if present.identification > self.requested:
            parts.append(f"the identification of α₂ is uncertain by ± {100 * present.identification:.2g} % on any mesh")
        return "; ".join(parts)

    def announcement(self, config: Config) -> str:
        """What the run will take and what other accuracies would, in one sentence before it begins."""
        return f"{self.sentence(None)}; {self._table(config)}"

    def check(self, config: Config) -> None:
        """Raise InputError where the size was to be chosen and none reaches the request."""
        if self.size_was_given or self.choice.is_reached:
            return
        best = self.sizes.best_accuracy
        ask = f"request {100 * best:.3g} % or more" if best <= MOST_ACCURACY else "leave accuracy out"
        raise InputError(
            f"{config.source}: accuracy: {100 * self.requested:g} % cannot be reached: {self.choice.size_mm:.3g} mm is "
            f"the smallest size that is tried; {ask}, or give mesh.size; {self.announcement(config)}"
        )

    def _table(self, config: Config) -> str:
        """Accuracies and what they take, in words."""
        best = self.sizes.best_accuracy
        finest = [self.sizes.choice(best)] if best <= MOST_ACCURACY else []
        rows = [
            f"{100 * choice.accuracy:.3g} %: {choice.size_mm:.3g} mm, {choice.cost(config)}"
            if choice.is_reached
            else f"{100 * choice.accuracy:.3g} %: not reached"
            for choice in (*self.sizes.compared(self.requested), *finest)
        ]
        law = "; the arm's own law several times as much" if config.law == "both" else ""
        least = " (the least)" if finest else ""
        return f"sizes and cost by accuracy, with one worker process: {'; '.join(rows)}{least}{law}"

    def _doubts(self, present: Estimate) -> list[str]:
        """Why an estimate is not reliable; empty where it is."""
        doubts = []
        if self.turn_rad < SMALLEST_TURN:
            doubts.append(
                f"the arm hardly bends ({self.turn_rad:.1g} rad at {self.pilots_kPa:g} kPa), so the estimate is not "
                "reliable; give higher pressures or thinner walls"
            )
        if present.largest > RELIABLE:
            doubts.append(f"errors above {100 * RELIABLE:g} % are not estimated reliably")
        return doubts

    def _finer(self, review: Estimate | None) -> Choice | None:
        """The size that would reach the request after all; None where it is reached, or where no smaller size would."""
        if review is None or review.largest <= self.requested:
            return None
        allowed = (self.requested - review.estimated_of_contact) / max(review.estimated.values())
        if allowed <= 0.0:
            return None
        model = self.sizes.model
        size = float(f"{model.size_for(allowed * max(model.at(self.choice.size_mm).values())):.2g}")
        if not self.sizes.smallest_mm <= size <= SMALLER * self.choice.size_mm:
            return None
        return self.sizes.with_size(size, self.requested)


def review(
    plan: Plan, outcomes: Outcomes, parameters: Sequence[Parameters], indicator: Indicator | None
) -> Estimate | None:
    """The errors as estimated from the states of a run; None where there are none.

    A contact that never acted has no error.
    """
    if indicator is None:
        return None
    touched = any("self_contact" in record.effects for record in outcomes.records)
    rigidities = [at_pressure.numbers_without_mesh["alpha2"] for at_pressure in parameters]
    models = [plan.sizes.model]
    models += [
        MeshErrorModel.fit(*plan.sizes.pilots, numbers_of(at_pressure))
        for at_pressure in parameters
        if is_same(at_pressure.pressure_kPa, plan.pilots_kPa)
    ]
    estimates = [model.with_indicator(indicator.stress_error) for model in models]
    return Estimate(
        estimated={name: max(estimate[name] for estimate in estimates) for name in HEADLINE},
        estimated_of_contact=plan.choice.estimated_of_contact if touched else 0.0,
        identification=max((alpha2.std / alpha2.value for alpha2 in rigidities), default=plan.estimate.identification),
        indicator=indicator,
    )
