"""The discretisation for a requested accuracy, and the errors that are estimated before and after the run.

The errors of κ₀(l/2), α₂ and F count. `pipeline.accuracy.planning` makes the plan from two pilots. After the run the
errors are estimated again, from the largest indicator of its states: the larger of what the pilots alone and the pilots
with the run as a third mesh give.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from geometry import Reason, Values
from pipeline.accuracy.error_model import Choice, MeshErrorModel, Pilot, Sizes
from pipeline.accuracy.measure import HEADLINE, numbers_of
from pipeline.config.config import Config, MeshSettings, Newton
from pipeline.config.kinds import MOST_ACCURACY
from pipeline.errors import InputError
from pipeline.identification.parameters import Parameters
from pipeline.notes import render_all
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

    @property
    def remark(self) -> Reason:
        """The errors."""
        percent = {name: 100.0 * error for name, error in self.estimated.items()}
        values = percent | {"contact": 100.0 * self.estimated_of_contact}
        return Reason("accuracy_estimated", values | {"when": "after" if self.indicator else "before"})


@dataclass(frozen=True)
class Plan:
    """The discretisation for a requested accuracy; errors are relative."""

    size_was_given: bool
    replaced: tuple[str, ...]  #: what the configuration gives for elements and grading and is not used
    formulation: str
    grading: str
    newton_tolerance: float
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
        own = ("size_was_given", "replaced", "formulation", "grading", "newton_tolerance", "pilots_kPa", "turn_rad")
        return {
            "requested": self.requested,
            "is_reached": self.is_reached(review),
            "size_mm": self.choice.size_mm,
            "contact_dhat_mm": self.choice.contact_dhat_mm,
            **{name: getattr(self, name) for name in own},
            "pilots": [_pilot_record(pilot) for pilot in self.sizes.pilots],
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
            "sentence": render_all(self.remarks(review)),
        }

    def remarks(self, review: Estimate | None) -> tuple[Reason, ...]:
        """Requested accuracy, discretisation and estimated errors."""
        values: Values = {
            "percent": 100.0 * self.requested,
            "formulation": self.formulation,
            "size_mm": self.choice.size_mm,
        }
        made = [Reason("accuracy_planned", values), self.estimate.remark]
        if self.replaced:
            made.append(Reason("accuracy_replaces", {"given": list(self.replaced)}))
        if review:
            made.append(review.remark)
        return (*made, *self.shortfalls(review))

    def shortfalls(self, review: Estimate | None) -> tuple[Reason, ...]:
        """Why the request is not reached, or may not be."""
        present = review or self.estimate
        large, uncertain = (100.0 * error for error in (present.largest, present.identification))
        missed = [Reason("accuracy_missed", {"percent": large})] if present.largest > self.requested else []
        if present.identification > self.requested:
            missed.append(Reason("accuracy_identified", {"percent": uncertain}))
        return (*missed, *self._doubts(present))

    def costs(self, config: Config) -> tuple[Reason, ...]:
        """What this accuracy, others and the smallest one take, with one worker process."""
        best, per_pair = self.sizes.best_accuracy, len(config.pressures_kPa) * len(config.experiments) / 2
        finest = [self.sizes.choice(best)] if best <= MOST_ACCURACY else []
        choices = [choice for choice in (*self.sizes.compared(self.requested), *finest) if choice.is_reached]
        return tuple(
            Reason(
                "accuracy_costs",
                {
                    "percent": 100.0 * choice.accuracy,
                    "size_mm": choice.size_mm,
                    "unknowns": choice.degrees_of_freedom,
                    "seconds": choice.cpu_seconds * per_pair,
                },
            )
            for choice in choices
        )

    def check(self, config: Config) -> None:
        """Raise InputError where the size was to be chosen and none reaches the request."""
        if self.size_was_given or self.choice.is_reached:
            return
        best = self.sizes.best_accuracy
        ask = f"request {100 * best:.3g} % or more" if best <= MOST_ACCURACY else "leave accuracy out"
        raise InputError(
            f"{config.source}: accuracy: {100 * self.requested:g} % cannot be reached: {self.choice.size_mm:.3g} mm is "
            f"the smallest size that is tried; {ask}, or give mesh.size"
        )

    def _doubts(self, present: Estimate) -> tuple[Reason, ...]:
        """Why an estimate is not reliable; empty where it is."""
        values = {"turn_rad": self.turn_rad, "pressure_kPa": self.pilots_kPa}
        bends_little = [Reason("accuracy_hardly_bent", values)] if self.turn_rad < SMALLEST_TURN else []
        is_large = [Reason("accuracy_unreliable")] if present.largest > RELIABLE else []
        return (*bends_little, *is_large)

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


def _pilot_record(pilot: Pilot) -> JsonObject:
    numbers = pilot.numbers
    return {
        "size_mm": pilot.size_mm,
        "degrees_of_freedom": pilot.degrees_of_freedom,
        "cpu_seconds": pilot.cpu_seconds,
        "numbers": {name: numbers.scalars[name] for name in HEADLINE},
        "alpha2_std_N_mm2": numbers.alpha2_std_N_mm2,
        "two_lines": numbers.has_two_lines,
        "stress_error": numbers.stress_error,
    }


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
