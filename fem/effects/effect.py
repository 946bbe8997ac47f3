"""Effects: what acts on the body besides its elasticity. One object each; an effect that is off is not in the sum.

An `Effect` is a value the user writes; bound to a discretisation it becomes a `Term` of the total potential with
energy, gradient and second derivative. The other abstract classes here say what some terms can do besides:
`LoadTerm` may be applied in full from the first target on, `UnilateralTerm` is contact.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, Self, final

import numpy as np

from fem.discretisation import Discretisation
from fem.effects.tightening import Tightening
from fem.materials.material import Material
from geometry import Reason
from geometry.arrays import Array, Index


@dataclass(frozen=True)
class Blocks:
    """Second derivative of a term by node pairs rows <= columns; the mirror image of off-diagonal blocks is implied."""

    rows: Index  #: (m,)
    columns: Index  #: (m,)
    values: Array  #: (m, 3, 3), N/mm


#: the second derivative of a potential that is linear in the positions, or zero
NO_BLOCKS = Blocks(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3, 3)))


class Effect(ABC):
    """What a user asks to be simulated."""

    @abstractmethod
    def bind(self, space: Discretisation, material: Material) -> "Term":
        """The term of the potential this effect adds on the given discretisation."""


class Term(ABC):
    """A term of the total potential; x (n, 3) are current positions in mm, factor is the load factor.

    It may have a stress or gap that Newton's method carries as an unknown, as the stress of the solid, around which its
    forces are linearised. Once the method has converged it is that of the positions.
    """

    effect: str  #: name of the effect as in a config
    #: whether it is contact that is infinite where parts meet: the start and every iterate must keep them apart
    is_infinite: ClassVar[bool] = False

    @abstractmethod
    def energy(self, x: Array, factor: float) -> float:
        """Potential, N mm."""

    @abstractmethod
    def gradient(self, x: Array, factor: float, out: Array) -> None:
        """Add d Pi / d x (n, 3), N, to out."""

    @abstractmethod
    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        """Second derivative; `convex` asks for a positive semi-definite substitute where the term can give one."""

    def with_constant_fraction(self, fraction: float) -> Self:
        """The term with its constant load scaled to `fraction`; itself where it has none."""
        return self

    def advanced(self, x: Array, dx: Array) -> Self:
        """The term with the stress or gap that it carries after the Newton step dx (n, 3) from x."""
        return self

    def stressed(self, x: Array, dx: Array) -> Self:
        """This term with a stress alone, which a predictor may foresee as well, to first order."""
        return self

    def settled(self) -> Self:
        """The term with the stress or gap of the positions themselves."""
        return self


Terms = tuple[Term, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadTerm(Term):
    """A load that grows with the load factor, or one that is applied in full from the first target on.

    The latter is brought up by its own fraction, from 0 at rest to 1 at the first target.
    """

    constant_fraction: float | None = None  #: fraction applied of a constant load; None: proportional to the factor

    @final
    def with_constant_fraction(self, fraction: float) -> Self:
        return self if self.constant_fraction is None else replace(self, constant_fraction=fraction)

    @final
    def scale(self, factor: float) -> float:
        """What the load is multiplied by at a load factor."""
        return factor if self.constant_fraction is None else self.constant_fraction


class UnilateralTerm(Term):
    """Contact: it keeps parts of the body apart and does nothing where they are apart."""

    starts_inactive: bool  #: whether the term is left out of the sum until a state without it touches

    @abstractmethod
    def gap(self, x: Array) -> float:
        """Smallest distance in mm between the parts that are kept apart, negative where they overlap if the term can
        tell; infinity where there are none."""

    @abstractmethod
    def touching(self, x: Array) -> bool:
        """Whether parts are within the activation distance at x (n, 3)."""

    @abstractmethod
    def violation(self, x: Array) -> Reason | None:
        """Why a converged state x (n, 3) is not admissible; None where it is."""

    def near_pairs(self, x: Array) -> tuple[Index, Index]:
        """Node pairs rows <= columns, two lists (m,), that may come into contact near the positions x (n, 3).

        Only a forecast: the matrix takes them up together with a pair in contact that it does not hold yet, so that it
        is analysed once for many. None by default.
        """
        return np.empty(0, np.int64), np.empty(0, np.int64)

    def gap_ahead(self, x: Array, dx: Array) -> float:
        """Smallest gap after a motion dx (n, 3) if each gap kept the rate that it has at x, mm.

        The smallest gap at x where the term knows no rates.
        """
        return self.gap(x)

    def tightening(self, model: "UnilateralTerm") -> Tightening | None:
        """How the term differs from that of the model, which it stands for; None where it does not."""
        return None

    def with_tightening(self, tightening: Tightening) -> "UnilateralTerm":
        """The term of the model as it stood in a state, from what `tightening` gave there."""
        return self

    def tightened(self, x: Array) -> "UnilateralTerm":
        """The term to try where the state x (n, 3), converged with this one, violates it; itself if there is none."""
        return self

    def with_exact_distances(self, x: Array) -> "UnilateralTerm":
        """The term with exact distances if those of this one may be inaccurate at x (n, 3); otherwise itself."""
        return self

    def at_new_increment(self) -> "UnilateralTerm":
        """The term with as many attempts to keep parts apart as an increment may take; itself where none are spent."""
        return self

    def step_limit(self, x: Array, dx: Array) -> float:
        """Largest fraction of the step dx (n, 3) in (0, 1] that keeps the parts apart."""
        return 1.0

    @final
    def must_activate(self, x: Array) -> bool:
        """Whether the term must be in the sum once a state without it was reached at x (n, 3)."""
        return not self.starts_inactive or self.touching(x)


def at_constant_fraction(terms: Terms, fraction: float) -> Terms:
    """The terms with the loads that are constant along the path scaled to `fraction`."""
    return tuple(term.with_constant_fraction(fraction) for term in terms)


def advanced(terms: Terms, x: Array, dx: Array) -> Terms:
    """The terms after the Newton step dx (n, 3) from x, with what they carry."""
    return tuple(term.advanced(x, dx) for term in terms)


def stressed(terms: Terms, x: Array, dx: Array) -> Terms:
    """The terms with the stress that a motion dx (n, 3) from x makes in those that carry one."""
    return tuple(term.stressed(x, dx) for term in terms)


def settled(terms: Terms) -> Terms:
    """The terms with what belongs to the positions themselves in place of what they carry."""
    return tuple(term.settled() for term in terms)


def step_limit(terms: Terms, x: Array, dx: Array) -> float:
    """Largest fraction of the step dx (n, 3) in (0, 1] that all terms admit."""
    return min((term.step_limit(x, dx) for term in terms if isinstance(term, UnilateralTerm)), default=1.0)


def near_pairs(terms: Terms, x: Array) -> tuple[Index, Index]:
    """Node pairs rows <= columns (m,) that may come into contact near the positions x (n, 3)."""
    pairs = [np.stack(term.near_pairs(x)) for term in terms if isinstance(term, UnilateralTerm)]
    rows, columns = np.concatenate([np.empty((2, 0), np.int64), *pairs], axis=1)
    return rows, columns


def smallest_gap(terms: Terms, x: Array) -> float:
    """Smallest distance in mm that contact sees at x (n, 3); infinity without contact."""
    return min((term.gap(x) for term in terms if isinstance(term, UnilateralTerm)), default=np.inf)
