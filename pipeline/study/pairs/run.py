"""A run at pairs of pressures: a run for each ratio of both, and the arm's own law over both pressures from their laws.

Between two ratios a further one is measured, by cell and ends alone, to see how far the law misses it. It then becomes
a part of the law; where it was missed by more than `BETWEEN`, both halves are looked at as well.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import inf
from pathlib import Path

import numpy as np

from pipeline.law.piece.adaptive import AdaptiveCurve, Interval
from pipeline.law.rows import PairSpec
from pipeline.law.study import measure_law
from pipeline.results.files import LAW, folder_of
from pipeline.results.laws import law_record
from pipeline.run import run
from pipeline.store.owner import PAIRS, claim
from pipeline.store.progress import Progress
from pipeline.store.provenance import provenance
from pipeline.store.result_folder import ResultFolder
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.formats import FORMAT, PAIRS_PAGE
from pipeline.values.formatting import percent
from pipeline.values.json_values import JsonObject
from pipeline.values.page import page
from pipeline.values.run import Run
from rod.arm_law.between import measure_disagreement
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import PairLaw, fractions_of
from rod.errors import RodError

#: largest error of the curvature halfway between two ratios, over the largest curvature, and how many ratios are added
BETWEEN, MOST_ADDED = 0.01, 6


@dataclass(frozen=True)
class PairRuns:
    """The results of a run at pairs of pressures; the same numbers stand in the files of `directory`."""

    directory: Path
    spec: PairSpec
    runs: dict[float, Run]  #: by direction, rising
    law: PairLaw | None  #: None where the law of a ratio is missing
    notes: tuple[str, ...]  #: what limits the law, a sentence each

    @property
    def sentences(self) -> tuple[str, ...]:
        """How far the law over both pressures reaches, and what limits it."""
        if self.law is None:
            return self.notes
        error = self.law.error_between
        ratios = ", ".join(folder_of(direction).replace("_", " ") for direction in self.law.directions)
        if len(self.law.directions) == 1:
            return (f"The law over both pressures has one ratio, {ratios}.", *self.notes)
        known = "" if error is None else f" to {percent(error)} of the largest curvature"
        first = f"The law over both pressures has the ratios {ratios}; between them it is interpolated{known}."
        return (first, *self.notes)

    def raise_if_failed(self) -> None:
        """Raise RunFailed where a pair was not reached."""
        for made in self.runs.values():
            made.raise_if_failed()


def run_pairs(spec: PairSpec, out: Path, jobs: int, fresh: bool, progress: Progress) -> PairRuns:
    """Solve every pair in the folder of its ratio, and write `out`/law.json and run.json.

    Raises InputError and RunFailed as `pipeline.run.run`, and InputError for a folder with the results of another run.
    """
    folder = claim(out, PAIRS)
    folder.save_text(PAIRS_PAGE, page(f"{spec.name}: not finished"))
    folder.path(LAW).unlink(missing_ok=True)
    configs = {direction: spec.config(direction, pressures) for direction, pressures in spec.rays.items()}
    runs: dict[float, Run] = {}
    for direction, config in configs.items():
        progress.remark(f"pressures of {' and '.join(spec.cavities)} as {folder_of(direction).replace('_', ' ')}")
        runs[direction] = run(config, out / folder_of(direction), jobs, fresh, progress).results

    def measured(direction: float, pressures: Sequence[float]) -> ArmLaw:
        config, name = spec.config(direction, pressures), folder_of(direction)
        progress.remark(f"law between ratios, {name.replace('_', ' ')}")
        return measure_law(config, out / "between" / name, jobs, fresh, progress).measured.law

    known = {d: law for d, done in runs.items() if done.law and (law := done.law.plane)}
    both, notes = joined(spec, known, measured)
    made = PairRuns(out, spec, runs, both, notes)
    save_pairs(made)
    return made


def save_pairs(made: PairRuns) -> None:
    """Write the law over both pressures, where there is one, and run.json for every other command."""
    folder, config = ResultFolder(made.directory), made.spec.config(*next(iter(made.spec.rays.items())))
    if made.law is not None:
        folder.save_json(LAW, record(made))
    rows = [[part * p for part in fractions_of(d)] for d, pressures in made.spec.rays.items() for p in pressures]
    folder.save_json("run.json", {"format": FORMAT, "config": config.record(), **provenance(), "rows_kPa": rows})


def record(made: PairRuns) -> JsonObject:
    """The law over both pressures, where there is one, with its notes and the pressures of each folder."""
    law = {"cavities": list(made.spec.cavities)} if made.law is None else law_record(made.law)
    folders = {folder_of(direction): list(pressures) for direction, pressures in made.spec.rays.items()}
    return {"design": made.spec.name, "pressures_kPa_by_folder": folders, "notes": list(made.notes), **law}


def joined(
    spec: PairSpec, laws: dict[float, ArmLaw], measured: Callable[[float, Sequence[float]], ArmLaw]
) -> tuple[PairLaw | None, tuple[str, ...]]:
    """The law over both pressures from those by direction, and what limits it; measured: gives that of a direction."""
    if missing := [folder_of(direction) for direction in spec.rays if direction not in laws]:
        return None, (f"There is no law over both pressures, because {', '.join(missing)} has no law of its own.",)
    fan = _RatioLaws(spec.cavities, laws, measured)
    try:
        intervals = AdaptiveCurve(fan.errors, fan.solve, BETWEEN, MOST_ADDED).refine(sorted(laws))
    except (InputError, RunFailed):
        return None, (*fan.notes, "The law over both pressures needs the run at equal pressures, which failed.")
    left = [one.error for one in intervals if one.error is not None and one not in fan.failed]
    if max(left, default=0.0) > BETWEEN:
        added = len(laws) - len(spec.rays)
        fan.notes.append(f"The law between ratios is less certain than usual, although {added} ratios were added.")
    return fan.law(*sorted(laws), error=None if fan.failed or not left else max(left)), tuple(fan.notes)


@dataclass(frozen=True)
class _RatioLaws:
    """Laws by direction, to which those of directions between are added."""

    cavities: tuple[str, ...]
    laws: dict[float, ArmLaw]
    measured: Callable[[float, Sequence[float]], ArmLaw]  #: the law of a direction at pressures (kPa)
    notes: list[str] = field(default_factory=list)
    failed: list[Interval[float]] = field(default_factory=list)  #: in which nothing more is known

    def law(self, *directions: float, error: float | None = None) -> PairLaw:
        """The law of some of the directions."""
        return PairLaw(self.cavities, directions, tuple(self.laws[d] for d in directions), error)

    def solve(self, intervals: Sequence[Interval[float]]) -> Iterator[float | None]:
        """Directions in the middle, whose laws are measured. Raises InputError and RunFailed at equal pressures."""
        for one in intervals:
            middle = 1.0 if _crosses(one) else 0.5 * (one.first + one.second)
            shorter = min(self.laws[one.first], self.laws[one.second], key=lambda law: law.pressures[-1])
            try:
                self.laws[middle] = self.measured(middle, [pressure for pressure in shorter.pressures if pressure])
            except (InputError, RunFailed) as failure:
                self._fail(one, failure)
                if _crosses(one):
                    raise
                yield None
            else:
                yield middle

    def errors(self, intervals: Sequence[Interval[float]]) -> Iterator[float | None]:
        """Expected errors of the curvature in halves, over the largest curvature; infinite without a ray between."""
        for one in intervals:
            try:
                yield inf if one.part_of is None or _crosses(one.part_of) else self._error(one, one.part_of)
            except RodError as failure:
                self._fail(one.part_of or one, failure)
                yield None

    def _fail(self, one: Interval[float], failure: Exception) -> None:
        self.failed.append(one)
        note = f"Between {folder_of(one.first)} and {folder_of(one.second)}: {failure}"
        self.notes.extend([note] if note not in self.notes else [])

    def _error(self, half: Interval[float], whole: Interval[float]) -> float:
        """What the law of two rays misses the third one in the middle by, times the part of the disagreement of their
        slopes that is left in the half. All at the highest pressure that the three have."""
        middle = half.second if half.first == whole.first else half.first
        larger = min(self.laws[d].pressures[-1] for d in (whole.first, middle, whole.second))
        law, part = self.law(whole.first, whole.second), self.law(half.first, half.second)
        one, other = fractions_of(middle)
        found, true = law.at((one * larger, other * larger)).section, self.laws[middle].at(larger).section
        there = (true.moment >= found.moment[0]) & (true.moment <= found.moment[-1])
        if not there.any():
            raise RodError("The laws of the ratios have no moment in common.")
        misses = np.abs(true.kappa - np.interp(true.moment, found.moment, found.kappa))[there]
        cells = law.cells_around(0, larger)
        error = float(misses.max()) / max(float(np.abs(cell.curve.kappa).max()) for cell in cells)
        before = float(measure_disagreement(*cells)[1].max()) or 1.0  # none: nothing to gain
        return error * min(1.0, float(measure_disagreement(*part.cells_around(0, larger))[1].max()) / before)


def _crosses(one: Interval[float]) -> bool:
    """Whether equal pressures, where slopes jump, lie between two directions."""
    return one.first < 1.0 < one.second
