"""What the pieces of an arm gave at one pressure: a cell and a clamped end over the moment, and the tip.

Moments, forces and volumes are those of the whole body; curvature is the rotation per rest length of the axis. With the
type of a field stand its key in law.json and its shape: k moments, m positions, n turns, c cavities. Fields with a
default may be missing there; they are empty then.
"""

from collections.abc import Mapping
from dataclasses import Field, dataclass, field, fields
from functools import cached_property
from typing import Annotated, Any, Generic, TypeVar, final, get_args

import numpy as np

from geometry.arrays import Array, Mask, freeze
from rod.cubics import cubic, monotone_cubic, parabola_slopes, periodic_slopes
from rod.errors import RodError

#: of a cell out of its plane: those that have a limit of the mesh and derivatives by the design, and all
ACROSS = ("lateral_rigidity", "torsional_rigidity")
IN_SPACE = (*ACROSS, "lateral_shear_rigidity", "twist_axis", "tilt_by_torque")
#: moment over the range of those of a law that a state may have which was solved without one
NO_MOMENT = 1e-6


def key_of(one: "Field[Any]") -> str:
    """The key of a field in a file; empty for a field without one."""
    known = get_args(one.type)
    return str(known[1]) if len(known) > 1 and isinstance(known[1], str) else ""


def nothing() -> Array:
    """The empty array of a field that may be missing."""
    return np.empty(0)


def has_unloaded(moment: Array) -> bool:
    """Whether rising moments (k,) in N mm have zero among them, or end there but for `NO_MOMENT`."""
    nearly = NO_MOMENT * float(moment[-1] - moment[0])
    return bool(moment[0] - nearly <= 0.0 <= moment[-1] + nearly)


Curve_co = TypeVar("Curve_co", covariant=True)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class CurveAt(Generic[Curve_co]):
    """A curve at its place on a path through pressures: a pressure in kPa, or the direction of a ray."""

    place: float
    curve: Curve_co
    slopes: Mapping[str, Array]  #: (k,) by the place, of fields by name; at fixed curvature, or fixed moment of an end


def _freeze(curve: "CellCurve | ClampCurve | TipCurve", *rising: str) -> None:
    """Everything but the pressure as an array that cannot be changed. Raises `RodError` for what does not rise."""
    freeze(curve, (one.name for one in fields(curve) if one.name != "pressure"))
    for one in fields(curve):
        if one.name in rising and np.any(np.diff(getattr(curve, one.name)) <= 0.0):
            raise RodError(f"{key_of(one)} must rise.")


@dataclass(frozen=True, eq=False)  # arrays inside
class CellCurve:
    """Pure bending of a cell at one pressure, by increasing moment.

    Arrays are read-only. Raises `RodError` unless moment and curvature both rise from point to point.
    """

    pressure: Annotated[float, "pressure_kPa"]  #: kPa
    moment: Annotated[Array, "moment_N_mm", "k"]  #: N mm
    kappa: Annotated[Array, "kappa_per_mm", "k"]  #: 1/mm
    rigidity: Annotated[Array, "rigidity_N_mm2", "k"]  #: dM/dkappa, N mm2
    moment_by_pressure: Annotated[Array, "moment_by_pressure_N_mm_per_kPa", "k"]  #: at fixed curvature, N mm / kPa
    stretch: Annotated[Array, "stretch", "k"]  #: of the axis without axial force
    stretch_by_kappa: Annotated[Array, "stretch_by_kappa_mm", "k"]  #: mm
    stretch_by_pressure: Annotated[Array, "stretch_by_pressure_per_kPa", "k"]  #: at fixed curvature, 1/kPa
    axial_rigidity: Annotated[Array, "axial_rigidity_N", "k"]  #: EA, N
    shear_rigidity: Annotated[Array, "shear_rigidity_N", "k"]  #: GA, N
    contact: Annotated[Mask, "contact", "k"]  #: whether walls touch
    min_J: Annotated[Array, "min_J", "k"]  #: smallest ratio of volumes in the cell
    s: Annotated[Array, "s_mm", "m"]  #: rest positions along half a cell, from its middle to its end, mm
    #: of the material curve beside the axis there, along and normal to it, mm
    ripple: Annotated[Array, "ripple_mm", "k", "m", 2]
    #: both by the pressure of one of two cavities alone, at fixed curvature, N mm / kPa and 1/kPa (`rod.arm_law.pairs`)
    moment_by_other: Annotated[Array, "moment_by_other_N_mm_per_kPa", "k"] = field(default_factory=nothing)
    stretch_by_other: Annotated[Array, "stretch_by_other_per_kPa", "k"] = field(default_factory=nothing)
    #: B_2, against bending out of the plane, N mm2; negative where the cell is unstable
    lateral_rigidity: Annotated[Array, "lateral_rigidity_N_mm2", "k"] = field(default_factory=nothing)
    torsional_rigidity: Annotated[Array, "torsional_rigidity_N_mm2", "k"] = field(default_factory=nothing)  #: GJ, N mm2
    #: against shear across the plane, without twist, N
    lateral_shear_rigidity: Annotated[Array, "lateral_shear_rigidity_N", "k"] = field(default_factory=nothing)
    #: of the axis of twist, above that of the rod, mm
    twist_axis: Annotated[Array, "twist_axis_mm", "k"] = field(default_factory=nothing)
    #: difference between the tilts of the planes at the end and in the middle of the cell, rad/(N mm)
    tilt_by_torque: Annotated[Array, "tilt_by_torque_rad_per_N_mm", "k"] = field(default_factory=nothing)
    #: air per rest length in each cavity of the body, mm2
    volume: Annotated[Array, "volume_mm3_per_mm", "k", "c"] = field(default_factory=nothing)

    def __post_init__(self) -> None:
        _freeze(self, "s")
        if len(self.moment) < 2:
            raise RodError(f"The law of a cell needs two curvatures at least; at {self.pressure:g} kPa it has one.")
        for name, unit in (("moment", "N mm"), ("kappa", "1/mm")):
            falls = np.flatnonzero(np.diff(getattr(self, name)) <= 0.0)
            if falls.size:
                value = getattr(self, name)[falls[0]]
                raise RodError(f"The {name} of a cell does not rise at {self.pressure:g} kPa beyond {value:g} {unit}.")

    @cached_property
    def placed(self) -> CurveAt["CellCurve"]:
        """At its pressure."""
        return CurveAt(self.pressure, self, {"moment": self.moment_by_pressure, "stretch": self.stretch_by_pressure})

    @property
    def is_in_space(self) -> bool:
        """Whether the rigidities out of the plane are known."""
        return len(self.lateral_rigidity) > 0

    @property
    def onset(self) -> float | None:
        """Curvature beyond which walls touch up to the end of the curve, 1/mm: halfway between two states; None where
        they touch nowhere or everywhere."""
        free = np.flatnonzero(~self.contact)
        if not self.contact[-1] or not free.size:
            return None
        return float(self.kappa[free[-1] : free[-1] + 2].mean())

    def on(self, moment: Array) -> tuple[Array, Array]:
        """Curvature (n,) in 1/mm and stretch (n,) at moments (n,) in N mm, by the cubics of both."""
        kappa = cubic(self.moment, self.kappa, 1.0 / self.rigidity, moment)
        return kappa, cubic(self.moment, self.stretch, self.stretch_by_kappa / self.rigidity, moment)

    def at(self, moment: float) -> tuple[float, float, Array]:
        """Curvature (1/mm), stretch, and the material curve beside the axis (2,) mm at the end of the cell."""
        kappa, stretch = self.on(np.array(moment))
        ripple = [np.interp(moment, self.moment, self.ripple[:, -1, k]) for k in range(2)]
        return float(kappa), float(stretch), np.array(ripple)


@dataclass(frozen=True, eq=False)  # arrays inside
class ClampCurve:
    """The clamped end at one pressure: how it departs from cells continued to the clamp, by increasing moment.

    A rod of cells that starts at the clamp turned by `rotation` and shifted by `offset` passes through the plane at the
    end of the piece. Arrays are read-only.
    """

    pressure: Annotated[float, "pressure_kPa"]  #: kPa
    moment: Annotated[Array, "moment_N_mm", "k"]  #: N mm
    rotation: Annotated[Array, "rotation_rad", "k"]  #: rad
    rotation_by_moment: Annotated[Array, "rotation_by_moment_rad_per_N_mm", "k"]  #: rad/(N mm)
    rotation_by_pressure: Annotated[Array, "rotation_by_pressure_rad_per_kPa", "k"]  #: at fixed moment, rad/kPa
    #: mm, of the axis at s = 0 from the clamped end of the material curve
    offset: Annotated[Array, "offset_mm", "k", 2]
    offset_by_moment: Annotated[Array, "offset_by_moment_per_N", "k", 2]  #: 1/N
    s: Annotated[Array, "s_mm", "m"]  #: rest positions of the nodes of the material curve in the piece, mm
    #: of the nodes beside the axis of that rod, along and normal to it, mm
    beside: Annotated[Array, "beside_mm", "k", "m", 2]
    #: without moment: turn about the tangent and tilt about the normal, at the clamp, per torque and moment about the
    #: normal there, beyond those of cells continued to the clamp, rad/(N mm)
    lateral_compliance: Annotated[Array, "lateral_compliance_rad_per_N_mm", 2, 2] = field(default_factory=nothing)
    #: by the pressure of one of two cavities alone, at fixed moment, rad/kPa
    rotation_by_other: Annotated[Array, "rotation_by_other_rad_per_kPa", "k"] = field(default_factory=nothing)
    #: air in each cavity of the piece, mm3
    volume: Annotated[Array, "volume_mm3", "k", "c"] = field(default_factory=nothing)

    def __post_init__(self) -> None:
        _freeze(self, "s", "moment")

    @cached_property
    def placed(self) -> CurveAt["ClampCurve"]:
        """At its pressure."""
        return CurveAt(self.pressure, self, {"rotation": self.rotation_by_pressure})

    @cached_property
    def position(self) -> float:
        """s in mm at which the moment decides: where a rotation makes the measured change of the offset.

        By reciprocity a shear force turns the piece as a moment shifts it.
        """
        if len(self.moment) < 2 or not self.rotation_by_moment.any():
            return 0.0
        steps = np.diff(self.moment)
        weights = np.abs(self.rotation_by_moment) * (np.append(steps, 0.0) + np.append(0.0, steps))
        bent = float(weights @ self.rotation_by_moment)
        shifted = float(weights @ self.offset_by_moment[:, 1])
        return float(np.clip(-shifted / bent, 0.0, self.s[-1]))

    def at(self, moment: float) -> tuple[float, Array]:
        """Rotation (rad) and offset (2,) mm at a moment, by the cubics of both; the ends outside."""
        return float(self.rotation_at(moment)), self.offset_at(moment)

    def rotation_at(self, moment: Array | float) -> Array:
        """Rotations in rad, of the shape of the moments; the ends outside."""
        return cubic(self.moment, self.rotation, self.rotation_by_moment, self._inside(moment))

    def offset_at(self, moment: Array | float) -> Array:
        """Offsets in mm, (n, 2) at moments (n,), (2,) at one; the ends outside."""
        return cubic(self.moment, self.offset, self.offset_by_moment, self._inside(moment))

    def volume_at(self, moment: Array) -> Array:
        """(n, c) mm3: air in each cavity of the piece at moments (n,); the ends outside."""
        return cubic(self.moment, self.volume, self._volume_slopes, self._inside(moment))

    @cached_property
    def _volume_slopes(self) -> Array:
        return parabola_slopes(self.moment, self.volume)

    def beside_at(self, moment: Array) -> Array:
        """(n, m, 2) mm: the nodes of the material curve beside the axis at moments (n,); the ends outside."""
        return cubic(self.moment, self.beside, self._beside_slopes, self._inside(moment))

    @cached_property
    def _beside_slopes(self) -> Array:
        return parabola_slopes(self.moment, self.beside)

    def slopes_at(self, slopes: Array, moment: Array) -> Array:
        """(n,) slopes (k,) of the rotation by a pressure or a place, at moments (n,); the ends outside.

        They jump where walls meet, so that smooth cubics would lie far beyond the values on both sides.
        """
        return monotone_cubic(self.moment, slopes, moment)

    def _inside(self, moment: Array | float) -> Array:
        return np.asarray(np.clip(moment, self.moment[0], self.moment[-1]))


@dataclass(frozen=True, eq=False)  # arrays inside
class TipCurve:
    """The end of the arm at one pressure, without moment, beside cells continued to s = l.

    It is free, or a support keeps all nodes of its edge at one height as in experiment III, or in one point. What the
    support at a height does depends on the turn of the end, the angle of the axis at s = l. Turns are equally spaced
    over a full turn from -pi on, a multiple of four. Positions are relative to the axis, along and normal to it; arrays
    are read-only. Raises `RodError` for another number of turns.
    """

    pressure: Annotated[float, "pressure_kPa"]  #: kPa
    #: rest positions of the nodes of the material curve before the end s = 0, rising to 0, mm
    s: Annotated[Array, "s_mm", "m"]
    beside: Annotated[Array, "beside_mm", "m", 2]  #: of the nodes where the end is free, mm
    #: of the middle of the free edge, where a force acts that is spread evenly over it, mm
    edge: Annotated[Array, "edge_mm", 2]
    #: N mm, of the support at a height without a resultant force, by turn
    couple: Annotated[Array, "couple_by_turn_N_mm", "n"]
    #: of the point in which a resultant force of that support acts, by turn, mm
    acts_at: Annotated[Array, "acts_at_by_turn_mm", "n", 2]
    #: of the nodes where the edge is held at a height, by turn, mm
    beside_held: Annotated[Array, "beside_by_turn_mm", "n", "m", 2]
    beside_pinned: Annotated[Array, "beside_pinned_mm", "m", 2]  #: of the nodes where the edge is held in one point, mm
    #: displacement of these nodes beside the axis by an axial force on the point, mm/N
    pinned_by_pull: Annotated[Array, "pinned_by_pull_mm_per_N", "m", 2]
    #: air in each cavity of the piece, which is free, mm3
    volume: Annotated[Array, "volume_mm3", "c"] = field(default_factory=nothing)

    def __post_init__(self) -> None:
        _freeze(self, "s")
        if len(self.couple) % 4:
            raise RodError(f"The tip needs a multiple of four turns, not {len(self.couple)}.")

    @cached_property
    def placed(self) -> CurveAt["TipCurve"]:
        """At its pressure."""
        return CurveAt(self.pressure, self, {})

    @cached_property
    def free(self) -> "TipState":
        """The end without a support."""
        return TipState(self.s, np.zeros(1), self.edge[None], self.beside[None], np.zeros_like(self.beside))

    @cached_property
    def held(self) -> "TipState":
        """The end whose edge is held at a height."""
        return TipState(self.s, self.couple, self.acts_at, self.beside_held, np.zeros_like(self.beside))

    @cached_property
    def held_along_x(self) -> "TipState":
        """The end whose edge is held at a position along x: a support at a height, a quarter turn on."""
        quarter = len(self.couple) // 4
        couple, acts_at, beside = (np.roll(a, -quarter, axis=0) for a in (self.couple, self.acts_at, self.beside_held))
        return TipState(self.s, couple, acts_at, beside, self.pinned_by_pull)

    @cached_property
    def pinned(self) -> "TipState":
        """The end whose edge is held in one point: forces there have no couple."""
        still = self.beside_pinned
        return TipState(self.s, np.zeros(1), still[None, -1], still[None], self.pinned_by_pull)


@dataclass(frozen=True, eq=False)  # arrays inside
class TipState:
    """The end of the arm as its conditions leave it, by turn as in `TipCurve`; one row where the turn does not matter.

    Positions are relative to the axis, along and normal to it.
    """

    s: Array  #: (m,) rest positions of the nodes of the material curve before the end s = 0, rising to 0, mm
    couple: Array  #: (n,) N mm, of the support without a resultant force
    acts_at: Array  #: (n, 2) of the point in which a force acts, mm
    beside: Array  #: (n, m, 2) of the nodes of the material curve, mm
    by_pull: Array  #: (m, 2) their displacement by an axial force on the end, mm/N

    @property
    def turns(self) -> Array:
        """(n + 1,) rad, of the rows and of the first one again after a full turn."""
        return np.linspace(-np.pi, np.pi, len(self.couple) + 1)

    def beside_at(self, turn: float, pull: float) -> Array:
        """(m, 2) mm: the nodes of the material curve at a turn in rad and an axial force on the end in N."""
        still = cubic(self.turns, *self._beside_over_turns, (turn + np.pi) % (2.0 * np.pi) - np.pi)
        return still + pull * self.by_pull

    @cached_property
    def _beside_over_turns(self) -> tuple[Array, Array]:
        return self.over_turns(self.beside)

    def over_turns(self, rows: Array) -> tuple[Array, Array]:
        """Rows (n, ...) and their slopes per rad at the turns, (n + 1, ...) each, of a smooth periodic curve."""
        values = np.concatenate([rows, rows[:1]])
        return values, periodic_slopes(values, 2.0 * np.pi / len(rows))
