"""The assembled equations of a model: residual and tangent of the total potential under its constraints."""

from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from time import perf_counter
from typing import final

import numpy as np

from fem.discretisation import Discretisation
from fem.effects.effect import Terms, near_pairs
from fem.equations.constraints import Constraints
from fem.equations.formulation import Formulation, formulation_of
from fem.equations.linear import LinearSolver
from fem.equations.linearised import Linearised
from fem.equations.state import Assembly, Change, State
from fem.equations.storage import TangentStorage
from fem.kernels import element as kernels
from fem.kernels.tangent import LawArrays, Product, tangent_matrix
from fem.materials.regions import Solid, laws_of
from fem.memory import keep_freed_memory
from geometry.arrays import Array

NO_INCREMENT = np.empty((0, 3))


@final
class Clock:
    """Seconds by what they were spent on: "assembly" and the names of effects."""

    def __init__(self) -> None:
        self.seconds: defaultdict[str, float] = defaultdict(float)

    @contextmanager
    def timing(self, name: str) -> Iterator[None]:
        """Add the time of the block to `name`."""
        start = perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += perf_counter() - start


@final
class System:
    """Gradient and tangent of the potential of one model, and its linear equations.

    What does not change between iterations is kept: elements, sparsity pattern, symbolic analysis.
    """

    def __init__(
        self,
        space: Discretisation,
        material: Solid,
        terms: Terms,
        constraints: Constraints,
        solver: LinearSolver,
    ) -> None:
        keep_freed_memory()
        self.space = space
        self.material = material
        self.formulation = formulation_of(space, material)
        self.terms = terms
        self.constraints = constraints
        self.solver = solver
        self.clock = Clock()
        self.storage = TangentStorage(space, self.formulation, constraints, solver)
        volume = float(space.weight[:, space.shear_points].sum())
        self._element_size = (volume / space.nodes.shape[0]) ** (1 / 3)  #: mean edge of a cube of that volume, mm
        self._roundoff_stiffness = self._roundoff_stiffness_at_rest()

    @property
    def size(self) -> int:
        """Number of unknowns: those of the constraints and the pressures."""
        return self.constraints.size + self.formulation.unknowns

    def replace_constraints(self, constraints: Constraints) -> None:
        """Take other constraints from now on, those of the next angle of a plane for example.

        States stay usable: Newton's method takes them to the new constraints by `Constraints.correction`. The symbolic
        analysis is repeated only where the sparsity of T^T K T is another one: where T has other stored entries. A
        `Linearised` made before still belongs to the old constraints.
        """
        self.constraints = constraints
        self.storage.constrain(constraints)

    def replace_body(self, space: Discretisation, formulation: Formulation) -> None:
        """Take the same elements with their nodes elsewhere, or with other constants of their materials."""
        self.space, self.formulation = space, formulation

    def rest_state(self) -> State:
        """The body at rest."""
        elements, points = self.space.weight.shape
        rest = np.zeros_like(self.space.points)
        return State(0.0, rest, np.zeros(self.formulation.unknowns), *np.zeros((2, elements, points, 6)))

    def state_at(self, displacement: Array, factor: float) -> State:
        """The state in which pressure, strain and stress are those of the displacement (n, 3)."""
        strain, _ = self.space.strain_of(displacement)
        pressure = self.formulation.pressure_of(strain)
        return State(factor, displacement, pressure, strain, self.formulation.evaluate(strain, pressure).stress)

    def strained(self, state: State) -> State:
        """The state with the strain of its displacement; its stress is that of its `assemble` then."""
        return replace(state, strain=self.space.strain_of(state.displacement)[0])

    def settled(self, state: State, terms: Terms) -> tuple[State, Assembly]:
        """The state in which pressure, strain and stress are those of its displacement, and its `assemble`."""
        strained = self.strained(state)
        strained = replace(strained, pressure=self.formulation.pressure_of(strained.strain))
        assembly = self.assemble(strained, terms)
        return replace(strained, stress=assembly.stress), assembly

    def assemble(self, state: State, terms: Terms) -> Assembly:
        """Gradient of the potential with the given terms at `state`.

        Exact where the carried strain is that of the displacement, or the law is linear.
        """
        displacement = state.displacement
        with self.clock.timing("assembly"):
            strain, jacobian = self.space.strain_of(displacement)
            law_values = self.formulation.evaluate(state.strain, state.pressure)
            stress = law_values.stress + _times(law_values.tangent, strain - state.strain)
            pressure_residual = self.formulation.pressure_residual(law_values, strain - state.strain, state.pressure)
            internal = np.zeros_like(displacement)
            kernels.internal_force(self.space.arrays, displacement, stress, internal)
        loads = self.loads(displacement, state.factor, terms)
        scale = max(float(np.linalg.norm(internal)), float(np.linalg.norm(loads)))
        roundoff = self._roundoff_stiffness * max(float(np.abs(displacement).max()), self._element_size)
        return Assembly(strain, law_values, stress, jacobian, internal + loads, pressure_residual, scale, roundoff)

    def gradient_at(self, displacement: Array, factor: float, terms: Terms) -> Array:
        """Gradient (n, 3) of the potential at a displacement (n, 3), where pressures are those of it, N."""
        stress, internal = self.state_at(displacement, factor).stress, np.zeros_like(displacement)
        with self.clock.timing("assembly"):
            kernels.internal_force(self.space.arrays, displacement, stress, internal)
        return np.asarray(internal + self.loads(displacement, factor, terms))

    def loads(self, displacement: Array, factor: float, terms: Terms) -> Array:
        """Gradient (n, 3) of the terms, N."""
        loads = np.zeros_like(displacement)
        for term in terms:
            with self.clock.timing(term.effect):
                term.gradient(self.space.points + displacement, factor, loads)
        return loads

    def _roundoff_stiffness_at_rest(self) -> float:
        """Stiffness of an element at rest times the spacing of numbers around 1, at all nodes, N/mm.

        Times the displacement it bounds the nodal forces of a rotated, unstrained body, which are round-off alone; in
        rotated bars of all laws they are at most a fifth of it. Where hardly anything moves, the deformation gradient
        around 1 is rounded all the same, as a displacement of the size of an element is: in hollow boxes of all laws
        displaced by 1e-20 to 1e-17 mm the nodal forces are at most a tenth of what this gives.
        """
        rest = np.zeros((1, 6))
        laws = laws_of(self.material).values()
        stiffness = max(float((law.shear(rest).tangent + law.volumetric(rest).tangent).max()) for law in laws)
        nodes = np.sqrt(self.space.points.shape[0])
        return float(4 * stiffness * self._element_size * np.finfo(float).eps * nodes)

    def energy(self, displacement: Array, factor: float, terms: Terms) -> float:
        """Total potential, N mm."""
        strain, _ = self.space.strain_of(displacement)
        law_values = self.formulation.evaluate(strain, self.formulation.pressure_of(strain))
        elastic = float(np.vdot(law_values.energy, self.space.weight))
        return elastic + sum(term.energy(self.space.points + displacement, factor) for term in terms)

    def linearise(
        self, state: State, assembly: Assembly, terms: Terms, increment: Array | None = None, convex: bool = False
    ) -> Linearised:
        """The tangent at `state`, factorized; assembly is that of the state and the terms.

        increment (n, 3) is what the displacement is about to change by to meet the constraints, mm; zero by default.
        With `convex` the terms give a positive semi-definite substitute where they can. Every `Linearised` made before
        becomes stale. Raises `SingularMatrix`.
        """
        if increment is None:
            increment = np.zeros_like(state.displacement)
        data, coupling = self.tangent(state, assembly, terms, increment, convex)
        self.storage.analyse()
        self.solver.factorize(data)
        pivots = self.solver.negative_pivots - self.formulation.unknowns
        return Linearised(coupling, pivots, self.solver, self.solver.generation, self.constraints)

    def tangent(
        self, state: State, assembly: Assembly, terms: Terms, increment: Array, convex: bool
    ) -> tuple[Array, Change]:
        """Upper triangle of T^T K T as values (r,), and K increment for an increment (n, 3) of the displacement."""
        x = self.space.points + state.displacement
        hessians = []
        for term in terms:
            with self.clock.timing(term.effect):
                hessians.append(term.blocks(x, state.factor, convex))
        starts = self.storage.starts(hessians, lambda: near_pairs(terms, x))
        with self.clock.timing("assembly"):
            pattern, moves = self.storage.pattern, bool(np.any(increment))
            data, coupling = np.zeros(pattern.indices.shape[0]), np.zeros_like(x)
            law = LawArrays(state.stress, assembly.law_values.tangent)
            product = Product(increment if moves else NO_INCREMENT, coupling)
            matrix, element_starts = pattern.matrix(data), self.storage.element_starts
            tangent_matrix(self.space.arrays, law, state.displacement, element_starts, matrix, product)
            for blocks, start in zip(hessians, starts, strict=True):
                pattern.scatter(data, blocks.rows, blocks.columns, blocks.values, start)
                if moves:
                    kernels.blocks_times(blocks.rows, blocks.columns, blocks.values, increment, coupling)
            self.formulation.scatter_pressures(
                pattern, self.storage.pressure_offsets, data, state.displacement, assembly.law_values
            )
            data = self.storage.reduced(data)
        pressure_coupling = np.zeros(self.formulation.unknowns)
        if moves and self.formulation.unknowns:
            strain = self.linearised_strain(state, increment)
            pressure_coupling = self.formulation.pressure_coupling(assembly.law_values, strain)
        return data, Change(0.0, coupling, pressure_coupling)

    def linearised_strain(self, state: State, increment: Array) -> Array:
        """B(u) du (e, q, 6) for an increment (n, 3)."""
        with self.clock.timing("assembly"):
            strain = np.empty((*self.space.weight.shape, 6))
            kernels.linearised_strain(self.space.arrays, state.displacement, increment, strain)
        return strain

    def rate(self, state: State, assembly: Assembly, change: Change) -> State:
        """Change of the state, strain and stress included, with a change of its unknowns, to first order.

        assembly is that of the state.
        """
        strain = self.linearised_strain(state, change.displacement)
        stress = _times(assembly.law_values.tangent, strain)
        stress = stress + self.formulation.stress_change(assembly.law_values, change.pressure)
        return State(change.factor, change.displacement, change.pressure, strain, stress)

    def advanced(self, state: State, assembly: Assembly, change: Change, strain: Array) -> State:
        """The state after a change whose B(u) du is `strain` (e, q, 6)."""
        with self.clock.timing("assembly"):
            stress = assembly.stress + _times(assembly.law_values.tangent, strain)
            stress = stress + self.formulation.stress_change(assembly.law_values, change.pressure)
            return State(
                state.factor + change.factor,
                state.displacement + change.displacement,
                state.pressure + change.pressure,
                assembly.strain + strain,
                stress,
            )


def _times(tangent: Array, strain: Array) -> Array:
    """C : strain (e, q, 6) for C (e, q, 6, 6), or (1, q or 1, 6, 6) where it is the same in all elements."""
    if tangent.shape[0] > 1:
        return np.asarray(np.einsum("eqvm,eqm->eqv", tangent, strain))
    product = np.matmul(strain.transpose(1, 0, 2), tangent[0].transpose(0, 2, 1))
    return np.ascontiguousarray(product.transpose(1, 0, 2))
