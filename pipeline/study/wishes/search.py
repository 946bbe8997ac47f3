"""The search for a design: from several starts on coarse cells, then on those of a law, corrected by delivered laws."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import qmc

from geometry.arrays import Array
from pipeline.store.context import RunContext
from pipeline.study.wishes.measured import MovedMesh, NotBorne, Response, delivered
from pipeline.study.wishes.step import Model, Worth, propose
from pipeline.study.wishes.wish import WishFile, rounded

#: change of the logarithm of a dimension in one step: at first, at most, and where the search ends
RADIUS, LARGEST, SMALLEST = 0.2, 0.4, 3e-3
#: part of its tolerance within which every wish is near enough, and the least gain of a step over the merit, on coarse
#: cells and on fine ones
ROUGHLY, FINELY = (1.0, 0.1), (0.3, 0.05)
#: designs that are tried in a row without a delivered law at most, and delivered laws from one start
TRIALS, DELIVERED = 12, 4
#: miss over the tolerance beyond which no other delivered law of the same start is tried
HOPEFUL = 3.0
SEED = 1
COARSE, FINE, OF_LAW = "coarse", "fine", "delivered"


@dataclass(frozen=True, eq=False)  # arrays inside
class Trial:
    """One design that was tried."""

    start: int  #: from which the search came, from 1 on
    law: str  #: on which mesh: coarse, that of the configuration; fine, that of the law; or delivered
    point: Array  #: (n,) mm and kPa
    solved: Response
    numbers: Response  #: the same, corrected as delivered laws before were
    worth: Worth
    taken: bool = True  #: whether the search went on from here


@dataclass(frozen=True, eq=False)
class Refusal:
    """One design that has no numbers."""

    start: int
    law: str
    point: Array  #: (n,) mm and kPa
    reason: str


@dataclass(frozen=True)
class SearchResult:
    """The best design, with the numbers of its delivered law, and how it was found."""

    trial: Trial
    history: tuple[Trial | Refusal, ...]


@dataclass
class Search:
    """One search, and the designs that it has tried."""

    file: WishFile
    context: RunContext
    trials: list[Trial | Refusal] = field(default_factory=list)
    #: numbers (m,) and largest stretch of the last delivered law, and numbers of a moved mesh for the same design
    known: tuple[Array, float, Response] | None = None

    def run(self) -> SearchResult:
        """Search from several starts; raises `NotBorne` where no design has a law."""
        laws: list[Trial] = []
        reason = ""
        for number, start in enumerate(starts(self.file), start=1):
            try:
                mesh, last = self._descended(number, rounded(start), is_fine=False)
                if self.file.is_fine:
                    mesh, last = self._descended(number, last.point, is_fine=True)
                if not laws or last.worth.is_within(HOPEFUL):
                    laws += self._delivered(mesh, last)
            except NotBorne as failure:
                reason = str(failure)
            if any(law.worth.is_within(1.0) for law in laws) and not self.file.wishes.minimize:
                break
        if not laws:
            raise NotBorne(reason)
        return SearchResult(min(laws, key=lambda law: law.worth.merit), tuple(self.trials))

    def _descended(self, number: int, point: Array, *, is_fine: bool) -> tuple[MovedMesh, Trial]:
        """The design to which steps lead from a point, on a mesh of its own. Raises `NotBorne`."""
        self.context.progress.stage(f"start {number} on {'the mesh of the law' if is_fine else 'coarse cells'}")
        mesh, trial = self._measured(number, point, is_fine)
        self._record(trial)
        return self._improved(mesh, trial, *(FINELY if is_fine else ROUGHLY))

    def _measured(
        self, number: int, point: Array, is_fine: bool, near: MovedMesh | None = None
    ) -> tuple[MovedMesh, Trial]:
        """A design on the mesh of another one that is near enough, or on its own. Raises `NotBorne`."""
        law = FINE if is_fine else COARSE
        try:
            if near is None or not near.reaches(point):
                near = MovedMesh.of(self.file, point, self.context, is_fine=is_fine)
            return near, self._judged(number, law, point, near.numbers(point))
        except NotBorne as failure:
            self._record(Refusal(number, law, point, str(failure)))
            raise

    def _judged(self, number: int, law: str, point: Array, solved: Response) -> Trial:
        """With its numbers as the delivered law is expected to have them."""
        numbers, wishes = solved, self.file.wishes
        if self.known:
            values, stretch, before = self.known
            is_ratio = wishes.powers & (values * before.values > 0.0)
            ratio = np.where(is_ratio, values / np.where(is_ratio, before.values, 1.0), 1.0)
            numbers = replace(
                solved,
                values=values + ratio * (solved.values - before.values),
                rates=ratio[:, None] * solved.rates,
                by_stiffness=ratio * solved.by_stiffness,
                stretch=stretch + solved.stretch - before.stretch,
            )
        worth = Model(self.file, point, numbers).worth(np.log(point))
        return Trial(number, law, point, solved, numbers, replace(worth, misses=wishes.misses(numbers.values)))

    def _improved(self, mesh: MovedMesh, trial: Trial, near: float, least: float) -> tuple[MovedMesh, Trial]:
        """The design to which steps lead, until every wish is near enough or no step gains the least part of the
        merit."""
        radius = RADIUS
        for _ in range(TRIALS):
            if radius < SMALLEST or (trial.worth.is_within(near) and not self.file.wishes.minimize):
                break
            model = Model(self.file, trial.point, trial.numbers)
            point = rounded(propose(model, radius))
            gain = trial.worth.merit - model.worth(np.log(point)).merit
            if gain <= least * max(trial.worth.merit, 1e-6):
                break
            radius = 0.4 * float(np.abs(np.log(point / trial.point)).max())
            with suppress(NotBorne):
                reached, tried = self._measured(trial.start, point, mesh.is_fine, mesh)
                is_better = tried.worth.merit < trial.worth.merit
                self._record(replace(tried, taken=is_better))
                if is_better:
                    mesh, trial, radius = reached, tried, min(5.0 * radius, LARGEST)
        return mesh, trial

    def _delivered(self, mesh: MovedMesh, trial: Trial) -> list[Trial]:
        """Correct the numbers by those of the delivered law, until these are right; all designs with such a law.

        Raises `NotBorne` where there is none.
        """
        laws: list[Trial] = []
        for attempt in range(DELIVERED):
            self.context.progress.stage(f"law of the design {attempt + 1} that a run delivers")
            try:
                self.known = *delivered(self.file, trial.point, self.context), trial.solved
            except NotBorne as failure:
                self._record(Refusal(trial.start, OF_LAW, trial.point, str(failure)))
                if laws:
                    break
                raise
            law = self._judged(trial.start, OF_LAW, trial.point, trial.solved)
            self._record(law)
            laws.append(law)
            if law.worth.is_within(1.0) and (attempt or not self.file.wishes.minimize):
                break
            mesh, trial = self._improved(mesh, law, *FINELY)
            if trial is law or (attempt and not law.worth.is_within(HOPEFUL)):
                break
        return laws

    def _record(self, trial: Trial | Refusal) -> None:
        """Add to the history, and tell it."""
        self.trials.append(trial)
        free = zip(self.file.wishes.free, trial.point, strict=True)
        shown = ", ".join(f"{one.key.partition('.')[2]} {value:.4g} {one.unit}" for one, value in free)
        told = trial.reason if isinstance(trial, Refusal) else self._farthest(trial)
        self.context.progress.remark(f"{len(self.trials)}. {trial.law}: {shown}: {told}")

    def _farthest(self, trial: Trial) -> str:
        """The wish that is missed most."""
        misses, wishes = trial.worth.misses, self.file.wishes
        k = int(np.argmax(misses))
        value = wishes.wishes[k].text(wishes.parts(trial.numbers.values)[k])
        return f"{wishes.wishes[k].name} is {value}, {misses[k]:.3g} tolerances away"


def starts(file: WishFile) -> Iterator[Array]:
    """Points (n,): the given one, then those of a Latin hypercube of the logarithms."""
    wishes = file.wishes
    yield wishes.start
    if wishes.starts > 1:
        fractions = qmc.LatinHypercube(len(wishes.free), rng=np.random.default_rng(SEED)).random(wishes.starts - 1)
        low, high = np.log(wishes.bounds).T
        yield from np.exp(low + fractions * (high - low))
