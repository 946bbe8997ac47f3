"""From tensile tests to a law: read, fit, judge."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fem.materials import Material as SolidLaw
from fem.materials import MaterialError, StVenantKirchhoff
from pipeline.answers.material.hold import Hold, read_hold
from pipeline.answers.material.judged import Judged, LawFit, Need, judge
from pipeline.answers.material.kinds import Kinds, contradictions, of_kind
from pipeline.answers.material.laws import STATES, Points
from pipeline.answers.material.loading import Selection, TensileTest, read_tensile
from pipeline.answers.material.sentences import (
    NOT_IN_LAWS,
    beyond,
    doubts,
    doubts_of_given,
    facts,
    recommendation,
    yaml_line,
)
from pipeline.answers.material.table import Specimen
from pipeline.config import units
from pipeline.config.document import read_document
from pipeline.config.load import checked
from pipeline.results.files import read_results
from pipeline.results.options import option_value
from pipeline.values.errors import InputError, RunFailed, argument, ask

#: stretches that arms reach (docs/materials.md), where no run says others
USUAL = Need(0.7, 2.0)
#: a specimen of unknown size, and the first loading
ANY, FIRST = Specimen(), Selection()
#: by how much stretches that a run needs are widened, in their logarithm, and the least that is asked for
WIDER, LEAST = 1.1, (0.9, 1.15)


@dataclass(frozen=True)
class FitOptions:
    """How tests are read and laws are judged, checked."""

    specimen: Specimen = ANY
    selection: Selection = FIRST
    need: Need = USUAL
    nu: float = 0.495  #: Poisson ratio of the laws that have one; it gives the others their kappa
    density: str | None = None  #: as written, for the configuration; None where it is not given
    hold: Path | None = None  #: a file of a specimen that is held
    kinds: tuple[str, ...] = ()  #: states of the tests of each file, or of all; without any, as the files say
    given: SolidLaw | None = None  #: a law that stands beside the tests

    @staticmethod
    def read(
        texts: dict[str, str | None], nu: float, cycle: int, run: Path | None, hold: Path | None = None,
        kinds: Sequence[str] = (),
    ) -> "FitOptions":  # fmt: skip
        """From texts by the name of the argument; run: results, or a configuration. Raises InputError."""
        if wrong := [kind for kind in kinds if kind not in STATES]:
            raise InputError(f"{argument('kind', wrong[0])}: is not known; allowed: {', '.join(STATES)}")
        config = checked(read_document(run, ())) if run and run.suffix in (".yaml", ".yml") else None
        ask(argument("nu"), StVenantKirchhoff, 1.0, nu)

        def value(option: str, dimension: units.Dimension) -> float | None:
            if (text := texts.get(option)) is None:
                return None
            if (found := option_value(option, text, dimension)) <= 0:
                allowed = f"allowed: above zero, for example '{dimension.example}'"
                raise InputError(f"{argument(option)}: {text} is not allowed; {allowed}")
            return found

        value("density", units.DENSITY)
        return FitOptions(
            Specimen(value("length", units.LENGTH), value("area", units.AREA)),
            Selection(cycle, value("start", units.STRAIN)),
            USUAL if run is None or config else need_of(run),
            nu,
            texts.get("density"),
            hold,
            tuple(kinds),
            config.material.built() if config else None,
        )


@dataclass(frozen=True)
class Material:
    """What tests give."""

    options: FitOptions
    tests: tuple[TensileTest, ...]
    kinds: Kinds
    notes: tuple[str, ...]  #: sentences on what was left out, and what is most likely wrong with the data
    hold: Hold | None  #: of a specimen that was held

    @property
    def judged(self) -> Judged:
        """The laws fitted to all tests, or where these contradict each other, to those of the first kind."""
        return next(iter(self.kinds.taken.values()))

    @property
    def words(self) -> list[str]:
        """The recommendation and what else to know, of each kind of test where these contradict each other."""
        said = list(self.kinds.words)
        for kind, judged in self.kinds.taken.items():
            points = Points.of(of_kind(self.tests, kind))
            said += [f"{kind.capitalize()} test alone:"] if self.kinds.words else []
            said += [*recommendation(judged, points, self.options.need), *facts(judged, points)]
        return [*said, NOT_IN_LAWS, *(self.hold.words if self.hold else [])]

    @property
    def lines(self) -> list[str]:
        """The recommended law for a configuration; of each kind of test where these contradict each other."""
        lines = []
        for kind, judged in self.kinds.taken.items():
            lines += [f"# {kind} test alone"] if self.kinds.words else []
            lines += [self._line(fit) for fit in judged.usable[:1]]
            if other := beyond(judged):
                lines += [f"# beside it, where walls stretch beyond {judged.laws[0].high:.3g}", self._line(other)]
        return lines

    @property
    def points(self) -> Points:
        """The points of all tests."""
        return Points.of(self.tests)

    def _line(self, fit: LawFit) -> str:
        line = yaml_line(fit, self.options.density)
        return f"{line.removesuffix('}')}, {self.hold.written}}}" if self.hold and self.hold.g else line


def need_of(run: Path) -> Need:
    """The stretches that an arm has reached in a run, and a little more. Raises InputError."""
    states = read_results(run).states
    reached = np.array([(state.min_stretch, state.max_stretch) for state in states])
    if not np.isfinite(reached).all() or not len(reached):
        raise InputError(f"{run}: has no states with stretches; give the folder of a finished run")
    low, high = reached[:, 0].min() ** WIDER, reached[:, 1].max() ** WIDER
    return Need(float(min(low, LEAST[0])), float(max(high, LEAST[1])))


def fit_tests(paths: Sequence[Path], options: FitOptions) -> Material:
    """Read, fit and judge. Raises InputError, and RunFailed where no law has constants for the tests."""
    hold = read_hold(options.hold) if options.hold else None
    kinds = options.kinds * len(paths) if len(options.kinds) == 1 else options.kinds
    if len(kinds) not in (0, len(paths)):
        raise InputError(
            f"{argument('kind')}: {len(kinds)} are given for {len(paths)} files; give one, or one for each"
        )
    tests = read_tensile(paths, options.specimen, options.selection, kinds)
    points = Points.of(tests)
    notes = (*doubts(tests, points), *doubts_of_given(options.nu, options.density, points.spread))
    try:
        states = [state for state in STATES if of_kind(tests, state)]
        each = {state: Points.of(of_kind(tests, state)) for state in states if len(states) > 1}
        alone = {state: judge(of, options.need, options.nu) for state, of in each.items()}
        words = tuple(contradictions(tests, alone))
        together = judge(points, options.need, options.nu, is_narrowed=not words)
    except MaterialError as failure:
        raise RunFailed("; ".join([f"no law can be fitted: {failure}", *notes])) from None
    return Material(options, tests, Kinds(tests, together, alone, words, options.given), notes, hold)
