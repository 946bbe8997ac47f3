"""From centrelines to the five numbers per pressure, by three estimators side by side.

Cell averages, a Gaussian process, and the rod that comes closest to shape and force. The rod is given the numbers of
the cell averages, or those of a single line where it suffices (docs/identification.md gives the reasons).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from geometry import Centreline
from pipeline.context import RunContext
from pipeline.identification.lines import Choice, choices, has_one_rigidity, takes_two_lines
from pipeline.parallel.worker import TaskContext
from pipeline.simulation.outcome import Outcomes, Record
from rod import (
    PARAMETER_NAMES,
    Closure,
    Curvature,
    Extension,
    FiveParameters,
    Identification,
    Interval,
    Load,
    LoadedShape,
    Moment,
    MomentRange,
    Observation,
    ParameterEstimate,
    Rod,
    RodError,
    RodFit,
    cell_averaged,
    end_displacement_closure,
    extension,
    fit_rod,
    gaussian_process,
    identify,
    is_clear,
    longest_break,
    moment_about_neutral_axis,
    moment_between,
    rest_curvature,
    shared_smoothing,
    shortest_break,
    without_stretch,
)

#: The estimator whose numbers the rod is given.
DEFAULT = "cell_averaged"


@dataclass(frozen=True)
class NoFit:
    """An estimator that gave no numbers at a pressure."""

    reason: str  #: a sentence


@dataclass(frozen=True)
class Parameters:
    """What is identified at a pressure: curvatures with and without load, moment, the numbers of three estimators."""

    pressure_kPa: float
    free: Record  #: experiment II
    loaded: Record  #: experiment III
    kappa_0: Curvature  #: cell-averaged, of II
    kappa: Curvature  #: cell-averaged, of III
    moment: Moment  #: of III without its stretch
    by_cells: Identification
    by_process: Identification  #: the same from a Gaussian process, for comparison
    extensible: Identification  #: from cell averages with the moment about the neutral axis, for the extensible rod
    extension: Extension  #: how the curve stretches: rest stretch and eccentricity
    bending_moment: Moment  #: of III about the neutral axis, with the levers of the stretched curve
    by_rod: RodFit | NoFit  #: the same from the closest rod
    given_d: float | None = None  #: mm, the break of all estimators where it was given; None where it was sought
    #: standard deviations due to the mesh by name; empty where they were not estimated
    mesh_std: Mapping[str, float] = field(default_factory=dict)
    #: relative errors of kappa_0(l/2), alpha2 and F due to the mesh, by name; empty where they were not estimated
    mesh_errors: Mapping[str, float] = field(default_factory=dict)
    #: kPa, the pressure at which those errors contain the difference from mixed elements; None where they do not
    mixed_at_kPa: float | None = None
    #: criterion of a single line minus that of two, summed over the pressures that are decided together; above zero it
    #: speaks for two (`pipeline.identification.lines`)
    evidence: float = 0.0
    #: whether two lines were chosen on the coarser mesh; None where there is none
    two_lines_on_coarser: bool | None = None
    #: whether the arm counts as one of equal cells; two lines then need walls that touch, or a given d
    equal_cells: bool = False

    @property
    def estimates(self) -> dict[str, ParameterEstimate | NoFit]:
        """The numbers by the name of their estimator, the default first."""
        return {DEFAULT: self.by_cells, "gaussian_process": self.by_process, "rod_fit": self.by_rod}

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
    def kappa_0_middle(self) -> float:
        """kappa_0(l/2), 1/mm, interpolated linearly between the cells nearest to the middle."""
        return float(np.interp(self.kappa_0.length / 2, self.kappa_0.s, self.kappa_0.kappa))

    @property
    def kappa_0_middle_std(self) -> float:
        """Standard deviation of kappa_0(l/2), 1/mm."""
        return float(np.interp(self.kappa_0.length / 2, self.kappa_0.s, self.kappa_0.kappa_std))

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
        return self._with_mesh(self.numbers_without_mesh)

    @property
    def numbers_without_mesh(self) -> dict[str, Interval]:
        """The same without the error of the mesh, which is common to all pressures and no scatter between them."""
        return self._of_rod(self.by_cells)

    @property
    def extensible_numbers(self) -> dict[str, Interval]:
        """The same of the rod whose curve stretches."""
        return self._with_mesh(self._of_rod(self.extensible))

    def _of_rod(self, identification: Identification) -> dict[str, Interval]:
        """The numbers of two lines, or those of a single line for both pieces where it suffices.

        A single line has no change of slope: d is then the lower end of its range.
        """
        line = identification.single_line
        d = Interval(self.shortest_break, 0.0, self.shortest_break, self.shortest_break)
        if self.two_lines:
            return {name: getattr(identification, name) for name in PARAMETER_NAMES}
        return {"alpha1": line.alpha, "alpha2": line.alpha, "m01": line.m0, "m02": line.m0, "d": d}

    def _with_mesh(self, numbers: Mapping[str, Interval]) -> dict[str, Interval]:
        return {name: number.widened(self.mesh_std.get(name, 0.0)) for name, number in numbers.items()}

    @property
    def rod(self) -> Rod:
        """The inextensible rod with the five numbers, clamped as the material curve begins in II."""
        return self._rod(self.numbers, None)

    @property
    def extensible_rod(self) -> Rod:
        """The rod whose curve stretches with its curvature."""
        return self._rod(self.extensible_numbers, self.extension)

    def _rod(self, numbers: Mapping[str, Interval], extension: Extension | None) -> Rod:
        theta0, profile = rest_curvature(self.free.centreline)
        curve = self.free.centreline
        law = FiveParameters(**{name: number.value for name, number in numbers.items()})
        start = (float(curve.x[0]), float(curve.y[0]))
        return Rod(
            curve.length,
            profile,
            law,
            theta0,
            start,
            extension=extension,
            weight=self.free.load.weight,
            weight_height=self.free.load.weight_height,
        )

    @property
    def moment_range(self) -> MomentRange:
        """The moments of III, from which the parameters were identified."""
        return MomentRange.of(self.moment)

    @property
    def extensible_moment_range(self) -> MomentRange:
        """The same of the rod whose curve stretches."""
        return MomentRange.of(self.bending_moment)


def decided_together(parameters: Iterable[Parameters]) -> tuple[Parameters, ...]:
    """The same at every pressure of a run, with a single line or two by the evidence of all of them."""
    parameters = tuple(parameters)
    chosen = choices_of([p.by_cells for p in parameters], parameters)
    return tuple(replace(p, evidence=choice.evidence) for p, choice in zip(parameters, chosen, strict=True))


def choices_of(identified: Sequence[Identification], parameters: Sequence[Parameters]) -> list[Choice]:
    """A single line or two for the numbers of an estimator, by pressure, decided as for the rod itself."""
    d_given = any(p.given_d is not None for p in parameters)  # at all pressures or at none
    return choices([e.evidence for e in identified], [p.one_rigidity for p in parameters], d_given)


def observed(parameters: Parameters, record: Record) -> Observation:
    """A loaded record at the pressure of the parameters as laws are compared on it. Raises RodError."""
    moment = moment_between(parameters.free.centreline, record.centreline, record.load)
    return Observation(parameters.kappa_0, cell_averaged(record.centreline, parameters.kappa.pitch), moment)


def identify_all(
    outcomes: Outcomes, pitch: float, d: float | None = None, *, equal_cells: bool
) -> tuple[tuple[Parameters, ...], tuple[str, ...]]:
    """The parameters at every pressure reached in both II and III, and a sentence for each where there are none.

    d: mm, the break where it is given and not sought. equal_cells: whether the arm counts as one of equal cells, so
    that two lines need walls that touch; False to choose by the criterion alone.
    """
    return _gathered(
        {pair[0].pressure_kPa: partial(_identified, *pair, pitch, d, equal_cells) for pair in outcomes.pairs}
    )


def identify_in_tasks(
    context: RunContext, outcomes: Outcomes, pitch: float, d: float | None = None, *, equal_cells: bool
) -> tuple[tuple[Parameters, ...], tuple[str, ...]]:
    """The same with a task for every pressure."""
    pending = {pair[0].pressure_kPa: context.submit(_task, *pair, pitch, d, equal_cells) for pair in outcomes.pairs}
    return _gathered({pressure: task.result for pressure, task in pending.items()})


def _gathered(by_pressure: Mapping[float, Callable[[], Parameters]]) -> tuple[tuple[Parameters, ...], tuple[str, ...]]:
    parameters, refused = [], []
    for pressure, identified in by_pressure.items():
        try:
            parameters.append(identified())
        except RodError as failure:
            refused.append(f"no five parameters at {pressure:g} kPa: {str(failure).removesuffix('.')}")
    return decided_together(parameters), tuple(refused)


def _task(
    context: TaskContext, free: Record, loaded: Record, pitch: float, d: float | None, equal_cells: bool
) -> Parameters:
    return _identified(free, loaded, pitch, d, equal_cells)


def _identified(free: Record, loaded: Record, pitch: float, d: float | None, equal_cells: bool) -> Parameters:
    curves = (free.centreline, loaded.centreline)
    moment, closure = _moment_and_closure(*curves, loaded.load)
    kappa_0, kappa = (cell_averaged(curve, pitch) for curve in curves)
    smoothing = shared_smoothing(curves, pitch)
    smooth_0, smooth = (gaussian_process(curve, smoothing) for curve in curves)
    by_cells = identify(kappa_0, kappa, moment, closure, d=d)
    by_process = identify(smooth_0, smooth, moment, closure, d=d)
    stretch = extension(*curves, pitch)
    bending_moment = moment_about_neutral_axis(*curves, loaded.load, stretch.eccentricity)
    return Parameters(
        pressure_kPa=free.pressure_kPa,
        free=free,
        loaded=loaded,
        kappa_0=kappa_0,
        kappa=kappa,
        moment=moment,
        by_cells=by_cells,
        by_process=by_process,
        extensible=identify(kappa_0, kappa, bending_moment, closure, d=d),
        extension=stretch,
        bending_moment=bending_moment,
        by_rod=_closest_rod(LoadedShape(*curves, loaded.load, pitch, loaded.held), d, (by_cells, by_process)),
        given_d=d,
        equal_cells=equal_cells,
    )


def numbers_of_cells(free: Record, loaded: Record, pitch: float, d: float | None = None) -> Identification:
    """The numbers of the default estimator alone, with d (mm) if it is given. Raises RodError."""
    return numbers_of_curves(free.centreline, loaded.centreline, loaded.load, pitch, d)


def numbers_of_curves(
    free: Centreline, loaded: Centreline, load: Load, pitch: float, d: float | None = None
) -> Identification:
    """The numbers of the default estimator from a curve without load and one under a load, with d (mm) if it is given.

    Raises RodError.
    """
    kappa_0, kappa = (cell_averaged(curve, pitch) for curve in (free, loaded))
    moment, closure = _moment_and_closure(free, loaded, load)
    return identify(kappa_0, kappa, moment, closure, d=d)


def _moment_and_closure(free: Centreline, loaded: Centreline, load: Load) -> tuple[Moment, Closure]:
    # levers of the curve without its stretch, for the rod that takes the numbers has none
    moment = moment_between(without_stretch(free), without_stretch(loaded), load)
    return moment, end_displacement_closure(free, loaded, load)


def _closest_rod(shape: LoadedShape, d: float | None, starts: Sequence[Identification]) -> RodFit | NoFit:
    breaks = None if d is None else (d / shape.length, d / shape.length)
    try:
        return fit_rod(shape, [start.law for start in starts], breaks=breaks)
    except RodError as failure:  # the other two estimators do not need an equilibrium
        return NoFit(str(failure))
