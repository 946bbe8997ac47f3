"""The arm's own law at one pressure, its sections and its ends, as the elements read them."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from geometry.arrays import Array
from rod.along import Position
from rod.arm.end_kernels import EndArrays
from rod.arm.section_kernels import COLUMNS, TABULATED, SectionArrays
from rod.arm.sections import RIGID
from rod.arm_law.curves import ClampCurve, TipCurve, TipState
from rod.arm_law.section import SectionLaw
from rod.cubics import cubic, cubic_coefficients, cubic_slope, parabola_slopes

#: intervals of the table over the curvature
INTERVALS = 1024
#: Newton's method for the moment at a curvature: iterations
ITERATIONS = 6
#: Newton's method for the curvature at a node: most iterations, and the last change over all curvatures of the law
STRAINS, SETTLED = 12, 1e-14
#: of the columns, rigidities in N, and those that every law has
IN_NEWTON = frozenset({"axial_rigidity", "shear_rigidity", "lateral_shear_rigidity"})
OVER_MOMENT = frozenset({"axial_rigidity", "shear_rigidity"})


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class TabulatedSection:
    """The arm's own law at one pressure, over its curvature."""

    law: SectionLaw
    length: float  #: mm, of the arm

    @cached_property
    def _over_kappa(self) -> tuple[Array, Array]:
        """Equally spaced curvatures (n,), and the moments there."""
        law = self.law
        kappa = np.linspace(law.kappa[0], law.kappa[-1], INTERVALS + 1)
        moment = np.interp(kappa, law.kappa, law.moment)
        low = law.moment[np.clip(np.searchsorted(law.kappa, kappa, side="right") - 1, 0, len(law.moment) - 2)]
        high = low + (law.moment[1] - law.moment[0])
        for _ in range(ITERATIONS):
            slope = np.maximum(cubic_slope(law.moment, law.kappa, law.kappa_slope, moment), 1e-3 * self._softest)
            moment = np.clip(
                moment - (cubic(law.moment, law.kappa, law.kappa_slope, moment) - kappa) / slope, low, high
            )
        moment[0], moment[-1] = law.moment[0], law.moment[-1]
        return kappa, moment

    @property
    def _softest(self) -> float:
        return float(np.median(self.law.kappa_slope))

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """(4, n, c) coefficients by COLUMNS, and first curvature and step."""
        law, (kappa, moment) = self.law, self._over_kappa
        slope = np.maximum(cubic_slope(law.moment, law.kappa, law.kappa_slope, moment), 1e-3 * self._softest)
        columns = [moment, cubic(law.moment, law.stretch, law.stretch_slope, moment)]
        slopes = [1.0 / slope, cubic_slope(law.moment, law.stretch, law.stretch_slope, moment) / slope]
        across = law.in_space.get("lateral_rigidity")
        softest = min(self.rigidity, np.inf if across is None else abs(float(across[len(across) // 2])))
        most = RIGID * softest / self.length**2  # N; with a stiffer one digits would be lost
        for name in COLUMNS[2:]:
            if name not in OVER_MOMENT and name not in law.in_space:
                break
            rows = getattr(law, name) if name in OVER_MOMENT else law.in_space[name]
            rows = np.minimum(rows, most) if name in IN_NEWTON else rows
            column = cubic(law.moment, rows, parabola_slopes(law.moment, rows), moment)
            columns.append(column)
            slopes.append(parabola_slopes(kappa, column))
        table = cubic_coefficients(kappa, np.column_stack(columns), np.column_stack(slopes))
        return np.ascontiguousarray(table), np.array([kappa[0], kappa[1] - kappa[0]])

    def arrays(self, s: Array, factor: float = 1.0, grown: float = 1.0) -> SectionArrays:
        """Arrays as `Section` has them."""
        table, numbers = self._table
        local = np.zeros((len(s) - 1, 4))
        if grown < 1.0:
            local[:, 0] = (1.0 - grown) * self._at_rest[0]
        return SectionArrays(TABULATED, table, numbers, local)

    def rest(self, s: Array, grown: float = 1.0) -> Array:
        """Strains at rest as `Section` has them."""
        kappa_0, stretch = self._at_rest
        return np.tile([0.0, 0.0, grown * kappa_0, stretch], (len(s) - 1, 1))

    @cached_property
    def _at_rest(self) -> tuple[float, float]:
        """Curvature (1/mm) and stretch without loads."""
        law = self.law
        return law.kappa_0, float(cubic(law.moment, law.stretch, law.stretch_slope, 0.0))

    @property
    def rigidity(self) -> float:
        """N mm2."""
        slopes = self.law.kappa_slope
        return 1.0 / float(slopes[len(slopes) // 2])

    def strains(self, moment: Array, force: Array) -> tuple[Array, Array, Array]:
        """Curvatures (N, 3) and stretch and shears (N, 3) under moments and forces (N, 3) in the frame; and the moments
        (N,) that bend the cells, N mm."""
        table, (first, step) = self._table
        axial, across = force[:, 0], force[:, 2]
        low, high = first, first + step * table.shape[1]
        kappa = np.interp(moment[:, 2], self._over_kappa[1], self._over_kappa[0])
        for _ in range(STRAINS):
            inside = np.clip(kappa, low, high)
            i = np.minimum(((inside - first) / step).astype(int), table.shape[1] - 1)
            x, (c0, c1, c2, c3) = (inside - first - i * step)[:, None], table[:, i]
            values = c0 + x * (c1 + x * (c2 + x * c3))
            slopes, curved = c1 + x * (2.0 * c2 + 3.0 * x * c3), 2.0 * c2 + 6.0 * x * c3
            beyond = kappa - inside
            values[:, :2] += beyond[:, None] * slopes[:, :2]
            bends, slopes[:, 2:][beyond != 0.0] = values[:, 0], 0.0
            longer, shear = axial / values[:, 2], force[:, 1] / values[:, 3]
            by_force = longer * (0.5 * slopes[:, 2] * longer - values[:, 2] * slopes[:, 1])
            by_force = by_force + 0.5 * slopes[:, 3] * shear**2
            twisted = np.zeros((len(kappa), 3))  # twist, lateral curvature, lateral shear
            if values.shape[1] > 4:
                B, GJ, GA, height = values[:, 4:].T
                slip = across / GA
                twisted[:, 0] = (moment[:, 0] - height * across) / GJ
                twisted[:, 1] = moment[:, 1] / B
                twisted[:, 2] = slip - height * twisted[:, 0]
                energy = slopes[:, 4] * twisted[:, 1] ** 2 + slopes[:, 5] * twisted[:, 0] ** 2 + slopes[:, 6] * slip**2
                by_force = by_force + 0.5 * energy + across * slopes[:, 7] * twisted[:, 0]
            change = (moment[:, 2] - bends - by_force) / (slopes[:, 0] - axial * curved[:, 1])
            kappa = kappa + change
            if np.abs(change).max() <= SETTLED * (high - low):
                break
        stretch = values[:, 1] + longer
        curvature = np.column_stack([twisted[:, :2], kappa])
        return curvature, np.column_stack([stretch, shear, twisted[:, 2]]), bends


def tip_state(tip: TipCurve, position: Position) -> TipState:
    """The tip that is free, held along x or at a height, or along both in one point."""
    x, y, _ = position
    if x is None and y is None:
        return tip.free
    if x is None:
        return tip.held
    return tip.held_along_x if y is None else tip.pinned


def end_arrays(clamp: ClampCurve, tip: TipState) -> EndArrays:
    """Both ends of an arm with a plane of symmetry."""
    n = len(tip.couple)
    zero = np.zeros((n, 1))
    table = np.column_stack([tip.couple, tip.acts_at, zero, tip.beside[:, -1], zero])
    values, slopes = tip.over_turns(table)
    lateral = clamp.lateral_compliance if clamp.lateral_compliance.size else np.zeros((2, 2))
    return EndArrays(
        False,
        writable(clamp.moment),
        writable(np.column_stack([clamp.rotation, clamp.offset])),
        writable(np.column_stack([clamp.rotation_by_moment, clamp.offset_by_moment])),
        writable(lateral),
        np.zeros((1, 1, 6)),
        writable(values),
        writable(slopes),
        writable(tip.by_pull[-1]),
    )


def writable(values: Array) -> Array:
    """A copy that may be written, row by row in memory; for other arrays numba would compile the solver again."""
    return np.array(values, order="C", dtype=float)
