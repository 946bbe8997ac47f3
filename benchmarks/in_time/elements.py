"""Finite elements in time, to check rods with: inertia, and stress that relaxes.

The stress of the law relaxes as S + sum q_k with dq_k/dt = g_k dS/dt - q_k / tau_k at every stress point. Steps are
generalised-alpha (J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993) 371). At the positions x at which forces balance
inertia has the potential (x - y)^T A (x - y) / 2: it is one more effect beside those of an equilibrium.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
import scipy.sparse as sp
import skfem

from fem import Model
from fem.discretisation import Discretisation
from fem.effects.effect import Blocks, Term
from fem.equations.formulation import DisplacementOnly
from fem.materials.material import Response
from fem.materials.regions import Laws
from fem.path import newton
from fem.path.active_set import ActiveSet
from fem.path.control import LoadControl
from geometry.arrays import Array
from rod import Relaxation

#: the residual is far from its end for some iterations where inertia is not
OPTIONS = newton.NewtonOptions(tolerance=1e-8, far=30, limited=30)


def mass_matrix(space: Discretisation, density: float) -> sp.csr_matrix:
    """(n, n) tonne: int rho N_a N_b dX of quadratic elements; density in tonne/mm3."""
    points, weight = skfem.quadrature.get_quadrature(skfem.refdom.RefTet, 4)
    shapes = [skfem.ElementTetP2().lbasis(points, a) for a in range(10)]
    shape, gradient = (np.stack([each[k] for each in shapes]) for k in (0, 1))  # (a, q), (a, k, q)
    volume = np.abs(np.linalg.det(np.einsum("akq,eai->eqik", gradient, space.points[space.nodes])))
    local = density * np.einsum("eq,aq,bq->eab", volume * weight, shape, shape)
    rows, columns = np.repeat(space.nodes, 10, axis=1), np.tile(space.nodes, (1, 10))
    return sp.csr_matrix((local.ravel(), (rows.ravel(), columns.ravel())), shape=(len(space.points),) * 2)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Inertia(Term):
    """The potential of inertia in a step."""

    effect = "inertia"
    matrix: sp.csr_matrix  #: (n, n) A, N/mm
    second: Blocks  #: the same
    target: Array  #: (n, 3) y, mm

    def energy(self, x: Array, factor: float) -> float:
        return 0.5 * float(np.vdot(x - self.target, self.matrix @ (x - self.target)))

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out += self.matrix @ (x - self.target)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        return self.second


@dataclass(frozen=True, eq=False)  # arrays inside
class Relaxing(Laws):
    """Laws whose stress is multiplied, with the stress of branches added; of the element p2p0."""

    factor: Array  #: (e, 1, 1)
    carried: Array  #: (e, q, 6) MPa, of the branches; that of the volumetric part is at the last point

    def shear(self, strain: Array) -> Response:
        return self._relaxed(super().shear(strain), self.carried[:, : strain.shape[1]])

    def volumetric(self, strain: Array) -> Response:
        return self._relaxed(super().volumetric(strain), self.carried[:, -1:])

    def _relaxed(self, elastic: Response, carried: Array) -> Response:
        stress = self.factor * elastic.stress + carried
        return Response(self.factor[..., 0] * elastic.energy, stress, self.factor[..., None] * elastic.tangent)


@dataclass(frozen=True, eq=False)  # arrays inside
class Moment:
    """A body at a time."""

    time: float  #: s
    displacement: Array  #: (n, 3) mm
    velocity: Array  #: (n, 3) mm/s
    acceleration: Array  #: (n, 3) mm/s2
    stress: Array  #: (e, q, 6) MPa, of the law alone
    branches: Array  #: (k, e, q, 6) MPa


@final
class Motion:
    """A body that moves from an equilibrium at rest; loads grow with a factor, which is a function of time.

    density: tonne/mm3. branches: for each of the laws of the body parts of its modulus, and times in s. size: of steps,
    s. high: what a step leaves of very fast motions; 1 damps nothing. Elements are p2p0.
    """

    def __init__(
        self, model: Model, density: float, branches: Sequence[Relaxation], size: float, high: float = 1.0
    ) -> None:
        self.system, self.size = model.system(), size
        self.space, formulation = self.system.space, self.system.formulation
        assert isinstance(formulation, DisplacementOnly)
        self.elastic, self.mass = formulation, mass_matrix(self.space, density)
        of = formulation.laws.part_of_element
        parts = [np.multiply.outer(one.shares, of == number) for number, one in enumerate(branches)]
        self.g = np.concatenate(parts)[..., None, None]  # (k, e, 1, 1)
        self.tau = np.concatenate([one.times_s for one in branches]).reshape(-1, 1, 1, 1)
        #: parts of a step after which forces and inertia are taken
        self.part, self.late = 1.0 / (1.0 + high), (2.0 - high) / (1.0 + high)
        self.beta, self.gamma = 0.25 * (1.0 + self.late - self.part) ** 2, 0.5 + self.late - self.part
        matrix = self.late / (self.part * self.beta * size**2) * self.mass
        upper = sp.triu(matrix, format="coo")
        pairs = [upper.row.astype(np.int64), upper.col.astype(np.int64), upper.data[:, None, None] * np.eye(3)]
        self.inertia = Inertia(matrix, Blocks(*pairs), np.empty(0))
        self.active = ActiveSet.of(self.system.terms, self.space.points)

    def begin(self, at: Array) -> Moment:
        """At rest in a displacement (n, 3), mm, to which all has relaxed."""
        self.active = self.active.activated(self.space.points + at)
        stress, still = self._stress(at), np.zeros_like(at)
        return Moment(0.0, at, still, still, stress, np.zeros((len(self.g), *stress.shape)))

    def run(self, start: Moment, factor: Callable[[float], float], steps: int) -> Iterator[Moment]:
        """The start, and after each step. Raises `fem.path.newton.StepFailed`."""
        yield (now := start)
        for _ in range(steps):
            yield (now := self._after(now, self._balanced(now, factor(now.time + self.part * self.size))))

    def _stress(self, displacement: Array) -> Array:
        self.system.replace_body(self.space, self.elastic)
        return self.system.state_at(displacement, 0.0).stress

    def _branches(self, now: Moment, part: float) -> tuple[Array, Array]:
        """After a part of a step: (k, e, 1, 1) of a change of the law's stress, and (k, e, q, 6) MPa that is left."""
        time = part * self.size
        gained = self.g * np.exp(-0.5 * time / self.tau)
        return gained, np.exp(-time / self.tau) * now.branches - gained * now.stress

    def _balanced(self, now: Moment, factor: float) -> Array:
        """(n, 3) mm: the displacement where forces balance."""
        gained, left = self._branches(now, self.part)
        laws = self.elastic.laws
        relaxing = Relaxing(laws.parts, laws.elements, 1.0 + gained.sum(axis=0), left.sum(axis=0))
        self.system.replace_body(self.space, DisplacementOnly(self.space, relaxing))
        moved = self.part * self.size * now.velocity
        curved = self.part * self.size**2 * (0.5 - self.beta / self.late) * now.acceleration
        inertia = replace(self.inertia, target=self.space.points + now.displacement + moved + curved)
        start = self.system.state_at(now.displacement + moved, factor)
        control, active = LoadControl.of(self.system).target(factor, 1.0), None
        while active is not self.active:  # until no more walls meet
            self.active = active or self.active
            begin = newton.Start(start, (*self.active.active, inertia))
            found = newton.solve(begin, control, OPTIONS, lambda *_: None, self.active.inactive).state
            active = self.active.activated(self.space.points + found.displacement)
        return found.displacement

    def _after(self, now: Moment, balanced: Array) -> Moment:
        """The end of a step, from where its forces balance (n, 3)."""
        size, moved = self.size, (balanced - now.displacement) / self.part
        acceleration = (moved / size - now.velocity) / (self.beta * size) - (0.5 / self.beta - 1.0) * now.acceleration
        velocity = now.velocity + size * ((1.0 - self.gamma) * now.acceleration + self.gamma * acceleration)
        stress = self._stress(now.displacement + moved)
        gained, left = self._branches(now, 1.0)
        return Moment(now.time + size, now.displacement + moved, velocity, acceleration, stress, left + gained * stress)
