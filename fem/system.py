"""The assembled equations of a model: residual and tangent of the total potential on the free components."""

from dataclasses import dataclass
from time import perf_counter
from typing import final

import numpy as np
from numpy.typing import NDArray

from fem import kernels
from fem.discretisation import Discretisation
from fem.effects import Blocks, Term
from fem.linear import LinearSolver
from fem.material import Material, Response
from fem.pattern import Pattern, element_keys
from fem.supports import Constraints

Array = NDArray[np.float64]

NO_INCREMENT = np.empty((0, 3))


@dataclass(frozen=True)
class State:
    """A point on the load path: displacement and the stresses Newton carries as unknowns of their own."""

    displacement: Array  #: (n, 3), mm
    stress: Array  #: (e, q, 6), second Piola-Kirchhoff, MPa


@dataclass(frozen=True)
class Assembly:
    """What one evaluation of the potential's gradient gives."""

    response: Response  #: the law at all stress points
    jacobian: Array  #: (e, q) det F
    gradient: Array  #: (n, 3) d Pi / d x, N; zero on the free components in equilibrium
    scale: float  #: norm of the nodal forces that balance, N


@dataclass
class Clock:
    """Seconds spent in assembly and in contact."""

    assembly: float = 0.0
    contact: float = 0.0


@final
class System:
    """Residual, tangent and linear solves of one model; everything that can be kept between iterations is."""

    def __init__(
        self,
        space: Discretisation,
        material: Material,
        terms: tuple[Term, ...],
        constraints: Constraints,
        solver: LinearSolver,
    ) -> None:
        self.space = space
        self.material = material
        self.terms = terms
        self.constraints = constraints
        self.solver = solver
        self.clock = Clock()
        self.pattern = Pattern.of(constraints.fixed, element_keys(space.nodes, space.points.shape[0]))
        self._take_pattern(self.pattern)

    def _take_pattern(self, pattern: Pattern) -> None:
        a, b = np.triu_indices(10)
        first, second = self.space.nodes[:, a], self.space.nodes[:, b]
        self.pattern = pattern
        self._offset = pattern.start_of(np.minimum(first, second), np.maximum(first, second))
        self.solver.analyse(pattern.indptr, pattern.indices)

    def start(self) -> State:
        """The body at rest."""
        elements, points = self.space.weight.shape
        return State(np.zeros_like(self.space.points), np.zeros((elements, points, 6)))

    def prescribed(self, factor: float, share: float) -> Array:
        """Prescribed displacements (n, 3): ramped ones at `factor`, constant ones to the given share."""
        return factor * self.constraints.ramped + share * self.constraints.constant

    def assemble(self, displacement: Array, factor: float) -> Assembly:
        """Gradient of the potential at `displacement` (n, 3) and load factor."""
        start = perf_counter()
        space = self.space
        strain = np.empty((*space.weight.shape, 6))
        jacobian = np.empty(space.weight.shape)
        kernels.green_lagrange(space.nodes, space.inverse, space.reference, displacement, strain, jacobian)
        response = space.respond(self.material, strain)
        gradient = np.zeros_like(displacement)
        kernels.internal_force(
            space.colours,
            space.nodes,
            space.inverse,
            space.reference,
            space.weight,
            displacement,
            response.stress,
            gradient,
        )
        loads = np.zeros_like(gradient)
        x = space.points + displacement
        for term in self.terms:
            term.gradient(x, factor, loads)
        scale = max(float(np.linalg.norm(gradient)), float(np.linalg.norm(loads)))
        gradient += loads
        self.clock.assembly += perf_counter() - start
        return Assembly(response, jacobian, gradient, scale)

    def energy(self, displacement: Array, factor: float) -> float:
        """Total potential, N mm."""
        space = self.space
        strain = np.empty((*space.weight.shape, 6))
        jacobian = np.empty(space.weight.shape)
        kernels.green_lagrange(space.nodes, space.inverse, space.reference, displacement, strain, jacobian)
        elastic = float(np.vdot(space.respond(self.material, strain).energy, space.weight))
        return elastic + sum(term.energy(space.points + displacement, factor) for term in self.terms)

    def free(self, values: Array) -> Array:
        """The free components (d,) of nodal values (n, 3)."""
        return values[~self.constraints.fixed]

    def increment(self, state: State, assembly: Assembly, factor: float, jump: Array, convex: bool) -> Array:
        """Newton increment (n, 3) of the displacement; `jump` (n, 3) is what the prescribed components still miss."""
        data, coupling = self.tangent(state, assembly, factor, jump, convex)
        self.solver.factorize(data)
        increment = jump.copy()
        increment[~self.constraints.fixed] = self.solver.solve(-self.free(assembly.gradient + coupling))
        return increment

    def tangent(
        self, state: State, assembly: Assembly, factor: float, jump: Array, convex: bool
    ) -> tuple[Array, Array]:
        """Values (nnz,) of the reduced upper triangle and K jump (n, 3)."""
        start = perf_counter()
        space = self.space
        x = space.points + state.displacement
        hessians = [term.blocks(x, factor, convex) for term in self.terms]
        self._make_room(hessians)
        pattern = self.pattern
        data = np.zeros(pattern.indices.shape[0])
        coupling = np.zeros_like(x)
        moves = bool(np.any(jump))
        kernels.tangent_matrix(
            space.colours,
            space.nodes,
            space.inverse,
            space.reference,
            space.weight,
            state.displacement,
            state.stress,
            assembly.response.tangent,
            self._offset,
            pattern.node_dof,
            pattern.indptr,
            pattern.free,
            data,
            jump if moves else NO_INCREMENT,
            coupling,
        )
        for blocks in hessians:
            pattern.place(data, blocks.rows, blocks.columns, blocks.values)
            if moves:
                kernels.blocks_times(blocks.rows, blocks.columns, blocks.values, jump, coupling)
        self.clock.assembly += perf_counter() - start
        return data, coupling

    def carried_stress(self, state: State, assembly: Assembly, increment: Array) -> Array:
        """S(E(u)) + C : (B(u) du), the stress (e, q, 6) Newton carries on (Magisano, Leonetti, Garcea 2017)."""
        start = perf_counter()
        space = self.space
        strain = np.empty((*space.weight.shape, 6))
        kernels.linearised_strain(
            space.nodes, space.inverse, space.reference, state.displacement, increment, strain
        )
        tangent = assembly.response.tangent
        if tangent.shape[0] == 1:
            change = np.einsum("qvm,eqm->eqv", np.broadcast_to(tangent[0], (strain.shape[1], 6, 6)), strain, optimize=True)
        else:
            change = np.einsum("eqvm,eqm->eqv", tangent, strain)
        self.clock.assembly += perf_counter() - start
        return assembly.response.stress + change

    def step_limit(self, displacement: Array, increment: Array) -> float:
        """Largest admissible share of the increment."""
        x = self.space.points + displacement
        return min((term.step_limit(x, increment) for term in self.terms), default=1.0)

    def _make_room(self, hessians: list[Blocks]) -> None:
        """Take new node pairs (contact) into the pattern; it only ever grows, so this becomes rare."""
        missing = [blocks for blocks in hessians if not self.pattern.holds(blocks.rows, blocks.columns)]
        if missing:
            rows = np.concatenate([blocks.rows for blocks in missing])
            columns = np.concatenate([blocks.columns for blocks in missing])
            self._take_pattern(self.pattern.with_pairs(rows, columns))
