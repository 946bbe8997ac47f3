"""Equations of a piece for small displacements out of its plane, antisymmetric about z = 0, at a planar state.

The second variation of the potential couples no displacement that is symmetric about z = 0 with one that is
antisymmetric. Half the body with u_x = u_y = 0 on z = 0 therefore gives the answer of the whole. A further mirror
plane admits two kinds of them:

- bent: the plane stays one. It tilts about its direction e2 in the plane of bending, and all moves freely within it.
- twisted: the plane turns about its normal n and moves along z. All moves freely along the normal, so that it warps.

Walls in contact with their mirror images press on a plane that stays one. Beside a plane of the normal n that warps
they slide: a wall and its image then have the same displacement u along n, and opposite ones within the plane, v - r
and r - v, with r the motion of the plane within itself. A gap does not change to first order. Where the walls tilt, its
second-order change is 2 grad u . (v - r), against which the contact force F of the wall does the work

    Pi = -sum F grad u . (v - r)        (of one half cell),

so that forces turn with the walls on which they act.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations_with_replacement
from typing import final

import numpy as np

from fem.cell.mirror_contact import is_with_images
from fem.cell.piece import BendingPiece, PieceState
from fem.cell.response import force_change
from fem.cell.rim import rim_forces
from fem.discretisation import Discretisation
from fem.effects.barrier import FacingTerm
from fem.effects.effect import Blocks, Term, Terms
from fem.effects.membrane import LayerTerm
from fem.effects.mirror_layer import MirroredLayerTerm
from fem.equations.constraints import Constraints
from fem.equations.system import System
from fem.supports import Fixed, FixedAlong, Support
from geometry.arrays import Array, Index

#: pairs a <= b of the nodes of a triangle of the wall and of one in the plane
PAIRS = tuple(combinations_with_replacement(range(6), 2))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SlidingWalls(Term):
    """The quadratic potential above, of displacements from given positions."""

    effect = "self_contact"

    at: Array  #: (n, 3) positions of the planar state, mm
    nodes: Index  #: (m, 6) of each triangle of the walls, and of one in the plane
    matrices: Array = field(repr=False)  #: (m, 6, 6, 3, 3) second derivatives, N/mm

    @staticmethod
    def of(term: FacingTerm, space: Discretisation, x: Array, normal: Array) -> "SlidingWalls":
        """From the contact of walls with their images at positions x (n, 3); normal: (3,) of the plane."""
        forces = np.zeros_like(x)
        term.gradient(x, 1.0, forces)
        walls, corner = space.triangles_between(term.pairs.nodes), term.pairs.triangles[0]
        double = np.cross(x[walls[:, 1]] - x[walls[:, 0]], x[walls[:, 2]] - x[walls[:, 0]]) @ normal
        around = np.bincount(walls.ravel(), np.repeat(np.abs(double), 3), minlength=len(x))  # each node
        share = (forces @ normal)[walls] * np.abs(double)[:, None] / around[walls]
        edges = np.stack([x[walls[:, k - 2]] - x[walls[:, k - 1]] for k in (0, 1, 2)], axis=1)
        slopes = np.zeros((len(walls), 6, 3))
        slopes[:, :3] = np.cross(normal, edges) / -double[:, None, None]
        on_plane = np.einsum("mk,mkb->mb", share, _weights(x, walls, corner))
        weights = np.concatenate([share, -on_plane], axis=1)
        one = -np.einsum("mc,i,maj->macij", weights, normal, slopes)
        matrices = one + one.transpose(0, 2, 1, 4, 3)
        return SlidingWalls(x, np.hstack([walls, np.tile(corner, (len(walls), 1))]), matrices)

    def energy(self, x: Array, factor: float) -> float:
        moved = (x - self.at)[self.nodes]
        return 0.5 * float(np.einsum("mai,macij,mcj->", moved, self.matrices, moved))

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        np.add.at(out, self.nodes, np.einsum("macij,mcj->mai", self.matrices, (x - self.at)[self.nodes]))

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        rows, columns, values = (np.concatenate(parts) for parts in zip(*self._pairs(), strict=True))
        return Blocks(rows, columns, np.ascontiguousarray(values))

    def _pairs(self) -> Iterator[tuple[Index, Index, Array]]:
        for a, b in PAIRS:
            first, second, values = self.nodes[:, a], self.nodes[:, b], self.matrices[:, a, b]
            swapped = first > second
            values = np.where(swapped[:, None, None], values.transpose(0, 2, 1), values)
            yield np.minimum(first, second), np.maximum(first, second), values


def _weights(x: Array, walls: Index, corner: Index) -> Array:
    """(m, 3, 3) of the nodes of a triangle (3,) in the plane for the points that face the nodes of the walls (m, 3)."""
    sides = np.stack([x[corner[1]] - x[corner[0]], x[corner[2]] - x[corner[0]]])
    within = (x[walls] - x[corner[0]]) @ np.linalg.pinv(sides)
    return np.concatenate([1.0 - within.sum(axis=2, keepdims=True), within], axis=2)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Place:
    """A piece in a planar state, and the plane at its end. Vectors of the plane are (3,)."""

    piece: BendingPiece
    at: PieceState

    @cached_property
    def x(self) -> Array:
        """(n, 3) positions, mm."""
        return np.asarray(self.piece.space.points + self.at.state.displacement)

    @property
    def normal(self) -> Array:
        """Normal of the plane."""
        return np.array([np.cos(self.at.angle), np.sin(self.at.angle), 0.0])

    @property
    def within(self) -> Array:
        """e2, in the plane of bending."""
        return np.array([-np.sin(self.at.angle), np.cos(self.at.angle), 0.0])

    @property
    def start(self) -> Index:
        """Nodes (k,) of the plane, or of the clamp, at the start."""
        return self.piece.space.surface("clamp").unique_nodes

    def on_plane(self, values: Array) -> Array:
        """Nodal values (n, 3) that are zero elsewhere."""
        result = np.zeros_like(self.x)
        result[self.piece.plane] = values[self.piece.plane]
        return result

    def turned(self, axis: Array) -> Array:
        """(n, 3) a x x, mm per rad, of all nodes about an axis a through the origin."""
        return np.cross(axis, self.x)


@final
class Sideways:
    """The factorized equations of one kind; earlier ones of that kind become stale.

    Raises `fem.equations.linear.SingularMatrix`.
    """

    def __init__(self, place: Place, name: str, terms: Terms, supports: Sequence[Support]) -> None:
        piece, at = place.piece, place.at
        terms = tuple(term.sideways() if isinstance(term, LayerTerm) else term for term in terms)
        self.place, self.terms = place, terms
        held = Constraints.of([Fixed("sym", "xy"), *supports], piece.space)
        self.system: System = piece.other_system(name, terms, held)
        assembly = self.system.assemble(at.state, terms)
        self.gradient = assembly.gradient
        self.linearised = self.system.linearise(at.state, assembly, terms)

    @property
    def negative_pivots(self) -> int:
        """Number of unstable directions."""
        return self.linearised.negative_pivots

    def forces(self, motion: Array) -> Array:
        """Change (n, 3) of the nodal gradient with a displacement (n, 3), to first order; mixed pressures follow."""
        return force_change(self.system, self.place.piece, self.place.at, self.terms, motion)

    def solve(self, *loads: Array) -> list[Array]:
        """The displacements (n, 3) that balance changes of the gradient (n, 3)."""
        return [change.displacement for change in self.linearised.solve_each([(load, None) for load in loads])]


@final
class Bent:
    """A piece whose plane tilts about e2 by a unit angle. Forces and moments are those of the meshed half."""

    def __init__(self, place: Place, supports: Sequence[Support]) -> None:
        normal = place.normal
        held = [*supports, FixedAlong("tip", (float(normal[0]), float(normal[1]), 0.0))]
        self.place, terms = place, place.at.terms
        self.equations = Sideways(place, "bent", terms, held)
        self.tilt = place.on_plane(place.turned(place.within))
        self.rim = rim_forces(place.piece, place.at, lambda x, nu: x[:, 2:] * nu)
        self.carried = place.on_plane(np.cross(place.within, self.equations.gradient))  # forces that turn with it
        self.by_tilt = self.equations.forces(self.tilt)
        (answer,) = self.equations.solve(self.by_tilt + self.rim - self.carried)
        self.motion = self.tilt + answer
        self.forces = self.equations.forces(self.motion) + self.rim - self.carried
        self.moment = self._work(self.motion) + float(np.vdot(self.rim, self.tilt))

    def _work(self, motion: Array) -> float:
        """Moment about e2 that a displacement (n, 3) makes."""
        return float(np.vdot(self.by_tilt + self.rim - self.carried, motion))

    def under(self, load: Array) -> tuple[Array, float]:
        """The displacement (n, 3) under further forces (n, 3) without a tilt, and the moment about e2 that holds it."""
        (motion,) = self.equations.solve(-load)
        return motion, self._work(motion) - float(np.vdot(load, self.tilt))

    @cached_property
    def tractions(self) -> Array:
        """(n, 3) forces on the plane along its normal, over the moment."""
        normal = self.place.normal
        forces = self.place.on_plane((self.forces @ normal)[:, None] * normal)
        return np.asarray(forces / np.vdot(forces, self.tilt))

    @cached_property
    def start_tractions(self) -> Array:
        """(n, 3) forces of the part behind the start on this one, over their moment, which turns the other way."""
        forces = np.zeros_like(self.forces)
        forces[self.place.start, 0] = self.forces[self.place.start, 0]
        return np.asarray(forces / np.sum(forces[:, 0] * self.place.x[:, 2]))


@final
class Twisted:
    """A piece whose plane turns about n by a unit angle, and moves along z by a unit length: two displacements.

    Rows and columns of `reaction` (2, 2) belong to these two; forces are those of the meshed half.
    """

    def __init__(self, place: Place, supports: Sequence[Support]) -> None:
        within, normal = place.within, place.normal
        held = [*supports, Fixed("tip", "z"), FixedAlong("tip", (float(within[0]), float(within[1]), 0.0))]
        self.place = place
        space, plane, is_cell = place.piece.space, place.piece.plane, place.piece.start == "mirror"
        # a layer that meets a plane that warps goes on beyond it without a jump of its slope
        terms = tuple(
            SlidingWalls.of(term, space, place.x, normal)
            if isinstance(term, FacingTerm) and term.pairs.nodes.size and is_with_images(term, plane)
            else term
            for term in place.at.terms
            if not (isinstance(term, MirroredLayerTerm) and (is_cell or np.array_equal(term.plane, plane)))
        )
        self.equations = Sideways(place, "twisted", terms, held)
        lift = place.on_plane(np.broadcast_to([0.0, 0.0, 1.0], place.x.shape))
        self.moves = (place.on_plane(place.turned(normal)), lift)

        def of_turn(x: Array, nu: Array) -> Array:
            return np.outer((x @ within) * nu[:, 2] + x[:, 2] * (nu @ within), normal)

        rims = (of_turn, lambda x, nu: np.outer(nu[:, 2], normal))
        self.rims = tuple(rim_forces(place.piece, place.at, field) for field in rims)
        self.by_move = tuple(self.equations.forces(move) for move in self.moves)
        loads = [by_move + rim for by_move, rim in zip(self.by_move, self.rims, strict=True)]
        answers = self.equations.solve(*loads)
        self.motions = tuple(move + answer for move, answer in zip(self.moves, answers, strict=True))
        self.reaction = np.array([self.held_by(motion) for motion in self.motions]).T

    def held_by(self, motion: Array) -> Array:
        """(2,) N mm and N: moment about n and force along z that a displacement (n, 3) makes."""
        pairs = zip(self.by_move, self.rims, strict=True)
        return np.array([float(np.vdot(by_move + rim, motion)) for by_move, rim in pairs])

    def tractions(self, parts: Array) -> Array:
        """(n, 3) forces of the combination parts (2,) of both displacements."""
        motion, rim = (np.tensordot(parts, np.array(columns), 1) for columns in (self.motions, self.rims))
        return np.asarray(self.equations.forces(motion) + rim)
