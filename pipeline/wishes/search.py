"""The search for a design: steps on coarse cells from several starts, then the law that a run delivers."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import qmc

from geometry import DesignError
from geometry.arrays import Array
from pipeline.cell.pieces import NoArmLaw
from pipeline.context import RunContext
from pipeline.errors import InputError
from pipeline.wishes.measured import Coarse, NotBorne, Numbers, delivered
from pipeline.wishes.spec import WishFile, rounded
from pipeline.wishes.step import Model, exact_objective, exact_ratios, merit_of, missing_slopes, propose
from pipeline.wishes.wish import Wishes

#: change of the logarithm of a dimension in one step: at first, at most, and where the search ends
RADIUS, LARGEST, SMALLEST = 0.2, 0.4, 2e-3
#: relative change of a dimension beyond which the cell is meshed anew
FARTHEST = 0.25
#: designs that are tried from one start at most, and delivered laws at most
TRIALS, DELIVERED = 15, 4
#: part of its tolerance within which every wish is near enough, and the least gain over the merit: on the coarse mesh
#: and on that of the law
ROUGHLY, FINELY = (0.7, 0.1), (0.15, 0.01)
#: miss over the tolerance on the mesh of the law up to which the delivered law may still have every wish
HOPEFUL = 3.0
COARSE, FINE, DELIVERED_LAW = "coarse", "fine", "delivered"
#: part of the expected gain for a step that is as good as expected, and for one that is not
GOOD, POOR = 0.7, 0.25
SEED = 1


@dataclass(frozen=True)
class Trial:
    """One design that was tried."""

    start: int  #: from which the search came, from 1 on
    law: str  #: coarse: on the mesh of the configuration; fine: on that of the law; or delivered
    point: tuple[float, ...]  #: in mm and kPa
    values: tuple[float, ...]  #: of all wishes, one after the other; empty where the design has none
    misses: tuple[float, ...]  #: of each wish, over its tolerance
    limits: tuple[float, ...]  #: over 1 where one is exceeded
    objective: float  #: over that at the start; NaN where nothing is made small
    taken: bool  #: whether the search went on from here
    reason: str = ""  #: why it has no numbers

    @property
    def is_met(self) -> bool:
        """Whether it has every wish and keeps every limit."""
        return bool(self.values) and max(self.misses) <= 1.0 and all(ratio <= 1.0 for ratio in self.limits)

    @property
    def merit(self) -> float:
        """As `merit_of`; infinity where there are no numbers."""
        if not self.values:
            return np.inf
        return merit_of(np.array(self.misses), np.array(self.limits), self.objective)


@dataclass(frozen=True, eq=False)  # arrays inside
class Found:
    """The best design, its numbers from the delivered law, and how it was found."""

    trial: Trial
    numbers: Numbers
    first: Numbers | None  #: of the coarse law at the first start; None where that has none
    history: tuple[Trial, ...]


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
class Search:
    """One search, and the designs that it has tried."""

    file: WishFile
    context: RunContext
    history: list[Trial] = field(default_factory=list)

    def run(self) -> Found:
        """Search from several starts on coarse cells, and go on from the best one with the delivered law.

        Raises `NotBorne` where no design has a law.
        """
        ended: list[Descent] = []
        found: list[tuple[Trial, Numbers]] = []
        for number, start in enumerate(starts(self.file), start=1):
            try:
                descent = Descent.begin(self, number, start)
                descent.descend(ROUGHLY)
                descent.refine()
                descent.descend(FINELY)
            except NotBorne:
                continue
            ended.append(descent)
            if descent.is_within(HOPEFUL):
                found += self._delivered(descent)
            if any(trial.is_met for trial, _ in found) and not self.file.wishes.minimize:
                break
        if ended and not found:
            found = self._delivered(min(ended, key=lambda descent: descent.trial.merit))
        if not found:
            raise NotBorne(self.history[-1].reason or "no start has a law")
        trial, numbers = min(found, key=lambda pair: pair[0].merit)
        first = ended[0].first if ended[0].number == 1 else None
        return Found(trial, numbers, first, tuple(self.history))

    def _delivered(self, descent: "Descent") -> list[tuple[Trial, Numbers]]:
        """Correct the numbers by those of the delivered law, until these are right; all designs with such a law."""
        wishes, found = self.file.wishes, list[tuple[Trial, Numbers]]()
        for attempt in range(DELIVERED):
            self.context.progress.stage(f"law of the design {attempt + 1} that a run delivers")
            try:
                fine = delivered(self.file, descent.point, self.context)
            except NotBorne as failure:
                self.refuse(descent.number, descent.point, DELIVERED_LAW, str(failure))
                break
            trial = self.tried(descent.number, DELIVERED_LAW, descent.point, fine, descent.sensitivity[0])
            self.record(trial)
            found.append((trial, fine))
            if trial.is_met and (attempt or not wishes.minimize):
                break
            before = descent.point
            descent.correct(Correction.of(wishes, descent.numbers, fine))
            descent.descend(FINELY)
            if np.array_equal(descent.point, before):
                break
        return found

    def tried(self, start: int, law: str, point: Array, numbers: Numbers, sensitivity: float) -> Trial:
        """A design with its numbers."""
        wishes = self.file.wishes
        u, objective = np.log(point), np.nan
        if wishes.minimize:
            objective = sensitivity if wishes.minimize == "sensitivity" else exact_objective(self.file, u)
        limits = [float(ratio) for ratio in exact_ratios(self.file, u)]
        if wishes.limits.largest_stretch is not None:
            limits.append((numbers.stretch - 1.0) / (wishes.limits.largest_stretch - 1.0))
        values, misses = numbers.values, wishes.misses(numbers.values)
        return Trial(start, law, _floats(point), _floats(values), _floats(misses), tuple(limits), objective, taken=True)

    def record(self, trial: Trial) -> None:
        """Add to the history, and tell it."""
        self.history.append(trial)
        misses = f"largest miss {max(trial.misses):.3g} tolerances" if trial.misses else trial.reason
        shown = ", ".join(
            f"{one.key.partition('.')[2]} {value:.4g} {one.unit}"
            for one, value in zip(self.file.wishes.free, trial.point, strict=True)
        )
        self.context.progress.remark(f"{len(self.history)}. {trial.law}: {shown}: {misses}")

    def refuse(self, start: int, point: Array, law: str, reason: str) -> None:
        """Record a design without numbers."""
        self.record(Trial(start, law, _floats(point), (), (), (), np.nan, taken=False, reason=reason))


@dataclass
class Descent:
    """The search from one start: the design that it has come to."""

    search: Search
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
    def begin(search: Search, number: int, start: Array) -> "Descent":
        """At a start. Raises `NotBorne`."""
        point, wishes = rounded(start), search.file.wishes
        search.context.progress.stage(f"start {number} on coarse cells")
        try:
            coarse = Coarse.of(search.file, point, search.context)
            numbers, sensitivity = coarse.numbers(point), coarse.sensitivity(point)
        except (NotBorne, NoArmLaw, InputError, DesignError) as failure:
            search.refuse(number, point, COARSE, str(failure))
            raise NotBorne(str(failure)) from None
        trial = search.tried(number, COARSE, point, numbers, sensitivity[0])
        search.record(trial)
        same, missing = Correction.none(wishes), np.zeros_like(numbers.rates)
        return Descent(search, number, coarse, point, numbers, trial, numbers, sensitivity, same, missing)

    def refine(self) -> None:
        """Go over to the mesh on which the delivered law is measured. Raises `NotBorne`."""
        if self.law == FINE or self.search.file.start.accuracy is None:
            return
        self.search.context.progress.stage(f"start {self.number} on the mesh of the law")
        try:
            self.coarse = Coarse.of(self.search.file, self.point, self.search.context, is_fine=True)
            self.numbers, self.sensitivity = self.coarse.numbers(self.point), self.coarse.sensitivity(self.point)
        except (NotBorne, NoArmLaw, InputError, DesignError) as failure:
            self.search.refuse(self.number, self.point, FINE, str(failure))
            raise NotBorne(str(failure)) from None
        self.law = FINE
        self.trial = self._tried(self.point, self.numbers, self.sensitivity[0])
        self.search.record(self.trial)

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
            if radius < SMALLEST or (self.is_within(near) and not self.search.file.wishes.minimize):
                return
            numbers = self.correction.applied(self.numbers)
            model = Model(self.search.file, self.point, numbers, self.sensitivity, self.missing)
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
            self.search.refuse(self.number, point, self.law, str(failure))
            return -1.0
        if coarse is self.coarse and not np.array_equal(point, self.point):
            before, after = (
                (at, self.correction.applied(one)) for at, one in ((self.point, self.numbers), (point, numbers))
            )
            self.missing = missing_slopes(self.search.file.wishes, before, after, self.missing)
        trial = self._tried(point, numbers, sensitivity[0])
        gain = self.trial.merit - trial.merit
        self.search.record(replace(trial, taken=gain > 0.0))
        if gain > 0.0:
            self.coarse, self.point, self.numbers, self.trial = coarse, point, numbers, trial
            self.sensitivity = sensitivity
        return gain / expected

    def _coarse_at(self, point: Array) -> Coarse:
        """The coarse cells whose mesh follows to a point, or new ones."""
        config = self.search.file.config(point)
        if self.coarse.reaches(config, FARTHEST):
            return self.coarse
        return Coarse.of(self.search.file, point, self.search.context, is_fine=self.law == FINE)

    def _tried(self, point: Array, numbers: Numbers, sensitivity: float) -> Trial:
        corrected = self.correction.applied(numbers)
        return self.search.tried(self.number, self.law, point, corrected, sensitivity)


def starts(file: WishFile) -> Iterator[Array]:
    """Points (n,): the given one, then those of a Latin hypercube of the logarithms."""
    wishes = file.wishes
    yield wishes.start
    if wishes.starts > 1:
        fractions = qmc.LatinHypercube(len(wishes.free), rng=np.random.default_rng(SEED)).random(wishes.starts - 1)
        low, high = np.log(wishes.bounds).T
        yield from np.exp(low + fractions * (high - low))


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
