"""Finite elements in time, to check rods with: inertia by the midpoint rule, and stress that relaxes.

The stress of the law relaxes as S + sum q_k with dq_k/dt = g_k dS/dt - q_k / tau_k at every stress point. A step asks
for the position x_m in its middle, where inertia has the potential 2/dt^2 (x_m - y)^T M (x_m - y) with
y = x + dt/2 v; it is one more effect beside those of an equilibrium, and Newton's method is that of `fem.path.newton`.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import LinearOperator, eigsh

from fem import Model
from fem.discretisation import Discretisation
from fem.effects.effect import Blocks, Term
from fem.equations.formulation import DisplacementOnly
from fem.equations.state import State
from fem.materials.material import Response
from fem.materials.regions import Laws
from fem.path import newton
from fem.path.active_set import ActiveSet
from fem.path.control import LoadControl
from geometry.arrays import Array

#: degree to which products of two quadratic shape functions are integrated exactly
DEGREE = 4
#: when Newton's method stops: 1e-5 of the forces, a thousandth of what a step changes them by
OPTIONS = newton.NewtonOptions(tolerance=1e-5, far=30, limited=30)


#: part g of the modulus of the configuration and time tau in s, of each branch
Branches = Sequence[tuple[float, float]]


def mass_matrix(space: Discretisation, density: float) -> sp.csr_matrix:
    """(n, n) tonne: int rho N_a N_b dX of quadratic elements; density in tonne/mm3."""
    points, weight = skfem.quadrature.get_quadrature(skfem.refdom.RefTet, DEGREE)
    shapes = [skfem.ElementTetP2().lbasis(points, a) for a in range(10)]
    shape, gradient = (np.stack([each[k] for each in shapes]) for k in (0, 1))  # (a, q), (a, k, q)
    volume = np.abs(np.linalg.det(np.einsum("akq,eai->eqik", gradient, space.points[space.nodes])))
    local = density * np.einsum("eq,aq,bq->eab", volume * weight, shape, shape)
    rows, columns = np.repeat(space.nodes, 10, axis=1), np.tile(space.nodes, (1, 10))
    return sp.csr_matrix((local.ravel(), (rows.ravel(), columns.ravel())), shape=(len(space.points),) * 2)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Inertia(Term):
    """(x - y)^T A (x - y) / 2 of positions x (n, 3) in mm."""

    effect = "inertia"

    matrix: sp.csr_matrix  #: (n, n) A, N/mm
    upper: sp.coo_matrix  #: its upper triangle
    target: Array  #: (n, 3) y, mm

    def energy(self, x: Array, factor: float) -> float:
        return 0.5 * float(np.vdot(x - self.target, self.matrix @ (x - self.target)))

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out += self.matrix @ (x - self.target)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        return self._blocks

    @cached_property
    def _blocks(self) -> Blocks:
        rows, columns = (numbers.astype(np.int64) for numbers in (self.upper.row, self.upper.col))
        return Blocks(rows, columns, self.upper.data[:, None, None] * np.eye(3))


@dataclass(frozen=True, eq=False)  # arrays inside
class Relaxing(Laws):
    """Laws whose stress is multiplied, with the stress of branches added."""

    factor: float
    carried: Array  #: (e, q, 6) MPa, of the branches
    split: int  #: number of stress points of the shear part; the others are those of the volumetric part

    def shear(self, strain: Array) -> Response:
        return self._relaxed(super().shear(strain), self.carried[:, : self.split])

    def volumetric(self, strain: Array) -> Response:
        carried = self.carried[:, self.split :]
        return self._relaxed(super().volumetric(strain), carried if carried.size else np.zeros(6))

    def _relaxed(self, elastic: Response, carried: Array) -> Response:
        stress = self.factor * elastic.stress + carried
        return Response(self.factor * elastic.energy, stress, self.factor * elastic.tangent)


@dataclass(frozen=True, eq=False)  # arrays inside
class Moment:
    """A body at a time."""

    time: float  #: s
    displacement: Array  #: (n, 3) mm
    velocity: Array  #: (n, 3) mm/s
    acceleration: Array  #: (n, 3) mm/s2
    stress: Array  #: (e, q, 6) MPa, of the law alone
    branches: Array  #: (k, e, q, 6) MPa, of each branch


@dataclass(frozen=True)
class Steps:
    """The generalised-alpha method: forces at a part of a step, inertia at another.

    Source: J. Chung, G. M. Hulbert, "A time integration algorithm for structural dynamics with improved numerical
    dissipation: the generalized-alpha method", J. Appl. Mech. 60 (1993).
    """

    size: float  #: s
    high: float = 1.0  #: what a step leaves of a motion of very high frequency; 1 damps nothing

    @property
    def force_at(self) -> float:
        """Part of a step after which forces balance."""
        return 1.0 / (1.0 + self.high)

    @property
    def inertia_at(self) -> float:
        """The same of inertia."""
        return (2.0 - self.high) / (1.0 + self.high)

    @property
    def gamma(self) -> float:
        """Weight of the new acceleration in the velocity."""
        return 0.5 + self.inertia_at - self.force_at

    @property
    def beta(self) -> float:
        """Weight of the new acceleration in the displacement."""
        return 0.25 * (1.0 + self.inertia_at - self.force_at) ** 2


@final
class Motion:
    """A body that moves from an equilibrium at rest.

    Effects of the model grow with a load factor, which is a function of time. Elements are quadratic and have no
    pressure unknowns. Raises ValueError for others.
    """

    def __init__(self, model: Model, density: float, branches: Branches, steps: Steps) -> None:
        self.system, self.steps = model.system(), steps
        formulation = self.system.formulation
        if not isinstance(formulation, DisplacementOnly) or not self.system.space.element.quadratic:
            raise ValueError("elements in time are p2 or p2p0")
        self.elastic = formulation
        self.mass = mass_matrix(self.system.space, density)
        self.g, self.tau = np.array(branches, dtype=float).reshape(-1, 2).T
        inertia = steps.inertia_at / (steps.force_at * steps.beta * steps.size**2) * self.mass
        self._inertia = Inertia(inertia, sp.triu(inertia, format="coo"), np.empty(0))
        self._active = ActiveSet.of(self.system.terms, self.system.space.points)

    def begin(self, displacement: Array | None = None) -> Moment:
        """At rest in a long-held displacement (n, 3), mm; without one the undeformed body."""
        at = np.zeros_like(self.system.space.points) if displacement is None else displacement
        self._active = self._active.activated(self.system.space.points + at)
        stress, still = self._stress(at), np.zeros_like(at)
        return Moment(0.0, at, still, still, stress, np.zeros((len(self.g), *stress.shape)))

    def run(self, start: Moment, factor: Callable[[float], float], steps: int) -> Iterator[Moment]:
        """The moments after each step; factor: of the loads at a time in s. Raises `fem.path.newton.StepFailed`."""
        now = start
        for _ in range(steps):
            now = self._after(now, self._balanced(now, factor(now.time + self.steps.force_at * self.steps.size)))
            yield now

    def energy(self, now: Moment, factor: float) -> float:
        """N mm: kinetic, of the law and of the loads; that of the branches is not in it."""
        self.system.replace_body(self.system.space, self.elastic)
        kinetic = 0.5 * float(np.vdot(now.velocity, self.mass @ now.velocity))
        return kinetic + self.system.energy(now.displacement, factor, self._active.active)

    def _stress(self, displacement: Array) -> Array:
        self.system.replace_body(self.system.space, self.elastic)
        return self.system.state_at(displacement, 0.0).stress

    def _branches(self, now: Moment, part: float) -> tuple[Array, Array]:
        """After a part of a step: (k, 1, 1, 1) of a change of the law's stress, and (k, e, q, 6) MPa that is left."""
        time = part * self.steps.size
        left, gained = (np.exp(-each / self.tau)[:, None, None, None] for each in (time, 0.5 * time))
        gained = self.g[:, None, None, None] * gained
        return gained, left * now.branches - gained * now.stress

    def _balanced(self, now: Moment, factor: float) -> Array:
        """(n, 3) mm: the displacement where forces balance."""
        space, part, size = self.system.space, self.steps.force_at, self.steps.size
        gained, left = self._branches(now, part)
        laws, points = self.elastic.laws, space.element.shape.points
        relaxing = Relaxing(laws.parts, laws.elements, 1.0 + float(gained.sum()), left.sum(axis=0), points)
        self.system.replace_body(space, DisplacementOnly(space, relaxing))
        start = self.system.state_at(now.displacement + part * size * now.velocity, factor)
        curved = size**2 * (0.5 - self.steps.beta / self.steps.inertia_at) * now.acceleration
        target = space.points + now.displacement + part * (size * now.velocity + curved)
        inertia = replace(self._inertia, target=target)
        control = LoadControl.of(self.system).target(factor, 1.0)
        while True:
            found = self._solve(start, inertia, control)
            active = self._active.activated(space.points + found.displacement)
            if active is self._active:
                return found.displacement
            self._active = active

    def _solve(self, start: State, inertia: Inertia, control: LoadControl) -> State:
        begin = newton.Start(start, (*self._active.active, inertia))
        return newton.solve(begin, control, OPTIONS, lambda *_: None, self._active.inactive).state

    def _after(self, now: Moment, balanced: Array) -> Moment:
        """The end of a step, from where its forces balance (n, 3)."""
        size, beta, gamma = self.steps.size, self.steps.beta, self.steps.gamma
        moved = (balanced - now.displacement) / self.steps.force_at
        acceleration = (moved - size * now.velocity) / (beta * size**2) - (0.5 / beta - 1.0) * now.acceleration
        velocity = now.velocity + size * ((1.0 - gamma) * now.acceleration + gamma * acceleration)
        stress = self._stress(now.displacement + moved)
        gained, left = self._branches(now, 1.0)
        branches = left + gained * stress
        return Moment(now.time + size, now.displacement + moved, velocity, acceleration, stress, branches)


def frequencies(model: Model, displacement: Array, density: float, count: int) -> Array:
    """(count,) Hz, rising: of small motions about an equilibrium of displacement (n, 3) in mm at load factor 1.

    Its supports hold displacement components; density in tonne/mm3.
    """
    system = model.system()
    active = ActiveSet.of(system.terms, system.space.points).activated(system.space.points + displacement).active
    state = system.state_at(displacement, 1.0)
    held, tangent = system.constraints, system.linearise(state, system.assemble(state, active), active)
    mass = sp.kron(mass_matrix(system.space, density), sp.eye(3))
    reduced = (held.transformation.T @ mass @ held.transformation).tocsr()
    inverse = LinearOperator(reduced.shape, lambda x: -held.reduce(tangent.solve(held.expand(x)).displacement))
    values = eigsh(reduced, count, reduced, sigma=0.0, OPinv=inverse, return_eigenvectors=False)
    return np.sort(np.sqrt(values)) / (2.0 * np.pi)
