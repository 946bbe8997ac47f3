"""Derivatives of a piece in equilibrium by its design: by a dimension, or a constant of its material or of a layer.

In equilibrium the derivative of the least potential by a parameter d is the partial one, and the moment is whole times
dP/dphi with P the least potential at the angle phi. With V the velocity of the nodes at rest, w a displacement that
keeps the constraints, D the change of the nodal gradient f with both, and du/dphi the change along the angle,

    dM/dd = whole D . du/dphi,      D = d/dt f(X + t V, u + t w).

Nodes of the plane keep their position there: w = -V. A displacement of the end of the material curve follows from the
displacement z by a unit force on it, as -z . D: two more right-hand sides at each state, for all parameters. No system
is solved for a parameter. With mixed elements the residuals of the pressures and their changes belong to D and z.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar, final

import numpy as np

from fem.cell.piece import BendingPiece, PieceState
from fem.cell.response import Slopes
from fem.discretisation import Discretisation
from fem.effects.barrier import FacingTerm
from fem.effects.effect import Term
from fem.effects.facing_pairs import FacingPairs
from fem.effects.membrane import LayerTerm, Membrane
from fem.effects.mirror_layer import MirroredLayerTerm
from fem.equations.formulation import Formulation, formulation_of
from fem.equations.state import Change, State
from fem.kernels import element as kernels
from fem.materials.regions import Solid, laws_of
from fem.post.extremes import extremes_of
from geometry.arrays import Array

Value = TypeVar("Value")

#: largest displacement of a node in difference quotients, over the length of the piece
STEP = 1e-5


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Variant:
    """A piece with a parameter a little smaller or larger."""

    space: Discretisation
    formulation: Formulation
    stiffness: float  #: of contact, over that of the piece: both follow the shear modulus
    layer: Membrane | None = None  #: in place of that of the same name
    _kept: dict[int, tuple[Any, Any]] = field(default_factory=dict, init=False, repr=False)

    @staticmethod
    def of(piece: BendingPiece, shift: Array | None, material: Solid | None) -> "Variant":
        """With nodes shifted by (n, 3), mm, or with another material."""
        space = piece.space if shift is None else piece.space.moved(piece.space.points + shift)
        solid = piece.material if material is None else material
        moduli = (laws_of(law)[""].shear_modulus for law in (solid, piece.material))
        return Variant(space, formulation_of(space, solid), next(moduli) / next(moduli))

    def pairs(self, known: FacingPairs, before: Array) -> FacingPairs:
        """The facing pairs of walls with their areas in this piece; before: (n, 3) its nodes in the piece itself."""
        if self.space.points is before:
            return known
        return self.once(known, lambda: _with_areas(known, self.space, before))

    def once(self, known: object, make: Callable[[], Value]) -> Value:
        """What is made here of a part of the piece, which all states share."""
        if id(known) not in self._kept:
            self._kept[id(known)] = known, make()
        made: Value = self._kept[id(known)][1]
        return made


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class DesignChange:
    """One parameter of a piece: the piece with less and with more of it."""

    less: Variant
    more: Variant
    step: float  #: of the parameter between them
    velocity: Array  #: (n, 3) of the nodes at rest, mm per unit of the parameter
    length: float  #: change of the length of the piece, mm per unit

    @staticmethod
    def of_dimension(piece: BendingPiece, velocity: Array, length: float) -> "DesignChange":
        """Nodes that move at a velocity (n, 3), mm per unit, and the change of the length of the piece."""
        largest = float(np.abs(velocity).max())
        half = STEP * piece.body.length / largest if largest else 1.0
        less, more = (Variant.of(piece, sign * half * velocity, None) for sign in (-1.0, 1.0))
        return DesignChange(less, more, 2.0 * half, velocity, length)

    @staticmethod
    def of_material(piece: BendingPiece, less: Solid, more: Solid, step: float) -> "DesignChange":
        """The materials with a constant smaller and larger by half a step."""
        first, second = (Variant.of(piece, None, solid) for solid in (less, more))
        return DesignChange(first, second, step, np.zeros_like(piece.space.points), 0.0)

    @staticmethod
    def of_layer(piece: BendingPiece, less: Membrane, more: Membrane, step: float) -> "DesignChange":
        """A layer on the same faces with a constant smaller and larger by half a step."""
        same = Variant.of(piece, None, None)
        first, second = (replace(same, layer=layer) for layer in (less, more))
        return DesignChange(first, second, step, np.zeros_like(piece.space.points), 0.0)

    def limit_rate(self, piece: BendingPiece, at: PieceState, along: State) -> float:
        """Change of an extreme pressure without moment, MPa per unit.

        along: change of the state without moment by ln V, at the constant pressure. With R the gradient, K along = 0
        there, so that along . (dR/dp dp + dR/dd dd) = 0, and -dR/dp . along = dV / d ln V = V.
        """
        volume = piece.volume(at.state) / piece.whole
        return _work(_Assemblies(piece, at).rate(self), along.change) / volume


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class DesignRate:
    """Change of a piece by one parameter, per unit of it, at a fixed angle of its plane."""

    moment: float  #: N mm, of the whole body
    end: Array  #: (2,) of the end of the material curve along the normal of the plane and within it, mm
    start: float  #: height of the start of the material curve, mm
    #: of the largest principal stretch without moment, where the angle follows the parameter; NaN where not asked for
    largest_stretch: float = float("nan")
    moved: Array = field(default_factory=lambda: np.empty((0, 3)))  #: (n, 3) of the displacement, mm; as above


def design_rates(
    piece: BendingPiece, at: PieceState, known: Slopes, changes: Mapping[str, DesignChange], *, stretch: bool = False
) -> dict[str, DesignRate]:
    """The rates of a state by parameter; two assemblies for each.

    known: slopes with `by_end_force`. stretch: whether those of the largest stretch and of the displacement are asked
    for, of a state without moment: one factorization more for all, and a right-hand side for each. Raises
    `fem.equations.linear.SingularMatrix` at a limit point.
    """
    along = Change(0.0, known.by_angle, known.angle_rate.pressure)
    tangent = piece.linearise(at, np.zeros_like(piece.space.points))[1] if stretch else None
    assemblies, rates = _Assemblies(piece, at), {}
    for name, change in changes.items():
        rate = assemblies.rate(change)
        moment = piece.whole * _work(rate, along)
        rates[name] = DesignRate(
            moment=moment,
            end=np.array([-_work(rate, one) for one in known.by_end_force]),
            start=float(change.velocity[piece.curve[0], 1]),
        )
        if tangent:
            turn = -moment / known.moment_by_angle
            moved = tangent.solve(*rate).displacement
            largest = _stretch_rate(piece, at, change, moved + turn * known.by_angle)
            rates[name] = replace(rates[name], largest_stretch=largest, moved=moved)
    return rates


def _work(rate: tuple[Array, Array], change: Change) -> float:
    """Of a gradient (n, 3) and residuals of the pressures (v,) on a change of the unknowns."""
    return float(np.vdot(rate[0], change.displacement) + rate[1] @ change.pressure)


def _stretch_rate(piece: BendingPiece, at: PieceState, change: DesignChange, moved: Array) -> float:
    """Of the largest principal stretch, per unit; moved: (n, 3) mm per unit, displacement of the nodes."""
    velocity = moved.copy()
    velocity[piece.plane] -= change.velocity[piece.plane]
    u = at.state.displacement
    less, more = (
        extremes_of(variant.space, *variant.space.strain_of(u + step * velocity)).max_stretch
        for variant, step in ((change.less, -0.5 * change.step), (change.more, 0.5 * change.step))
    )
    return (more - less) / change.step


@final
class _Assemblies:
    """Gradients of the potential of one state on variants of its piece."""

    def __init__(self, piece: BendingPiece, at: PieceState) -> None:
        self._piece, self._at = piece, at

    def rate(self, change: DesignChange) -> tuple[Array, Array]:
        """D: of the nodal gradient (n, 3) and of the residuals of the pressures (v,), per unit of the parameter."""
        less, more = (self._gradient(variant) for variant in (change.less, change.more))
        return (more[0] - less[0]) / change.step, (more[1] - less[1]) / change.step

    def _gradient(self, variant: Variant) -> tuple[Array, Array]:
        """Of the potential of a variant, whose plane is where it is in the state."""
        piece, space, state = self._piece, variant.space, self._at.state
        displacement = state.displacement.copy()
        displacement[piece.plane] += (piece.space.points - space.points)[piece.plane]
        strain = self._own_strain if space is piece.space else space.strain_of(displacement)[0]
        law = variant.formulation.evaluate(strain, state.pressure)
        gradient = np.zeros_like(displacement)
        kernels.internal_force(space.arrays, displacement, law.stress, gradient)
        for term in self._at.terms:
            moved = moved_term(term, piece.space.points, variant)
            moved.gradient(space.points + displacement, state.factor, gradient)
        return gradient, variant.formulation.pressure_residual(law, np.zeros_like(strain), state.pressure)

    @cached_property
    def _own_strain(self) -> Array:
        """(e, q, 6) on the mesh of the piece itself, which variants of the material share."""
        return self._piece.space.strain_of(self._at.state.displacement)[0]


def moved_term(term: Term, before: Array, variant: Variant) -> Term:
    """A term of a state on the variant: what it holds of the body at rest follows it; before: (n, 3) nodes there."""
    after = variant.space.points
    if isinstance(term, FacingTerm):
        return replace(term, pairs=variant.pairs(term.pairs, before), stiffness=variant.stiffness * term.stiffness)
    if isinstance(term, LayerTerm | MirroredLayerTerm) and (variant.layer or after is not before):
        layer = variant.layer if variant.layer and variant.layer.name == term.effect else term.sheet
        of_rest = term.arrays if isinstance(term, LayerTerm) else term.matrix
        return variant.once(of_rest, lambda: term.changed(layer, after))
    return term


def _with_areas(pairs: FacingPairs, space: Discretisation, before: Array) -> FacingPairs:
    """The pairs with the areas of their nodes, which are those of triangles between such nodes, on moved walls."""
    walls, areas = space.triangles_between(pairs.nodes), []
    for points in (before, space.points):
        a, b, c = (points[walls[:, k]] for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        areas.append(np.bincount(walls.ravel(), np.repeat(area, 3), minlength=len(before))[pairs.nodes])
    ratio = np.divide(areas[1], areas[0], out=np.ones(len(pairs.nodes)), where=areas[0] > 0.0)
    return replace(pairs, area=pairs.area * ratio)
