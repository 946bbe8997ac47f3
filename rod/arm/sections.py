"""The sections of an arm at one pressure, as the elements read them, and those with two straight lines."""

from dataclasses import dataclass
from typing import Protocol, final

import numpy as np

from geometry.arrays import Array
from rod.arm.section_kernels import LINES, SectionArrays
from rod.law import TwoSlopes

#: largest rigidity against stretch and shear, over that against bending over the length squared
RIGID = 1e8


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
class LinesSection:
    """Two straight lines between moment and curvature, before and beyond a position, without stretch and shear."""

    law: TwoSlopes
    length: float  #: mm
    s: Array  #: (n,) mm, of kappa_0, joined by straight lines
    kappa_0: Array  #: (n,) 1/mm
    own_s: Array  #: (k,) mm, of the own moment
    own_moment: Array  #: (k,) N mm, of the weight under which the rod has kappa_0
    is_loaded: bool  #: whether anything acts: the intercepts of an idle rod are zero

    @property
    def rigid(self) -> float:
        """N, against stretch and shear."""
        return RIGID * max(abs(self.law.alpha1), abs(self.law.alpha2)) / self.length**2

    def arrays(self, s: Array, factor: float = 1.0, grown: float = 1.0) -> SectionArrays:
        """Arrays as `Section` has them."""
        middle = 0.5 * (s[1:] + s[:-1])
        rest, part = self.rest(s, grown), float(self.is_loaded)
        m0 = factor * (part * self.law.intercept(middle) + _means(self.own_s, self.own_moment, s))
        local = np.column_stack([rest[:, 2], self.law.rigidity(middle), m0])
        return SectionArrays(LINES, np.zeros((1, 1, 1)), np.array([self.rigid, self.rigid]), local)

    def rest(self, s: Array, grown: float = 1.0) -> Array:
        """Strains at rest as `Section` has them."""
        result = np.zeros((len(s) - 1, 4))
        result[:, 2] = grown * _means(self.s, self.kappa_0, s)
        result[:, 3] = 1.0
        return result

    @property
    def rigidity(self) -> float:
        """N mm2."""
        return min(abs(self.law.alpha1), abs(self.law.alpha2))


def _means(known: Array, values: Array, s: Array) -> Array:
    """(n - 1,) means over the intervals between positions s (n,) of values (k,) that straight lines join."""
    area = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(known) * (values[1:] + values[:-1]))])
    k = np.clip(np.searchsorted(known, s, side="right") - 1, 0, len(known) - 2)
    filled = area[k] + 0.5 * (s - known[k]) * (values[k] + np.interp(s, known, values))
    return np.asarray(np.diff(filled) / np.diff(s))
