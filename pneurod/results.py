"""What a run leaves, in Python: the values of the run, pandas frames with units in their columns, and its rods."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path

import pandas as pd

from pipeline.cell.saved import SavedLaw
from pipeline.errors import InputError, quoted
from pipeline.notes.verdict import Verdict, verdict_of
from pipeline.results.files import read_results as read_run
from pipeline.results.values import Effect, RodError, Run, State
from pipeline.rods.at_pressure import RodAtPressure
from pipeline.rods.checks import check_parameters
from pipeline.rods.saved import pressurised_rod
from pneurod.arguments import given_choice, given_path
from pneurod.frames import by_pressure, curves_frame, expanded, frame_of, profiles
from rod import PARAMETER_COLUMNS, ArmLaw, FiveParameters, Interval, OutsidePressures, PressurisedRod, Rod
from rod import RodError as NoRod
from rod.checked import finite
from rod.same_pressure import known_at
from rod.solution import RodSolution


@dataclass(frozen=True)
class Results:
    """Every result of `pneurod run`.

    A frame of something that the run did not reach has no rows. Units are in the column names (N, mm, rad, kPa;
    `kappa_per_mm`); NaN where a number does not exist.
    """

    run: Run = field(repr=False)  #: configuration, states, errors, effects and curves as frozen values

    @property
    def directory(self) -> Path:
        """The result folder."""
        return self.run.directory

    @property
    def length_mm(self) -> float:
        """Rest length of the material curve; NaN where the body was not meshed."""
        return self.run.length_mm

    @property
    def mass_g(self) -> float:
        """Mass of the solid; NaN where the configuration has no density."""
        mass = self.run.parameters.mass_g
        return math.nan if mass is None else mass

    @property
    def pressures_kPa(self) -> tuple[float, ...]:
        """The pressures that have five parameters, ascending."""
        return self.run.identified_kPa

    @property
    def report(self) -> Path:
        """The page with verdict, pictures and plots; it exists once the run has `finished`."""
        return self.directory / "report.html"

    @property
    def pictures(self) -> dict[str, Path]:
        """Name (body, II_17kPa) -> PNG file."""
        return {path.stem: path for path in sorted((self.directory / "pictures").glob("*.png"))}

    @cached_property
    def verdict(self) -> Verdict:
        """How far the arm bends, the rod to take and its errors, and what to do next; `verdict.lines` in words."""
        return verdict_of(self.run)

    @cached_property
    def parameters(self) -> pd.DataFrame:
        """One row per pressure: alpha1, alpha2, m01, m02, d with _std and 95 % interval, and how well they fit."""
        rest = self.run.parameters.kappa_0
        more = {"kappa_0_middle_per_mm": rest.middle_per_mm, "theta0_rad": rest.theta0_rad}
        return by_pressure(asdict(self.run.parameters) | more, self.pressures_kPa)

    @cached_property
    def extensible(self) -> pd.DataFrame:
        """The parameters of the rod whose curve stretches, with the eccentricity of its neutral axis."""
        content = self.run.parameters.eccentricity
        return by_pressure(asdict(content), self.pressures_kPa) if content else by_pressure({}, ())

    @cached_property
    def kappa_0(self) -> pd.DataFrame:
        """pressure_kPa, s_mm, kappa_0_per_mm: the curvature of the rod without load."""
        return profiles(self.run.parameters.kappa_0, self.pressures_kPa)

    @cached_property
    def dimensionless(self) -> pd.DataFrame:
        """M/(m g l) over (kappa - kappa_0) l by pressure."""
        return expanded([asdict(row) for row in self.run.parameters.dimensionless])

    @cached_property
    def experiments(self) -> pd.DataFrame:
        """One row per experiment (I, II, III) and pressure."""
        return frame_of(State, self.run.states)

    @cached_property
    def validation(self) -> pd.DataFrame:
        """Rods against finite elements: one row per load, pressure and rod."""
        return frame_of(RodError, self.run.rod_errors)

    @cached_property
    def effects(self) -> pd.DataFrame:
        """Which effects were simulated, and why."""
        return frame_of(Effect, self.run.effects)

    @cached_property
    def curves(self) -> pd.DataFrame:
        """Material curve of every experiment and pressure, with the curves of the rods beside it."""
        return curves_frame(self.directory / "curves.csv")

    @cached_property
    def validation_curves(self) -> pd.DataFrame:
        """Material curves under the loads that nothing was fitted to."""
        return curves_frame(self.directory / "validation_curves.csv")

    @cached_property
    def arm_law(self) -> ArmLaw | None:
        """The arm's own law; None where the folder has no law.json."""
        path = self.directory / "law.json"
        return SavedLaw.read(path).law if path.is_file() else None

    @property
    def curve_start_mm(self) -> tuple[float, float]:
        """x and y of the clamped end of the material curve in `curves` and `experiments`, mm; NaN without any.

        Rods begin at (0, 0): `shape.curve + results.curve_start_mm` lies on the curves of the finite elements.
        """
        clamped = self.run.curves_of("II")
        return (float(clamped[0]["x_mm"][0]), float(clamped[0]["y_mm"][0])) if clamped else (math.nan, math.nan)

    def law(self, pressure_kPa: float) -> FiveParameters:
        """The five parameters at an identified pressure. Raises InputError for another one."""
        row = self._row(pressure_kPa)
        return FiveParameters(*(float(row[name]) for name in PARAMETER_COLUMNS.values()))

    def interval(self, name: str, pressure_kPa: float) -> Interval:
        """alpha1, alpha2 (N mm2), m01, m02 (N mm) or d (mm) with its standard deviation and 95 % interval.

        Raises InputError for a pressure that was not identified or a name that is none of these.
        """
        if not isinstance(name, str) or name not in PARAMETER_COLUMNS:
            raise InputError(f"{quoted(name)} is no parameter of the rod; allowed: {', '.join(PARAMETER_COLUMNS)}")
        row, column = self._row(pressure_kPa), PARAMETER_COLUMNS[name]
        return Interval(*(float(row[f"{column}{ending}"]) for ending in ("", "_std", "_95_low", "_95_high")))

    def rod(self, pressure_kPa: float, *, extensible: bool | None = None, extrapolate: bool = False) -> Rod:
        """The rod with five parameters at a pressure; between identified pressures by cubics.

        Its origin is the clamped end of the material curve. extensible: the rod whose curve stretches; None for the one
        that stretches where the free curve is longer by more than 0.5 %. extrapolate: also outside the identified
        pressures. Raises InputError where nothing was identified, and outside these pressures. A rod with the arm's own
        law is `Rod(results.length_mm, law=results.arm_law.at(pressure))`.
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
            return RodAtPressure.of(rods, pressure_kPa, beyond).warning(shape)

    def _rods(self, extensible: bool | None) -> PressurisedRod:
        if not self.pressures_kPa:
            raise self._nothing_identified()
        content = asdict(self.run.parameters)
        rods = [pressurised_rod(content, stretching) for stretching in (False, True)]
        stretches = rods[1].stretches if extensible is None else given_choice(extensible, "extensible")
        return rods[1 if stretches else 0]

    def _row(self, pressure_kPa: float) -> "pd.Series":
        if not self.pressures_kPa:
            raise self._nothing_identified()
        try:
            pressure = finite(pressure_kPa, "The pressure in kPa")
        except NoRod as failure:
            raise InputError(str(failure)) from None
        known = known_at(self.pressures_kPa, pressure)
        if known is None:
            identified = ", ".join(f"{p:g}" for p in self.pressures_kPa)
            raise InputError(f"there are no parameters at {pressure:g} kPa; identified are {identified} kPa")
        return self.parameters.iloc[known]

    def _nothing_identified(self) -> InputError:
        reason = self.run.failure or "the run has not come to the identification"
        return InputError(f"{self.directory}: holds no parameters of a rod: {reason}")


def read_results(directory: Path | str) -> Results:
    """Every result in the folder of a run.

    A run that failed or was stopped has left some of them: frames of the others have no rows, and `run.failure` and
    `run.finished` say what happened. Raises InputError with one sentence for what is no path, and for a folder that
    does not exist, holds no result, or holds a file that cannot be read.
    """
    run = read_run(given_path(directory, "directory", "results/pneunet"))
    try:
        if run.parameters.pressures_kPa:
            check_parameters(asdict(run.parameters))
    except (KeyError, TypeError, ValueError) as failure:  # a file that was edited by hand
        raise InputError(f"{run.directory / 'parameters.json'}: {failure}") from None
    return Results(run)


@contextmanager
def _told() -> Iterator[None]:
    """Raise InputError for the error of a rod in the block."""
    try:
        yield
    except OutsidePressures as failure:
        raise InputError(f"{failure} Give extrapolate=True to go beyond it.") from None
    except NoRod as failure:
        raise InputError(str(failure)) from None
