"""Laws of several pressures in one ratio of them, for what has one pressure."""

from dataclasses import replace
from pathlib import Path

from pipeline.answers.rods.choice import RodOfRun, choose_rod, rod_of_law, rod_of_path, told_ratios
from pipeline.results.files import LAW, folder_of, read_results
from pipeline.values.errors import InputError, argument, ask
from pipeline.values.law import DeliveredLaw
from pipeline.values.run import Run
from rod.arm_law.kinds import along, ratios_of
from rod.arm_law.pairs import PairLaw, direction_of
from rod.arm_law.space_law import SpaceLaw
from rod.same_pressure import Pressures


def run_along(folder: Path, ratio: str | None) -> Run:
    """The results of a folder; those of a law of several pressures in a ratio of them. Raises InputError.

    ratio: as 1:0.5; None where there is one pressure, or one ratio.
    """
    run = read_results(folder)
    if run.law is None:
        _refuse(folder, ratio)
        return run
    law = law_along(folder, run.law, ratio)
    if law is run.law:
        return run
    if isinstance(run.law.law, PairLaw):
        own = folder / folder_of(direction_of(_fractions(folder, run.law.law, ratio))[1])
        if (own / LAW).is_file():
            return read_results(own)
    return replace(run, law=law)


def rod_along(path: Path, kind: str | None, ratio: str | None) -> RodOfRun:
    """The rod over one pressure of a result folder, a parameters.json or a law.json; parameters as of `run_along`.

    Raises InputError.
    """
    if path.is_dir():
        return choose_rod(run_along(path, ratio), kind)
    rods = rod_of_path(path, kind)
    if not isinstance(rods.source, PairLaw | SpaceLaw):
        _refuse(path, ratio)
        return rods
    return rod_of_law(law_along(path, DeliveredLaw(rods.source), ratio))


def law_along(path: Path, delivered: DeliveredLaw, ratio: str | None) -> DeliveredLaw:
    """A law of several pressures in a ratio of them, a law of one pressure as it is; ratio as of `run_along`.

    Raises InputError.
    """
    law = delivered.law
    if not isinstance(law, PairLaw | SpaceLaw):
        _refuse(path, ratio)
        return delivered
    return replace(delivered, law=ask(argument("ratio", ratio), along, law, _fractions(path, law, ratio)))


def _fractions(path: Path, law: PairLaw | SpaceLaw, ratio: str | None) -> Pressures:
    """The parts of the pressures in a ratio as it was written, or in the only one of a law."""
    measured, names = ratios_of(law), ", ".join(law.cavities)
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


def _refuse(path: Path, ratio: str | None) -> None:
    if ratio is not None:
        raise InputError(f"{argument('ratio', ratio)}: the rod of {path} has one pressure; leave it out")
