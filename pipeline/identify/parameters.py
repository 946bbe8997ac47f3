"""From centrelines to the five numbers per pressure, with a single line or two.

The criterion of one pressure depends on the mesh where a single line and two are close to each other, and alpha2 would
jump where the number of lines changes between two pressures. So the criteria are added over the pressures at which two
lines are possible: with independent errors the sum approximates twice the logarithm of the evidence for two lines at
all of these pressures against a single line at all, if each parameter is penalised with the observations of its own
pressure. The rod is given the numbers of a single line where it suffices (docs/identification.md gives the reasons).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from geometry import Centreline, Design, Reason
from pipeline.simulate.outcome import Outcomes, Record
from pipeline.simulate.scene import Scene
from pipeline.simulate.too_short import too_coarse, too_short
from pipeline.store.context import RunContext
from pipeline.store.parallel import TaskContext
from rod import (
    PARAMETER_COLUMNS,
    PARAMETER_NAMES,
    Closure,
    Curvature,
    Identification,
    Interval,
    Load,
    Moment,
    MomentRange,
    RodError,
    cell_averaged,
    end_displacement_closure,
    identify,
    is_clear,
    longest_break,
    moment_between,
    shortest_break,
    without_stretch,
)


def row_of(numbers: Mapping[str, Interval]) -> dict[str, float | tuple[float, float]]:
    """The five parameters by their columns in every table: value, standard deviation and 95 % interval of each."""
    row: dict[str, float | tuple[float, float]] = {}
    for name, column in PARAMETER_COLUMNS.items():
        number = numbers[name]
        row |= {column: number.value, f"{column}_std": number.std, f"{column}_95": (number.low, number.high)}
    return row


@dataclass(frozen=True)
class Parameters:
    """What is identified at a pressure: curvatures with and without load, moment, the five numbers."""

    pressure_kPa: float
    free: Record  #: experiment II
    loaded: Record  #: experiment III
    kappa_0: Curvature  #: cell-averaged, of II
    kappa: Curvature  #: cell-averaged, of III
    moment: Moment  #: of III without its stretch
    by_cells: Identification
    given_d: float | None = None  #: mm, the break where it was given; None where it was sought
    #: standard deviations due to the mesh by name; empty where they were not estimated
    mesh_std: Mapping[str, float] = field(default_factory=dict)
    #: relative errors of kappa_0(l/2), alpha2 and F due to the mesh, by name; empty where they were not estimated
    mesh_errors: Mapping[str, float] = field(default_factory=dict)
    #: kPa, the pressure at which those errors contain the difference from mixed elements; None where they do not
    mixed_at_kPa: float | None = None
    #: criterion of a single line minus that of two, summed over the pressures that are decided together; above zero it
    #: speaks for two
    evidence: float = 0.0
    #: whether two lines were chosen on the coarser mesh; None where there is none
    two_lines_on_coarser: bool | None = None
    #: whether the arm counts as one of equal cells; two lines then need walls that touch, or a given d
    equal_cells: bool = False

    @property
    def one_rigidity(self) -> bool:
        """Whether nothing but its ends makes one part of the arm different from another (`has_one_rigidity`)."""
        return has_one_rigidity(self.equal_cells, self.free, self.loaded)

    @property
    def two_lines(self) -> bool:
        """Whether the rod has two lines, and not a single one."""
        return takes_two_lines(self.evidence, self.one_rigidity, self.given_d is not None)

    @property
    def choice_is_clear(self) -> bool:
        """Whether the data decide between a single line and two, or need not."""
        return self.given_d is not None or self.one_rigidity or is_clear(self.evidence)

    @property
    def shortest_break(self) -> float:
        """The lower end of the range of d, mm; a d there means "at most that"."""
        return shortest_break(self.kappa.length, self.kappa.pitch)

    @property
    def longest_break(self) -> float:
        """The upper end of the range of d, mm; a d there means "at least that"."""
        return longest_break(self.kappa.length)

    @property
    def numbers(self) -> dict[str, Interval]:
        """alpha1, alpha2, m01, m02, d of the rod, with the error of the mesh where it was estimated."""
        numbers = self.numbers_without_mesh.items()
        return {name: number.widened(self.mesh_std.get(name, 0.0)) for name, number in numbers}

    @property
    def numbers_without_mesh(self) -> dict[str, Interval]:
        """The five numbers without the error of the mesh, which all pressures share: no scatter between them."""
        return self.numbers_of(self.by_cells)

    def numbers_of(self, identification: Identification) -> dict[str, Interval]:
        """The five numbers with as many lines as the rod has: those of a single line for both pieces where it suffices.

        Its rigidity and the second one of two lines are different numbers. It has no change of slope: d is then the
        lower end of its range.
        """
        line = identification.single_line
        d = Interval(self.shortest_break, 0.0, self.shortest_break, self.shortest_break)
        if self.two_lines:
            return {name: getattr(identification, name) for name in PARAMETER_NAMES}
        return {"alpha1": line.alpha, "alpha2": line.alpha, "m01": line.m0, "m02": line.m0, "d": d}

    @property
    def moment_range(self) -> MomentRange:
        """The moments of III, from which the parameters were identified."""
        return MomentRange.of(self.moment)


def counts_as_equal_cells(design: Design) -> bool:
    """Whether an arm consists of equal cells, or its curvature is averaged over less than the distance of its cavities:
    it then changes between a cavity and the wall beside it, which two lines would describe."""
    return design.repeats or design.averages_within_cavities


def has_one_rigidity(equal_cells: bool, free: Record, loaded: Record) -> bool:
    """Whether nothing but its ends makes one part of the arm different from another: equal cells, and in II and III no
    walls came within the activation distance of contact up to that pressure."""
    return equal_cells and not any("self_contact" in record.effects for record in (free, loaded))


def sum_evidence(evidence: Sequence[float], one_rigidity: Sequence[bool]) -> list[float]:
    """The evidence that decides at each pressure, from the evidence for two lines that each has alone.

    Where the rigidity may vary along the arm it is the sum over all such pressures. Elsewhere each keeps its own.
    """
    together = sum(own for own, is_one in zip(evidence, one_rigidity, strict=True) if not is_one)
    return [own if is_one else together for own, is_one in zip(evidence, one_rigidity, strict=True)]


def takes_two_lines(evidence: float, one_rigidity: bool, d_given: bool) -> bool:
    """Whether two lines are wanted, or worth their parameters by the criterion and not excluded by one rigidity."""
    return d_given or (evidence > 0.0 and not one_rigidity)


def decide_together(
    parameters: Sequence[Parameters], identified: Iterable[Identification] = ()
) -> tuple[Parameters, ...]:
    """The parameters of a run, with a single line or two by the evidence of all pressures, or by that of others."""
    lines = tuple(identified) or [p.by_cells for p in parameters]
    decisive = sum_evidence([one.evidence for one in lines], [p.one_rigidity for p in parameters])
    return tuple(replace(p, evidence=evidence) for p, evidence in zip(parameters, decisive, strict=True))


def identify_all(
    outcomes: Outcomes, pitch: float, d: float | None = None, *, equal_cells: bool, context: RunContext | None = None
) -> tuple[tuple[Parameters, ...], tuple[Reason, ...]]:
    """The parameters at every pressure reached in both II and III, and a reason for each where there are none.

    d: mm, the break where it is given and not sought. equal_cells: whether the arm counts as one of equal cells, so
    that two lines need walls that touch; False to choose by the criterion alone. context: of a run, whose workers take
    a pressure each.
    """
    results: list[Callable[[], Parameters]] = []
    for pair in outcomes.pairs:
        given = (*pair, pitch, d, equal_cells)
        results.append(
            partial(_identify, None, *given) if context is None else context.submit(_identify, *given).result
        )
    parameters, refused = [], []
    for (free, _), result in zip(outcomes.pairs, results, strict=True):
        try:
            parameters.append(result())
        except RodError as failure:
            why = str(failure).removesuffix(".")
            refused.append(Reason("not_identified", {"pressure_kPa": free.pressure_kPa, "why": why}))
    return decide_together(parameters), tuple(refused)


def _identify(
    context: TaskContext | None, free: Record, loaded: Record, pitch: float, d: float | None, equal_cells: bool
) -> Parameters:
    """A task."""
    curves = (free.centreline, loaded.centreline)
    moment, closure = _moment_and_closure(*curves, loaded.load)
    kappa_0, kappa = (cell_averaged(curve, pitch) for curve in curves)
    return Parameters(
        pressure_kPa=free.pressure_kPa,
        free=free,
        loaded=loaded,
        kappa_0=kappa_0,
        kappa=kappa,
        moment=moment,
        by_cells=identify(kappa_0, kappa, moment, closure, d=d),
        given_d=d,
        equal_cells=equal_cells,
    )


def numbers_of_curves(
    free: Centreline, loaded: Centreline, load: Load, pitch: float, d: float | None = None
) -> Identification:
    """The numbers from a curve without load and one under a load, with d (mm) if it is given. Raises RodError."""
    kappa_0, kappa = (cell_averaged(curve, pitch) for curve in (free, loaded))
    moment, closure = _moment_and_closure(free, loaded, load)
    return identify(kappa_0, kappa, moment, closure, d=d)


def _moment_and_closure(free: Centreline, loaded: Centreline, load: Load) -> tuple[Moment, Closure]:
    # levers of the curve without its stretch, for the rod that takes the numbers has none
    moment = moment_between(without_stretch(free), without_stretch(loaded), load)
    return moment, end_displacement_closure(free, loaded, load)


@dataclass(frozen=True)
class Identified:
    """The outcomes of a run and the parameters that follow from them."""

    outcomes: Outcomes
    parameters: tuple[Parameters, ...]  #: by ascending pressure
    refused: tuple[Reason, ...] = ()  #: why there are no parameters, or none at a pressure

    def failures(self, other_rod: bool) -> tuple[Reason, ...]:
        """What makes the run fail: a pressure without parameters only where there are no others and no other rod."""
        return () if self.parameters or other_rod else self.refused

    def remarks(self, other_rod: bool) -> tuple[Reason, ...]:
        """The other reasons."""
        return self.refused if self.parameters or other_rod else ()


def identify_run(scene: Scene, context: RunContext, outcomes: Outcomes) -> Identified:
    """The parameters at all pressures."""
    config = scene.config
    if reason := too_short(config) or too_coarse(config, scene.body):
        return Identified(outcomes, (), (reason,))
    equal, d = counts_as_equal_cells(config.design), config.identification.d_mm
    return Identified(outcomes, *identify_all(outcomes, scene.body.pitch, d, equal_cells=equal, context=context))
