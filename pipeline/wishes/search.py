"""The search for a design: from several starts on coarse cells, and then with the law that a run delivers."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from geometry.arrays import Array
from pipeline.context import RunContext
from pipeline.wishes.descent import Correction, Descent
from pipeline.wishes.measured import NotBorne, Numbers, delivered
from pipeline.wishes.trial import DELIVERED_LAW, History, Trial
from pipeline.wishes.wish_file import WishFile

#: delivered laws from one start at most
DELIVERED = 4
#: part of its tolerance within which every wish is near enough, and the least gain over the merit: on the coarse mesh
#: and on that of the law
ROUGHLY, FINELY = (0.7, 0.1), (0.4, 0.05)
#: miss over the tolerance on the mesh of the law up to which the delivered law may still have every wish
HOPEFUL = 3.0
SEED = 1


@dataclass(frozen=True, eq=False)  # arrays inside
class Found:
    """The best design, its numbers from the delivered law, and how it was found."""

    trial: Trial
    numbers: Numbers
    first: Numbers | None  #: of the coarse law at the first start; None where that has none
    history: tuple[Trial, ...]


@dataclass(frozen=True)
class Search:
    """One search, and the designs that it has tried."""

    history: History

    @staticmethod
    def of(file: WishFile, context: RunContext) -> "Search":
        """One that has tried nothing."""
        return Search(History(file, context))

    def run(self) -> Found:
        """Search from several starts on coarse cells, and go on from the best one with the delivered law.

        Raises `NotBorne` where no design has a law.
        """
        ended: list[Descent] = []
        found: list[tuple[Trial, Numbers]] = []
        for number, start in enumerate(starts(self.history.file), start=1):
            try:
                descent = Descent.begin(self.history, number, start)
                descent.descend(ROUGHLY)
                descent.refine()
                descent.descend(FINELY)
            except NotBorne:
                continue
            ended.append(descent)
            if descent.is_within(HOPEFUL):
                found += self._delivered(descent)
            if any(trial.is_met for trial, _ in found) and not self.history.file.wishes.minimize:
                break
        if ended and not found:
            found = self._delivered(min(ended, key=lambda descent: descent.trial.merit))
        if not found:
            raise NotBorne(self.history.trials[-1].reason or "no start has a law")
        trial, numbers = min(found, key=lambda pair: pair[0].merit)
        first = ended[0].first if ended[0].number == 1 else None
        return Found(trial, numbers, first, tuple(self.history.trials))

    def _delivered(self, descent: "Descent") -> list[tuple[Trial, Numbers]]:
        """Correct the numbers by those of the delivered law, until these are right; all designs with such a law."""
        wishes, found = self.history.file.wishes, list[tuple[Trial, Numbers]]()
        for attempt in range(DELIVERED):
            self.history.context.progress.stage(f"law of the design {attempt + 1} that a run delivers")
            try:
                fine = delivered(self.history.file, descent.point, self.history.context)
            except NotBorne as failure:
                self.history.refuse(descent.number, descent.point, DELIVERED_LAW, str(failure))
                break
            trial = self.history.tried(descent.number, DELIVERED_LAW, descent.point, fine, descent.sensitivity[0])
            self.history.record(trial)
            found.append((trial, fine))
            if trial.is_met and (attempt or not wishes.minimize):
                break
            before = descent.point
            descent.correct(Correction.of(wishes, descent.numbers, fine))
            descent.descend(FINELY)
            if np.array_equal(descent.point, before):
                break
        return found


def starts(file: WishFile) -> Iterator[Array]:
    """Points (n,): the given one, then those of a Latin hypercube of the logarithms."""
    wishes = file.wishes
    yield wishes.start
    if wishes.starts > 1:
        fractions = qmc.LatinHypercube(len(wishes.free), rng=np.random.default_rng(SEED)).random(wishes.starts - 1)
        low, high = np.log(wishes.bounds).T
        yield from np.exp(low + fractions * (high - low))
