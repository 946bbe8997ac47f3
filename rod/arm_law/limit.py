"""Limits of the pressure: where a form of an arm is lost, and its chambers swell or shrink at once.

With the energy W(kappa, V) over curvature and volume V of its air, p = dW/dV; under a given pressure a cell is stable
while p rises with V. Beyond a maximum it jumps to a larger volume, which it holds down to the next minimum.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, final

from geometry.arrays import Array, freeze
from rod.arm_law.curves import nothing
from rod.errors import RodError


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class PressureLimit:
    """A pressure at which a form of an arm is lost. Raises `RodError` unless it is above 0 kPa."""

    value: Annotated[float, "value"]  #: kPa
    std: Annotated[float | None, "std"] = None  #: kPa, due to the mesh; None: not known
    #: kPa per mm, MPa or 1 of a parameter of the design, by its key
    rates: Annotated[Mapping[str, float], "derivatives"] = field(default_factory=dict)
    #: states without moment along the volume of the air, from one form to the other: kPa, and curvatures in 1/mm
    pressures: Annotated[Array, "way.pressure_kPa", "k"] = field(default_factory=nothing)
    kappas: Annotated[Array, "way.kappa_per_mm", "k"] = field(default_factory=nothing)

    def __post_init__(self) -> None:
        freeze(self, ("pressures", "kappas"))
        if not (math.isfinite(self.value) and self.value > 0.0):
            raise RodError(f"A limit pressure is above 0 kPa, not {self.value:g}.")

    def scaled(self, factor: float, units: Mapping[str, str]) -> "PressureLimit":
        """The limit of an arm whose moduli are all multiplied by a factor; exact.

        units: of the parameters with a derivative; a modulus is multiplied itself.
        """
        powers = {name: float(unit != "MPa") for name, unit in units.items() if name in self.rates}
        rates = {name: factor**power * self.rates[name] for name, power in powers.items()}
        return replace(self._times(factor), rates=rates)

    def growing(self, rate: float) -> "PressureLimit":
        """The limit of an arm whose moduli are exp(rate p) times as large at a pressure p; rate: 1/kPa."""
        factor, slope = math.exp(rate * self.value), 1.0 + rate * self.value
        rates = {name: factor * slope * by for name, by in self.rates.items()}
        std = None if self.std is None else factor * slope * self.std
        return replace(self._times(factor), std=std, rates=rates)

    def changed(self, changes: Mapping[str, float]) -> "PressureLimit":
        """After small changes of parameters, to first order; a limit without a derivative by one stays."""
        change = sum(self.rates.get(name, 0.0) * amount for name, amount in changes.items())
        return self._times(1.0 + change / self.value)

    def _times(self, factor: float) -> "PressureLimit":
        std = None if self.std is None else factor * self.std
        return replace(self, value=factor * self.value, std=std, pressures=factor * self.pressures)
