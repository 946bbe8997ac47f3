"""The identified rod over a range of pressures: between two of them by cubics in the pressure.

Numbers and kappa_0(s) curve over the pressure, because walls meet and materials stiffen; straight lines between a few
pressures miss that. The five parameters follow monotone cubics (PCHIP), which never go beyond two neighbours, so that a
rigidity stays positive. F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17 (1980).

Outside the identified pressures there is no rod.

kappa_0(s) ripples along the arm by more than its mean, so that its interpolation must be linear in the values: only
then is the mean of the interpolated profile the interpolated mean. It and theta0 follow cubics whose slopes are those
of parabolas through three neighbours, and have one more value, that of the drawing without pressure, unless something
else than the pressure of the run bends the arm. With two values a cubic is a straight line.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from geometry.arrays import Array
from rod.checked import Amount, finite
from rod.cubics import cubic, monotone_slopes
from rod.errors import RodError
from rod.identification.moment_range import MomentRange
from rod.law import PARAMETER_NAMES, FiveParameters
from rod.mechanics.equilibrium import Rod
from rod.same_pressure import Pressures, as_known, known_at, pressures_of
from rod.weight import Mass

#: where the numbers at an identified pressure come from
IDENTIFIED = "identified"


@dataclass(frozen=True)
class PressurisedRod:
    """The identified rod over a range of pressures: parameters and kappa_0 follow cubics between them.

    At an identified pressure it has the identified numbers.
    Raises `RodError` unless pressures rise.
    """

    length: float  #: mm
    pressures: Array  #: (n,) kPa
    laws: tuple[FiveParameters, ...]  #: (n,)
    s: Array  #: (m,) mm, from 0 to length
    kappa_0: Array  #: (n, m) 1/mm
    theta0: Array  #: (n,) rad, tangent angle at the clamp
    moment_ranges: tuple[MomentRange, ...] = ()  #: (n,) of the identification; empty: not given
    #: whether the arm is straight without pressure; not where it has a weight or a cavity with a constant pressure
    straight_without_pressure: bool = True
    weight: tuple[float, float] = (0.0, 0.0)  #: N/mm, see `Rod`
    weight_height: float = 0.0  #: mm
    mass: Mass | None = None  #: of the arm; None: not known
    cavities: ClassVar[tuple[str, ...]] = ("the arm",)
    fractions: ClassVar[Mapping[str, float]] = {"the arm": 1.0}
    has_plane: ClassVar[bool] = True
    plane: ClassVar[None] = None

    def __post_init__(self) -> None:
        if len(self.pressures) < 1 or np.any(np.diff(self.pressures) <= 0.0) or self.pressures[0] < 0.0:
            raise RodError("The pressures of a rod must rise, from 0 kPa at least.")
        if self.moment_ranges and len(self.moment_ranges) != len(self.pressures):
            raise RodError("Where ranges of moments are given, every pressure needs its own.")
        self.at(float(self.pressures[0]))  # refuses an s that does not rise to the length

    @property
    def rows(self) -> tuple[Pressures, ...]:
        """The pressures, kPa."""
        return tuple((float(pressure),) for pressure in self.pressures)

    def at(self, pressure: Amount | Sequence[Amount]) -> Rod:
        """The rod at a pressure (kPa) in the identified range, which may be a tuple of one.

        Raises `RodError` outside the range, and for another number of pressures.
        """
        (pressure,) = pressures_of(pressure, self.cavities)
        origin, (i, j, t) = self.origin_at(pressure), self._interval(pressure)  # refuse what is outside
        ranges = self.moment_ranges
        law = FiveParameters(*(self._at([getattr(law, n) for law in self.laws], pressure) for n in PARAMETER_NAMES))
        kappa_0 = self._shape_at(self.kappa_0, pressure)
        theta0 = float(self._shape_at(self.theta0, pressure))
        profile = np.column_stack([self.s, kappa_0])
        return Rod(
            self.length,
            profile,
            law,
            theta0,
            weight=self.weight,
            weight_height=self.weight_height,
            mass=self.mass,
            moment_range=ranges[i].between(ranges[j], t) if ranges else None,
            notes=() if origin == IDENTIFIED else (f"The parameters at {pressure:g} kPa are {origin}.",),
        )

    def _at(self, values: Any, pressure: float) -> Any:
        """Values (n, ...) over the pressures at one of them, or at one between by monotone cubics."""
        p, v = self.pressures, np.asarray(values, float)
        known = known_at(p, pressure)
        return cubic(p, v, monotone_slopes(p, v), pressure) if known is None else v[known]

    def _shape_at(self, values: Any, pressure: float) -> Any:
        """Values (n, ...) at a pressure, by cubics that are linear in them; those of a straight arm are zero."""
        p, v = self.pressures, np.asarray(values, float)
        if self.straight_without_pressure and p[0] > 0.0:
            p, v = np.append(0.0, p), np.concatenate([np.zeros_like(v[:1]), v])
        known = known_at(p, pressure)
        if known is not None:
            return v[known]
        return cubic(p, v, np.gradient(v, p, axis=0, edge_order=2 if len(p) > 2 else 1), pressure)

    def origin_at(self, pressure: float) -> str:
        """Where the numbers at a pressure (kPa) come from, in words. Raises `RodError` as `at`."""
        i, j, _ = self._interval(pressure)
        p = self.pressures
        if known_at(p, pressure) is not None:
            return IDENTIFIED
        return f"interpolated between those identified at {p[i]:g} and {p[j]:g} kPa"

    def _interval(self, pressure: float) -> tuple[int, int, float]:
        """Indices of the two pressures between which to interpolate, and the fraction of the interval between them."""
        p = self.pressures
        pressure = as_known(p, finite(pressure, "The pressure in kPa"))
        if not p[0] <= pressure <= p[-1]:
            raise RodError(f"{pressure:g} kPa lies outside the identified range of {p[0]:g} to {p[-1]:g} kPa.")
        if len(p) == 1:
            return 0, 0, 0.0
        i = int(np.clip(np.searchsorted(p, pressure) - 1, 0, len(p) - 2))
        return i, i + 1, float((pressure - p[i]) / (p[i + 1] - p[i]))
