"""Tests of several kinds beside each other: their ratio, and that of every law."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fem.materials import Material
from geometry.arrays import Array
from pipeline.answers.material.judged import Judged
from pipeline.answers.material.laws import STATES
from pipeline.answers.material.loading import TensileTest
from pipeline.answers.material.sentences import OF_ONE_BATCH, constants
from pipeline.values.table import Table

#: strains at which tests and laws are compared
STRAINS = np.array([0.2, 0.5, 1.0])
#: factor between tests of two kinds beyond what a law has from which one is wrong: specimens of a batch differ by less
APART = 1.0 + OF_ONE_BATCH
#: strain up to which a law has to describe the tests of one kind, to be asked about another one
DESCRIBED = 0.5
TOGETHER = "all tests"


@dataclass(frozen=True)
class Kinds:
    """Tests of several kinds, and laws that are fitted to all of them and to those of each kind."""

    tests: tuple[TensileTest, ...]
    together: Judged  #: the laws that are fitted to all tests
    alone: Mapping[str, Judged]  #: those fitted to one of several kinds, by kind; empty for one kind
    words: tuple[str, ...]  #: which kinds contradict each other
    given: Material | None = None  #: a law that stands beside

    @property
    def taken(self) -> Mapping[str, Judged]:
        """The laws to choose from: those fitted to all tests, or where these contradict each other, to each kind."""
        return self.alone if self.words else {TOGETHER: self.together}

    @property
    def table(self) -> Table:
        """The tests over each law at `STRAINS`, and the ratios between kinds; empty for one kind and no law beside."""
        kinds = list(self.alone) or [self.tests[0].state]
        if len(kinds) < 2 and self.given is None:
            return Table((), ())
        stresses = {kind: _stresses(self.tests, kind) for kind in kinds}
        ratios = [_told(stresses[kind] / stresses[kinds[0]]) for kind in kinds[1:]]
        rows = [("tests (kPa)", "", "", *(_told(1e3 * stresses[kind], ".3g") for kind in kinds), *ratios)]
        fits = [(TOGETHER, self.together), *self.alone.items()]
        laws = [(fit.name, of, constants(fit), fit.law) for of, judged in fits for fit in judged.laws]
        laws += [] if self.given is None else [("as given", "", "", self.given)]
        for *names, law in laws:
            over = [_told(stresses[kind] / _of(law, kind)) for kind in kinds]
            rows.append((*names, *over, *(_told(_of(law, kind) / _of(law, kinds[0])) for kind in kinds[1:])))
        heads = *(f"{kind} test over law" for kind in kinds), *(f"{kind} over {kinds[0]}" for kind in kinds[1:])
        at = ", ".join(f"{100 * strain:g}" for strain in STRAINS)
        caption = f"Stresses of the tests over those of each law, and of one kind over another, at strains of {at} %."
        return Table(("law", "fitted to", "constants (MPa)", *heads), tuple(rows), caption)


def contradictions(tests: Sequence[TensileTest], alone: Mapping[str, Judged]) -> Iterator[str]:
    """Which tests have no law that describes those of the first kind as well.

    Asked are the laws that describe these up to a strain of `DESCRIBED`; the nearest one counts.
    """
    first, *others = alone or [""]
    for kind in others:
        ratio = _stresses(tests, kind) / _stresses(tests, first)
        if not (known := np.isfinite(ratio)).any():
            continue
        needed = 1 + min(DESCRIBED, float(STRAINS[known][-1]))
        laws = [fit.law for fit in alone[first].usable if fit.high >= needed]
        factors = [float(np.median((ratio * _of(law, first) / _of(law, kind))[known])) for law in laws]
        factor = min(factors, key=lambda of: abs(np.log(of)), default=1.0)
        if not 1 / APART <= factor <= APART:
            yield (
                f"The {kind} test is {factor:.2g} times what any law says that describes the {first} one; one of them "
                "is wrong, or its grips count."
            )


def of_kind(tests: Sequence[TensileTest], kind: str) -> tuple[TensileTest, ...]:
    """The tests of a kind, or all."""
    return tuple(test for test in tests if kind in (test.state, TOGETHER))


def _stresses(tests: Sequence[TensileTest], kind: str) -> Array:
    """Mean stresses (3,) in MPa of the tests of a kind that reach `STRAINS` of their files; NaN where none does."""
    found = [
        np.interp(STRAINS - 1e-9, test.strain + test.slack, test.stress, np.nan, np.nan)
        for test in of_kind(tests, kind)
    ]
    known = [at[np.isfinite(at)] for at in np.transpose(found)]
    return np.array([at.mean() if len(at) else np.nan for at in known])


def _of(law: Material, kind: str) -> Array:
    """Nominal stresses (3,) of the incompressible body at `STRAINS`, MPa."""
    return law.incompressible(1 + STRAINS, STATES[kind](1 + STRAINS))


def _told(values: Array, form: str = ".2f") -> str:
    return ", ".join("-" if np.isnan(value) else f"{value:{form}}" for value in values)
