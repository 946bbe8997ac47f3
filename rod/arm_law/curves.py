"""What the pieces of an arm gave at one pressure: a cell and a clamped end over the moment, and the tip.

Moments and forces are those of the whole body; curvature is the rotation per rest length of the axis.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from geometry.arrays import Array, Mask
from rod.law import RodError


def _frozen(value: Any) -> Array:
    array = np.array(value)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)  # arrays inside
class CellCurve:
    """Pure bending of a cell at one pressure, by increasing moment.

    Arrays are read-only. Raises `RodError` unless moment and curvature both rise from point to point.
    """

    pressure: float  #: kPa
    moment: Array  #: (k,) N mm
    kappa: Array  #: (k,) 1/mm
    rigidity: Array  #: (k,) dM/dkappa, N mm2
    moment_by_pressure: Array  #: (k,) at fixed curvature, N mm / kPa
    stretch: Array  #: (k,) of the axis without axial force
    stretch_by_kappa: Array  #: (k,) mm
    stretch_by_pressure: Array  #: (k,) at fixed curvature, 1/kPa
    axial_rigidity: Array  #: (k,) EA, N
    shear_rigidity: Array  #: (k,) GA, N
    contact: Mask  #: (k,) whether walls touch
    min_J: Array  #: (k,) smallest ratio of volumes in the cell
    s: Array  #: (m,) rest positions along half a cell, from its middle to its end, mm
    ripple: Array  #: (k, m, 2) of the material curve beside the axis there, along and normal to it, mm

    def __post_init__(self) -> None:
        for field in fields(self):
            if field.name != "pressure":
                object.__setattr__(self, field.name, _frozen(getattr(self, field.name)))
        if len(self.moment) < 2:
            raise RodError(f"The law of a cell needs two curvatures at least; at {self.pressure:g} kPa it has one.")
        for name, unit in (("moment", "N mm"), ("kappa", "1/mm")):
            falls = np.flatnonzero(np.diff(getattr(self, name)) <= 0.0)
            if falls.size:
                value = getattr(self, name)[falls[0]]
                raise RodError(f"The {name} of a cell does not rise at {self.pressure:g} kPa beyond {value:g} {unit}.")

    def on(self, moment: Array) -> tuple[Array, Array]:
        """Curvature (n,) in 1/mm and stretch (n,) at moments (n,) in N mm, by the cubics of both."""
        kappa = CubicHermiteSpline(self.moment, self.kappa, 1.0 / self.rigidity)
        stretch = CubicHermiteSpline(self.moment, self.stretch, self.stretch_by_kappa / self.rigidity)
        return np.asarray(kappa(moment)), np.asarray(stretch(moment))

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

    pressure: float  #: kPa
    moment: Array  #: (k,) N mm
    rotation: Array  #: (k,) rad
    rotation_by_moment: Array  #: (k,) rad/(N mm)
    offset: Array  #: (k, 2) mm, of the axis at s = 0 from the clamped end of the material curve
    offset_by_moment: Array  #: (k, 2) 1/N
    s: Array  #: (m,) rest positions of the nodes of the material curve in the piece, mm
    beside: Array  #: (k, m, 2) of the nodes beside the axis of that rod, along and normal to it, mm

    def __post_init__(self) -> None:
        for field in fields(self):
            if field.name != "pressure":
                object.__setattr__(self, field.name, _frozen(getattr(self, field.name)))

    @property
    def position(self) -> float:
        """s in mm at which the moment decides: where a rotation makes the measured change of the offset.

        By reciprocity a shear force turns the piece as a moment shifts it.
        """
        weights = np.abs(self.rotation_by_moment)
        if not weights.any():
            return 0.0
        bent = float(weights @ self.rotation_by_moment)
        shifted = float(weights @ self.offset_by_moment[:, 1])
        return float(np.clip(-shifted / bent, 0.0, self.s[-1]))

    def at(self, moment: float) -> tuple[float, Array]:
        """Rotation (rad) and offset (2,) mm at a moment, by the cubics of both; the ends outside."""
        m = float(np.clip(moment, self.moment[0], self.moment[-1]))
        rotation = CubicHermiteSpline(self.moment, self.rotation, self.rotation_by_moment)(m)
        return float(rotation), np.asarray(CubicHermiteSpline(self.moment, self.offset, self.offset_by_moment)(m))


@dataclass(frozen=True, eq=False)  # arrays inside
class TipCurve:
    """The end of the arm at one pressure, without moment, beside cells continued to s = l. Arrays are read-only."""

    pressure: float  #: kPa
    rotation: float  #: rad, of the end beyond that of the cells
    couple: float  #: N mm, that the support of the end exerts; zero at a free end
    s: Array  #: (m,) rest positions of the nodes of the material curve before the end s = 0, rising to 0, mm
    beside: Array  #: (m, 2) of the nodes beside the axis, along and normal to it, mm

    def __post_init__(self) -> None:
        object.__setattr__(self, "s", _frozen(self.s))
        object.__setattr__(self, "beside", _frozen(self.beside))
