"""What a run leaves, as frozen values: pandas frames whose columns carry units, and the record of the run."""

import copyreg
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import pandas as pd

from pipeline.errors import InputError, quoted
from pipeline.report.verdict import Verdict
from pipeline.rods.at_pressure import RodAtPressure
from pneurod.arguments import given_choice
from rod import PARAMETER_COLUMNS, ArmLaw, FiveParameters, Interval, OutsidePressures, PressurisedRod, Rod, RodError
from rod.checked import finite
from rod.same_pressure import known_at
from rod.solution import RodSolution


def _read_only(content: dict[str, object]) -> MappingProxyType[str, object]:
    return MappingProxyType(content)


# Python has no way of its own to pickle or copy a read-only mapping; with this one results go to other processes.
copyreg.pickle(MappingProxyType, lambda mapping: (_read_only, (dict(mapping),)))


@dataclass(frozen=True)
class RunRecord:
    """With what a run was made, and how long it took (run.json).

    Where a run was stopped before its report, only `config` and `config_hash` are there: the texts are empty, the
    mappings too, and `finished` is false.
    """

    config: Mapping[str, object] = field(repr=False)  #: the whole configuration in mm, MPa, tonne/mm3 and kPa
    config_hash: str = field(repr=False)  #: sha256 of `config`
    version: str  #: of pneurod
    commit: str | None  #: of the sources, "+" at its end where files differ from it; None outside a clone
    python: str  #: version
    packages: Mapping[str, str | None] = field(repr=False)  #: distribution -> version
    machine: Mapping[str, object] = field(repr=False)  #: system, processor, cores, memory_GB
    seconds: Mapping[str, float] = field(repr=False)  #: stage -> wall time, s
    #: part of the solver -> time summed over the experiments, s
    solver_seconds: Mapping[str, float] = field(repr=False)
    factorizations: Mapping[str, int] = field(repr=False)  #: experiment -> count
    degrees_of_freedom: Mapping[str, int] = field(repr=False)  #: experiment -> count
    solver: tuple[str, ...]  #: linear solvers that were used
    stress_error: float  #: largest error indicator of all states, relative in energy; NaN where there is none
    #: what a requested accuracy led to; empty where none was requested
    accuracy: Mapping[str, object] = field(repr=False)
    failure: str  #: why the run could not reach everything, one sentence; empty where it did

    @property
    def finished(self) -> bool:
        """Whether the run came to its report; it may have a `failure` even so."""
        return bool(self.version)

    @property
    def name(self) -> str:
        """The name that the configuration gives the design."""
        return str(self.config.get("name", ""))


@dataclass(frozen=True)
class PressureSlopes:
    """beta = d alpha / d p over the range in which the law is linear in the pressure; NaN below two pressures."""

    beta1_N_mm2_per_kPa: float
    beta1_N_mm2_per_kPa_std: float
    beta2_N_mm2_per_kPa: float
    beta2_N_mm2_per_kPa_std: float
    linear_range_kPa: tuple[float, float]  #: (NaN, NaN) where there is none: beta is then over all pressures
    tested: bool  #: there are more than two pressures in the range; a line always goes through two


@dataclass(frozen=True)
class Results:
    """Every result of `pneurod run`.

    A frame of something that the run did not reach has no rows, and still its main columns. Units are in the column
    names (N, mm, rad, kPa; `kappa_per_mm`); NaN where a number does not exist. Frames belong to the caller: changing
    one changes no file.
    """

    directory: Path
    run: RunRecord
    #: the five parameters as they are written, the rod to take, and in sentences its errors, what was simulated and
    #: why, the error of the mesh, what was not tested and what to do next; the report begins with it
    verdict: Verdict = field(repr=False)
    length_mm: float  #: rest length of the material curve; NaN where the identification was not reached
    mass_g: float  #: of the solid; NaN as above
    slopes: PressureSlopes
    mesh_error_reason: (
        str  #: why the error of the mesh could not be estimated; empty where it was, or was not requested
    )
    #: one row per pressure: alpha1, alpha2, m01, m02, d, each with _std and the ends of its 95 % interval, and how well
    #: two lines and a single line describe the data
    parameters: pd.DataFrame = field(repr=False)
    extensible: pd.DataFrame = field(repr=False)  #: the same of the rod whose curve stretches, with its eccentricity
    estimators: pd.DataFrame = field(repr=False)  #: the five parameters by every estimator, one row each and pressure
    kappa_0: pd.DataFrame = field(repr=False)  #: pressure_kPa, s_mm, kappa_0_per_mm, rest_stretch: the rod's profile
    kappa_0_cells: pd.DataFrame = field(repr=False)  #: the same averaged over one cell of the arm
    linearity: pd.DataFrame = field(repr=False)  #: quantities over the pressure against their straight lines
    break_profile: pd.DataFrame = field(repr=False)  #: pressure_kPa, d_mm, rms_per_mm: residual over the position of d
    dimensionless: pd.DataFrame = field(repr=False)  #: M/(m g l) over (kappa - kappa_0) l by pressure
    experiments: pd.DataFrame = field(repr=False)  #: one row per experiment (I, II, III) and pressure
    curves: pd.DataFrame = field(repr=False)  #: material curve of every experiment and pressure, the rod's beside it
    validation: pd.DataFrame = field(repr=False)  #: rods against finite elements: a row per load, pressure and rod
    validation_curves: pd.DataFrame = field(repr=False)  #: as `curves`, for the loads that nothing was fitted to
    effects: pd.DataFrame = field(repr=False)  #: which effects were simulated, and why
    rods: tuple[PressurisedRod, ...] = field(repr=False)  #: inextensible and extensible rod over the pressure, or none
    arm_law: ArmLaw | None = field(repr=False)  #: the arm's own law, where the folder has a law.json
    pictures: Mapping[str, Path] = field(repr=False)  #: name (body, II_17kPa) -> PNG file

    @property
    def pressures_kPa(self) -> tuple[float, ...]:
        """The pressures that have five parameters, ascending."""
        return tuple(self.parameters["pressure_kPa"].tolist())

    @property
    def report(self) -> Path:
        """The page with everything in words, pictures and plots; it exists once the run has `finished`."""
        return self.directory / "report.html"

    @property
    def curve_start_mm(self) -> tuple[float, float]:
        """x and y of the clamped end of the material curve in `curves` and `experiments`, mm; NaN without any.

        Rods begin at (0, 0): `shape.curve + results.curve_start_mm` lies on the curves of the finite elements.
        """
        clamped = self.curves[(self.curves["experiment"] == "II") & (self.curves["s_mm"] == 0.0)]
        if clamped.empty:
            return math.nan, math.nan
        return float(clamped["x_mm"].iloc[0]), float(clamped["y_mm"].iloc[0])

    def law(self, pressure_kPa: float) -> FiveParameters:
        """The five parameters at an identified pressure. Raises InputError for another one."""
        row = self._row(pressure_kPa)
        return FiveParameters(*(float(row[name]) for name in COLUMNS))

    def interval(self, name: str, pressure_kPa: float) -> Interval:
        """alpha1, alpha2 (N mm2), m01, m02 (N mm) or d (mm) with its standard deviation and 95 % interval.

        Raises InputError for a pressure that was not identified or a name that is none of these.
        """
        if not isinstance(name, str) or name not in PARAMETER_COLUMNS:
            raise InputError(f"{quoted(name)} is no parameter of the rod; allowed: {', '.join(PARAMETER_COLUMNS)}")
        row, column = self._row(pressure_kPa), PARAMETER_COLUMNS[name]
        return Interval(*(float(row[f"{column}{ending}"]) for ending in ("", "_std", "_95_low", "_95_high")))

    def rod(self, pressure_kPa: float, *, extensible: bool | None = None, extrapolate: bool = False) -> Rod:
        """The rod at a pressure; between identified ones by cubics.

        Its origin is the clamped end of the material curve, which is at `curve_start_mm` in `curves`; end_y = 0 is the
        height of experiment III with `end: {y: 0 mm}`.

        extensible: the rod whose curve stretches; None for the one that stretches where the free curve of the arm is
        longer by more than 0.5 %. extrapolate: also outside the identified pressures, down to 0 kPa and up by half of
        their range, see `rod.PressurisedRod.at`. Raises InputError where nothing was identified, outside these
        pressures, and for arguments of another type. A rod with the arm's own law is
        `Rod(length, law=results.arm_law.at(pressure))`. What a load may be is told by `warning`.
        """
        rods, beyond = self._rods(extensible), given_choice(extrapolate, "extrapolate")
        with _told():
            return rods.at(pressure_kPa, extrapolate=beyond)

    def warning(
        self, pressure_kPa: float, shape: RodSolution, *, extensible: bool | None = None, extrapolate: bool = False
    ) -> str:
        """What to know where the moments of a shape of the rod leave those of its identification; else empty.

        shape: from `rod(...).solve(...)` with the same other arguments. Raises as `rod`.
        """
        if not isinstance(shape, RodSolution):
            raise InputError(f"shape: {quoted(shape)} is no shape of a rod; give what the `solve` of a rod returns")
        rods, beyond = self._rods(extensible), given_choice(extrapolate, "extrapolate")
        with _told():
            selected = RodAtPressure.of(rods, pressure_kPa, beyond)
        return selected.warning(shape)

    def _rods(self, extensible: bool | None) -> PressurisedRod:
        if not self.rods:
            raise self._nothing_identified()
        stretches = self.rods[1].stretches if extensible is None else given_choice(extensible, "extensible")
        return self.rods[1 if stretches else 0]

    def _row(self, pressure_kPa: float) -> "pd.Series":
        if not len(self.parameters):
            raise self._nothing_identified()
        try:
            pressure = finite(pressure_kPa, "The pressure in kPa")
        except RodError as failure:
            raise InputError(str(failure)) from None
        known = known_at(self.pressures_kPa, pressure)
        if known is None:
            identified = ", ".join(f"{p:g}" for p in self.pressures_kPa)
            raise InputError(f"there are no parameters at {pressure:g} kPa; identified are {identified} kPa")
        return self.parameters.iloc[known]

    def _nothing_identified(self) -> InputError:
        reason = self.run.failure or "the run has not come to the identification"
        return InputError(f"{self.directory}: holds no parameters of a rod: {reason}")


@contextmanager
def _told() -> Iterator[None]:
    """Raise InputError for the error of a rod in the block."""
    try:
        yield
    except OutsidePressures as failure:
        raise InputError(f"{failure} Give extrapolate=True to go beyond it.") from None
    except RodError as failure:
        raise InputError(str(failure)) from None


#: the five parameters -> their columns
COLUMNS = tuple(PARAMETER_COLUMNS.values())
