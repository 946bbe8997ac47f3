"""A specimen that is held or vibrates: branches of relaxation from its stress over time, from its strain under a
constant load, or from storage and loss modulus over frequency.

Its stress is that at long times with the factor 1 + sum g exp(-t / tau); its strain under a load follows from the same
branches. Times of branches are evenly spaced in log t, and their parts are not negative, so that noise makes none. The
ramp before a hold counts: with increments dh of what is held, over its value at the end of the ramp, a branch has

    S = sum dh tau / (v - u) (exp(-(t1 - v) / tau) - exp(-(t1 - u) / tau))

of its part there, u and v the times around an increment and t1 the end. In tension the stress stands for what is held.
"""

import re
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from geometry.arrays import Array
from pipeline.answers.columns import Column, Columns, Form, Values, plain, read
from pipeline.answers.material.table import KINDS
from pipeline.config import units
from pipeline.values.errors import InputError, quoted
from rod.errors import RodError
from rod.in_time.relaxation import Creep, Relaxation

HELD = Form(
    "a specimen over time",
    {
        "time": Column(units.TIME, r"^t$|\btime|zeit|\btemps"),
        "frequency": Column(units.Dimension("a frequency", "Hz", "1 Hz"), r"^f$|freq|^ω$|omega"),
        "storage": Column(units.STRESS, r"stor|speicher|conserv|^[eg]['′]$"),
        "loss": Column(units.STRESS, r"loss|verlust|perte|^[eg](''|″)$", r"factor|faktor|facteur|tan|angle|winkel"),
        **KINDS,
    },
    (("time", "frequency"), (*KINDS, "storage")),
    "columns of a time and of a stress, force or strain",
    "a line of titles names a time and what was read, as 'time (s), stress (MPa)' or 'time (s), strain (%)', or as "
    "'frequency (Hz), storage modulus (MPa), loss modulus (MPa)'",
    title_lines=2,
)
#: branches in a tenfold time of a hold, and of a frequency; the shortest time of one over that of the first point and
#: over that of the ramp, the longest over that of the last point
PER_DECADE, OF_HZ, SHORTEST, OF_RAMP, LONGEST = 2.0, 4.0, 3.0, 0.2, 1.0 / 3.0
#: a part of the stress below which a branch is left out, fewest points of a hold, and largest misfit
LEAST, MIN_POINTS, LARGEST_MISFIT = 2e-3, 5, 0.05
#: what is held, over its value: in rest, at the end of its ramp, and by how much it may change later; scatters below
#: the largest stress at which the ramp ends
REST, REACHED, CHANGE, SCATTERS = 0.02, 0.999, 0.05, 3.0
#: words of a frequency in radians per time, in its title and unit
IS_ANGULAR = re.compile(r"^(?!.*hz)(.*\b(ang|angular|circular|kreis|puls)|.*(rad|rpm|deg|omega|ω))")
#: largest loss factor of a rubber, and frequencies at which arms vibrate, Hz
LARGEST_LOSS, OF_ARMS = 0.5, (0.1, 10.0)


@dataclass(frozen=True)
class Hold:
    """Branches of relaxation of a specimen that was held."""

    g: tuple[float, ...]  #: parts over the stress at long times
    tau_s: tuple[float, ...]  #: s
    between_s: tuple[float, float]  #: first and last time; of vibrations 1 / (2 pi f)
    misfit: float  #: root mean square of the differences over what was read at long times
    #: (n, 3): times (s), or frequencies (Hz), what was read over that at long times, and what branches make of it
    drawn: Array = field(repr=False, compare=False)
    loss: tuple[float, float, float, float] | None = None  #: least and largest measured loss factor between two Hz

    @property
    def written(self) -> str:
        """The branches as a configuration takes them."""
        branches = (f"{{g: {g:.3g}, tau: {tau:.3g} s}}" for g, tau in zip(self.g, self.tau_s, strict=True))
        return f"relaxation: [{', '.join(branches)}]"

    @property
    def words(self) -> list[str]:
        """How much of the stress a stretch loses that is held, its loss factor, and one that no rubber has."""
        low, high = self.between_s
        lost = 100.0 * (1.0 - 1.0 / (1.0 + sum(self.g)))
        said = [
            f"A stretch that is held loses {lost:#.3g} % of its stress from {low:.3g} to {high:.3g} s; branches "
            f"describe it within {100.0 * self.misfit:.2g} %. The law is taken as that at long times."
        ]
        if self.loss:
            least, most, start, end = self.loss
            said.append(f"The loss factor is {least:.2g} to {most:.2g} from {start:.3g} to {end:.3g} Hz.")
        hz = np.geomspace(1.0 / high, 1.0 / low, 60) / (2.0 * np.pi)
        losses = Relaxation(self.g, self.tau_s).loss_factor(hz)
        if losses.max() > LARGEST_LOSS:
            said.append(
                f"The loss factor is {losses.max():.2g} at {hz[losses.argmax()]:.2g} Hz, and rubbers have less than "
                f"{LARGEST_LOSS:g}: is the time 0 where the hold begins, and does the specimen slip?"
            )
        return said


def read_hold(path: Path) -> Hold:
    """The branches of a file of a hold with its ramp, or of vibrations. Raises InputError."""
    columns = read(path, HELD)
    for column in columns.known:
        if re.search(r"\b(log|log10|lg|ln)\b", plain(column.title)):
            raise InputError(f"{path}: column {quoted(column.title)} holds logarithms; give the numbers themselves")
    if columns.all("frequency") and columns.all("storage"):
        return _vibrating(columns)
    if not columns.all("time"):
        raise InputError(f"{path}: has no time; {HELD.example}")
    time = columns.all("time")[0]
    columns.check(time)
    found = [columns.all(*kinds) for kinds in (("stress", "force"), ("stretch", "strain", "extension"))]
    read_values = [time.numbers, *(of[0].numbers - float(of[0].name == "stretch") for of in found if of)]
    points = np.column_stack(read_values)
    t, *values = points[np.isfinite(points).all(axis=1)].T
    if (falls := np.diff(t) <= 0.0).any():
        raise InputError(f"{path}: times do not rise at {t[1:][falls][0]:g} s; give every time once, in their order")
    if len(t) < MIN_POINTS:
        raise InputError(f"{path}: has {len(t)} points; give {MIN_POINTS} or more, over a longer time")
    if len(values) == 1:
        return _held(path, t, np.abs(values[0]), None, is_creep=not found[0])
    stress, strain = (np.abs(of) for of in values)
    first, second = (float(np.median(of[len(t) // 2 :])) for of in (stress, strain))
    if not min(first, second) > 0.0:
        raise InputError(f"{path}: stress or strain is zero in most rows; leave out what follows the hold")
    begin = int(np.argmax((stress >= (1.0 - CHANGE) * first) | (strain >= (1.0 - CHANGE) * second)))
    is_creep = _range(stress[begin:]) / first < _range(strain[begin:]) / second
    return _held(path, t, *((strain, stress) if is_creep else (stress, strain)), is_creep=is_creep)


def _held(path: Path, t: Array, value: Array, held: Array | None, *, is_creep: bool) -> Hold:
    """From times (n,) in s, what changes and what is held, (n,) at them; None where the latter was not read."""
    end = _end_of_ramp(path, t, value if held is None else held, held is not None, is_creep=is_creep and held is None)
    ramp = held[: end + 1] if held is not None and is_creep else value[: end + 1]
    rests = np.flatnonzero(ramp <= REST * ramp[-1] + (1.0 - REST) * _preload(t[: end + 1], ramp))
    begin = int(rests[-1]) if len(rests) and not (is_creep and held is None) else end
    t, value, before = t[end:] - t[end], value[end:], t[begin : end + 1] - t[end]
    if len(t) < MIN_POINTS or t[-1] < 10.0 * SHORTEST * t[1]:
        raise InputError(f"{path}: has {len(t)} points of a hold; give {MIN_POINTS} or more, over a longer time")
    first, last = max(SHORTEST * t[1], -OF_RAMP * before[0]), LONGEST * t[-1]
    tau = np.geomspace(first, last, max(2, round(PER_DECADE * np.log10(last / first)) + 1))
    left = np.ones(len(tau))
    if begin < end:
        rise = np.diff(ramp[begin:]) / np.diff(before) / ramp[-1]
        left = tau * (rise @ np.diff(np.exp(before[:, None] / tau), axis=0))
    columns = np.column_stack([np.ones(len(t)), (-left if is_creep else left) * np.exp(-t[:, None] / tau)])
    weight = np.sqrt(np.gradient(np.log(np.maximum(t, 0.5 * t[1]))))
    level, *parts = nnls(columns * weight[:, None], value * weight)[0]
    if not level > 0.0:
        raise InputError(f"{path}: what was read comes to no rest; give a longer time")
    g = np.array(parts) / level
    drawn = np.column_stack([t, value / level, columns @ (1.0, *g)])
    misfit = float(np.sqrt(np.average((drawn[:, 2] - drawn[:, 1]) ** 2, weights=weight**2)))
    between = max(float(t[1]), first / SHORTEST), float(t[-1])
    return _of_branches(path, g, tau, between, misfit, drawn, is_creep=is_creep)


def _preload(t: Array, ramp: Array) -> float:
    """What acts for longer than a ramp (n,) takes before it; zero where nothing does."""
    rises = t[int(np.argmax(ramp > ramp[0] + REST * (ramp[-1] - ramp[0])))]
    return float(ramp[0]) if rises - t[0] > t[-1] - rises else 0.0


def _end_of_ramp(path: Path, t: Array, held: Array, is_known: bool, *, is_creep: bool) -> int:
    """The point at which a hold begins: not before the time 0, and for a strain alone there."""
    zero, late = int(np.argmax(t >= 0.0)), held[len(t) // 2 :]
    if is_creep:
        return zero
    noise = SCATTERS * float(np.median(np.abs(np.diff(late))))
    if not is_known:
        return max(zero, int(np.argmax(held >= held.max() - noise)))
    level = float(np.median(late))
    end = max(zero, int(np.argmax(held >= REACHED * level - noise)))
    if _range(held[end:]) > CHANGE * level:
        raise InputError(f"{path}: neither stress nor strain is held to the end; leave out what follows the hold")
    return end


def _range(values: Array) -> float:
    """Of all but the outermost, which may be noise."""
    return float(np.ptp(np.percentile(values, (3.0, 97.0))))


def _vibrating(columns: Columns) -> Hold:
    """From storage and loss modulus over frequency."""
    taken: list[Values] = [of[0] for name in ("frequency", "storage", "loss") if (of := columns.all(name))]
    columns.check(*taken)
    if len(taken) < 3:
        raise InputError(f"{columns.path}: has no loss modulus; {HELD.example}")
    points = np.column_stack([column.numbers for column in taken])
    hz, storage, loss = points[np.isfinite(points).all(axis=1) & (points > 0.0).all(axis=1)].T
    hz = hz / (2.0 * np.pi) if IS_ANGULAR.search(plain(f"{taken[0].title} {taken[0].unit}")) else hz
    if (count := len(np.unique(hz))) < MIN_POINTS:
        raise InputError(
            f"{columns.path}: has too few frequencies, {count}; give {MIN_POINTS} or more, at one temperature"
        )
    times = 1.0 / (2.0 * np.pi * np.array([hz.max(), hz.min()]))
    first, last = times[0] / SHORTEST, times[1] * SHORTEST
    tau = np.geomspace(first, last, round(OF_HZ * np.log10(last / first)) + 1)
    turned = 2j * np.pi * hz[:, None] * tau
    known = np.column_stack([np.ones(len(hz)), turned / (1.0 + turned)])
    weights = np.concatenate([1.0 / storage, 1.0 / loss])
    rows = np.vstack([known.real, known.imag]) * weights[:, None]
    level, *parts = nnls(rows, np.ones(len(rows)))[0]
    if not level > 0.0:
        raise InputError(f"{columns.path}: the storage modulus goes to zero at low frequencies, as of no rubber")
    misfit = float(np.sqrt(np.mean((rows @ (level, *parts) - 1.0) ** 2)))
    made = known @ (level, *parts)
    drawn = np.column_stack([hz, loss / storage, made.imag / made.real])
    found = _of_branches(columns.path, np.array(parts) / level, tau, (times[0], times[1]), misfit, drawn)
    inside = (hz >= OF_ARMS[0]) & (hz <= OF_ARMS[1]) if ((hz >= OF_ARMS[0]) & (hz <= OF_ARMS[1])).any() else hz > 0.0
    factor, between = (loss / storage)[inside], hz[inside]
    return replace(found, loss=(float(factor.min()), float(factor.max()), float(between.min()), float(between.max())))


def _of_branches(
    path: Path,
    g: Array,
    tau: Array,
    between: tuple[float, float],
    misfit: float,
    drawn: Array,
    *,
    is_creep: bool = False,
) -> Hold:
    """The branches that count, checked."""
    if misfit > LARGEST_MISFIT:
        raise InputError(
            f"{path}: branches describe it within {100.0 * misfit:.2g} % only, and {100.0 * LARGEST_MISFIT:g} % are "
            "allowed; leave out what follows the hold, and give one specimen that is held once"
        )
    shares, times = tuple(g[g > LEAST].tolist()), tuple(tau[g > LEAST].tolist())
    try:
        rubber = Creep(shares, times).relaxation if is_creep else Relaxation(shares, times)
    except RodError:
        raise InputError(f"{path}: the strain begins near zero; the time 0 is when the whole load acts") from None
    return Hold(rubber.shares, rubber.times_s, between, misfit, drawn)
