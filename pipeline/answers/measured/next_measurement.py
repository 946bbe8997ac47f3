"""Which measurement would help most: the one after which the tip is known best, at all pressures and under loads."""

from dataclasses import dataclass, replace

import numpy as np

from pipeline.answers.measured.fit import OF_POSITIONS, effects_on
from pipeline.answers.measured.gaussian import Effects, Gaussian
from pipeline.answers.measured.predicted import Numbers
from pipeline.answers.measured.rows import Measurements, Row, State
from pipeline.answers.measured.unknowns import BuiltArm
from pipeline.values.errors import InputError
from rod.arm_law.law import ArmLaw

#: pressures over the highest one, and the forces across the end over the rigidity / length^2
PRESSURES, FORCES = (0.2, 0.4, 0.6, 0.8, 0.95), (0.0, 0.1, -0.1)


@dataclass(frozen=True)
class NextMeasurement:
    """A state in which the tip is worth measuring, and what it is worth."""

    pressure_kPa: float
    force_y_N: float  #: dead force on the end
    tip_std_mm: float  #: root mean square over pressures and loads, now
    tip_std_then_mm: float  #: after this measurement

    @property
    def text(self) -> str:
        """In words."""
        at = f"tip at {self.pressure_kPa:.3g} kPa"
        tip = f"{at} under {self.force_y_N:.3g} N in y" if self.force_y_N else f"unloaded {at}"
        return (
            f"Best next measurement: the {tip}. It lowers the tip's standard deviation from "
            f"{self.tip_std_mm:.2g} to {self.tip_std_then_mm:.2g} mm."
        )


def next_measurement(arm: BuiltArm, fitted: Gaussian, law: ArmLaw) -> NextMeasurement:
    """Of the tip in some states, the one that leaves the least variance of the tip in all of them, to first order.

    law: of the calibrated arm.
    """
    rigidity = 1.0 / float(np.interp(0.0, (known := law.at(law.pressures[-1]).section).moment, known.kappa_slope))
    unit = rigidity / law.length**2
    states = [State(part * law.pressures[-1], (0.0, force * unit)) for part in PRESSURES for force in FORCES]
    reached, effects = [], []
    for state in states:
        row = Row(0, state, {"tip_x": 0.0, "tip_y": 0.0})
        try:
            effects.append(effects_on(arm, Numbers.of(Measurements("", (row,))), fitted.changes))
            reached.append(state)
        except InputError:  # no rod there
            continue
    targets = Effects.joined(effects)
    now = _deviation(fitted, targets)
    then = [_deviation(_after(fitted, one, law.length), targets) for one in effects]
    best = int(np.argmin(then))
    return NextMeasurement(reached[best].pressure_kPa, reached[best].force_N[1], now, then[best])


def _deviation(fitted: Gaussian, targets: Effects) -> float:
    """mm, root mean square of the distance of the tip."""
    return float(np.sqrt(2.0 * np.diag(fitted.error_covariance(targets)).mean()))


def _after(fitted: Gaussian, effects: Effects, length: float) -> Gaussian:
    """With two numbers more, whose values do not matter."""
    scatter = {"mm": OF_POSITIONS * length} | dict(fitted.spread.scatter)
    return replace(
        fitted,
        effects=Effects.joined([fitted.effects, effects]),
        residual=np.append(fitted.residual, np.zeros(2)),
        units=(*fitted.units, "mm", "mm"),
        spread=replace(fitted.spread, scatter=scatter),
    )
