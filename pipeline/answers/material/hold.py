"""A specimen that is held: branches of relaxation from its stress over time, or from its strain under a constant load.

Its stress is that at long times with the factor 1 + sum g exp(-t / tau); its strain under a load follows from the same
branches. Times of branches are evenly spaced in log t, and their parts are not negative, so that noise makes none.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from geometry.arrays import Array
from pipeline.answers.columns import Column, Form, read
from pipeline.answers.material.table import KINDS
from pipeline.config.units import TIME
from pipeline.values.errors import InputError
from rod.errors import RodError
from rod.in_time.relaxation import Creep, Relaxation

HELD = Form(
    "a specimen over time",
    {"time": Column(TIME, r"^t$|\btime|zeit|\btemps"), **KINDS},
    (("time",), tuple(KINDS)),
    "columns of a time and of a stress, force or strain",
    "a line of titles names a time and what was read, as 'time (s), stress (MPa)' or 'time (s), strain (%)'",
    title_lines=2,
)
#: branches in a tenfold time; the shortest time of one over that of the first point, the longest over that of the last
PER_DECADE, SHORTEST, LONGEST = 2.0, 3.0, 1.0 / 3.0
#: a part of the stress below which a branch is left out, and fewest points of a hold
LEAST, MIN_POINTS = 2e-3, 10
#: largest loss factor of a rubber
LARGEST_LOSS = 0.5


@dataclass(frozen=True)
class Hold:
    """Branches of relaxation of a specimen that was held."""

    g: tuple[float, ...]  #: parts over the stress at long times
    tau_s: tuple[float, ...]  #: s
    between_s: tuple[float, float]  #: first and last time
    misfit: float  #: root mean square of the differences over what was read at long times

    @property
    def written(self) -> str:
        """As a configuration takes it."""
        branches = (f"{{g: {g:.3g}, tau: {tau:.3g} s}}" for g, tau in zip(self.g, self.tau_s, strict=True))
        return f"relaxation: [{', '.join(branches)}]"

    @property
    def words(self) -> list[str]:
        """How much of the stress a stretch loses that is held, and a loss factor that no rubber has."""
        low, high = self.between_s
        lost = 100.0 * (1.0 - 1.0 / (1.0 + sum(self.g)))
        said = [
            f"A stretch that is held loses {lost:.3g} % of its stress from {low:.3g} to {high:.3g} s; branches "
            f"describe it within {100.0 * self.misfit:.2g} %. The law is taken as that at long times."
        ]
        hz = np.geomspace(1.0 / high, 1.0 / low, 60) / (2.0 * np.pi)
        losses = Relaxation(self.g, self.tau_s).loss_factor(hz)
        if losses.max() > LARGEST_LOSS:
            said.append(
                f"The loss factor is {losses.max():.2g} at {hz[losses.argmax()]:.2g} Hz, and rubbers have less than "
                f"{LARGEST_LOSS:g}: is the time 0 where the hold begins, and does the specimen slip?"
            )
        return said


def read_hold(path: Path) -> Hold:
    """The branches of a file with a time that is 0 where the hold begins. Raises InputError."""
    columns = read(path, HELD)
    time = columns.all("time")[0]
    value = next(
        found[0] for kind in ("stress", "force", "strain", "extension", "stretch") if (found := columns.all(kind))
    )
    columns.check(time)
    _check_rise(path, time.numbers[np.isfinite(time.numbers)])
    points = np.column_stack([time.numbers, value.numbers - float(value.name == "stretch")])
    return _held(path, points[np.isfinite(points).all(axis=1)], is_creep=value.name not in ("stress", "force"))


def _check_rise(path: Path, time: Array) -> None:
    """Raise InputError for times (n,) in s that do not rise."""
    if (falls := np.diff(time) <= 0.0).any():
        raise InputError(f"{path}: times do not rise at {time[1:][falls][0]:g} s; give every time once, in their order")


def _held(path: Path, points: Array, *, is_creep: bool) -> Hold:
    t, value = points[points[:, 0] > 0.0].T
    if len(t) < MIN_POINTS or t[-1] < 10.0 * SHORTEST * t[0]:
        raise InputError(f"{path}: has {len(t)} points after the time 0; give {MIN_POINTS} or more, over a longer time")
    first, last = SHORTEST * t[0], LONGEST * t[-1]
    tau = np.geomspace(first, last, max(2, round(PER_DECADE * np.log10(last / first)) + 1))
    columns = np.column_stack([np.ones(len(t)), (-1.0 if is_creep else 1.0) * np.exp(-t[:, None] / tau)])
    weight = np.sqrt(np.gradient(np.log(t)))
    level, *parts = nnls(columns * weight[:, None], np.abs(value) * weight)[0]
    if not level > 0.0:
        raise InputError(f"{path}: what was read comes to no rest; give a longer time")
    g = np.array(parts) / level
    misfit = float(np.sqrt(np.average((columns @ (1.0, *g) - np.abs(value) / level) ** 2, weights=weight**2)))
    g, tau = g[g > LEAST], tau[g > LEAST]
    shares, times = tuple(g.tolist()), tuple(tau.tolist())
    try:
        rubber = Creep(shares, times).relaxation if is_creep else Relaxation(shares, times)
    except RodError:
        raise InputError(f"{path}: the strain begins near zero; the time 0 is when the whole load acts") from None
    return Hold(rubber.shares, rubber.times_s, (float(t[0]), float(t[-1])), misfit)
