"""The contact barrier between walls that face each other, as a function of their signed gap.

A barrier that is infinite at contact keeps every Newton iterate on its side, so steps are cut and distances that came
out too small only double from one iteration to the next. This one is continued quadratically below a part of its
activation distance: no step has to be cut, and an iterate may pass through. A converged state may not: its gaps are
checked, and crossing walls (by exact intersection tests) are refused, see `fem.effects.contact`.

As no iterate is held back by it, the barrier need not be infinite where walls meet, nor stiff. A part of its width, the
overlap, lies behind the wall, so that walls in contact rest near their surface. Where a pressure on a small spot pushes
them through each other all the same, the state is solved again with a stiffer barrier.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import NamedTuple, final

import numpy as np

from fem.effects.effect import Blocks, UnilateralTerm
from fem.effects.facing_pairs import FacingPairs, LocalPairs
from fem.effects.tightening import Tightening
from fem.kernels import contact as kernels
from fem.reasons import position_of
from geometry import Reason
from geometry.arrays import Array, Index

#: fraction of the barrier's width that lies behind the wall: without it walls in contact rest at nine tenths of the
#: width, with more of it they cross and the stiffness must be raised (studies/solver.md)
OVERLAP = 0.7
#: what the stiffness is multiplied by where walls pass through each other, and how often
STIFFENING_FACTOR, MAX_STIFFENINGS = 4.0, 2
#: how often pairs are added in an increment where walls cross in a crease; designs of studies/solver.md need one or two
MAX_CREASE_SEARCHES = 4
#: distance over the barrier's width below which it is continued quadratically
CONTINUATION = 0.5
#: compliance of the body at a pair over the smallest one of the barrier, as Newton's method assumes it where it chooses
#: the carried gap. 10 costs a twentieth more factorizations, 30 to 3000 as many (studies/solver.md)
COMPLIANCE = 300.0
#: largest number of iterations for a carried gap; it need not be exact
GAP_ITERATIONS = 20
#: a node presses beside the triangle of its pair where its projection onto it has a barycentric coordinate below minus
#: this number
BESIDE_TRIANGLE = 0.5
#: part of the contact force on such nodes from which on the contact is compared with that of exact distances
PART_BESIDE = 0.05
#: fraction of a motion over which the rates of the gaps are measured
RATE_STEP = 1e-3
#: what ipctk's improved-max collision set sums up to over one wall's area, measured on parallel grids, for both walls
WEIGHT = 1.55 / 2


class _Pressed(NamedTuple):
    """Pairs in contact, with the derivatives of their energy by the gap."""

    local: LocalPairs
    force: Array  #: (m,) first derivative, linearised around the carried gap, N
    slope: Array  #: (m,) first derivative at the carried gap, N
    curvature: Array  #: (m,) second derivative there, N/mm


@final
@dataclass(frozen=True, eq=False)  # arrays inside: two terms are the same one or not
class FacingTerm(UnilateralTerm):
    """Sum over facing pairs of area times stiffness times phi(gap).

    Newton's method carries a gap e of each pair, around which it linearises: phi'(g) ~ phi'(e) + phi''(e) (g - e).
    """

    effect = "self_contact"

    pairs: FacingPairs
    #: activation distance: the gap at which the barrier begins, mm; (k,) where it is not the same for all pairs
    dhat: float | Array
    stiffness: float  #: MPa
    overlap: float  #: fraction of the barrier's width that lies behind the wall
    starts_inactive: bool
    #: mm: where the matrix has no place for a pair in contact yet, it is given places for all pairs whose gap is below
    #: this at the same positions
    near: float = np.inf
    #: gives the barrier with exact distances, in which mirror images are kept apart with the given stiffness, MPa;
    #: None where a crossing is judged by the signed gaps alone
    exact: Callable[[float], UnilateralTerm] | None = field(default=None, repr=False)
    #: further pairs of walls that cross in a crease at positions (n, 3), besides the given ones, and their activation
    #: distances (m,), mm; None where they are not looked for
    pairs_in_creases: Callable[[Array, FacingPairs], tuple[FacingPairs, Array]] | None = field(default=None, repr=False)
    #: how often they may still be added in the increment
    crease_searches: int = field(default=MAX_CREASE_SEARCHES, repr=False)
    stiffenings: int = field(default=MAX_STIFFENINGS, repr=False)  #: how often the stiffness may still be raised
    carried: Array | None = field(default=None, repr=False)  #: (k,) the gaps e, mm; None where they are those of x

    def energy(self, x: Array, factor: float) -> float:
        value, _, _ = contact_potential(self.pairs.gaps(x), self.dhat, self.overlap)
        return WEIGHT * self.stiffness * float(self.pairs.area @ value)

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        pressed = self._pressed(x)
        kernels.add_forces(pressed.local.nodes, pressed.local.first, pressed.force, out)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        pressed = self._pressed(x)
        return Blocks(*pressed.local.blocks(pressed.curvature, 0.0 * pressed.slope if convex else pressed.slope))

    def near_pairs(self, x: Array) -> tuple[Index, Index]:
        return self.pairs.taken(np.flatnonzero(self.pairs.gaps(x) < self.near)).node_pairs

    def advanced(self, x: Array, dx: Array) -> "FacingTerm":
        now, change = self.pairs.gaps_after(x, dx)
        before = now if self.carried is None else self.carried
        _, slope, curvature = contact_potential(before, self.dhat, self.overlap)
        gap = now + change
        pressure = np.maximum(-slope - curvature * (gap - before), 0.0)
        return replace(self, carried=carried_gaps(gap, pressure, self.dhat, self.overlap))

    def settled(self) -> "FacingTerm":
        return replace(self, carried=None)

    def gap(self, x: Array) -> float:
        return float(self.pairs.gaps(x).min(initial=np.inf))

    def gap_ahead(self, x: Array, dx: Array) -> float:
        now = self.pairs.gaps(x)
        later = now + (self.pairs.gaps(x + RATE_STEP * dx) - now) / RATE_STEP
        return float(later.min(initial=np.inf))

    def touching(self, x: Array) -> bool:
        return bool((self.pairs.gaps(x) < self.dhat).any())

    def violation(self, x: Array) -> Reason | None:
        gaps = self.pairs.gaps(x)
        if not (gaps <= self.dhat).any():
            return None
        if gaps.min() <= 0:
            return Reason("walls_cross", where=position_of(x[self.pairs.nodes[int(np.argmin(gaps))]]))
        return self.exact(self.stiffness).violation(x) if self.exact else None

    def tightened(self, x: Array) -> UnilateralTerm:
        """A stiffer barrier where walls overlap, as often as that is tried; further pairs where others cross in a
        crease; else the barrier with exact distances, and the term itself where there is none."""
        overlaps = self.gap(x) <= 0
        if overlaps and self.stiffenings:
            return replace(self, stiffness=STIFFENING_FACTOR * self.stiffness, stiffenings=self.stiffenings - 1)
        if self.pairs_in_creases is not None and self.crease_searches and not overlaps:
            pairs, dhat = self.pairs_in_creases(x, self.pairs)
            if pairs.nodes.size:
                left, joined = self.crease_searches - 1, self.pairs.joined(pairs)
                return replace(
                    self, pairs=joined, dhat=np.append(self._dhats, dhat), crease_searches=left, carried=None
                )
        return self.exact(self.stiffness) if self.exact else self

    def tightening(self, model: UnilateralTerm) -> Tightening | None:
        if self is model or not isinstance(model, FacingTerm):
            return None
        added = np.arange(model.pairs.nodes.size, self.pairs.nodes.size)
        return Tightening(self.stiffness, self.stiffenings, False, self.pairs.taken(added), self._dhats[added])

    def with_tightening(self, tightening: Tightening) -> UnilateralTerm:
        if tightening.is_exact and self.exact:
            return self.exact(tightening.stiffness)
        term = replace(self, stiffness=tightening.stiffness, stiffenings=tightening.stiffenings)
        if not tightening.pairs.nodes.size:
            return term
        return replace(term, pairs=self.pairs.joined(tightening.pairs), dhat=np.append(self._dhats, tightening.dhat))

    def at_new_increment(self) -> UnilateralTerm:
        if self.crease_searches == MAX_CREASE_SEARCHES:
            return self
        return replace(self, crease_searches=MAX_CREASE_SEARCHES)

    def with_exact_distances(self, x: Array) -> UnilateralTerm:
        """The barrier with exact distances where nodes in a cavity press beside the triangles of their pairs.

        Cavities have no part of the barrier behind the wall. With such a part walls rest nearer to each other than with
        exact distances, and the two could not be compared.
        """
        if self.exact is None or self.overlap or self._part_beside(x) <= PART_BESIDE:
            return self
        return self.exact(self.stiffness)

    def _part_beside(self, x: Array) -> float:
        """Part of the contact force on nodes that press beside the triangles of their pairs at x (n, 3)."""
        which = np.flatnonzero((self.pairs.gaps(x) < self.dhat) & ~self.pairs.is_mirrored)
        if which.size == 0:
            return 0.0
        local = self.pairs.local(x, which)
        _, slope, _ = contact_potential(local.gap, self._dhats[which], self.overlap)
        force = -slope * self.pairs.area[which]
        return float(force[local.outside > BESIDE_TRIANGLE].sum() / force.sum())

    @property
    def _dhats(self) -> Array:
        """Of each pair, (k,)."""
        return np.broadcast_to(self.dhat, self.pairs.nodes.shape)

    def _pressed(self, x: Array) -> "_Pressed":
        """The pairs whose carried gap is below dhat, beyond which the barrier is zero."""
        gap = self.pairs.gaps(x) if self.carried is None else self.carried
        which = np.flatnonzero(gap < self.dhat)
        gap, dhat = gap[which], self._dhats[which]
        local, scale = self.pairs.local(x, which), WEIGHT * self.stiffness * self.pairs.area[which]
        _, slope, curvature = contact_potential(gap, dhat, self.overlap)
        force = slope if self.carried is None else slope + curvature * (local.gap - gap)
        return _Pressed(local, scale * force, scale * slope, scale * curvature)


def contact_potential(gap: Array, dhat: float | Array, overlap: float = OVERLAP) -> tuple[Array, Array, Array]:
    """The barrier that begins at the gap dhat and of whose width the fraction `overlap` lies behind the wall, with
    first and second derivative.

    gap (k,) and dhat, one number or (k,), in mm; values in mm, 1 and 1/mm.
    """
    width = dhat / (1.0 - overlap)
    return continued_barrier(gap + overlap * width, width)


def carried_gaps(gap: Array, pressure: Array, dhat: float | Array, overlap: float = OVERLAP) -> Array:
    """The gaps (k,) around which the next iteration linearises the barrier, where a Newton step has led to the gaps
    `gap` (k,), mm, and its linearised barrier to the pressures `pressure` (k,), not negative, over the stiffness.

    Both are those of the barrier at one gap e only in equilibrium. Walls that press on each other are rather at the
    pressure of the step, which balances the body, than at its gap, in which a rotation makes an error as large as the
    barrier is wide: e is where the barrier's pressure p(e) has moved a body of the compliance c,

        e - gap = c (p(e) - pressure),    c = COMPLIANCE times that of the barrier where it is quadratic.
    """
    e, width = np.array(gap, dtype=float), np.full(gap.shape, dhat / (1.0 - overlap))
    kernels.gaps_at_pressures(e, pressure, width, overlap, CONTINUATION, COMPLIANCE, GAP_ITERATIONS)
    return e


def continued_barrier(distance: Array, width: float | Array) -> tuple[Array, Array, Array]:
    """phi(d) = w (1 - r)^2 (-ln r), r = (d / w)^2, with first and second derivative; 0 beyond the width w, quadratic
    below CONTINUATION w. Distances d (k,) and w, one number or (k,), in mm; values in mm, 1 and 1/mm."""
    values = np.empty((3, *distance.shape))
    kernels.continued_barriers(distance, np.full(distance.shape, width), CONTINUATION, values)
    return values[0], values[1], values[2]
