"""What a run leaves, in Python: the values of the run, pandas frames with units in their columns, and its rods."""

import math
import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from functools import cached_property, partial
from pathlib import Path

import pandas as pd

from pipeline.answers.rods import choice, end_loads, export, motion, pressures
from pipeline.answers.rods.budget import budget_of
from pipeline.answers.rods.choice import run_along
from pipeline.answers.rods.in_time import in_time
from pipeline.answers.rods.poses import Hand
from pipeline.answers.rods.rods import Rods
from pipeline.api import frames
from pipeline.api.course import given_choice, given_path
from pipeline.api.rods import move
from pipeline.config import units
from pipeline.results.files import read_results as read_run
from pipeline.results.options import option_pressures, option_value
from pipeline.results.verdict import Verdict, verdict_of
from pipeline.show import figures
from pipeline.values import plots
from pipeline.values.errors import InputError, ask, quoted
from pipeline.values.run import Effect, RodError, Run, State
from rod import PARAMETER_COLUMNS, FiveParameters, Interval, Loading, Rod, RodWarning
from rod.arm_law.kinds import Law
from rod.in_time.move import MovingArm
from rod.same_pressure import known_at


class Plots:
    """The plots of one run. Each raises InputError where the run has nothing to draw."""

    def __init__(self, run: Run) -> None:
        self._run = run

    def angle(self) -> "plots.Figure":
        """Bending angle over pressure and path of the tip: finite elements, and the rod to take with its error."""
        return self._drawn(figures.bending(self._run), "states of experiment II")

    def shape(self, experiment: str = "II") -> "plots.Figure":
        """Material curve and its curvature in experiment I, II or III: finite elements and rods."""
        if experiment not in figures.EXPERIMENTS:
            raise InputError(f"experiment: {quoted(experiment)} is none; allowed: I, II, III")
        return self._drawn(figures.of_experiment(self._run, experiment), f"states of experiment {experiment}")

    def force(self) -> "plots.Figure":
        """Force that holds the end at a height, the blocked force, over pressure: finite elements and rods."""
        return self._drawn(figures.end_forces(self._run), "loads of its validation with a held end")

    def law(self) -> "plots.Figure":
        """Moment of a cell over its curvature, and the finite elements of the whole arm."""
        return self._drawn(figures.arm_law(self._run), "law of its own")

    def moments(self) -> "plots.Figure":
        """Moment over change of curvature in experiment III: finite elements, and the rod with five parameters."""
        return self._drawn(figures.moments(self._run), "five parameters")

    def _drawn(self, panels: figures.Panels, what: str) -> "plots.Figure":
        if not panels:
            raise InputError(f"{self._run.directory}: this run has no {what}")
        return plots.plotly_figure(panels)


@dataclass(frozen=True)
class Results:
    """Every result of `pneurod run`.

    A frame of something that the run did not reach has no rows. Units are in the column names (N, mm, rad, kPa;
    `kappa_per_mm`); NaN where a number does not exist.
    """

    run: Run = field(repr=False)  #: configuration, states, errors, effects and curves as frozen values
    _rods: dict[str | None, Rods] = field(default_factory=dict, init=False, repr=False, compare=False)

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
        if mass is None and (law := self.arm_law) is not None and law.mass is not None:  # a run with its law alone
            mass = float(law.mass.grams[-1])
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

    def __repr__(self) -> str:
        return f"Results({str(self.directory)!r})"

    def __str__(self) -> str:
        return f"{self.verdict}"

    @property
    def plot(self) -> Plots:
        """Plots as figures of plotly: `results.plot.angle()`, `.shape("III")`, `.force()`, `.law()`, `.moments()`."""
        return Plots(self.run)

    @cached_property
    def hand(self) -> Hand:
        """The arm that bends under sliders of its pressures and where its tip is dragged: a notebook shows it.

        `str(results.hand)` is the page. Raises InputError where the results have no rod.
        """
        self._chosen(None)
        return Hand.of(self.run)

    def _repr_html_(self) -> str:
        """Verdict and five parameters, for notebooks."""
        columns = ["pressure_kPa", *PARAMETER_COLUMNS.values()]
        table = "" if self.parameters.empty else self.parameters[columns].to_html(index=False, float_format="%.4g")
        return f"{self.verdict._repr_html_()}{table}"

    @cached_property
    def verdict(self) -> Verdict:
        """How far the arm bends, the rod to take and its errors, and what to do next; `verdict.lines` in words."""
        return verdict_of(self.run)

    @cached_property
    def parameters(self) -> pd.DataFrame:
        """One row per pressure: alpha1, alpha2, m01, m02, d with _std and 95 % interval, and how well they fit."""
        rest = self.run.parameters.kappa_0
        more = {"kappa_0_middle_per_mm": rest.middle_per_mm, "theta0_rad": rest.theta0_rad}
        return frames.by_pressure(asdict(self.run.parameters) | more, self.pressures_kPa)

    @cached_property
    def kappa_0(self) -> pd.DataFrame:
        """pressure_kPa, s_mm, kappa_0_per_mm: the curvature of the rod without load."""
        return frames.profiles(self.run.parameters.kappa_0, self.pressures_kPa)

    @cached_property
    def experiments(self) -> pd.DataFrame:
        """One row per experiment (I, II, III) and pressure."""
        return frames.frame_of(State, self.run.states)

    @cached_property
    def validation(self) -> pd.DataFrame:
        """Rods against finite elements: one row per load, pressure and rod."""
        return frames.frame_of(RodError, self.run.rod_errors)

    @cached_property
    def effects(self) -> pd.DataFrame:
        """Which effects were simulated, and why."""
        return frames.frame_of(Effect, self.run.effects)

    @cached_property
    def curves(self) -> pd.DataFrame:
        """Material curve of every experiment and pressure, with the curves of the rods beside it."""
        return frames.curves_frame(self.directory / "curves.csv")

    @cached_property
    def validation_curves(self) -> pd.DataFrame:
        """Material curves under the loads that nothing was fitted to."""
        return frames.curves_frame(self.directory / "validation_curves.csv")

    @property
    def arm_law(self) -> Law | None:
        """The arm's own law, of one pressure, two, or more; None where the folder has no law.json."""
        return None if self.run.law is None else self.run.law.law

    def along(self, ratio: str) -> "Results":
        """The results in one ratio of the pressures, such as "1:0.5", where the arm's own law has several.

        Raises InputError for a ratio that it does not have.
        """
        return Results(run_along(self.directory, ratio))

    @cached_property
    def sensitivities(self) -> pd.DataFrame:
        """Derivatives of the arm's own law by its dimensions and materials, per unit of each, and relative: by how many
        % a number changes by 1 % of the parameter. No rows where the law has none."""
        return frames.sensitivities_frame(None if self.run.law is None else self.run.law.plane)

    def budget(self, pressure_kPa: float | str | None = None) -> pd.DataFrame:
        """What the tolerances of the built arm do at a pressure, the highest one unless it is given, in %.

        One row per tolerance, the largest first, then one for all. No rows where a law has no derivatives. Raises
        InputError outside its pressures.
        """
        pressure = None if pressure_kPa is None else option_value("pressure_kPa", pressure_kPa, units.PRESSURE)
        return frames.budget_frame(budget_of(self.run, pressure))

    @property
    def curve_start_mm(self) -> tuple[float, float]:
        """x and y of the clamped end of the material curve in `curves` and `experiments`, mm; NaN without any.

        Rods begin at (0, 0): `shape.curve + results.curve_start_mm` lies on the curves of the finite elements.
        """
        return (0.0, self.run.mesh.curve_height_mm) if self.run.mesh else (math.nan, math.nan)

    def law(self, pressure_kPa: float | str) -> FiveParameters:
        """The five parameters at an identified pressure. Raises InputError for another one."""
        row = self._row(pressure_kPa)
        return FiveParameters(*(float(row[name]) for name in PARAMETER_COLUMNS.values()))

    def interval(self, name: str, pressure_kPa: float | str) -> Interval:
        """alpha1, alpha2 (N mm2), m01, m02 (N mm) or d (mm) with its standard deviation and 95 % interval.

        Raises InputError for a pressure that was not identified or a name that is none of these.
        """
        if not isinstance(name, str) or name not in PARAMETER_COLUMNS:
            raise InputError(f"{quoted(name)} is no parameter of the rod; allowed: {', '.join(PARAMETER_COLUMNS)}")
        row, column = self._row(pressure_kPa), PARAMETER_COLUMNS[name]
        return Interval(*(float(row[f"{column}{ending}"]) for ending in ("", "_std", "_95_low", "_95_high")))

    def rod(
        self, pressure_kPa: float | str | Sequence[float | str], kind: str | None = None, *, after_snap: bool = False
    ) -> Rod:
        """The rod at a pressure, in kPa or written with its unit ("12 kPa"): the one that the verdict recommends.

        Of a law of several pressures give those of all cavities, (20.0, 5.0).

        kind: "law" for the arm's own law, "five" for the five parameters of the paper. Its origin is the clamped end of
        the material curve. after_snap: the swollen form of an arm that has two at this pressure.

        Warns with `RodWarning` where the rod is less certain than usual; its `notes`, and those of its shapes, say the
        same. Raises InputError outside its pressures, where the run has no such rod, and for an arm that leaves its
        plane.
        """
        choice.check_kind(kind, "kind")
        pressure = option_pressures("pressure_kPa", pressure_kPa)
        chosen = self._chosen(kind).wanted(after_snap=given_choice(after_snap, "after_snap"))
        rod = ask("", chosen.at, pressure)
        for note in rod.notes:
            warnings.warn(note, RodWarning, stacklevel=2)
        return rod

    def pressure_for(
        self,
        *,
        tip: Sequence[float | str] | None = None,
        angle: float | str | None = None,
        force: float | str | None = None,
        at_height: float | str | None = None,
        direction: str | Sequence[float] | None = None,
        tip_mass: float | str = 0.0,
        kind: str | None = None,
    ) -> pd.DataFrame:
        """Every pressure at which the end of the arm is as it is wanted, with the error that rod and mesh make of it.

        One row each, with units in the names of the columns. Give one of: tip, x and y (in space z) from the clamped
        end in mm; angle, by which the arm bends, in degrees; force, upwards on the end in N, that is held at_height,
        mm. Each may be a text with its unit ("30 mm").
        direction, tip_mass: as in `Rod.solve`. kind: as in `rod`. Raises InputError for what is out of reach, with the
        nearest that is not, and for a law of several pressures (`along`).
        """
        choice.check_kind(kind, "kind")
        wish = pressures.Wish.read(
            tip, angle, force, at_height, ask("", partial(Loading, direction=direction, tip_mass=tip_mass))
        )
        rods = self._chosen(kind)
        return frames.pressures_frame(pressures.pressures_for(rods, wish), tuple(rods.law.fractions))

    def export(self, to: str, out: Path | str | None = None, *, force: bool = False) -> tuple[Path, ...]:
        """Write the rod for another program, as `pneurod export` does: the files that were written.

        to: "mujoco", "pyelastica", "somo", "sorosim", "json" or "csv". out: their folder, by default that of the
        results. force: replace files that exist. Raises InputError for another format, a rod that it cannot take,
        and files that exist.
        """
        folder = None if out is None else given_path(out, "out", "results/arm")
        options = export.ExportOptions(out=folder, force=given_choice(force, "force"))
        return export.exported_run(self.run, to, options).files

    @cached_property
    def frequencies(self) -> pd.DataFrame:
        """One row per pressure: natural frequencies and damping ratios in the plane and across, settling and creep.

        No rows where the run has no rod over one pressure, or no mass.
        """
        with suppress(InputError):
            return pd.DataFrame(ask("", in_time, self.run, self._chosen(None)))
        return pd.DataFrame()

    def move(
        self,
        pressure: float | str | Path,
        seconds: float = 3.0,
        *,
        force: str | None = None,
        held_at: Sequence[str] = (),
        orientation: str | None = None,
        tip_mass: float | str | None = None,
        release: bool = False,
        air: str | None = None,
        rod: str | None = None,
        out: Path | str | None = None,
    ) -> pd.DataFrame:
        """The motion of the arm as motion.csv has it, which is written into the folder with a picture.

        All is as `pneurod.move` takes it, such as force="[0 N, 0.02 N]" and release=True. Raises as that does.
        """
        parts = [] if self.arm_law is None else self.arm_law.fractions.values()
        ratio = ":".join(map(str, parts)) if len(parts) > 1 else None
        moved = move(
            self, pressure, seconds=seconds, force=force, held_at=held_at, orientation=orientation, tip_mass=tip_mass,
            release=release, air=air, rod=rod, ratio=ratio, out=out,
        )  # fmt: skip
        return pd.DataFrame(dict(moved.columns))

    def moving(
        self,
        pressure: float | str | Sequence[float | str] = "0 kPa",
        *,
        force: str | None = None,
        held_at: Sequence[str] = (),
        orientation: str | None = None,
        tip_mass: float | str | None = None,
        in_space: bool = False,
        rod: str | None = None,
    ) -> MovingArm:
        """The arm at rest, to be moved in steps by a program, as a controller does; its time begins at 0 s.

        `motion.step(0.005, pressure_kPa=20.0, force=(0.0, 0.01))` moves it and says where it is (`rod.Instant`);
        `motion.copy()` is another one in the same state, and `motion.state` has all its arrays, and takes them back.
        pressure: kPa, one for each cavity of a law of several. in_space: whether it may leave its plane. All else is as
        `pneurod.move` takes it. Raises InputError for what cannot begin.
        """
        loading = end_loads.read_loading(orientation, tip_mass, force=force)
        is_free, rods = given_choice(in_space, "in_space"), self._chosen(rod)
        return motion.begin_motion(self.run, rods, pressure, loading, held_at=held_at, in_space=is_free)

    def _chosen(self, kind: str | None) -> Rods:
        if kind not in self._rods:
            self._rods[kind] = choice.choose_rod(self.run, kind)
        return self._rods[kind]

    def _row(self, pressure_kPa: float | str) -> "pd.Series":
        if not self.pressures_kPa:
            raise choice.nothing_identified(self.run)
        pressure = option_value("pressure_kPa", pressure_kPa, units.PRESSURE)
        known = known_at(self.pressures_kPa, pressure)
        if known is None:
            identified = ", ".join(f"{p:g}" for p in self.pressures_kPa)
            raise InputError(f"there are no parameters at {pressure:g} kPa; identified are {identified} kPa")
        return self.parameters.iloc[known]


def read_results(directory: Path | str) -> Results:
    """Every result in the folder of a run.

    A run that failed or was stopped has left some of them: frames of the others have no rows, and `run.failure` and
    `run.finished` say what happened. Raises InputError with one sentence for what is no path, and for a folder that
    does not exist, holds no result, or holds a file that cannot be read.
    """
    return Results(read_run(given_path(directory, "directory", "results/pneunet")))
