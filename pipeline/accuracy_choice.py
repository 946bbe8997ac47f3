"""Mesh, tolerance and contact distance for an accuracy that is asked for, and the error that is believed to remain.

Errors of κ₀(l/2), α₂ and F count. What the mesh has wrong is told by two pilots, the same two experiments at the lowest
pressure of the run on two coarse meshes: errors are taken to fall with the square of the size, as the ladders of
docs/accuracy.md do or faster. What contact leaves is told by what those ladders measured.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import floor
from typing import Any

import fem
from pipeline.accuracy import touching_distance
from pipeline.accuracy_errors import HEADLINE, NUMBERS
from pipeline.config import Config
from pipeline.failure import RunFailed
from pipeline.progress import Progress
from pipeline.rung_measured import measure
from pipeline.rungs import Rung, mesh_choice
from pipeline.scene import meshed_body
from pipeline.store import Store

__all__ = ["Choice", "chosen", "size_for"]

#: elements and grading that reach an accuracy with the fewest degrees of freedom
FORMULATION, GRADING = "mixed", "walls"
#: sizes of the pilots over the smallest side of the body
PILOTS = (0.4, 0.27)
#: power of the size with which errors fall
ORDER = 2.0
#: share of the asked error that the mesh may have; the rest is for contact
OF_MESH = 0.6
#: error per activation distance over the gap: that of F on arm (a) at 17 kPa, the largest
PER_DISTANCE = 1.1
#: the smallest activation distance over the gap that is chosen: it takes 2.5 times the factorizations of the default
CLOSEST = 0.025
#: Newton's tolerance is this share of the asked error
OF_NEWTON = 1e-3
#: the finest mesh that is chosen, over the finer pilot
FINEST = 0.35


@dataclass(frozen=True)
class Choice:
    """What was chosen for an asked accuracy, and the error that is believed to remain; errors are relative."""

    asked: float
    size_mm: float
    size_was_given: bool
    formulation: str
    grading: str
    newton_tolerance: float
    contact_dhat_mm: float | None  #: None where no faces can meet
    pilots: Sequence[Mapping[str, Any]]  #: size_mm, degrees_of_freedom, numbers
    believed: Mapping[str, float]  #: error of the mesh by number
    believed_of_contact: float

    @property
    def largest(self) -> float:
        """The largest error that is believed to remain."""
        return max(self.believed.values()) + self.believed_of_contact

    def record(self) -> dict[str, Any]:
        """The part of run.json about it."""
        return {**asdict(self), "believed_error": self.largest, "sentence": self.sentence()}

    def sentence(self) -> str:
        """What was asked for, chosen and is believed, for the terminal and the report."""
        parts = ", ".join(f"{100 * error:.1f} % in {NUMBERS[key]}" for key, error in self.believed.items())
        given = " (mesh.size is given and was kept)" if self.size_was_given else ""
        contact = f", {100 * self.believed_of_contact:.1f} % more from contact" if self.contact_dhat_mm else ""
        kept = "is kept" if self.largest <= self.asked else "is not reached"
        return (
            f"asked for {100 * self.asked:g} %: {self.formulation}, graded to {self.grading}, {self.size_mm:.3g} mm"
            f"{given}; the mesh is believed to leave {parts}{contact}; the asked accuracy {kept}"
        )


def chosen(config: Config, store: Store, progress: Progress) -> tuple[Config, Choice | None]:
    """The configuration with what its accuracy asks for, and the choice; unchanged where none is asked for.

    A choice made earlier in the same folder is kept. Raises RunFailed where the pilots give no numbers.
    """
    if config.accuracy is None:
        return config, None
    known = store.read_json("states/choice.json")
    if known is not None and known.pop("key") == store.key:
        choice = Choice(**known)
    else:
        progress.stage("pilots for the asked accuracy")
        choice = _choose(config)
        store.save_json("states/choice.json", {"key": store.key, **asdict(choice)})
    mesh = replace(config.mesh, size_mm=choice.size_mm, formulation=choice.formulation, grading=choice.grading)
    return replace(
        config, mesh=mesh, newton_tolerance=choice.newton_tolerance, contact_dhat_mm=choice.contact_dhat_mm
    ), choice


def size_for(asked: float, coarse: Mapping[str, float], fine: Mapping[str, float], sizes: tuple[float, float]) -> float:
    """The mesh size (mm) that leaves `asked` of relative error, from numbers on two meshes of `sizes` (mm).

    Never coarser than the first of them, nor finer than FINEST times the second; in hundredths.
    """
    error = max(mesh_errors(coarse, fine, sizes).values())
    size = sizes[1] * (asked / error) ** (1 / ORDER) if error > 0 else sizes[0]
    return floor(100.0 * min(max(size, FINEST * sizes[1]), sizes[0])) / 100.0


def mesh_errors(coarse: Mapping[str, float], fine: Mapping[str, float], sizes: tuple[float, float]) -> dict[str, float]:
    """Relative errors of the numbers on the finer of two meshes of `sizes` (mm), by Richardson's extrapolation."""
    left = 1.0 / ((sizes[0] / sizes[1]) ** ORDER - 1.0)
    return {key: left * abs(fine[key] - coarse[key]) / abs(fine[key]) for key in HEADLINE}


def _choose(config: Config) -> Choice:
    asked = config.accuracy
    assert asked is not None
    elements = replace(config.mesh, formulation=FORMULATION, grading=GRADING)
    config = replace(config, mesh=elements, pressures_kPa=config.pressures_kPa[:1])
    sizes = (PILOTS[0] * min(config.design.extent), PILOTS[1] * min(config.design.extent))
    pilots = [_pilot(config, size) for size in sizes]
    coarse, fine = (pilot["numbers"] for pilot in pilots)
    size = size_for(OF_MESH * asked, coarse, fine, sizes)
    if config.size_is_given:
        size = config.mesh.size_mm
    share = (size / sizes[1]) ** ORDER
    distance, of_contact = _contact(config, (1.0 - OF_MESH) * asked)
    return Choice(
        asked=asked,
        size_mm=size,
        size_was_given=config.size_is_given,
        formulation=FORMULATION,
        grading=GRADING,
        newton_tolerance=min(1e-4, OF_NEWTON * asked),
        contact_dhat_mm=distance,
        pilots=pilots,
        believed={key: share * error for key, error in mesh_errors(coarse, fine, sizes).items()},
        believed_of_contact=of_contact,
    )


def _pilot(config: Config, size: float) -> dict[str, Any]:
    """Size, degrees of freedom and numbers of II and III at the lowest pressure of the run."""
    config = replace(config, mesh=replace(config.mesh, size_mm=size))
    found = measure(Rung(mesh_choice(config), size, config))
    if not found["numbers"]:
        raise RunFailed(f"the pilot with a mesh of {size:.3g} mm gave no numbers: {found['failure']}; give mesh.size")
    return {
        "size_mm": size,
        "degrees_of_freedom": found["degrees_of_freedom"],
        "cpu_seconds": found["cpu_seconds"],
        "numbers": {key: found["numbers"][0][key] for key in HEADLINE},
    }


def _contact(config: Config, asked: float) -> tuple[float | None, float]:
    """The activation distance (mm) that leaves `asked` of relative error, and what it leaves; as given where it is."""
    usual = touching_distance(replace(config, contact_dhat_mm=None), meshed_body(config))
    if usual is None:
        return None, 0.0
    gap = usual / fem.ACTIVATION
    distance = config.contact_dhat_mm or min(usual, gap * max(asked / PER_DISTANCE, CLOSEST))
    return distance, PER_DISTANCE * distance / gap
