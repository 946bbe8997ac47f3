"""The result of a load path: steps as values, their form as plain arrays to be stored, and why a path ended."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.discretisation import Discretisation
from fem.effects.loads import enclosed_volume
from fem.effects.tightening import Tightening
from fem.equations.state import Change
from fem.reasons import Reasons, position_of, reasons_of, sentence
from fem.supports import Where, nodes_at
from geometry import PneurodError
from geometry.arrays import Array, Index


@dataclass(frozen=True)
class Extremes:
    """Extreme values of a state over its stress points, and their positions."""

    min_J: float  #: smallest det F at a stress point
    max_stretch: float  #: largest principal stretch at a stress point
    min_stretch: float  #: smallest principal stretch at a stress point
    min_J_at: tuple[float, float, float]  #: reference position of that element's centre, mm
    max_stretch_at: tuple[float, float, float]
    min_stretch_at: tuple[float, float, float]


#: stages of a load path besides its effects
STAGES = ("set_up", "assembly", "analysis", "factorization", "solve")


@dataclass(frozen=True)
class Seconds:
    """Wall seconds of a load path by what they were spent on."""

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
        """Seconds spent since `other`."""
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
class ExactContact:
    """The equilibrium near a step's with the distances between all triangles of walls in contact."""

    displacement: Array = field(repr=False)  #: (n, 3), mm
    gradient: Array = field(repr=False)  #: as in `Step`


@dataclass(frozen=True)
class Step:
    """One converged equilibrium."""

    space: Discretisation = field(repr=False)
    factor: float  #: load factor
    displacement: Array = field(repr=False)  #: (n, 3), mm
    stress: Array = field(
        repr=False
    )  #: (e, q, 6), second Piola-Kirchhoff of the part of the law at each stress point, MPa
    rate: Change | None = field(repr=False)  #: of displacement and pressures per load factor (or mm3); None if unknown
    gradient: Array = field(repr=False)  #: (n, 3) forces of the supports on the body, zero on free components, N
    extremes: Extremes
    min_gap: float  #: smallest signed gap between facing walls, mm; infinity without such walls
    negative_pivots: int  #: of the tangent; 0 in an equilibrium that is stable while the load is held
    instability: Reasons  #: in how many directions the equilibrium is unstable and where; empty for a stable one
    newton_iterations: int  #: of the increments since the previous step that converged; starts that failed left out
    #: all since the previous step: one for each Newton iteration, those of failed starts and increments included, one
    #: for the tangent at rest, and one where the stability of an unstable equilibrium is analysed
    factorizations: int
    cutbacks: int  #: increments that failed since the previous step
    effects: tuple[str, ...]  #: names of the effects in the potential
    active: tuple[bool, ...]  #: which of the model's effects, in their order, are in the potential
    #: (k,) node pairs that contact has brought into the pattern of the matrix (`fem.equations.storage`), so that a path
    #: that is resumed has the same one
    added_pairs: Index = field(repr=False)
    #: for each of the model's effects how its contact differs from that of the model; None where it does not
    contacts: tuple[Tightening | None, ...] = field(repr=False)
    seconds: float  #: wall seconds since the previous step
    spent: Seconds  #: the same by what they were spent on; no set-up
    #: for comparison where nodes in a cavity press beside the triangles of their pairs; None elsewhere
    exact: ExactContact | None = None
    inexact: Reasons = ()  #: why there is nothing to compare with where that was tried; empty elsewhere
    #: difference to the equilibrium whose contact in creases is that of this load alone, relative to displacement or
    #: strain, where it is too far from the path to be taken; infinity where none was found; 0 elsewhere
    path_dependence: float = 0.0

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
    factorizations: int  #: numeric ones, in all
    #: sparsity patterns: one, plus one whenever contact enlarged it. Each needs a symbolic factorization, unless one of
    #: the same pattern was kept in this process
    analyses: int
    solver: str  #: name of the linear solver
    degrees_of_freedom: int  #: free ones


@dataclass(frozen=True)
class End:
    """Where and why a path ended before its last target."""

    quantity: str  #: name of the driven quantity, for sentences
    target: float  #: its value that was not reached
    reached: float  #: its value at the last equilibrium
    constant_fraction: float  #: applied of constant loads and displacements, 1 once the first target was reached
    cutbacks: int  #: increments that failed since the last target that was reached
    factorizations: int  #: since then, that of the last equilibrium's stability included
    reasons: Reasons  #: why the last attempt failed, and what the last equilibrium tells of it
    #: value of the quantity at which the rates of the path become infinite, where no equilibrium was found closely
    #: behind the last one; None where the path did not announce its end
    limit: float | None = None

    @property
    def cause(self) -> str:
        """The reasons as a sentence without full stop."""
        return sentence(self.reasons)


class NotConverged(PneurodError, RuntimeError):
    """The path ended before the last target. Carries the end, the reason as a sentence, and the steps reached."""

    def __init__(self, end: End, partial: Solution) -> None:
        self.reason = (
            f"no equilibrium found beyond {end.quantity} {end.reached:.4g} on the way to {end.target:.4g}: "
            f"{f'the limit is at {end.limit:.4g}; ' if end.limit else ''}{end.cause}"
        )
        super().__init__(self.reason)
        self.end = end
        self.partial = partial


#: arrays of a step under their own names, and its further values that are sequences
_ARRAYS = ("displacement", "stress", "gradient", "added_pairs")
_SEQUENCES = ("effects", "active")
_NUMBERS = (
    *("factor", "min_gap", "negative_pivots", "newton_iterations", "factorizations", "cutbacks"),
    *("seconds", "path_dependence"),
)


def step_to_arrays(step: Step) -> dict[str, NDArray[Any]]:
    """Everything of a step but its discretisation, by name, so that it can be stored and a path resumed from it."""
    others = {name: getattr(step, name) for name in (*_NUMBERS, *_SEQUENCES)}
    others |= {"extremes": asdict(step.extremes), "spent": asdict(step.spent)}
    others |= {name: list(map(asdict, getattr(step, name))) for name in ("instability", "inexact")}
    arrays = {name: getattr(step, name) for name in _ARRAYS}
    arrays["others"] = np.array(json.dumps(others, default=lambda value: value.item()))
    if step.rate is not None:
        rate = step.rate
        arrays |= {
            "rate": rate.displacement,
            "rate_of_pressures": rate.pressure,
            "rate_of_factor": np.array(rate.factor),
        }
    if step.exact is not None:
        arrays |= {"exact_displacement": step.exact.displacement, "exact_gradient": step.exact.gradient}
    for number, contact in enumerate(step.contacts):
        arrays |= {} if contact is None else contact.arrays(_contact(number))
    return arrays


def step_from_arrays(space: Discretisation, arrays: Mapping[str, NDArray[Any]]) -> Step:
    """The step of which `step_to_arrays` gave these arrays, on an equal discretisation."""
    others = json.loads(str(arrays["others"]))
    values: dict[str, Any] = {name: arrays[name] for name in _ARRAYS} | {name: others[name] for name in _NUMBERS}
    values |= {name: tuple(others[name]) for name in _SEQUENCES}
    values |= {name: reasons_of(others[name]) for name in ("instability", "inexact")}
    extremes: dict[str, Any] = others["extremes"]
    extremes |= {name: position_of(place) for name, place in extremes.items() if name.endswith("_at")}
    rate, exact = None, None
    if "rate" in arrays:
        rate = Change(float(arrays["rate_of_factor"]), arrays["rate"], arrays["rate_of_pressures"])
    if "exact_displacement" in arrays:
        exact = ExactContact(arrays["exact_displacement"], arrays["exact_gradient"])
    return Step(
        space=space,
        **values,
        rate=rate,
        extremes=Extremes(**extremes),
        contacts=tuple(Tightening.from_arrays(_contact(k), arrays) for k in range(len(others["active"]))),
        spent=Seconds(**others["spent"]),
        exact=exact,
    )


def _contact(number: int) -> str:
    return f"contact_{number}"
