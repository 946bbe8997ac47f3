"""Laws of several pressures in one ratio of them, for what has one pressure."""

from dataclasses import replace
from pathlib import Path

from pipeline.answers.rods.choice import told_ratios
from pipeline.results.files import LAW, folder_of, read_results, read_run
from pipeline.values.errors import InputError, argument, ask
from pipeline.values.run import Run
from rod.arm_law.kinds import Law, along
from rod.arm_law.pairs import direction_of
from rod.same_pressure import Pressures


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
