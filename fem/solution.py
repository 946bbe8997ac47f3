"""What a load path leaves behind: frozen steps and the outcome."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fem.discretisation import Discretisation
from fem.effects.loads import enclosed_volume
from fem.equations.state import Change
from fem.supports import Where, nodes_at
from geometry.arrays import Array


@dataclass(frozen=True)
class Extremes:
    """The worst points of a state and where they sit."""

    min_J: float  #: smallest det F at a stress point
    max_stretch: float  #: largest principal stretch at a stress point
    min_stretch: float  #: smallest principal stretch at a stress point
    min_J_at: tuple[float, float, float]  #: reference position of that element's centre, mm
    max_stretch_at: tuple[float, float, float]
    min_stretch_at: tuple[float, float, float]


STAGES = ("set_up", "assembly", "analysis", "factorization", "solve")


@dataclass(frozen=True)
class Seconds:
    """Where the time of a load path went."""

    set_up: float = 0.0
    assembly: float = 0.0  #: of the body itself
    analysis: float = 0.0
    factorization: float = 0.0
    solve: float = 0.0
    effects: Mapping[str, float] = field(default_factory=dict)  #: assembly of each effect

    @property
    def total(self) -> float:
        """Sum of all stages."""
        return sum(getattr(self, name) for name in STAGES) + sum(self.effects.values())

    def __sub__(self, other: "Seconds") -> "Seconds":
        """What was spent after `other`."""
        return self._combined(other, -1.0)

    def __add__(self, other: "Seconds") -> "Seconds":
        return self._combined(other, 1.0)

    def _combined(self, other: "Seconds", sign: float) -> "Seconds":
        names = {**self.effects, **other.effects}
        return Seconds(
            **{name: getattr(self, name) + sign * getattr(other, name) for name in STAGES},
            effects={name: self.effects.get(name, 0.0) + sign * other.effects.get(name, 0.0) for name in names},
        )


@dataclass(frozen=True)
class Step:
    """One converged equilibrium."""

    space: Discretisation = field(repr=False)
    factor: float  #: load factor
    displacement: Array = field(repr=False)  #: (n, 3), mm
    stress: Array = field(repr=False)  #: (e, q, 6), second Piola-Kirchhoff of each stress point's share of the law, MPa
    rate: Change | None = field(repr=False)  #: of displacement and pressures per load factor (or mm3); None if unknown
    gradient: Array = field(repr=False)  #: (n, 3) forces of the supports on the body, zero on free components, N
    extremes: Extremes
    min_gap: float  #: smallest signed gap between facing walls, mm; infinity without such walls
    negative_pivots: int  #: of the tangent; 0 in an equilibrium that is stable while the load is held
    instability: str  #: in how many directions the equilibrium is unstable and where; empty in a stable one
    newton_iterations: int  #: of the increments since the previous step that converged; starts that failed left out
    #: all since the previous step: one for each Newton iteration, those of failed starts and increments included, one
    #: for the tangent at rest, and one where the stability of an unstable equilibrium is analysed
    factorizations: int
    cutbacks: int  #: increments that failed since the previous step
    effects: tuple[str, ...]  #: names of the effects in the potential
    active: tuple[bool, ...]  #: which of the model's effects, in their order, are in the potential
    seconds: float  #: since the previous step
    spent: Seconds  #: the same by what they were spent on; no set-up

    @property
    def points(self) -> Array:
        """(n, 3) reference positions of all nodes, mid-edge nodes included where there are some, mm."""
        return self.space.points

    @property
    def positions(self) -> Array:
        """(n, 3) current positions, mm."""
        return self.space.points + self.displacement

    @property
    def min_J(self) -> float:
        """Smallest det F at a stress point."""
        return self.extremes.min_J

    def reaction(self, where: Where) -> Array:
        """(3,) force in N that the supports at `where` exert on the meshed part (half a body gives half the force)."""
        return np.asarray(self.gradient[nodes_at(where, self.space)].sum(axis=0))

    def cavity_volume(self, name: str) -> float:
        """Volume in mm3 enclosed by the named faces and the symmetry plane, in the current configuration."""
        return enclosed_volume(self.space.surface(name), self.positions)


@dataclass(frozen=True)
class Solution:
    """The steps at the targets, as far as the path went."""

    steps: tuple[Step, ...]
    seconds: Seconds
    factorizations: int  #: in all
    analyses: int  #: symbolic analyses, one more for each time contact asked for room in the pattern
    solver: str  #: name of the linear solver
    degrees_of_freedom: int  #: free ones


@dataclass(frozen=True)
class End:
    """Where and why a path ended."""

    quantity: str  #: what is driven along the path, for sentences
    target: float  #: its value that was not reached
    reached: float  #: its value at the last equilibrium
    constant_fraction: float  #: applied of constant loads and displacements, 1 once the first target was reached
    cutbacks: int  #: increments that failed since the last target that was reached
    factorizations: int  #: since then, that of the last equilibrium's stability included
    cause: str  #: a sentence without full stop


class NotConverged(RuntimeError):
    """The path ended before the last target. Carries the end, the reason and what was reached."""

    def __init__(self, end: End, partial: Solution) -> None:
        self.reason = (
            f"no equilibrium found beyond {end.quantity} {end.reached:.4g} on the way to {end.target:.4g}: {end.cause}"
        )
        super().__init__(self.reason)
        self.end = end
        self.partial = partial
