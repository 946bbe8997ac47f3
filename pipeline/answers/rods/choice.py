"""The rods of a result folder over the pressure, and which of them to take: the one that the verdict recommends."""

import json
from collections.abc import Hashable
from dataclasses import asdict, dataclass, field, replace
from math import isfinite
from pathlib import Path
from typing import Any

from geometry import Reason
from pipeline.results.files import read_results
from pipeline.results.rod_errors import RodAndMesh, rod_and_mesh, rod_to_take
from pipeline.results.saved_law import SavedLaw, is_law
from pipeline.results.saved_law_in_space import read_space_law
from pipeline.results.saved_pairs import read_pair_law
from pipeline.results.saved_rod import SavedRod, pressurised_rod
from pipeline.results.verdict import OUT_OF_PLANE, Verdict, verdict_of
from pipeline.values.errors import InputError, argument, quoted
from pipeline.values.formats import ARM_LAW, EXTENSIBLE, FIVE
from pipeline.values.reasons import NO_PARAMETERS, report_reason
from pipeline.values.run import Run
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import PairLaw
from rod.arm_law.space_law import SpaceLaw
from rod.errors import RodError
from rod.inverse import Response
from rod.mechanics.equilibrium import Rod
from rod.pressurised_rod import PressurisedRod
from rod.weight import Mass

#: the rods by the names that a user gives them: the arm's own law, five parameters, and those of a curve that stretches
KINDS = {"law": ARM_LAW, "five": FIVE, "five_extensible": EXTENSIBLE}
#: error of the shape over the length, of rod and mesh together, from which on every shape of the rod has a note
NOTED = 0.05


@dataclass(frozen=True, eq=False)  # arrays inside
class RodOfRun:
    """One of the rods of a run over the pressure."""

    kind: str  #: one of KINDS
    source: ArmLaw | PairLaw | SpaceLaw | PressurisedRod
    errors: RodAndMesh | None = None  #: None where it was not compared with finite elements
    notes: tuple[str, ...] = ()  #: what limits the trust in it, a sentence each
    mass: Mass | None = None  #: of an arm with five parameters; None: not known
    responses: dict[Hashable, tuple[Response, ...]] = field(default_factory=dict, repr=False)  #: by load, once made

    @property
    def error_text(self) -> str:
        """Its errors against finite elements in words; empty where it was not compared."""
        return "" if self.errors is None or not isfinite(self.errors.shape) else self.errors.text

    @property
    def pressures_kPa(self) -> tuple[float, float]:
        """The lowest and the highest pressure."""
        assert not isinstance(self.source, PairLaw | SpaceLaw)  # refused before it is asked
        known = self.source.pressures
        return float(known[0]), float(known[-1])

    def at(self, pressure_kPa: float | tuple[float, ...]) -> Rod:
        """The rod at a pressure, or at the pressures of all cavities; its origin is the clamped end of the material
        curve.

        Raises `RodError` outside its pressures, and for a pair where it has one pressure, or the other way round.
        """
        if isinstance(self.source, PairLaw | SpaceLaw):
            cavities = self.source.cavities
            if not isinstance(pressure_kPa, tuple) or len(pressure_kPa) != len(cavities):
                example = ", ".join(["20 kPa", "5 kPa", *["0 kPa"] * (len(cavities) - 2)])
                raise RodError(f"This law has the pressures of {', '.join(cavities)}; give all, such as [{example}].")
            return Rod(self.source.length, law=self.source.at(pressure_kPa), notes=self.notes)
        if isinstance(pressure_kPa, tuple):
            raise RodError("This rod has one pressure; give it alone, such as 20 kPa.")
        if isinstance(self.source, PressurisedRod):
            rod = replace(self.source.at(pressure_kPa), mass=self.mass)
        else:
            rod = Rod(self.source.length, law=self.source.at(pressure_kPa))
        return replace(rod, notes=(*self.notes, *rod.notes))


def rod_of_path(path: Path, kind: str | None) -> RodOfRun:
    """The rod of a result folder, or the one of a parameters.json or a law.json alone. Raises InputError."""
    check_kind(kind, "rod")
    if (pairs := read_pair_law(path)) is not None:
        if kind not in (None, "law"):
            raise InputError(f"{argument('rod', kind)}: a law over two pressures is that of rod law; leave it out")
        doubt = pairs.error_between is None and len(pairs.laws) > 1
        return RodOfRun("law", pairs, notes=("The error of this law between its ratios is not known.",) * doubt)
    if (in_space := read_space_law(path)) is not None:
        if kind not in (None, "law"):
            raise InputError(f"{argument('rod', kind)}: a law in space is that of rod law; leave it out")
        return RodOfRun("law", in_space)
    if path.is_dir():
        return choose_rod(read_results(path), kind)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        content = None  # the sentence is that of the parameters
    there = ("law",) if is_law(content) else ("five", "five_extensible")
    if kind not in (None, *there):
        raise InputError(f"{argument('rod', kind)}: is not in {path.name}; give the folder of the run")
    if is_law(content):
        return RodOfRun("law", SavedLaw.of(path, content).law)
    chosen = kind or "five"
    return RodOfRun(chosen, SavedRod.read(path, extensible=chosen == "five_extensible").rods)


def check_kind(kind: Any, name: str) -> None:
    """Raise InputError for what is no name of a rod; name: of the argument."""
    if kind is not None and (not isinstance(kind, str) or kind not in KINDS):
        given = argument(name, kind if isinstance(kind, str) else quoted(kind))
        raise InputError(f"{given}: allowed are {', '.join(KINDS)}")


def choose_rod(run: Run, kind: str | None = None) -> RodOfRun:
    """The rod that the verdict recommends, or the one of a kind.

    Where nothing was compared with finite elements it is the one with the arm's own law, if there is one. Raises
    InputError where the run has no such rod, and for an arm that leaves its plane.
    """
    refuse_out_of_plane(run)
    verdict = verdict_of(run)
    names = {name: kind for kind, name in KINDS.items()}
    chosen = kind or names.get(verdict.rod, "law" if run.law else "five")
    rod = KINDS[chosen]
    compared = next((errors for errors in verdict.errors if errors.rod == rod), None)
    taken = rod_to_take(run, verdict.errors)
    errors = rod_and_mesh(run, compared) if compared else taken[1] if taken and taken[0] == rod else None
    mass = None if chosen == "law" else _mass(run)
    return RodOfRun(chosen, _source(run, chosen), errors, _notes(verdict, errors), mass)


def refuse_out_of_plane(run: Run) -> None:
    """Raise InputError for an arm that leaves its plane."""
    if remark := next((remark for remark in run.remarks if remark.code == OUT_OF_PLANE), None):
        raise InputError(f"{run.directory}: {remark.text}")


def _source(run: Run, kind: str) -> ArmLaw | PressurisedRod:
    if kind == "law":
        if run.law is None:
            raise InputError(f"{run.directory}: has no law.json, the arm's own law{_why(run)}; take rod five")
        return SavedLaw.read(run.directory / "law.json").law
    if not run.identified_kPa:
        raise nothing_identified(run)
    extensible = kind == "five_extensible"
    if extensible and run.parameters.eccentricity is None:
        raise InputError(f"{run.directory}: has no parameters of a rod that stretches; take rod five")
    return pressurised_rod(asdict(run.parameters), extensible)


def _mass(run: Run) -> Mass | None:
    """As in the law of a run, else spread evenly at the height of the material curve; None where it is not known."""
    of_law, grams = SavedLaw.read(run.directory / "law.json").law.mass if run.law else None, run.parameters.mass_g
    if of_law is not None:
        return of_law
    return None if grams is None else Mass.even(run.length_mm, grams)


def nothing_identified(run: Run) -> InputError:
    """The refusal of a run without five parameters."""
    named = next((r.text for r in (*run.remarks, *run.failures) if r.code in NO_PARAMETERS), "")
    reason = named or run.failure or "the run has not come to the identification"
    return InputError(f"{run.directory}: holds no parameters of a rod: {reason}")


def _why(run: Run) -> str:
    """Why a run has no law of its own, a clause in brackets; empty where it does not say so."""
    reason = next((r.text for r in (*run.failures, *run.remarks) if r.code == "no_arm_law"), "")
    return f" ({reason.rstrip('.')})" if reason else ""


def _notes(verdict: Verdict, errors: RodAndMesh | None) -> tuple[str, ...]:
    """The refusal of the verdict, a large error, or one that is not known."""
    notes = [] if verdict.refusal is None else [verdict.refusal.text]
    if errors is None:
        return tuple(notes)
    if errors.mesh.largest is None:
        notes.append(report_reason(Reason("mesh_error_unknown")).text)
    if verdict.refusal is None and errors.shape > NOTED:
        notes.append(f"The errors of this rod are large: {errors.text}.")
    return tuple(notes)
