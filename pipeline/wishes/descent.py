"""The search from one start: steps on coarse cells, and then on those of the mesh of the law."""

from dataclasses import dataclass, replace

import numpy as np

from geometry import DesignError
from geometry.arrays import Array
from pipeline.cell.pieces import NoArmLaw
from pipeline.errors import InputError
from pipeline.wishes.measured import Coarse, NotBorne, Numbers
from pipeline.wishes.step import Model, missing_slopes, propose
from pipeline.wishes.trial import COARSE, FINE, History, Trial
from pipeline.wishes.wish import Wishes
from pipeline.wishes.wish_file import rounded

#: change of the logarithm of a dimension in one step: at first, at most, and where the search ends
RADIUS, LARGEST, SMALLEST = 0.2, 0.4, 2e-3
#: relative change of a dimension beyond which the cell is meshed anew
FARTHEST = 0.25
#: designs that are tried in one descent at most
TRIALS = 15
#: part of the expected gain for a step that is as good as expected, and for one that is not
GOOD, POOR = 0.7, 0.25


@dataclass(frozen=True, eq=False)  # arrays inside
class Correction:
    """From coarse numbers to those of the delivered law: factors of some, differences of others."""

    factor: Array  #: (m,)
    shift: Array  #: (m,)
    stretch: float = 0.0  #: difference of the largest stretch

    @staticmethod
    def none(wishes: Wishes) -> "Correction":
        """Of laws that are equal."""
        count = sum(len(wish.target) for wish in wishes.wishes)
        return Correction(np.ones(count), np.zeros(count))

    @staticmethod
    def of(wishes: Wishes, coarse: Numbers, fine: Numbers) -> "Correction":
        """Of the two laws of one design."""
        powers = np.concatenate([[wish.is_power] * len(wish.target) for wish in wishes.wishes])
        is_ratio = powers & (coarse.values * fine.values > 0.0)
        factor = np.where(is_ratio, fine.values / np.where(is_ratio, coarse.values, 1.0), 1.0)
        shift = np.where(is_ratio, 0.0, fine.values - coarse.values)
        stretch = fine.stretch - coarse.stretch
        return Correction(factor, shift, stretch if np.isfinite(stretch) else 0.0)

    def applied(self, coarse: Numbers) -> Numbers:
        """Coarse numbers as the delivered law is expected to have them."""
        values, rates = self.factor * coarse.values + self.shift, self.factor[:, None] * coarse.rates
        return replace(coarse, values=values, rates=rates, stretch=coarse.stretch + self.stretch)


@dataclass
class Descent:
    """The search from one start: the design that it has come to."""

    history: History
    number: int
    coarse: Coarse
    point: Array
    numbers: Numbers  #: coarse
    trial: Trial
    first: Numbers  #: at the start
    sensitivity: tuple[float, Array]  #: with rates by the logarithms
    correction: Correction
    missing: Array  #: (m, n) what the slopes of the model lack
    law: str = COARSE  #: on which mesh

    @staticmethod
    def begin(history: History, number: int, start: Array) -> "Descent":
        """At a start. Raises `NotBorne`."""
        point, wishes = rounded(start), history.file.wishes
        history.context.progress.stage(f"start {number} on coarse cells")
        try:
            coarse = Coarse.of(history.file, point, history.context)
            numbers, sensitivity = coarse.numbers(point), coarse.sensitivity(point)
        except (NotBorne, NoArmLaw, InputError, DesignError) as failure:
            history.refuse(number, point, COARSE, str(failure))
            raise NotBorne(str(failure)) from None
        trial = history.tried(number, COARSE, point, numbers, sensitivity[0])
        history.record(trial)
        same, missing = Correction.none(wishes), np.zeros_like(numbers.rates)
        return Descent(history, number, coarse, point, numbers, trial, numbers, sensitivity, same, missing)

    def refine(self) -> None:
        """Go over to the mesh on which the delivered law is measured. Raises `NotBorne`."""
        if self.law == FINE or self.history.file.start.accuracy is None:
            return
        self.history.context.progress.stage(f"start {self.number} on the mesh of the law")
        try:
            self.coarse = Coarse.of(self.history.file, self.point, self.history.context, is_fine=True)
            self.numbers, self.sensitivity = self.coarse.numbers(self.point), self.coarse.sensitivity(self.point)
        except (NotBorne, NoArmLaw, InputError, DesignError) as failure:
            self.history.refuse(self.number, self.point, FINE, str(failure))
            raise NotBorne(str(failure)) from None
        self.law = FINE
        self.trial = self._tried(self.point, self.numbers, self.sensitivity[0])
        self.history.record(self.trial)

    def correct(self, correction: Correction) -> None:
        """Take the numbers for those of the delivered law."""
        self.correction = correction
        self.trial = self._tried(self.point, self.numbers, self.sensitivity[0])

    def is_within(self, part: float) -> bool:
        """Whether no wish is missed by more than this part of its tolerance, and every limit is kept."""
        return max(self.trial.misses) <= part and all(ratio <= 1.0 for ratio in self.trial.limits)

    def descend(self, until: tuple[float, float]) -> None:
        """Steps until the wishes are nearly met, or none is better.

        until: part of its tolerance within which every wish is near enough, and least gain of a step over the merit.
        """
        near, least = until
        radius = RADIUS
        for _ in range(TRIALS):
            if radius < SMALLEST or (self.is_within(near) and not self.history.file.wishes.minimize):
                return
            numbers = self.correction.applied(self.numbers)
            model = Model(self.history.file, self.point, numbers, self.sensitivity, self.missing)
            proposal = propose(model, radius)
            gain = self.trial.merit - proposal.merit
            if gain <= least * max(self.trial.merit, 1e-6):
                return
            ratio = self._try(rounded(proposal.point), gain)
            length = float(np.abs(np.log(proposal.point / model.point)).max())
            radius = radius if ratio >= POOR else 0.4 * length
            radius = min(2.0 * radius, LARGEST) if ratio > GOOD else radius

    def _try(self, point: Array, expected: float) -> float:
        """Go to a point if it is better; the gain over the expected one."""
        try:
            coarse = self._coarse_at(point)
            numbers = coarse.numbers(point)
            sensitivity = coarse.sensitivity(point)
        except (NotBorne, NoArmLaw, InputError, DesignError) as failure:
            self.history.refuse(self.number, point, self.law, str(failure))
            return -1.0
        if coarse is self.coarse and not np.array_equal(point, self.point):
            before, after = (
                (at, self.correction.applied(one)) for at, one in ((self.point, self.numbers), (point, numbers))
            )
            self.missing = missing_slopes(self.history.file.wishes, before, after, self.missing)
        trial = self._tried(point, numbers, sensitivity[0])
        gain = self.trial.merit - trial.merit
        self.history.record(replace(trial, taken=gain > 0.0))
        if gain > 0.0:
            self.coarse, self.point, self.numbers, self.trial = coarse, point, numbers, trial
            self.sensitivity = sensitivity
        return gain / expected

    def _coarse_at(self, point: Array) -> Coarse:
        """The coarse cells whose mesh follows to a point, or new ones."""
        config = self.history.file.config(point)
        if self.coarse.reaches(config, FARTHEST):
            return self.coarse
        return Coarse.of(self.history.file, point, self.history.context, is_fine=self.law == FINE)

    def _tried(self, point: Array, numbers: Numbers, sensitivity: float) -> Trial:
        corrected = self.correction.applied(numbers)
        return self.history.tried(self.number, self.law, point, corrected, sensitivity)
