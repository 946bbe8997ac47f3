"""The pressure for a tip, a bending or a force: the question that a rod answers, backwards."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.told import Printable
from pipeline.answers.rods.end_loads import solved
from pipeline.answers.rods.rods import Rods
from pipeline.config import units
from pipeline.results.options import option_value, option_vector
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.formatting import number
from pipeline.values.run import bending_error_deg
from rod.errors import LoadError, RodError
from rod.inverse import AtPressure, Branch, Quantity
from rod.load import Loading

#: distance of the tip from the wanted place, over the length, that is met where the error of the rod is not known
MET = 0.005


@dataclass(frozen=True)
class Wish:
    """What is wanted of the end of an arm: its place, how far it bends, or its force where it is held."""

    tip_mm: tuple[float, ...] | None = None  #: from the clamped end of the material curve; in space with z
    angle_deg: float | None = None  #: rotation of the end section, as the verdict says
    force_N: float | None = None  #: y component of the force on the end, which is held at a height
    height_mm: float | None = None  #: of the end that is held
    loading: Loading = Loading()  # noqa: RUF009  frozen

    @staticmethod
    def read(tip: Any, angle: Any, force: Any, at_height: Any, loading: Loading) -> "Wish":
        """From texts with units, or numbers; None for what is not given. Raises InputError, also for contradictions."""
        return Wish(
            None if tip is None else option_vector("tip", tip, units.LENGTH),
            None if angle is None else option_value("angle", angle, units.ANGLE),
            None if force is None else option_value("force", force, units.FORCE),
            None if at_height is None else option_value("at_height", at_height, units.LENGTH),
            loading,
        )

    def __post_init__(self) -> None:
        given = sum(value is not None for value in (self.tip_mm, self.angle_deg, self.force_N))
        if given != 1:
            raise InputError("give one of a tip, an angle and a force")
        if (self.force_N is None) != (self.height_mm is None):
            raise InputError("give the height at which the end is held together with a force, and with nothing else")


@dataclass(frozen=True)
class PressureFor:
    """A pressure at which the wish is met, and the end of the arm there."""

    pressure_kPa: float
    error_kPa: float | None  #: by the errors of rod and mesh; None where they are not known
    tip_mm: tuple[float, ...]  #: of an arm in space with z, as its force
    angle_deg: float
    force_N: tuple[float, ...]
    away_mm: float | None  #: of the tip from the wanted one; None where another quantity was wanted
    pressures_kPa: tuple[float, ...] = ()  #: of all cavities; of an arm with one pressure that one
    note: str = ""  #: sentences: which of two forms it is, and on an arm in its plane that is unstable out of it

    @property
    def text(self) -> str:
        """The wish in words."""
        error = "" if self.error_kPa is None else f" ± {self.error_kPa:.2g}"
        several = f" ({_listed(self.pressures_kPa, '.4f')})" if len(self.pressures_kPa) > 1 else ""
        away = "" if self.away_mm is None else f", {self.away_mm:.2g} mm away"
        end = f"tip at ({_listed(self.tip_mm, 'z.2f')}) mm{away}, bends by {self.angle_deg:z.2f}°"
        force = f", force on the end [{_listed(self.force_N, '.4g')}] N" if any(self.force_N) else ""
        return f"{self.pressure_kPa:.4f}{error} kPa{several}: {end}{force}{f'. {self.note}' if self.note else ''}"


@dataclass(frozen=True)
class Solutions(Printable):
    """The pressures at which the end of an arm is as it is wanted."""

    solutions: tuple[PressureFor, ...]
    notes: tuple[str, ...]  #: what limits the trust in the rod, a sentence each

    @property
    def lines(self) -> list[str]:
        """Each pressure with the end of the arm there, and the notes."""
        return [*(at.text for at in self.solutions), *self.notes]


def _listed(values: Sequence[float], form: str) -> str:
    return ", ".join(format(value, form) for value in values)


def pressures_for(rods: Rods, wish: Wish) -> tuple[PressureFor, ...]:
    """All pressures at which a wish is met, by rising pressure; for a tip the nearest one first.

    Raises InputError for a wish that is out of reach, with what is nearest to it, and RunFailed where the arm has no
    equilibrium under its load.
    """
    branches = branches_of(rods, wish)
    if wish.tip_mm is not None:
        return _for_tip(rods, wish, branches, wish.tip_mm)
    quantity, target = (_angle(rods, wish), wish.angle_deg) if wish.angle_deg is not None else (_force, wish.force_N)
    assert target is not None
    found = [at for branch in branches for at in branch.where(quantity, target)]
    if not found:
        raise InputError(_out_of_reach(rods, wish, branches, quantity, target))
    return tuple(_met(rods, wish, at) for at in found)


def branches_of(rods: Rods, wish: Wish) -> tuple[Branch, ...]:
    """The arm under the load of a wish over its pressure, kept with the rods. Raises InputError for several ones."""
    known = rods.over_one_pressure
    is_in_space = not rods.law.has_plane
    if not is_in_space and wish.loading.is_spatial:
        raise InputError("pressures are found for arms in their plane; give gravity as x and y")
    if wish.tip_mm is not None and len(wish.tip_mm) != (3 if is_in_space else 2):
        where, axes = ("in space", "x, y and z") if is_in_space else ("in its plane", "x and y")
        raise InputError(f"this arm bends {where}; give the place of its tip as {axes}")
    loading = replace(wish.loading, end=None if wish.height_mm is None else (None, wish.height_mm))
    if loading not in rods.branches:
        solve = partial(solved, loading=loading)
        try:
            branches = Branch.all_of(rods.at, solve, known)
        except LoadError as failure:
            raise InputError(str(failure)) from None
        except RodError as failure:
            raise RunFailed(str(failure)) from None
        if swollen := rods.swollen:
            with suppress(RodError):
                after = Branch.all_of(swollen.at, solve, swollen.over_one_pressure)
                branches += tuple(replace(branch, after_snap=True) for branch in after)
        rods.branches[loading] = branches
    return rods.branches[loading]


def _for_tip(rods: Rods, wish: Wish, branches: tuple[Branch, ...], tip: tuple[float, ...]) -> tuple[PressureFor, ...]:
    near = [_met(rods, wish, at) for branch in branches for at in branch.nearest(tip)]
    near.sort(key=lambda at: at.away_mm or 0.0)
    error = MET if rods.errors is None or not rods.errors.is_known else rods.errors.shape
    met = [at for at in near if (at.away_mm or 0.0) <= error * rods.law.length]
    if met:
        return tuple(met)
    raise InputError(
        f"no pressure{_range(rods, branches)} brings the tip to ({_listed(tip, 'g')}) mm; nearest: {near[0].text}"
    )


def _out_of_reach(rods: Rods, wish: Wish, branches: tuple[Branch, ...], quantity: Quantity, target: float) -> str:
    ends = [at for branch in branches for at in branch.extremes(quantity)]
    nearest = min(ends, key=lambda at: abs(float(at.of(quantity)[0]) - target))
    what = f"bends the arm by {target:g}°" if wish.angle_deg is not None else f"gives the end a force of {target:g} N"
    return f"no pressure{_range(rods, branches)} {what}; nearest: {_met(rods, wish, nearest).text}"


def _range(rods: Rods, branches: tuple[Branch, ...]) -> str:
    """The pressures that were searched; at others the load leaves the range of the rod."""
    known = [(float(branch.pressures[0]), float(branch.pressures[-1])) for branch in branches]
    text = f" from {' and from '.join(f'{number(low)} to {number(high)}' for low, high in known)} kPa"
    return text if known == [rods.pressures_kPa] else f"{text}, where the rod is known under this load,"


def _met(rods: Rods, wish: Wish, at: AtPressure) -> PressureFor:
    axes = 2 if rods.law.has_plane else 3
    tip, force = (tuple(at.state[first : first + axes].tolist()) for first in (0, 3))
    away = None if wish.tip_mm is None else math.dist(tip, wish.tip_mm)
    angle = float(_angle(rods, wish)(at.state[None])[0])
    held = force if wish.force_N is not None else (0.0,) * len(force)
    pressures = tuple(part * at.pressure for part in rods.law.fractions.values())
    told = rods.forms.told_at(at.pressure, after_snap=at.after_snap) if rods.forms else ""
    note = " ".join(filter(None, [told, at.path.sideways]))
    return PressureFor(at.pressure, _error(rods, wish, at), tip, angle, held, away, pressures, note)


def _error(rods: Rods, wish: Wish, at: AtPressure) -> float | None:
    """kPa: the error of the rod and its mesh in what is wanted, over its change by the pressure."""
    errors = rods.errors
    if errors is None or not errors.is_known:
        return None
    moves = errors.shape * rods.law.length
    if wish.force_N is not None:
        if errors.force is None or errors.largest_N is None:
            return None
        return _over(errors.force * errors.largest_N, float(at.of(_force)[1]))
    if wish.angle_deg is not None:
        return _over(bending_error_deg(moves, at.state[:3].tolist()), float(at.of(_angle(rods, wish))[1]))
    return _over(moves, math.hypot(*at.slope[:3]))


def _over(error: float, slope: float) -> float | None:
    return abs(error / slope) if slope else None


def _angle(rods: Rods, wish: Wish) -> Quantity:
    """Degrees; in the plane positive to the side to which the arm bends without load at the highest pressure."""
    return branches_of(rods, wish)[-1].paths[-1].bending_deg


def _force(states: Array) -> Array:
    return np.asarray(states[:, 4])
