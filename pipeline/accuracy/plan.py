"""Mesh, tolerance and contact distance for a requested accuracy, and the error that is estimated to remain.

The errors of κ₀(l/2), α₂ and F count. Before the run the error of the mesh is estimated from two pilots, II and III at
the lowest pressure of the run on two coarse meshes, and from their error indicators (`pipeline.accuracy.error_model`).
After the run it is estimated again, from the largest indicator of its states: the larger of what the pilots alone and
the pilots with the run as a third mesh give. The error of contact follows from its activation distance with a ratio
measured in docs/accuracy.md.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import floor
from typing import Any

import fem
from fem.elements import MOST_ACCURATE
from pipeline.accuracy.error_model import MeshErrorModel, Pilot, SolvedMesh
from pipeline.accuracy.ladder import Rung, mesh_series
from pipeline.accuracy.measure import measure, numbers_of
from pipeline.accuracy.reference import NUMBERS
from pipeline.accuracy.result import HEADLINE, Headline
from pipeline.config.config import AUTO, Config, MeshSettings, Newton
from pipeline.errors import RunFailed
from pipeline.identification.parameters import Parameters
from pipeline.progress import Progress
from pipeline.simulation.outcome import Indicator, Outcomes
from pipeline.simulation.scene import Scene
from pipeline.store.json_values import JsonObject
from pipeline.store.store import Store

#: element and grading that reach an accuracy with the fewest degrees of freedom
FORMULATION, GRADING = MOST_ACCURATE, "walls"
#: sizes of the pilots over the smallest side of the body
PILOTS = (0.4, 0.27)
#: fraction of the requested error that contact may have, and fraction of the rest that the mesh is planned for
CONTACT_FRACTION, MESH_FRACTION = 0.4, 0.8
#: relative error per activation distance over the gap: the largest measured, that of F on the gapped pneu-net arm
ERROR_PER_DISTANCE = 0.7
#: smallest activation distance over the gap: half of it takes three times the factorizations, because walls enter and
#: leave so thin a barrier between Newton iterations
MIN_DISTANCE = 0.01
#: Newton's tolerance over the requested error
NEWTON_FRACTION = 1e-3
#: smallest mesh size over that of the finer pilot
FINEST = 0.35


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

    requested: float
    size_mm: float
    size_was_given: bool
    replaced: tuple[str, ...]  #: what the configuration gives for elements and grading and is not used
    formulation: str
    grading: str
    newton_tolerance: float
    contact_dhat_mm: float | None  #: None where no faces can meet
    pilots: tuple[Pilot, Pilot]  #: the coarser first
    pilots_kPa: float
    estimated_of_contact: float

    @property
    def error_model(self) -> MeshErrorModel:
        """How errors fall with the mesh, from the pilots alone."""
        return MeshErrorModel.fit(*self.pilots)

    @property
    def estimate(self) -> Estimate:
        """The errors as estimated before the run."""
        fine = self.pilots[1].solved
        identification = fine.alpha2_std_N_mm2 / fine.numbers.alpha2_N_mm2
        return Estimate(self.error_model.at(self.size_mm), self.estimated_of_contact, identification)

    def applied(self, config: Config) -> Config:
        """The configuration with this discretisation."""
        mesh = MeshSettings(self.size_mm, self.formulation, config.mesh.coarser, self.grading)
        config = replace(config, mesh=mesh, newton=Newton(self.newton_tolerance))
        return config.with_contact_distance(self.contact_dhat_mm)

    def inputs(self) -> JsonObject:
        """Everything that is decided before the run, as JSON."""
        pilots = [
            {
                "size_mm": pilot.size_mm,
                "degrees_of_freedom": pilot.degrees_of_freedom,
                "cpu_seconds": pilot.cpu_seconds,
                **asdict(pilot.solved),
            }
            for pilot in self.pilots
        ]
        return {**{name: getattr(self, name) for name in Plan.__dataclass_fields__}, "pilots": pilots}

    @staticmethod
    def read(inputs: Mapping[str, Any]) -> "Plan":
        """From what `inputs` wrote."""
        coarse, fine = (
            Pilot(
                pilot["size_mm"],
                pilot["degrees_of_freedom"],
                pilot["cpu_seconds"],
                SolvedMesh(Headline(**pilot["numbers"]), pilot["alpha2_std_N_mm2"], pilot["stress_error"]),
            )
            for pilot in inputs["pilots"]
        )
        return Plan(**{**inputs, "replaced": tuple(inputs["replaced"]), "pilots": (coarse, fine)})

    def record(self, review: Review | None) -> JsonObject:
        """The part of run.json about it."""
        before = self.estimate
        return {
            **self.inputs(),
            "order": self.error_model.order,
            "estimated": before.estimated,
            "estimated_error": before.largest,
            "identification": before.identification,
            "after": {**asdict(review), "estimated_error": review.largest} if review else None,
            "sentence": self.sentence(review),
        }

    def sentence(self, review: Review | None) -> str:
        """Requested accuracy, discretisation and estimated errors, for the terminal and the report."""
        given = " (mesh.size was given and is kept)" if self.size_was_given else ""
        if self.replaced:
            given += f" (instead of {' and '.join(self.replaced)}: the estimates hold for these elements alone)"
        sentences = [
            f"requested accuracy {100 * self.requested:g} %: element {self.formulation}, graded to {self.grading}, "
            f"mesh size {self.size_mm:.3g} mm{given}",
            f"errors estimated before the run: {self.estimate}",
        ]
        if review:
            sentences.append(
                f"errors estimated from the error indicator of the run: {review} (the indicator is largest "
                f"{review.indicator.location()})"
            )
        present = review or self.estimate
        reached = "is reached" if present.largest <= self.requested else "is not reached"
        sentences.append(f"the requested accuracy {reached}")
        if present.identification > self.requested:
            sentences.append(
                f"the identification of α₂ alone is uncertain by ± {100 * present.identification:.2g} %, on every mesh"
            )
        return "; ".join(sentences)


def plan_discretisation(config: Config, store: Store, progress: Progress) -> tuple[Config, Plan | None]:
    """The configuration with the discretisation for its accuracy, and the plan; unchanged where none is requested.

    A plan made earlier in the same folder is kept. Raises RunFailed where the pilots give no numbers.
    """
    if config.accuracy is None:
        return config, None
    kept = store.read_json("states/plan.json")
    if kept is not None and kept.pop("key") == store.numbers_key:
        plan = Plan.read(kept)
    else:
        progress.stage("pilots for the requested accuracy")
        plan = _plan(config, config.accuracy)
        store.save_json("states/plan.json", {"key": store.numbers_key, **plan.inputs()})
    return plan.applied(config), plan


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
        MeshErrorModel.fit(*plan.pilots, SolvedMesh.of(numbers_of(at_pressure)))
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


def _plan(config: Config, requested: float) -> Plan:
    replaced = config.mesh.given_unlike(formulation=FORMULATION, grading=GRADING)
    elements = replace(config.mesh, formulation=FORMULATION, grading=GRADING)
    config = replace(config, mesh=elements, pressures_kPa=config.pressures_kPa[:1])
    smallest_side = min(config.design.extent)
    coarse, fine = (_pilot(config, fraction * smallest_side) for fraction in PILOTS)
    given = config.mesh.size_mm
    sized = config.with_mesh_size(coarse.size_mm) if given is AUTO else config
    distance, of_contact = _contact(sized, CONTACT_FRACTION * requested)
    of_mesh = max(requested - of_contact, (1.0 - CONTACT_FRACTION) * requested)  # a given distance may exceed its part
    size = MeshErrorModel.fit(coarse, fine).size_for(MESH_FRACTION * of_mesh)
    size = floor(100.0 * min(max(size, FINEST * fine.size_mm), coarse.size_mm)) / 100.0
    return Plan(
        requested=requested,
        size_mm=size if given is AUTO else config.mesh.element_size_mm,
        size_was_given=given is not AUTO,
        replaced=replaced,
        formulation=FORMULATION,
        grading=GRADING,
        newton_tolerance=min(1e-4, NEWTON_FRACTION * requested),
        contact_dhat_mm=distance,
        pilots=(coarse, fine),
        pilots_kPa=config.pressures_kPa[0],
        estimated_of_contact=of_contact,
    )


def _pilot(config: Config, size: float) -> Pilot:
    """II and III at the lowest pressure of the run on a coarse mesh."""
    config = config.with_mesh_size(size)
    result = measure(Rung(mesh_series(config), size, config))
    if result.cost is None or not result.numbers:
        raise RunFailed(f"the pilot with a mesh of {size:.3g} mm gave no numbers: {result.failure}; give mesh.size")
    solved = SolvedMesh.of(result.numbers[0])
    return Pilot(size, result.cost.degrees_of_freedom, result.cost.cpu_seconds, solved)


def _contact(config: Config, allowed: float) -> tuple[float | None, float]:
    """The activation distance (mm) with an error of `allowed` at most, unless one is given, and its relative error."""
    default = Scene.meshed(config.with_contact_distance(None)).activation_distance
    if default is None:
        return None, 0.0
    gap = default / fem.ACTIVATION
    distance = config.effects.self_contact.dhat_mm or min(
        default, gap * max(allowed / ERROR_PER_DISTANCE, MIN_DISTANCE)
    )
    return distance, ERROR_PER_DISTANCE * distance / gap
