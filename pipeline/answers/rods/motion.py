"""The arm of a result folder in time: its pressure over time, what it does, and its files."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.answers.columns import Column, Form, read
from pipeline.answers.rods.end_loads import read_along
from pipeline.answers.rods.in_time import body_of
from pipeline.answers.rods.rods import Rods
from pipeline.config import units
from pipeline.results.options import option_pressures
from pipeline.store.owner import MOTION, claim
from pipeline.store.time_left import TimeLeft
from pipeline.values.errors import InputError, RunFailed, argument, ask
from pipeline.values.page import Section, page
from pipeline.values.plots import COLOURS, GREY, Line, Panel, ordered_colour
from pipeline.values.run import Run
from rod import (
    Air,
    Body,
    Loading,
    Motion,
    RodError,
    RodSolution,
    Start,
    Steps,
    frequencies,
    move,
)
from rod.along import Support, split_along
from rod.in_time.move import MovingArm

PRESSURES = Form(
    "pressures over time",
    {"time": Column(units.TIME), "pressure": Column(units.PRESSURE)},
    (("time",), ("pressure",)),
    "a time and a pressure",
    "a line of titles names columns with their units, as 't_s, pressure_kPa'",
)
#: of an arm with a limit of the pressure that shares a given amount of air
ONE_BY_ONE = "Near {:.4g} kPa chambers that share a given amount of air may swell one by one; that is not solved."
#: shapes that are drawn, at equal parts of the way of the tip; the longest motion in s
SHAPES, LONGEST = 12, 3600.0
#: what air may have by its name, as it is read
OF_AIR: dict[str, Callable[[str], float]] = {
    "flow": partial(units.convert, dimension=units.Dimension("a flow of free air", "mm**3/s", "1 l/min")),
    "supply": partial(units.convert, dimension=units.PRESSURE),
    "conductance": partial(units.convert, dimension=units.Dimension("a conductance", "mm**3/s/kPa", "20 mm^3/s/kPa")),
    "dead volume": partial(units.convert, dimension=units.Dimension("a volume", "mm**3", "5 cm^3")),
    "exponent": float,
}


@dataclass(frozen=True, eq=False)  # an array inside
class MotionRequest:
    """A motion that is asked for."""

    pressure: Any  #: kPa from 0 s on, one for each cavity, or rows (n, 1 + c) of a time in s and pressures
    seconds: float
    loading: Loading
    release: bool  #: the arm is let go at 0 s: of the force, or without one of what held it weightless
    air: Air | None  #: that makes the pressure, which begins as it is given; None: it stays so

    @staticmethod
    def read(
        pressure: Any, seconds: float, loading: Loading, *, release: bool, air: str | None = None
    ) -> "MotionRequest":
        """From options, as `pneurod.move` takes them. Raises InputError."""
        is_file = isinstance(pressure, Path) or (isinstance(pressure, str) and pressure.endswith(".csv"))
        acts = _read_table(Path(pressure)) if is_file else option_pressures("pressure", pressure)
        if air is not None and np.ndim(acts):
            raise InputError(f"{argument('air')}: needs one {argument('pressure')}, that at 0 s")
        if isinstance(seconds, int | float) and not seconds <= LONGEST:
            raise InputError(
                f"{argument('seconds')}: {seconds:g} s is more than an hour of the arm, which would take long; is it "
                f"meant? give {LONGEST:g} at most"
            )
        return MotionRequest(acts, seconds, loading, release, None if air is None else _read_air(air))

    @property
    def during(self) -> Loading:
        """What acts on the arm in motion."""
        return replace(self.loading, force=None) if self.release else self.loading

    @property
    def told(self) -> list[str]:
        """What acts, in a sentence."""
        words = ["a pressure over time" if np.ndim(self.pressure) else f"{self.pressure:g} kPa"]
        words += ["air that is closed in or flows"] if self.air else []
        if any(self.loading.force or ()):
            words.append(f"{'released from' if self.release else 'under'} {self.loading.force} N on its end")
        words += [f"{self.loading.tip_mass:g} g on its end"] if self.loading.tip_mass else []
        words += [str(self.loading.direction)] if self.loading.direction else []
        return [f"It moves: {', '.join(words)}."]

    def of(self, body: Body, tell: Callable[[float], None]) -> Motion:
        """The motion of an arm, which is told its time in s. Raises `RodError` where it cannot begin."""
        before = replace(self.loading, force=None)
        if self.release:
            before = self.loading if any(self.loading.force or ()) else Loading(along=self.loading.along)
        is_kept = self.release or self.air is not None
        first = self.pressure if is_kept else (0.0,) * np.size(self.pressure)
        start = Start(None if np.ndim(self.pressure) == 2 else first, before)
        return move(body, self.air or self.pressure, self.seconds, self.during, start, tell=tell)


@dataclass(frozen=True, eq=False)  # arrays inside
class ArmMotion:
    """The motion of an arm, and its files."""

    motion: Motion
    columns: Mapping[str, Array]  #: of motion.csv, each (n,)
    notes: tuple[str, ...]  #: what limits the trust in it, a sentence each
    directory: Path

    @property
    def lines(self) -> list[str]:
        """Where the tip goes, what limits the trust in it, and the files."""
        return [*self.told, f"written: {self.directory / 'motion.csv'}, motion.html (picture)"]

    @property
    def told(self) -> list[str]:
        """Where the tip goes, and what limits the trust in it."""
        ends = [f"({', '.join(f'{value:z.2f}' for value in self.motion.tips[k].tolist())})" for k in (0, -1)]
        went = f"tip from {ends[0]} to {ends[1]} mm after {self.motion.times_s[-1]:.4g} s"
        return [went, *self.notes]


def move_arm(run: Run, rods: Rods, asked: MotionRequest, out: Path, remark: Callable[[str], None]) -> ArmMotion:
    """Move the arm of a run; motion.csv and motion.html are in `out`. remark: is told how long it takes.

    Raises InputError for what cannot begin, and RunFailed, which has the motion up to the last good time as `reached`,
    where the arm cannot be followed, or an interrupt ends it.
    """
    try:
        body, damped = body_of(run, rods)
        if np.ndim(asked.pressure) < 2:
            rods.at(asked.pressure)
        left, whole = TimeLeft({}), asked.seconds
        moved = asked.of(body, lambda t: left.tell(remark, f"{t:.3g} of {whole:g} s are done", t / whole))
        moved = replace(moved, end_angles_deg=side_of(rods) * moved.end_angles_deg)
    except RodError as failure:
        raise InputError(str(failure)) from None
    limit = rods.forms.limit if rods.forms and asked.air else None
    shared = [ONE_BY_ONE.format(limit.value)] if limit else []
    columns = _columns(moved, split_along(asked.loading.along)[1])
    notes = *(damped, *_vibration(body, moved, asked)), *rods.notes, *shared, *moved.notes
    made = ArmMotion(moved, columns, notes, out)
    folder = claim(out, MOTION)
    folder.save_rows("motion.csv", tuple(made.columns), np.column_stack(tuple(made.columns.values())).tolist())
    ended = [moved.reason] if moved.reason else []
    drawn = Section(sentences=[*asked.told, *made.told, *ended], panels=motion_panels(moved))
    folder.save_text("motion.html", page(f"{run.design} in time", drawn))
    if moved.reason:
        raise RunFailed(moved.reason, out).with_reached(made)
    return made


def begin_motion(
    run: Run, rods: Rods, pressure: Any, loading: Loading, *, held_at: Sequence[str], in_space: bool
) -> MovingArm:
    """The arm of a run at rest, to be moved in steps. Raises InputError for what cannot begin."""
    loading = replace(loading, along=read_along(rods.law.length, held_at=held_at))
    try:
        acts = option_pressures("pressure", pressure)
        arm = MovingArm.at_rest(body_of(run, rods)[0], acts, loading, Steps(in_space=in_space))
        arm.side = side_of(rods)
    except RodError as failure:
        raise InputError(str(failure)) from None
    return arm


def side_of(rods: Rods) -> float:
    """1.0, or -1.0 where pressure turns the end to the negative side. Raises `RodError` as a rod does."""
    free = rods.at(rods.law.rows[-1]).solve()
    return -1.0 if isinstance(free, RodSolution) and free.theta[-1] < 0.0 else 1.0


def _vibration(body: Body, moved: Motion, asked: MotionRequest) -> list[str]:
    """A sentence on the first vibration where the motion ends; none for a rod without such an equilibrium."""
    with suppress(RodError):
        mode = frequencies(body, moved.pressures_kPa[-1], asked.during, 1)[0]
        told = f"{mode.frequency_hz:.3g} Hz, damping ratio {mode.damping_ratio:.2g}"
        return [f"Its first vibration about the rest at its last pressure: {told}."]
    return []


def _columns(moved: Motion, supports: Sequence[Support]) -> dict[str, Array]:
    """The columns of motion.csv; the second of a kind and later ones have their number in the name."""
    reactions = [f"reaction{{}}_{'N_mm' if axis > 2 else 'N'}" for one in supports for axis in one.held]
    found = {"t_s": moved.times_s}

    def add(names: Sequence[str], values: Array) -> None:
        known = values if values.shape[1] else np.full((len(values), len(names)), np.nan)
        found.update({name.format(f"_{k + 1}" if k else ""): known[:, k] for k, name in enumerate(names)})

    add(["pressure{}_kPa"] * moved.pressures_kPa.shape[1], moved.pressures_kPa)
    add(["volume{}_mm3"] * moved.pressures_kPa.shape[1], moved.volumes_mm3)
    add([f"tip_{axis}_mm" for axis in "xyz"[: moved.tips.shape[1]]], moved.tips)
    add(["end_angle_deg"], moved.end_angles_deg[:, None])
    add(["beyond_law_per_mm"], moved.beyond_per_mm[:, None])
    add(reactions, moved.reactions)
    return found


def motion_panels(moved: Motion) -> tuple[Panel, ...]:
    """Tip, end and pressure over time, and shapes."""
    t, tips, time = moved.times_s, moved.tips, "time (s)"
    way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(tips, axis=0), axis=1)))
    at = np.unique(np.interp(np.linspace(0.0, way[-1], SHAPES), way, t))
    shapes = zip(at.tolist(), moved.shapes(at.tolist()), strict=True)
    entry = f"shapes from 0 s (green) to {t[-1]:.3g} s (violet)"
    drawn = [
        Line(xy[:, 0], xy[:, 1], f"{s:.3g} s", ordered_colour(k, len(at)), entry=entry)
        for k, (s, xy) in enumerate(shapes)
    ]
    places = [Line(t, column, f"tip {'xyz'[k]}", COLOURS[k]) for k, column in enumerate(tips.T)]
    names = [f"pressure {k + 1}" for k in range(moved.pressures_kPa.shape[1])]
    names = names if len(names) > 1 else ["pressure"]
    pressures = [Line(t, moved.pressures_kPa[:, k], name, COLOURS[k]) for k, name in enumerate(names)]
    return (
        Panel("Tip", time, "position (mm)", tuple(places)),
        Panel("End", time, "angle (°)", (Line(t, moved.end_angles_deg, "end", COLOURS[3]),)),
        Panel("Air", time, "pressure (kPa)", tuple(pressures), from_zero=True),
        Panel("Shapes", "x (mm)", "y (mm)", (*drawn, Line(tips[:, 0], tips[:, 1], "tip", GREY, "dot")), lengths=True),
    )


def _read_air(text: str) -> Air:
    """From a text such as 'supply 40 kPa, conductance 20 mm^3/s/kPa, exponent 1.2', or 'closed'. Raises InputError."""
    found: dict[str, float] = {}
    for part in (part.strip() for part in text.split(",")):
        name = next((name for name in OF_AIR if part.startswith(f"{name} ")), "")
        if name:
            value = part.removeprefix(name).strip()
            found[name.replace(" ", "_")] = ask(argument("air"), OF_AIR[name], value)
        elif part != "closed":
            raise InputError(f"{argument('air')}: '{part}' is not known; allowed: closed, {', '.join(OF_AIR)}")
    if ("supply" in found) != ("conductance" in found):
        raise InputError(f"{argument('air')}: a supply needs the conductance of its tube, as '20 mm^3/s/kPa'")
    return ask(argument("air"), Air, *(found.get(field.name, field.default) for field in fields(Air)))


def _read_table(path: Path) -> Array:
    """(n, 1 + c) of a time in s from 0 on, and pressures in kPa. Raises InputError."""
    columns = read(path, PRESSURES)
    columns.check_gauge()
    taken = [columns.all("time")[0], *columns.all("pressure")]
    numbers = np.column_stack([column.numbers for column in taken])
    if not np.isfinite(numbers).all():
        raise InputError(f"{path}: has rows without a time or a pressure; give both in every row")
    return numbers
