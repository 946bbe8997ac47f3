"""The contact barrier between walls that look at each other, as a function of their signed gap.

A barrier that is infinite at contact keeps every Newton iterate on its side, so steps are cut and distances that came
out too small only double from one iteration to the next. This one is continued quadratically below a part of its
activation distance: no step has to be cut, and an iterate may pass through. A converged state may not: its gaps are
checked, and crossing walls (by exact intersection tests) are refused, see `fem.effects.contact`.

As no iterate is held back by it, the barrier need not be infinite where walls meet, nor stiff. A part of its width,
BEHIND, lies behind the wall, so that walls in contact rest near their surface. Where a pressure on a small spot pushes
them through each other all the same, the state found is the start of a search with a stiffer one.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import final

import numpy as np

from fem.effects.effect import Blocks, Term
from fem.effects.facing_pairs import FacingPairs, LocalPairs
from geometry.arrays import Array

#: part of the barrier's width that lies behind the wall: without it walls rest at nine tenths of the width; with 0.75
#: they cross on the coarse arm (a), test III, 37 kPa, and a firmer contact must help (`fem.effects.contact.STIFFNESS`)
BEHIND = 0.7
#: what the stiffness is raised by where walls pass through each other, and how often
FIRMER, TIMES = 4.0, 2
#: distance over the barrier's width below which it is continued quadratically
CONTINUED = 0.5
#: what ipctk's improved-max collision set sums up to over one wall's area, measured on parallel grids, for both walls
WEIGHT = 1.55 / 2


@final
@dataclass(frozen=True, eq=False)  # arrays inside: two terms are the same one or not
class FacingTerm(Term):
    """Sum over facing pairs of area times stiffness times phi(gap)."""

    effect = "self_contact"

    pairs: FacingPairs
    dhat: float  #: activation distance: the gap at which the barrier begins, mm
    stiffness: float  #: MPa
    behind: float  #: part of the barrier's width that lies behind the wall
    waits: bool  #: stays out of the sum until a state without it comes within dhat
    exact: Callable[[], Term] = field(repr=False)  #: gives the barrier with exact distances
    firmer: int = field(default=TIMES, repr=False)  #: how often the stiffness may still be raised

    def energy(self, x: Array, factor: float) -> float:
        value, _, _ = contact_potential(self.pairs.gaps(x), self.dhat, self.behind)
        return WEIGHT * self.stiffness * float(self.pairs.area @ value)

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        local, slope, _ = self._derivatives(x)
        np.add.at(out, local.nodes, slope[:, None, None] * local.first)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        local, slope, bend = self._derivatives(x)
        a, b = np.triu_indices(4)
        first = local.first
        values = bend[:, None, None, None] * first[:, a, :, None] * first[:, b, None, :]
        if not convex:
            values += slope[:, None, None, None] * local.second(a, b)
        rows, columns = local.nodes[:, a], local.nodes[:, b]
        swap = rows > columns
        values[swap] = values[swap].transpose(0, 2, 1)
        low, high = np.minimum(rows, columns), np.maximum(rows, columns)
        return Blocks(low.ravel(), high.ravel(), values.reshape(-1, 3, 3))

    def step_limit(self, x: Array, dx: Array) -> float:
        return 1.0

    def wanted(self, x: Array) -> bool:
        return not self.waits or self.gap(x) < self.dhat

    def objection(self, x: Array) -> str:
        gaps = self.pairs.gaps(x)
        if gaps.min() > self.dhat:
            return ""
        if gaps.min() <= 0:
            place = x[self.pairs.nodes[int(np.argmin(gaps))]]
            return f"two walls pass through each other at ({place[0]:.1f}, {place[1]:.1f}, {place[2]:.1f}) mm"
        return self.exact().objection(x)

    def at(self, share: float) -> Term:
        return self

    def advanced(self, x: Array, dx: Array) -> Term:
        return self

    def stricter(self, x: Array) -> Term:
        if self.firmer and self.gap(x) <= 0:
            return replace(self, stiffness=FIRMER * self.stiffness, firmer=self.firmer - 1)
        return self.exact()

    def gap(self, x: Array) -> float:
        return float(self.pairs.gaps(x).min(initial=np.inf))

    def touching(self, x: Array) -> bool:
        return self.gap(x) < self.dhat

    def _derivatives(self, x: Array) -> tuple[LocalPairs, Array, Array]:
        """All pairs, with first and second derivative of their energy by the gap (k,), zero beyond dhat.

        All of them, so that the matrix keeps one pattern: on the coarse arm (a) that costs 8 % in each factorization
        and saves nine symbolic analyses of ten.
        """
        local = self.pairs.local(x)
        _, slope, bend = contact_potential(local.gap, self.dhat, self.behind)
        scale = WEIGHT * self.stiffness * self.pairs.area
        return local, scale * slope, scale * bend


def contact_potential(gap: Array, dhat: float, behind: float = BEHIND) -> tuple[Array, Array, Array]:
    """The barrier that begins at the gap dhat and of whose width a part lies behind the wall, with first and second
    derivative.

    gap (k,) in mm; values in mm, 1 and 1/mm.
    """
    width = dhat / (1.0 - behind)
    return continued_barrier(gap + behind * width, width)


def continued_barrier(distance: Array, width: float) -> tuple[Array, Array, Array]:
    """phi(d) = w (1 - r)^2 (-ln r), r = (d / w)^2, with first and second derivative; 0 beyond the width w, quadratic
    below CONTINUED w. Distances d (k,) in mm; values in mm, 1 and 1/mm."""
    start = CONTINUED * width
    inside = np.clip(distance, start, width)
    r = (inside / width) ** 2
    log = -np.log(r)
    slope_r = -2 * (1 - r) * log - (1 - r) ** 2 / r
    bend_r = 2 * log + 4 * (1 - r) / r + (1 - r) ** 2 / r**2
    r1, r2 = 2 * inside / width**2, 2 / width**2
    value = width * (1 - r) ** 2 * log
    slope = width * slope_r * r1
    bend = width * (bend_r * r1**2 + slope_r * r2)
    below = np.minimum(distance - start, 0.0)
    beyond = distance >= width
    return (
        np.where(beyond, 0.0, value + slope * below + 0.5 * bend * below**2),
        np.where(beyond, 0.0, slope + bend * below),
        np.where(beyond, 0.0, bend),
    )
