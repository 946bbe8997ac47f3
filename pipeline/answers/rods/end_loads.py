"""What acts on an arm, written with units, and the shapes under it."""

import math
import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.told import Printable, aligned, listed
from pipeline.answers.rods.rods import Rods
from pipeline.config import units
from pipeline.results.options import is_list, option_pressures, option_value, option_vector, write_new
from pipeline.values.errors import InputError, RunFailed, argument, ask
from pipeline.values.formats import ARM_LAW, FIVE
from rod.along import Along, LineLoad, PointLoad, Reaction, Support
from rod.errors import LoadError, RodError, RodWarning
from rod.load import Loading
from rod.mechanics.equilibrium import Rod
from rod.solution import RodSolution, SpatialSolution
from rod.weight import gravity_vector, in_grams, position_along

#: loads along an arm as options have them
EXAMPLES = {
    "force_at": "0.5 l: [0 N, 0.02 N]",
    "line_load": "0.2 l to 0.8 l: [0 N/m, 0.5 N/m]",
    "held_at": "0.5 l: y -3 mm",
    "mass_at": "0.5 l: 5 g",
}


def read_loading(
    orientation: Any,
    tip_mass: Any,
    mass_at: Sequence[str] = (),
    *,
    force: Any = None,
    moment: Any = 0.0,
    end_y: Any = None,
    end: Any = None,
) -> Loading:
    """Weight, payloads, and what acts on the end or holds it, from options: numbers or texts with units.

    Positions are relative to the clamped end of the material curve. Raises InputError, also where options contradict
    each other.
    """
    if (tip_mass is not None or mass_at) and orientation is None:
        orientations = f"{argument('orientation')} hanging, lying, standing, '30 deg' or '[0, -1]'"
        raise InputError(f"{argument('mass_at' if tip_mass is None else 'tip_mass')}: needs {orientations}")
    direction = None if orientation is None else ask(argument("orientation"), gravity_vector, _pair_of(orientation))
    tip_mass_g = ask(argument("tip_mass"), in_grams, 0.0 if tip_mass is None else tip_mass)
    hung = [(at, ask(argument("mass_at"), in_grams, mass)) for (at,), mass in _placed("mass_at", mass_at)]
    if sum(given is not None for given in (force, end_y, end)) > 1:
        names = ", ".join(map(argument, ("force", "end_y", "end")))
        raise InputError(f"{names}: give one of them; the others follow from it")
    if end is not None and tip_mass_g:
        raise InputError(
            f"{argument('end')}, {argument('tip_mass')}: an end that is held carries no mass; leave one of them out"
        )
    along = force if force is None or is_list(force) else ["0 N", force]
    held = (None, option_value("end_y", end_y, units.LENGTH)) if end_y is not None else None
    return Loading(
        force=None if along is None else option_vector("force", along, units.FORCE),
        moment=(option_vector if is_list(moment) else option_value)("moment", moment, units.MOMENT),
        end=held if end is None else option_vector("end", end, units.LENGTH),
        direction=direction,
        tip_mass=tip_mass_g,
        hung=hung,
    )


def read_along(
    length: float, force_at: Sequence[str] = (), line_load: Sequence[str] = (), held_at: Sequence[str] = ()
) -> tuple[Along, ...]:
    """Loads and supports along an arm of a length in mm, from options. Raises InputError."""
    found: list[Along] = []
    for (at,), force in _placed("force_at", force_at):
        found.append(PointLoad(position_along(at, length), option_vector("force_at", force, units.FORCE)))
    for ends, force in _placed("line_load", line_load):
        even = option_vector("line_load", force, units.STIFFNESS)
        start, end = (position_along(s, length) for s in ends)
        found.append(ask(argument("line_load"), LineLoad, start, end, even))
    for (at,), what in _placed("held_at", held_at):
        found.append(Support(position_along(at, length), **_held(what)))
    return tuple(found)


def solved(rod: Rod, loading: Loading) -> RodSolution | SpatialSolution:
    """The equilibrium; its `notes` say what a `RodWarning` would. Raises `RodError` as `Rod.solve` does."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RodWarning)
        return rod.bear(loading)


def shape_under(rod: Rod, loading: Loading) -> RodSolution | SpatialSolution:
    """The shape. Raises RunFailed where there is none, InputError for an end farther away than the arm is long."""
    try:
        return solved(rod, loading)
    except RodError as failure:
        away = math.hypot(*(at or 0.0 for at in loading.end or ()))
        if away > rod.length:
            given = argument("end_y" if loading.end[0] is None else "end")
            far = f"is {away:g} mm away from the clamped end, but the arm is {rod.length:g} mm long"
            raise InputError(f"{given}: {far}") from None
        raise (InputError if isinstance(failure, LoadError) else RunFailed)(str(failure)) from None


def _placed(name: str, texts: Sequence[str]) -> list[tuple[tuple[str, ...], str]]:
    """Places along the arm and what acts there, of an argument that may be repeated. Raises InputError."""
    found = []
    for text in (texts,) if isinstance(texts, str) else texts:
        place, _, load = text.partition(":")
        places = tuple(place.split(" to "))
        if not load or len(places) != len(EXAMPLES[name].split(" to ")):
            raise InputError(f"{argument(name)}: '{text}' is not a place and a load; write it as '{EXAMPLES[name]}'")
        for one in places:
            ask(argument(name), position_along, one, 1.0)
        found.append((places, load.strip()))
    return found


def _held(text: str) -> dict[str, Any]:
    """x, y and z in mm and the angle in rad, of a text such as "x 50 mm, angle 5 deg". Raises InputError."""
    found: dict[str, float] = {}
    for part in text.split(","):
        name, _, value = part.strip().partition(" ")
        if name not in ("x", "y", "z", "angle") or name in found:
            told = f"says x, y, z or angle once each, as in '{EXAMPLES['held_at']}'"
            raise InputError(f"{argument('held_at')}: '{text}' does not say what is held; it {told}")
        at = option_value("held_at", value, units.ANGLE if name == "angle" else units.LENGTH)
        found[name] = math.radians(at) if name == "angle" else at
    return found


def _pair_of(text: Any) -> Any:
    """The numbers of a text such as [0, -1]; anything else as it is."""
    if not isinstance(text, str) or not text.strip().startswith("["):
        return text
    parts = text.strip().removeprefix("[").removesuffix("]").split(",")
    with suppress(ValueError):
        return [float(part) for part in parts]
    return list(parts)


def rod_at(rods: Rods, pressure: Any) -> Rod:
    """The rod at a pressure, a number or a text with its unit, or at two: [20 kPa, 5 kPa]. Raises InputError."""
    return ask(argument("pressure", pressure), rods.at, option_pressures("pressure", pressure))


@dataclass(frozen=True)
class RodShape(Printable):
    """A rod and its shape under loads."""

    rod: Rod
    shape: RodSolution | SpatialSolution
    errors: str  #: of the rod against finite elements; empty where they are not known

    @property
    def lines(self) -> list[str]:
        """Which rod it is, position, angle and force of its end, and the moment at the clamp; then notes."""
        kind = f"{ARM_LAW}: the arm's own law" if self.rod.has_own_law else f"{FIVE}: five parameters, inextensible"
        lines = {"rod": kind, **({"errors": self.errors} if self.errors else {}), **self.shape.told}
        at_end = float(self.shape.s[-1])
        supports = (one for one in self.shape.reactions if one.s < at_end or one.couple)
        lines |= {f"reaction at {one.s:g} mm": _reaction(one) for one in supports}
        return [*aligned(lines), *self.shape.notes]


def _reaction(one: Reaction) -> str:
    """Force of a support on the arm, and its couple where it holds the angle."""
    force = listed(np.array(one.force if one.force[2] else one.force[:2]), "N")
    return f"{force}, {one.couple:.5g} N mm" if one.couple else force


def write_shape(shape: RodSolution | SpatialSolution, file: Path) -> None:
    """Write the shape as CSV: s_mm, x_mm, y_mm, theta_rad, kappa_per_mm, moment_N_mm; in space s_mm, x_mm, y_mm, z_mm,
    and the components of curvature and moment.

    x and y are those of the material curve, theta and kappa those of the axis. Raises InputError when the file
    cannot be written.
    """
    if isinstance(shape, SpatialSolution):
        names = ["s_mm", "x_mm", "y_mm", "z_mm", "twist_per_mm", "lateral_curvature_per_mm", "kappa_per_mm"]
        names += [f"moment_{axis}_N_mm" for axis in "xyz"]
        columns = (shape.s, *shape.curve.T, *shape.curvature.T, *shape.moment.T)
    else:
        names = ["s_mm", "x_mm", "y_mm", "theta_rad", "kappa_per_mm", "moment_N_mm"]
        columns = (shape.s, *shape.curve.T, shape.theta, shape.kappa, shape.moment)
    rows = [",".join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
    write_new(file, "\n".join([",".join(names), *rows]) + "\n")
