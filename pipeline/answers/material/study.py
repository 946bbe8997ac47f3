"""From tensile tests to a law: read, fit, judge."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fem.materials import MaterialError, StVenantKirchhoff
from pipeline.answers.material.hold import Hold, read_hold
from pipeline.answers.material.judged import Judged, Need, judge
from pipeline.answers.material.laws import Points
from pipeline.answers.material.loading import Selection, TensileTest, read_tensile
from pipeline.answers.material.sentences import doubts, doubts_of_given, facts, recommendation, yaml_line
from pipeline.answers.material.table import Specimen
from pipeline.config.units import AREA, DENSITY, LENGTH, STRAIN, Dimension
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

    @staticmethod
    def read(
        texts: dict[str, str | None], nu: float, cycle: int, run: Path | None, hold: Path | None = None
    ) -> "FitOptions":
        """From texts by the name of the argument. Raises InputError."""
        ask(argument("nu"), StVenantKirchhoff, 1.0, nu)

        def value(option: str, dimension: Dimension) -> float | None:
            text = texts.get(option)
            return None if text is None else _positive(option, text, dimension)

        value("density", DENSITY)
        return FitOptions(
            Specimen(value("length", LENGTH), value("area", AREA)),
            Selection(cycle, value("start", STRAIN)),
            USUAL if run is None else need_of(run),
            nu,
            texts.get("density"),
            hold,
        )


@dataclass(frozen=True)
class Material:
    """What tensile tests give."""

    options: FitOptions
    tests: tuple[TensileTest, ...]
    points: Points
    judged: Judged
    notes: tuple[str, ...]  #: sentences on what was left out, and what is most likely wrong with the data
    hold: Hold | None  #: of a specimen that was held

    @property
    def words(self) -> list[str]:
        """The recommendation and what else to know."""
        said = recommendation(self.judged, self.points, self.options.need)
        return [*said, *facts(self.judged, self.points), *(self.hold.words if self.hold else [])]

    @property
    def line(self) -> str:
        """The recommended law for a configuration."""
        line = yaml_line(self.judged.laws[0], self.options.density)
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
    tests = read_tensile(paths, options.specimen, options.selection)
    points = Points.of(tests)
    notes = (*doubts(tests, points), *doubts_of_given(options.nu, options.density, points.spread))
    try:
        judged = judge(points, options.need, options.nu)
    except MaterialError as failure:
        raise RunFailed("; ".join([f"no law can be fitted: {failure}", *notes])) from None
    return Material(options, tests, points, judged, notes, hold)


def _positive(option: str, text: str, dimension: Dimension) -> float:
    value = option_value(option, text, dimension)
    if value <= 0:
        raise InputError(
            f"{argument(option)}: {text} is not allowed; allowed: above zero, for example '{dimension.example}'"
        )
    return value
