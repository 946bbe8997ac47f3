"""A run at pairs of pressures: a run for each ratio of both, and the arm's own law over both pressures from their laws.

Between two ratios a further one is measured, by cell and ends alone, to see how far the law misses it. It then becomes
a part of the law; where it was missed by more than `BETWEEN`, both halves are looked at as well.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from pipeline.law.rows import PairSpec
from pipeline.law.study import measure_law
from pipeline.results.files import LAW, folder_of
from pipeline.run import run
from pipeline.store.progress import Progress
from pipeline.store.provenance import provenance
from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.store.store import check_no_run
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.formats import FORMAT, PAIRS_PAGE
from pipeline.values.formatting import percent
from pipeline.values.json_values import JsonObject
from pipeline.values.run import Run
from rod.arm_law.between import measure_disagreement
from rod.arm_law.kinds import law_record
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import PairLaw, fractions_of
from rod.errors import RodError

#: largest error of the curvature halfway between two ratios, over the largest curvature, and how many ratios are added
BETWEEN, MOST_ADDED = 0.01, 6
#: two directions, and the error of the law between them that is expected; None: not known
Interval = tuple[float, float, float | None]


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
    open_folder(out)
    check_no_run(out)
    for name in (LAW, PAIRS_PAGE):
        (out / name).unlink(missing_ok=True)
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
    notes: list[str] = []
    left: list[float | None] = []  # errors between rays
    pending: list[Interval] = [(low, high, None) for low, high in pairwise(sorted(laws))]
    while pending:
        low, high, expected = pending.pop(0)
        if expected is not None and (expected <= BETWEEN or len(laws) - len(spec.rays) >= MOST_ADDED):
            left.append(expected)
            continue
        crosses = low < 1.0 < high  # slopes jump at equal pressures
        middle = 1.0 if crosses else 0.5 * (low + high)
        try:
            laws[middle] = measured(middle, _common(laws[low], laws[high]))
        except (InputError, RunFailed) as failure:
            notes.append(f"Between {folder_of(low)} and {folder_of(high)}: {failure}")
            if crosses:
                return None, (*notes, "There is no law over both pressures without one at equal pressures.")
            left.append(None)
            continue
        try:
            errors = (None, None) if crosses else _errors(spec, laws, (low, middle, high))
        except RodError as failure:
            notes.append(f"Between {folder_of(low)} and {folder_of(high)}: {failure}")
            left.append(None)
            continue
        pending += [(low, middle, errors[0]), (middle, high, errors[1])]
    if max((error or 0.0 for error in left), default=0.0) > BETWEEN:
        added = len(laws) - len(spec.rays)
        notes.append(f"The law between ratios is less certain than usual, although {added} ratios were added.")
    rays = sorted(laws)
    error = None if None in left or not left else max(error for error in left if error is not None)
    return PairLaw(spec.cavities, tuple(rays), tuple(laws[d] for d in rays), error), tuple(notes)


def _common(low: ArmLaw, high: ArmLaw) -> list[float]:
    """The pressures above 0 kPa of the law that ends first."""
    return [pressure for pressure in min(low, high, key=lambda law: law.pressures[-1]).pressures if pressure]


def _errors(spec: PairSpec, laws: Mapping[float, ArmLaw], rays: tuple[float, float, float]) -> tuple[float, float]:
    """Expected errors of the curvature in both halves between two rays, over the largest curvature.

    What the law of both rays misses the third one in the middle by, times the part of the disagreement of their slopes
    that is left in a half. All at the highest pressure that the three have.
    """
    low, middle, high = rays
    larger = min(laws[d].pressures[-1] for d in rays)

    def fan(*directions: float) -> PairLaw:
        return PairLaw(spec.cavities, directions, tuple(laws[d] for d in directions))

    whole, halves = fan(low, high), (fan(low, middle), fan(middle, high))
    one, other = fractions_of(middle)
    found, true = whole.at((one * larger, other * larger)).section, laws[middle].at(larger).section
    there = (true.moment >= found.moment[0]) & (true.moment <= found.moment[-1])
    if not there.any():
        raise RodError("The laws of the ratios have no moment in common.")
    misses = np.abs(true.kappa - np.interp(true.moment, found.moment, found.kappa))[there]
    cells = whole.cells_around(0, larger)
    error = float(misses.max()) / max(float(np.abs(cell.curve.kappa).max()) for cell in cells)
    before = float(measure_disagreement(*cells)[1].max()) or 1.0  # none: nothing to gain
    parts = [float(measure_disagreement(*half.cells_around(0, larger))[1].max()) / before for half in halves]
    return error * min(1.0, parts[0]), error * min(1.0, parts[1])
