"""The sections of an arm at one pressure: tabulated, of two lines, or polynomial.

Each gives the arrays that the elements read, its strains without loads, and its strains under given forces.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, final

import numpy as np

from geometry.arrays import Array
from rod.arm.chain import Nodes, in_frame
from rod.arm.section_kernels import BEYOND, COLUMNS, LINES, POLYNOMIAL, TABULATED, SectionArrays
from rod.arm_law.polynomial import Plane
from rod.arm_law.section import SectionLaw
from rod.cubics import cubic, cubic_coefficients, cubic_slope, parabola_slopes
from rod.errors import RodError
from rod.law import TwoSlopes

#: intervals of the table over the curvature
INTERVALS = 1024
#: Newton's method for the moment at a curvature: iterations
ITERATIONS = 6
#: largest rigidity against stretch and shear, over that against bending over the length squared
RIGID = 1e8
#: of the columns, rigidities in N, and those that every law has
IN_NEWTON = frozenset({"axial_rigidity", "shear_rigidity", "lateral_shear_rigidity"})
OVER_MOMENT = frozenset({"axial_rigidity", "shear_rigidity"})
#: Newton's method for the curvature at a node: most iterations, and the last change over all curvatures of the law
STRAINS, SETTLED = 12, 1e-14


class Section(Protocol):
    """What the arm asks of its sections."""

    def arrays(self, s: Array, factor: float = 1.0, grown: float = 1.0) -> SectionArrays:
        """For elements between positions s (n + 1,); factor: part of the loads; grown: part of the rest curvature."""

    def rest(self, s: Array, grown: float = 1.0) -> Array:
        """(n, 4) curvatures (1/mm) and stretch of the elements without loads."""

    @property
    def rigidity(self) -> float:
        """Against bending, about, N mm2."""


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
        """As `Section` says."""
        table, numbers = self._table
        local = np.zeros((len(s) - 1, 4))
        if grown < 1.0:
            local[:, 0] = (1.0 - grown) * self._at_rest[0]
        return SectionArrays(TABULATED, table, numbers, local)

    def rest(self, s: Array, grown: float = 1.0) -> Array:
        """As `Section` says."""
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


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class LinesSection:
    """Two straight lines between moment and curvature, before and beyond a position, without stretch and shear."""

    law: TwoSlopes
    length: float  #: mm
    s: Array  #: (n,) mm, of kappa_0, joined by straight lines
    kappa_0: Array  #: (n,) 1/mm
    own_s: Array  #: (k,) mm, of the own moment
    own_moment: Array  #: (k,) N mm, of the weight under which the rod has kappa_0
    is_loaded: bool  #: whether anything acts: the intercepts of an idle rod are zero

    def with_own_moment(self, s: Array, moment: Array) -> "LinesSection":
        """The same with an own moment (k,) at positions (k,)."""
        return replace(self, own_s=s, own_moment=moment)

    @property
    def rigid(self) -> float:
        """N, against stretch and shear."""
        return RIGID * max(abs(self.law.alpha1), abs(self.law.alpha2)) / self.length**2

    def arrays(self, s: Array, factor: float = 1.0, grown: float = 1.0) -> SectionArrays:
        """As `Section` says."""
        middle = 0.5 * (s[1:] + s[:-1])
        rest, part = self.rest(s, grown), float(self.is_loaded)
        m0 = factor * (part * self.law.intercept(middle) + _means(self.own_s, self.own_moment, s))
        local = np.column_stack([rest[:, 2], self.law.rigidity(middle), m0])
        return SectionArrays(LINES, np.zeros((1, 1, 1)), np.array([self.rigid, self.rigid]), local)

    def rest(self, s: Array, grown: float = 1.0) -> Array:
        """As `Section` says."""
        result = np.zeros((len(s) - 1, 4))
        result[:, 2] = grown * _means(self.s, self.kappa_0, s)
        result[:, 3] = 1.0
        return result

    @property
    def rigidity(self) -> float:
        """N mm2."""
        return min(abs(self.law.alpha1), abs(self.law.alpha2))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class PolynomialSection:
    """The law of an arm without a plane of symmetry at given pressures, as polynomials of both curvatures."""

    #: of the curvatures: the columns of `SectionArrays.table`
    plane: Plane
    EA: float  #: N
    compliance: Array  #: (3, 3) of twist, shear and lateral shear
    origin: Array  #: (2,) 1/mm, curvatures without moment
    reach: float  #: 1/mm

    @staticmethod
    def of(w: Plane, stretch: Plane, EA: Plane, compliance: Array, reach: float) -> "PolynomialSection":
        """From polynomials of the curvatures. Raises `RodError` where no curvature has no moment."""
        first, other = w.derivative(0), w.derivative(1)
        by_first, by_other = stretch.derivative(0), stretch.derivative(1)
        columns = [first, other, first.derivative(0), first.derivative(1), other.derivative(1), stretch]
        columns += [by_first, by_other, by_first.derivative(0), by_first.derivative(1), by_other.derivative(1)]
        plane = Plane.joined(columns)
        origin = np.zeros(2)
        for _ in range(60):
            values = plane(origin)
            origin = origin - np.linalg.solve(_matrix(values), values[:2])
        softest = float(np.linalg.eigvalsh(_matrix(plane(origin)))[0]) if np.isfinite(origin).all() else -1.0
        if not softest > 0.0:
            raise RodError("The law in space has no stable state without moment at these pressures.")
        return PolynomialSection(plane, float(EA(origin)[0]), compliance, origin, reach)

    def arrays(self, s: Array, factor: float = 1.0, grown: float = 1.0) -> SectionArrays:
        """As `Section` says."""
        stiff = np.linalg.inv(self.compliance)
        numbers = np.concatenate([[self.EA], stiff.ravel(), self.origin, [self.reach]])
        return SectionArrays(POLYNOMIAL, np.ascontiguousarray(self.plane.table), numbers, np.zeros((len(s) - 1, 4)))

    def rest(self, s: Array, grown: float = 1.0) -> Array:
        """As `Section` says."""
        return np.tile([0.0, *self.origin, float(self.plane(self.origin)[5])], (len(s) - 1, 1))

    @property
    def rigidities(self) -> tuple[float, float]:
        """N mm2, the smaller and the larger one, without moment."""
        least, most = np.linalg.eigvalsh(_matrix(self.plane(self.origin)))
        return float(least), float(most)

    @property
    def rigidity(self) -> float:
        """N mm2, the smaller one."""
        return self.rigidities[0]

    def strains(self, moment: Array, force: Array) -> tuple[Array, Array]:
        """Curvatures (N, 3) and stretch and shears (N, 3) under moments and forces (N, 3) in the frame."""
        kappa = np.tile(self.origin, (len(moment), 1))
        for _ in range(STRAINS):
            values = self.plane(kappa)
            left = values[:, :2] - force[:, :1] * values[:, 6:8] - moment[:, 1:]
            matrices = values[:, [2, 3, 3, 4]] - force[:, :1] * values[:, [8, 9, 9, 10]]
            away = kappa - np.linalg.solve(matrices.reshape(-1, 2, 2), left[..., None])[..., 0] - self.origin
            size = np.linalg.norm(away, axis=1, keepdims=True)
            before, kappa = kappa, self.origin + away * np.minimum(1.0, BEYOND * self.reach / np.maximum(size, 1e-300))
            if np.abs(kappa - before).max() <= SETTLED * self.reach:
                break
        twisted = np.column_stack([moment[:, 0], force[:, 1:]]) @ self.compliance
        stretch = self.plane(kappa)[:, 5] + force[:, 0] / self.EA
        return np.column_stack([twisted[:, 0], kappa]), np.column_stack([stretch, twisted[:, 1:]])


def _means(known: Array, values: Array, s: Array) -> Array:
    """(n - 1,) means over the intervals between positions s (n,) of values (k,) that straight lines join."""
    area = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(known) * (values[1:] + values[:-1]))])
    k = np.clip(np.searchsorted(known, s, side="right") - 1, 0, len(known) - 2)
    filled = area[k] + 0.5 * (s - known[k]) * (values[k] + np.interp(s, known, values))
    return np.asarray(np.diff(filled) / np.diff(s))


def _matrix(values: Array) -> Array:
    """(2, 2) rigidities among the columns of a polynomial section."""
    return np.array([[values[2], values[3]], [values[3], values[4]]])


def acting_in_frames(nodes: Nodes) -> tuple[Array, Array]:
    """Moments and forces (N, 3) on the part before each node, along its frame."""
    return in_frame(nodes.frames, nodes.moment), in_frame(nodes.frames, nodes.inner)
