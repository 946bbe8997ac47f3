"""Mesh, tolerance and contact distance for an accuracy that is asked for, and the error that is believed to remain.

Errors of κ₀(l/2), α₂ and F count. What the mesh has wrong is told by two pilots, the same two experiments at the lowest
pressure of the run on two coarse meshes, and by their error indicators (`pipeline.accuracy.error_model`). After the run
it is told once more: by the largest indicator of its states, times what the pilots alone or with the run as a third
mesh say, whichever is more. What contact leaves is told by what the ladders of docs/accuracy.md measured.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import floor
from typing import Any

import fem
from pipeline.accuracy.error_model import RIGIDITY, MeshLaw
from pipeline.accuracy.ladder import Rung, mesh_choice
from pipeline.accuracy.measure import measure, numbers_of
from pipeline.accuracy.reference import HEADLINE, NUMBERS
from pipeline.config.config import Config
from pipeline.errors import RunFailed
from pipeline.identification.parameters import Parameters
from pipeline.progress import Progress
from pipeline.simulation.outcome import Indicator, Outcomes
from pipeline.simulation.scene import Scene
from pipeline.store.store import Store

#: elements and grading that reach an accuracy with the fewest degrees of freedom
FORMULATION, GRADING = "mixed", "walls"
#: sizes of the pilots over the smallest side of the body
PILOTS = (0.4, 0.27)
#: share of the asked error that contact may have, and the share of the rest that the mesh is to have before the run
OF_CONTACT, OF_MESH = 0.4, 0.8
#: error per activation distance over the gap: that of F on arm (a) at 17 kPa, the largest (0.56 to 0.7 over the meshes)
PER_DISTANCE = 0.7
#: the smallest activation distance over the gap that is chosen: half of it takes three times the factorizations, for
#: walls go in and out of so thin a barrier from one iteration to the next
CLOSEST = 0.01
#: Newton's tolerance is this share of the asked error
OF_NEWTON = 1e-3
#: the finest mesh that is chosen, over the finer pilot
FINEST = 0.35


@dataclass(frozen=True)
class Afterwards:
    """What the run itself says of its errors; errors are relative."""

    believed: Mapping[str, float]  #: error of the mesh by number, the largest over the pressures
    believed_of_contact: float
    identification: float  #: largest deviation of α₂ that does not come from the mesh
    indicator: Indicator  #: of the state in which it is largest


@dataclass(frozen=True)
class Choice:
    """What was chosen for an asked accuracy, and the error that was believed to remain; errors are relative."""

    asked: float
    size_mm: float
    size_was_given: bool
    formulation: str
    grading: str
    newton_tolerance: float
    contact_dhat_mm: float | None  #: None where no faces can meet
    #: size_mm, degrees_of_freedom, cpu_seconds, numbers, alpha2_std_N_mm2, stress_error
    pilots: Sequence[Mapping[str, Any]]
    pilots_kPa: float
    believed_of_contact: float

    @property
    def law(self) -> MeshLaw:
        """How errors fall with the mesh."""
        return MeshLaw.of(self.pilots)

    @property
    def believed(self) -> dict[str, float]:
        """Error of the mesh by number, before the run."""
        return self.law.at(self.size_mm)

    @property
    def identification(self) -> float:
        """Deviation of α₂ that does not come from the mesh, before the run."""
        fine = self.pilots[1]
        return float(fine["alpha2_std_N_mm2"] / fine["numbers"][RIGIDITY])

    def record(self, after: Afterwards | None) -> dict[str, Any]:
        """The part of run.json about it."""
        return {
            **asdict(self),
            "order": self.law.order,
            "believed": self.believed,
            "believed_error": largest_error(self),
            "identification": self.identification,
            "after": after and {**asdict(after), "believed_error": largest_error(after)},
            "sentence": self.sentence(after),
        }

    def sentence(self, after: Afterwards | None) -> str:
        """What was asked for, chosen and is believed, for the terminal and the report."""
        given = " (mesh.size is given and was kept)" if self.size_was_given else ""
        said = [
            f"asked for {100 * self.asked:g} %: {self.formulation}, graded to {self.grading}, "
            f"{self.size_mm:.3g} mm{given}",
            f"the mesh was believed before the run to leave {_parts(self)}",
        ]
        if after:
            said.append(
                f"by the error indicator of the run it leaves {_parts(after)} (the indicator is largest "
                f"{after.indicator.location()})"
            )
        now = after or self
        reached = "is kept" if largest_error(now) <= self.asked else "is not reached"
        said.append(f"the asked accuracy {reached}")
        if now.identification > self.asked:
            said.append(f"α₂ is known to ± {100 * now.identification:.2g} % from its identification, whatever the mesh")
        return "; ".join(said)


def largest_error(known: Choice | Afterwards) -> float:
    """The largest error that is believed to remain, contact included."""
    return max(known.believed.values()) + known.believed_of_contact


def _parts(known: Choice | Afterwards) -> str:
    parts = ", ".join(f"{100 * error:.1f} % in {NUMBERS[key]}" for key, error in known.believed.items())
    return parts + (f", {100 * known.believed_of_contact:.1f} % more from contact" if known.believed_of_contact else "")


def chosen(config: Config, store: Store, progress: Progress) -> tuple[Config, Choice | None]:
    """The configuration with what its accuracy asks for, and the choice; unchanged where none is asked for.

    A choice made earlier in the same folder is kept. Raises RunFailed where the pilots give no numbers.
    """
    if config.accuracy is None:
        return config, None
    known = store.read_json("states/choice.json")
    if known is not None and known.pop("key") == store.numbers_key:
        choice = Choice(**known)
    else:
        progress.stage("pilots for the asked accuracy")
        choice = _choose(config)
        store.save_json("states/choice.json", {"key": store.numbers_key, **asdict(choice)})
    mesh = replace(config.mesh, size_mm=choice.size_mm, formulation=choice.formulation, grading=choice.grading)
    return replace(
        config, mesh=mesh, newton_tolerance=choice.newton_tolerance, contact_dhat_mm=choice.contact_dhat_mm
    ), choice


def afterwards(
    choice: Choice, outcomes: Outcomes, found: Sequence[Parameters], indicator: Indicator | None
) -> Afterwards | None:
    """What the states of a run say of its errors; None where there are none.

    A contact that never acted leaves no error.
    """
    if indicator is None:
        return None
    touched = any("self_contact" in record.effects for record in outcomes.records)
    rigidities = [one.numbers_without_mesh["alpha2"] for one in found]
    alike = [one for one in found if one.pressure_kPa == choice.pilots_kPa]
    laws = [choice.law.with_indicator(indicator.stress_error)]
    if alike:
        run = _solved(numbers_of(alike[0]))
        laws.append(MeshLaw.of(choice.pilots, run).with_indicator(indicator.stress_error))
    return Afterwards(
        believed={key: max(law[key] for law in laws) for key in HEADLINE},
        believed_of_contact=choice.believed_of_contact if touched else 0.0,
        identification=max((one.std / one.value for one in rigidities), default=choice.identification),
        indicator=indicator,
    )


def _choose(config: Config) -> Choice:
    asked = config.accuracy
    assert asked is not None
    elements = replace(config.mesh, formulation=FORMULATION, grading=GRADING)
    config = replace(config, mesh=elements, pressures_kPa=config.pressures_kPa[:1])
    sizes = (PILOTS[0] * min(config.design.extent), PILOTS[1] * min(config.design.extent))
    pilots = [_pilot(config, size) for size in sizes]
    distance, of_contact = _contact(config, OF_CONTACT * asked)
    left = max(asked - of_contact, (1.0 - OF_CONTACT) * asked)  # a given distance may leave more than its share
    size = MeshLaw.of(pilots).size_for(OF_MESH * left)
    size = floor(100.0 * min(max(size, FINEST * sizes[1]), sizes[0])) / 100.0
    return Choice(
        asked=asked,
        size_mm=config.mesh.size_mm if config.size_is_given else size,
        size_was_given=config.size_is_given,
        formulation=FORMULATION,
        grading=GRADING,
        newton_tolerance=min(1e-4, OF_NEWTON * asked),
        contact_dhat_mm=distance,
        pilots=pilots,
        pilots_kPa=config.pressures_kPa[0],
        believed_of_contact=of_contact,
    )


def _pilot(config: Config, size: float) -> dict[str, Any]:
    """Size, degrees of freedom, numbers and indicator of II and III at the lowest pressure of the run."""
    config = replace(config, mesh=replace(config.mesh, size_mm=size))
    found = measure(Rung(mesh_choice(config), size, config))
    if not found["numbers"]:
        raise RunFailed(f"the pilot with a mesh of {size:.3g} mm gave no numbers: {found['failure']}; give mesh.size")
    return {
        "size_mm": size,
        "degrees_of_freedom": found["degrees_of_freedom"],
        "cpu_seconds": found["cpu_seconds"],
        **_solved(found["numbers"][0]),
    }


def _solved(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """What the law of the mesh needs of one mesh."""
    headline = {key: numbers[key] for key in HEADLINE}
    return {"numbers": headline, **{key: numbers[key] for key in ("alpha2_std_N_mm2", "stress_error")}}


def _contact(config: Config, asked: float) -> tuple[float | None, float]:
    """The activation distance (mm) that leaves `asked` of relative error, and what it leaves; as given where it is."""
    usual = Scene.meshed(replace(config, contact_dhat_mm=None)).activation_distance
    if usual is None:
        return None, 0.0
    gap = usual / fem.ACTIVATION
    distance = config.contact_dhat_mm or min(usual, gap * max(asked / PER_DISTANCE, CLOSEST))
    return distance, PER_DISTANCE * distance / gap
