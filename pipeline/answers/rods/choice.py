"""Which of the rods of a result folder to take, the one that the verdict recommends; and laws in one ratio."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from pipeline.answers.rods.rods import Rods
from pipeline.results.files import LAW, folder_of, read_results, read_run
from pipeline.results.rod_errors import rod_to_take
from pipeline.results.verdict import errors_and_notes, verdict_of
from pipeline.values.errors import InputError, argument, ask, quoted
from pipeline.values.formats import ARM_LAW, FIVE
from pipeline.values.reasons import NO_PARAMETERS
from pipeline.values.run import Run
from rod.arm_law.kinds import Law, along
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import direction_of
from rod.pressurised_rod import PressurisedRod
from rod.same_pressure import Pressures
from rod.weight import Mass

#: the rods by the names that a user gives them: the arm's own law, five parameters, and those of a curve that stretches
KINDS = {"law": ARM_LAW, "five": FIVE}


def rod_of_path(path: Path, kind: str | None) -> Rods:
    """The rod of a result folder, of a parameters.json or of a law.json alone. Raises InputError."""
    return choose_rod(read_run(path), kind)


def check_kind(kind: Any, name: str) -> None:
    """Raise InputError for what is no name of a rod; name: of the argument."""
    if kind is not None and (not isinstance(kind, str) or kind not in KINDS):
        given = argument(name, kind if isinstance(kind, str) else quoted(kind))
        raise InputError(f"{given}: allowed are {', '.join(KINDS)}")


def choose_rod(run: Run, kind: str | None = None) -> Rods:
    """The rod that the verdict recommends, or the one of a kind.

    Where nothing was compared with finite elements it is the one with the arm's own law, if there is one. Raises
    InputError where the run has no such rod, and for an arm that leaves its plane.
    """
    check_kind(kind, "rod")
    refuse_out_of_plane(run)
    if run.law is not None and run.law.plane is None:
        if kind not in (None, "law"):
            raise InputError(f"{argument('rod', kind)}: a law of several pressures is that of rod law; leave it out")
        taken = rod_to_take(run)
        return Rods(run.law.law, "law", taken[1] if taken else None, run.law.law.notes)
    verdict = verdict_of(run)
    names = {name: kind for kind, name in KINDS.items()}
    chosen = kind or names.get(verdict.rod, "law" if run.law else "five")
    errors, notes = errors_and_notes(run, verdict, KINDS[chosen])
    law = _source(run, chosen)
    forms = law.plane if law.plane and law.plane.limit else None
    return Rods(forms.before_snap if forms else law, chosen, errors, notes, forms=forms)


def refuse_out_of_plane(run: Run) -> None:
    """Raise InputError for an arm that leaves its plane."""
    if remark := run.remark("out_of_plane"):
        raise InputError(f"{run.directory}: {remark.text}")


def refuse_draft(run: Run, what: str) -> None:
    """Raise InputError, with what needs derivatives, for a draft."""
    if run.law and run.law.draft:
        remedy = f"run it without {argument('draft', True)}"
        raise InputError(f"{run.directory}: {what} needs derivatives, which a draft does not have; {remedy}")


def plane_of(run: Run, what: str) -> ArmLaw:
    """The law of one pressure in a plane of a run that has a law. Raises InputError, with what needs it, for others."""
    assert run.law is not None
    if run.law.plane is not None:
        return run.law.plane
    if run.law.law.has_plane:
        measured = f"a law at a measured ratio of its pressures, one of {told_ratios(run.law.law)}"
        raise InputError(f"{run.directory}: {what} takes {measured}")
    raise InputError(f"{run.directory}: {what} takes a law in a plane, and this one is in space")


def told_ratios(law: Law) -> str:
    """The ratios in which a law of several pressures was measured, as they are written for --ratio."""
    return ", ".join(":".join(f"{part:.6g}" for part in ratio) for ratio in law.ratios)


def _source(run: Run, kind: str) -> Law | PressurisedRod:
    if kind == "law":
        if run.law is None:
            reason = next((r.text for r in (*run.failures, *run.remarks) if r.code == "no_arm_law"), "")
            why = f" ({reason.rstrip('.')})" if reason else ""
            raise InputError(f"{run.directory}: has no law.json, the arm's own law{why}; take rod five")
        return run.law.law
    if not run.identified_kPa:
        raise nothing_identified(run)
    mass, grams = run.law.law.mass if run.law else None, run.parameters.mass_g
    if mass is None and grams is not None:  # spread evenly at the height of the material curve
        mass = Mass.even(run.length_mm, grams)
    return replace(run.parameters.rods(), mass=mass)


def nothing_identified(run: Run) -> InputError:
    """The refusal of a run without five parameters."""
    named = next((r.text for r in (*run.remarks, *run.failures) if r.code in NO_PARAMETERS), "")
    without = "the identification needs II and III at the same pressure"
    missing = without if run.parameters.format else "the run has not come to the identification"
    return InputError(f"{run.directory}: holds no parameters of a rod: {named or run.failure or missing}")


def run_along(path: Path, ratio: str | None) -> Run:
    """The results of a folder or of a file; those of a law of several pressures in a ratio of them. Raises InputError.

    ratio: as 1:0.5; None where there is one pressure, or one ratio.
    """
    run = read_run(path)
    if run.law is None or not run.law.has_rows:
        if ratio is not None:
            raise InputError(f"{argument('ratio', ratio)}: the rod of {path} has one pressure; leave it out")
        return run
    law, fractions = run.law.law, _fractions(path, run.law.law, ratio)
    one = ask(argument("ratio", ratio), along, law, fractions)
    if law.has_plane and ((own := path / folder_of(direction_of(fractions)[1])) / LAW).is_file():
        return read_results(own)
    return replace(run, law=replace(run.law, law=one))


def _fractions(path: Path, law: Law, ratio: str | None) -> Pressures:
    """The parts of the pressures in a ratio as it was written, or in the only one of a law."""
    measured, names = law.ratios, ", ".join(law.cavities)
    if ratio is None:
        if len(measured) == 1:
            return measured[0]
        example = argument("ratio", told_ratios(law).split(", ")[-1])
        raise InputError(f"{path}: its law has the pressures of {names}; give their ratio, such as {example}")
    try:
        return tuple(float(part) for part in ratio.split(":"))
    except ValueError:
        example = ":".join(["1", "0.5", *["0"] * (len(law.cavities) - 2)])
        raise InputError(
            f"{argument('ratio', ratio)}: is no ratio of the pressures of {names}; for example {example}"
        ) from None
