"""What the law of one arm, calibrated to its rows, says of another arm of the same silicone, with intervals."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.answers.measured.fit import Fitted, effects_on, fit, numbers_of
from pipeline.answers.measured.gaussian import Posterior
from pipeline.answers.measured.predicted import Numbers
from pipeline.answers.measured.rows import Measurements
from pipeline.answers.measured.unknowns import CLAMP, GAUGE, MODULUS, BuiltArm, unknowns_of
from rod.arm_law.law import ArmLaw

#: what arms of one batch of silicone have in common
OF_RUBBER = (MODULUS,)


@dataclass(frozen=True, eq=False)  # arrays inside
class Calibrated:
    """An arm fitted to its rows."""

    arm: BuiltArm
    fitted: Fitted

    @classmethod
    def to(cls, law: ArmLaw, config: Mapping[str, Any], rows: Measurements) -> "Calibrated":
        """The law of an arm fitted to its rows.

        The unknowns are a factor of all moduli, the offset of the gauge and the angle of the clamp. `pneurod calibrate`
        also frees a trend of the moduli and the second order of the strain, which leave no law of cells so inflated.
        """
        unknowns = unknowns_of(law, config, (), max(rows.pressures_kPa))
        arm = BuiltArm(law, tuple(one for one in unknowns if one.name in (MODULUS, GAUGE, CLAMP)))
        return cls(arm, fit(arm, Numbers.of(rows)))

    def for_arm(self, law: ArmLaw) -> "Foretelling":
        """Another arm of the same silicone. Its dimensions, gauge and clamp are known as before a measurement."""
        kept = np.array([one.name in OF_RUBBER for one in self.arm.unknowns])
        known, stds = self.fitted.posterior, np.array([one.std for one in self.arm.unknowns])
        covariance = np.where(np.outer(kept, kept), known.covariance, np.diag(stds**2))
        posterior = replace(known, covariance=covariance, gain=known.gain * kept[:, None])
        return Foretelling(replace(self.arm, law=law), posterior, self.fitted.changes * kept)

    def told(self) -> list[list[str]]:
        """Lines of a table: each unknown before and after, with standard deviations."""
        rows = zip(self.arm.unknowns, self.fitted.changes.tolist(), self.fitted.posterior.stds.tolist(), strict=True)
        return [
            [f"{u.name}, {u.unit}".removesuffix(", 1"), f"{u.drawn:.3g} ± {u.std:.2g}",
             f"{u.value(change):.3g} ± {u.std_of(change, std):.2g}"]
            for u, change, std in rows
        ]  # fmt: skip

    @property
    def same(self) -> "Foretelling":
        """The arm itself."""
        return Foretelling(self.arm, self.fitted.posterior, self.fitted.changes)


@dataclass(frozen=True, eq=False)  # arrays inside
class Foretelling:
    """An arm with what is known of it."""

    arm: BuiltArm
    posterior: Posterior
    changes: Array

    def intervals(self, rows: Measurements) -> Array:
        """(3, n): numbers of rows, and the ends of the intervals that hold nine of ten readings.

        The deviation of a number is that of the logarithm of the modulus which changes it as much. The ends of the
        interval of the modulus are carried through the curve of the rod, which is far from straight where it is steep.
        """
        numbers = Numbers.of(rows)
        middle, effects = numbers_of(self.arm, numbers, self.changes), effects_on(self.arm, numbers, self.changes)
        off = self.posterior.quantile * self.posterior.deviations(effects)
        scatter = self.posterior.quantile * np.sqrt(np.diag(self.posterior.spread.scatter_of(numbers.units)))
        ends = np.array([
            [self._with_modulus(one, sign * change) for sign in (-1.0, 1.0)]
            for one, change in zip(each_row(rows), off / effects.by_unknown[:, 0], strict=True)
        ])  # fmt: skip
        low, high = middle - ends.min(axis=1), ends.max(axis=1) - middle
        return np.array([middle, middle - np.hypot(low, scatter), middle + np.hypot(high, scatter)])

    def _with_modulus(self, row: Measurements, change: float) -> float:
        """The number of one row with another logarithm of the modulus."""
        changes = self.changes + np.array([change, *np.zeros(len(self.changes) - 1)])
        return float(numbers_of(self.arm, Numbers.of(row), changes)[0])


def each_row(rows: Measurements) -> list[Measurements]:
    """Every row by itself."""
    return [replace(rows, rows=(row,)) for row in rows.rows]
