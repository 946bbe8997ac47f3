"""An arm at one pressure as a chain: stiff pieces joined by hinges with springs, as programs for robots take it.

With the arm's own law the stretch follows the curvature, so that a line at the height dstretch/dkappa above the axis
keeps its length. The hinges lie on that line; then the chain is as long as the arm and an axial force bends it as the
arm, although no piece stretches. The first hinge stands for the clamped end. Without load the chain lies on the rod.

A spring is a broken line through states of the law, which is not extrapolated: a program stops the hinge at its ends.
Shear moves the arm under a force F across its end by s F/GA at s. A turn of the first hinge by F l/GA over its distance
from the end moves it likewise: that hinge is softer by as much, and turns too far under a couple. The stretch under an
axial force is left out.
"""

import cmath
import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline

from geometry.arrays import Array
from rod.arm_law.law_rod import LawRod
from rod.arm_law.space_rod import SpaceRod
from rod.cubics import cubic
from rod.errors import RodError
from rod.export.in_space import Part, SpaceHinges, space_hinges
from rod.load import Load
from rod.mechanics.equilibrium import Rod

#: moments of the broken line of a spring over the largest and over the smallest moment of the law
ABOVE, BELOW = (0.03, 0.08, 0.15, 0.25, 0.4, 0.6, 0.8, 1.0), (0.08, 0.25, 0.5, 0.75, 1.0)
#: which of these states has no moment
REST = len(BELOW)
#: moments for derivatives at rest, over those of the law
SLIGHT = 1e-3
#: of Newton's method for a chain under a load: iterations, and largest change of an angle in the last one, rad
ITERATIONS, SETTLED = 100, 1e-10
#: rad, largest change of an angle in one of its iterations
LARGEST_TURN = 0.2


@dataclass(frozen=True, eq=False)  # arrays inside
class Chain:
    """A chain of m pieces; piece k follows hinge k and is as the cross section of the rod at s[k] turned.

    Positions are relative to the clamped end of the material curve, those in a piece to its hinge, along and across it.
    """

    base: Array  #: (2,) mm, of the first hinge
    legs: Array  #: (m - 1, 2) mm, from the hinge of a piece to the next one
    s: Array  #: (m,) mm, rest arc lengths, the last one that of the end
    points: Array  #: (m, 2) mm, of the material curve at s, in the piece
    lift: float  #: mm, of the hinges above the axis
    angle: Array  #: (m, n) rad, of the states of the springs, rising
    moment: Array  #: (m, n) N mm, rising; zero at n = `rest`
    axial: float  #: N, rigidity against stretch along the hinges
    shear: float  #: N, against shear
    is_limited: bool  #: whether the springs are unknown beyond their states; else they go on as straight lines
    space: SpaceHinges | None = None  #: how the hinges turn out of the plane; None where that is not known

    @property
    def rest(self) -> int:
        """Which state of the springs has no moment."""
        return REST if self.is_limited else 0

    @property
    def neutral(self) -> Array:
        """(m,) rad, without load."""
        return self.angle[:, self.rest]

    @property
    def rigidity(self) -> float:
        """N mm2, of the arm behind the clamped end, without load."""
        _, slope = self.springs(self.neutral)
        return float(slope[-1] * (self.s[-1] - self.s[-2]))

    def straight(self) -> "Chain":
        """The chain with the same springs that is straight without load."""
        return replace(self, angle=self.angle - self.neutral[:, None])

    def between(self, other: "Chain", t: float) -> "Chain":
        """The chain between this one (t = 0) and another (t = 1) of as many pieces, by straight lines."""
        names = ("base", "legs", "points", "lift", "angle", "moment", "axial", "shear")
        values = {name: (1.0 - t) * getattr(self, name) + t * getattr(other, name) for name in names}
        space = self.space.between(other.space, t) if self.space and other.space else None
        return replace(self, **values, space=space)

    def springs(self, turn: Array) -> tuple[Array, Array]:
        """Moments (m,) in N mm and their slopes (m,) in N mm/rad at angles (m,) in rad."""
        rows = np.arange(len(turn))
        i = (turn[:, None] > self.angle[:, 1:-1]).sum(axis=1)
        angle, moment = self.angle[rows, i], self.moment[rows, i]
        slope = (self.moment[rows, i + 1] - moment) / (self.angle[rows, i + 1] - angle)
        return moment + slope * (turn - angle), slope

    def hinges(self, turn: Array) -> Array:
        """(m, 2) mm, the positions of the hinges at angles (m,) in rad."""
        return self.base + np.vstack([np.zeros(2), np.cumsum(_turned(self.legs, np.cumsum(turn)[:-1]), axis=0)])

    def curve(self, turn: Array) -> Array:
        """(m, 2) mm: the material curve at s."""
        return self.hinges(turn) + _turned(self.points, np.cumsum(turn))

    def solve(
        self, force: tuple[float, float] = (0.0, 0.0), weight: tuple[float, float] = (0.0, 0.0), height: float = 0.0
    ) -> Array:
        """(m,) rad: the angles of the hinges under a dead force in N on the end of the material curve.

        weight: x and y in N/mm, along the pieces at a height in mm above the material curve. Raises `RodError` where
        Newton's method does not find them, or where the chain would leave them.
        """
        turn = self.neutral.copy()
        lengths = np.append(self.legs[:, 0], self.points[-1, 0])
        weights = np.outer(lengths, weight)
        middles = np.column_stack([0.5 * lengths, np.full(len(turn), height - self.lift)])
        beyond = _sums_to_end(weights)
        # a hinge moves what is behind it, whichever hinge before it the moment is about
        behind = np.maximum.outer(np.arange(len(turn)), np.arange(len(turn)))
        for _ in range(ITERATIONS):
            hinges = self.hinges(turn)
            lever = self.curve(turn)[-1] - hinges
            at = hinges + _turned(middles, np.cumsum(turn))
            acting = _cross(lever, force) + _sums_to_end(_cross(at, weights)) - _cross(hinges, beyond)
            along = lever @ force + _sums_to_end((at * weights).sum(axis=1)) - (hinges * beyond).sum(axis=1)
            moment, slope = self.springs(turn)
            change = -along[behind]
            step = np.linalg.solve(np.diag(slope) - change, acting - moment)
            largest = np.abs(step).max()
            turn = turn + step * min(1.0, LARGEST_TURN / max(largest, 1e-300))
            if largest < SETTLED:
                if np.linalg.eigvalsh(np.diag(slope) - change)[0] < 0.0:
                    raise RodError("The equilibrium of the chain under this load is unstable.")
                return turn
        raise RodError("The chain has no equilibrium under this load.")


def _sums_to_end(rows: Array) -> Array:
    """At each row of (m, ...) the sum of it and of those behind it."""
    return np.asarray(np.cumsum(rows[::-1], axis=0)[::-1])


def _cross(levers: Array, forces: ArrayLike) -> Array:
    """(m,) moments of forces (m, 2) or (2,) at levers (m, 2)."""
    return np.asarray(levers[:, 0] * np.asarray(forces)[..., 1] - levers[:, 1] * np.asarray(forces)[..., 0])


def _turned(vectors: Array, angles: Array) -> Array:
    """Vectors (n, 2) turned by angles (n,) in rad."""
    cosine, sine = np.cos(angles), np.sin(angles)
    x, y = vectors.T
    return np.column_stack([x * cosine - y * sine, x * sine + y * cosine])


def chain_of_law(rod: LawRod, pieces: int, *, has_shear: bool = True) -> Chain:
    """The chain of a rod with the arm's own law; pieces: behind the clamped end; has_shear: in its first hinge."""
    section, clamped = rod.section, float(rod.clamp.s[-1])
    low, high = max(section.moment[0], rod.clamp.moment[0]), min(section.moment[-1], rod.clamp.moment[-1])
    if not low < 0.0 < high:
        raise RodError(f"The law at {section.pressure:g} kPa has no point without moment between others.")
    moment = np.array([*(low * part for part in reversed(BELOW)), 0.0, *(high * part for part in ABOVE)])
    kappa, stretch = _cells(rod, moment)
    kappa_0, stretch_0 = kappa[REST], stretch[REST]
    by_moment = [np.interp(0.0, section.moment, slope) for slope in (section.stretch_slope, section.kappa_slope)]
    lift = float(by_moment[0] / by_moment[1])
    h = (rod.length - clamped) / pieces
    half_turn = 0.5 * kappa_0 * h
    # the tangents at both ends of a piece of the arm meet in its hinge
    leg = 0.5 * h * (stretch_0 - lift * kappa_0) * (math.tan(half_turn) / half_turn if half_turn else 1.0)
    base, turn, reached = _clamped_end(rod, clamped, moment)
    end = Part(rod.clamp.offset_at(0.0), float(rod.clamp.rotation_at(0.0)), clamped, kappa_0, stretch_0, base)
    piece = Part(np.array([-leg, -lift]), 0.0, h, kappa_0, stretch_0, np.zeros(2))
    is_first = np.eye(pieces + 1)[0]
    space = space_hinges(rod, [end, *[piece] * pieces], is_first, is_first * has_shear / (rod.length - base[0]) ** 2)
    if has_shear:
        turn = turn + moment * _turn_by_shear(rod, base[0])
    s = np.linspace(clamped, rod.length, pieces + 1)
    points = _beside(rod, s) + np.vstack([reached, np.tile([leg, -lift], (pieces, 1))])
    legs = np.vstack([reached + np.array([leg, lift]), np.tile([2.0 * leg, 0.0], (pieces - 1, 1))])
    angle: Array = np.vstack([turn, np.tile(kappa * h, (pieces, 1))])
    moments = np.tile(moment, (pieces + 1, 1))
    return Chain(base, legs, s, points, lift, angle, moments, *_rigidities(rod), is_limited=True, space=space)


def _beside(rod: LawRod, s: Array) -> Array:
    """(m, 2) mm: the material curve beside the axis at s (m,) mm without load, along and across it."""
    free = rod.under(Load())
    assert free.beside is not None  # the arm's own law has it
    return free.beside(s)


def _rigidities(rod: LawRod) -> tuple[float, float]:
    """Axial and shear rigidity of the cells without moment, N."""
    section = rod.section
    axial, shear = (np.interp(0.0, section.moment, v) for v in (section.axial_rigidity, section.shear_rigidity))
    return float(axial), float(shear)


def _turn_by_shear(rod: LawRod, at: float) -> float:
    """rad/(N mm), of a hinge at a distance from the clamp (mm) that moves the end as shear does."""
    _, shear = _rigidities(rod)
    return rod.length / (shear * (rod.length - at) ** 2)


def _cells(rod: LawRod, moment: Array) -> tuple[Array, Array]:
    """Curvature (n,) in 1/mm and stretch (n,) of the cells at moments (n,) in N mm."""
    section = rod.section
    kappa = cubic(section.moment, section.kappa, section.kappa_slope, moment)
    return kappa, cubic(section.moment, section.stretch, section.stretch_slope, moment)


def _clamped_end(rod: LawRod, clamped: float, moment: Array) -> tuple[Array, Array, Array]:
    """Where the clamped end of an arm (mm) turns, (2,) mm; its angles (n,) in rad at moments (n,) in N mm; and the end
    of its axis from there, (2,) mm, along and across it.

    Raises `RodError` where the angle does not rise with the moment.
    """

    def end(at: Array) -> tuple[Array, Array]:
        kappa, stretch = _cells(rod, at)
        first, turn = rod.clamp.rotation_at(at), kappa * clamped
        chord = stretch * clamped * np.sinc(turn / (2.0 * np.pi)) * np.exp(1j * (first + 0.5 * turn))
        return first + turn, rod.clamp.offset_at(at) @ [1.0, 1j] + chord

    turn = end(moment)[0]
    if np.any(np.diff(turn) <= 0.0):
        raise RodError(f"The clamped end at {rod.section.pressure:g} kPa does not turn as its moment, and is no hinge.")
    turns, positions = end(SLIGHT * min(-moment[0], moment[-1]) * np.array([-1.0, 0.0, 1.0]))
    # a point that turns by an angle moves by 1j times its distance from the centre
    away = (positions[2] - positions[0]) / (1j * (turns[2] - turns[0]))
    along = away * cmath.exp(-1j * turns[1])
    centre = positions[1] - away
    return np.array([centre.real, centre.imag]), turn, np.array([along.real, along.imag])


def linear_chain_of_law(rod: LawRod, pieces: int) -> Chain:
    """The chain of equal pieces with straight springs, as stiff as a rod with the arm's own law without load.

    Its hinges lie on the line that keeps its length; the rotation of the clamped end is spread evenly over that piece.
    """
    section, clamped = rod.section, float(rod.clamp.s[-1])
    (kappa,), (stretch,) = _cells(rod, np.zeros(1))
    by_moment = [float(np.interp(0.0, section.moment, slope)) for slope in (section.kappa_slope, section.stretch_slope)]
    edges = np.linspace(0.0, rod.length, pieces + 1)
    in_clamped = np.diff(np.minimum(edges, clamped)) / clamped
    h = rod.length / pieces
    slight = SLIGHT * np.ptp(section.moment)
    rotations = rod.clamp.rotation_at(np.array([-slight, 0.0, slight]))
    rotation_by_moment = (rotations[2] - rotations[0]) / (2.0 * slight)
    compliance = by_moment[0] * h + (rotation_by_moment + _turn_by_shear(rod, 0.5 * clamped)) * in_clamped
    if np.any(compliance <= 0.0):
        raise RodError(f"The clamped end at {section.pressure:g} kPa turns against its moment, and is no spring.")
    neutral = kappa * h + rotations[1] * in_clamped
    lift = by_moment[1] / by_moment[0]
    leg = h * (stretch - lift * kappa)
    piece = Part(np.array([-0.5 * leg, -lift]), 0.0, h, kappa, stretch, np.zeros(2))
    space = space_hinges(rod, [piece] * pieces, in_clamped, in_clamped / (rod.length - 0.5 * clamped) ** 2)
    chain = _linear(edges, leg, neutral, compliance, _rigidities(rod))
    base = chain.base + rod.clamp.offset_at(0.0) + [0.0, lift]
    points = chain.points + _beside(rod, chain.s) - [0.0, lift]
    return replace(chain, base=base, points=points, lift=lift, space=space)


def chain_of_five(rod: Rod, pieces: int, axial: float) -> Chain:
    """The chain of an inextensible rod with five parameters; axial: N, its rigidity against stretch."""
    edges = np.linspace(0.0, rod.length, pieces + 1)
    cut = cut_into_joints(rod, edges)
    neutral = cut.rest_rotation.copy()
    neutral[0] += rod.theta0
    chain = _linear(edges, rod.length / pieces, neutral, cut.compliance, (axial, axial / 3.0))
    return replace(chain, base=chain.base[0] * np.array([math.cos(rod.theta0), math.sin(rod.theta0)]))


def chain_in_space(rod: SpaceRod, pieces: int) -> Chain:
    """The straight chain of a rod with a law in space, with straight springs of the same rigidity about y and z."""
    twist, *_ = np.diag(rod.section.compliance)
    bend, ones = rod.section.rigidity * pieces / rod.length, np.ones(pieces)
    chain = _linear(np.linspace(0.0, rod.length, pieces + 1), rod.length / pieces, 0.0 * ones, ones / bend, (1.0, 1.0))
    turn = pieces / (twist * rod.length)
    return replace(chain, space=SpaceHinges(0.0 * ones, np.zeros((pieces, 2)), turn * ones, bend * ones, 1.0))


def _linear(edges: Array, leg: float, neutral: Array, compliance: Array, rigidities: tuple[float, float]) -> Chain:
    """A chain of equal pieces (mm) whose hinges stand in the middles between the edges (m + 1,) of rest lengths."""
    count = len(neutral)
    moment = np.array([0.0, 1.0])
    return Chain(
        base=np.array([0.5 * leg, 0.0]),
        legs=np.tile([leg, 0.0], (count - 1, 1)),
        s=edges[1:],
        points=np.tile([0.5 * leg, 0.0], (count, 1)),
        lift=0.0,
        angle=neutral[:, None] + compliance[:, None] * moment,
        moment=np.tile(moment, (count, 1)),
        axial=rigidities[0],
        shear=rigidities[1],
        is_limited=False,
    )


@dataclass(frozen=True)
class Joints:
    """Springs at the middles of the intervals of a rod that carries a load.

    Over an interval the tangent turns by the integral of kappa_0 + (M - m0)/alpha. With M nearly constant over it that
    is rest rotation + M * compliance, with the integrals of kappa_rest and of 1/alpha. So a joint with the spring
    1/compliance and the neutral angle `rest rotation` represents the five parameters, wherever d lies in the interval;
    the error of a chain of n joints is of order 1/n^2.
    """

    edges: Array  #: (n + 1,) mm, from 0 to the length
    compliance: Array  #: (n,) rad/(N mm)
    rest_rotation: Array  #: (n,) rad


def cut_into_joints(rod: Rod, edges: Array) -> Joints:
    """The rod cut at `edges`, (n + 1,) mm rising from 0 to the length. Raises `RodError` for other edges."""
    edges = np.asarray(edges, float)
    if edges.ndim != 1 or len(edges) < 3 or np.any(np.diff(edges) <= 0.0) or edges[0] != 0.0:
        raise RodError("A rod is cut into at least two pieces by lengths that rise from 0.")
    if abs(edges[-1] - rod.length) > 1e-9 * rod.length:
        raise RodError(f"The last cut must be the end of the rod, {rod.length:g} mm, not {edges[-1]:g} mm.")
    law, rest = rod.five, rod.under(Load())
    turned = CubicHermiteSpline(rest.s, rest.theta, rest.kappa)(np.minimum(edges, rod.length))
    first = np.minimum(edges, law.d)
    compliance = first / law.alpha1 + (edges - first) / law.alpha2
    offset = first * law.m01 / law.alpha1 + (edges - first) * law.m02 / law.alpha2
    return Joints(edges, np.diff(compliance), np.diff(turned - offset))
