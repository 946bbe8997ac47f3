"""How the volumetric part of a law enters the potential: through the displacement alone, or through a pressure.

In the mixed formulation the hydrostatic pressure is a field of its own, linear in each tetrahedron and continuous
(C. Taylor, P. Hood, "A numerical solution of the Navier-Stokes equations using the finite element technique", Comput.
Fluids 1 (1973), for rubber e.g. T. Sussman, K.-J. Bathe, Comput. Struct. 26 (1987)). For a volumetric energy
m/2 theta(E)^2 the potential is

    Pi(u, p) = int W_shear(E) + p theta(E) - p^2 / (2 m) dX - ...,

stationary in p where p is m times the projection of theta on the linear fields: a displacement determines its
pressure. The unknowns are the nodal p over the shear modulus, so that the displacement and the pressure rows of the
tangent are of similar size in any units.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import SuperLU, splu

from fem.discretisation import Discretisation
from fem.elements import Volumetric
from fem.equations.pattern import Pattern
from fem.kernels.mixed import pressure_columns
from fem.materials.material import MaterialError, Response
from fem.materials.regions import Laws, Solid
from geometry.arrays import Array, Index

#: where in the pattern the columns of each element's pressures begin in the rows of its nodes, (e, 4 or 10, 0 or 4),
#: as `Pattern.offset_of` gives it; and where the pairs of pressures stand, (m, 3), as `Pattern.starts_of` does
PressureOffsets = tuple[Index, NDArray[np.int32]]


@dataclass(frozen=True)
class LawValues:
    """Energy, stress and tangent of a law at all stress points of a body."""

    energy: Array  #: (e, q), MPa
    stress: Array  #: (e, q, 6), second Piola-Kirchhoff, of the part of the law taken at each point, MPa
    tangent: Array  #: (e, q, 6, 6) dS/dE, MPa; (1, q or 1, 6, 6) where it is the same everywhere
    dilatation: Array  #: (e, q) theta; (0, 0) where the pressure is not an unknown
    #: (e, q, 6) d theta / d E, (1, 1, 6) where it is the same everywhere; (0, 0, 6) without pressure unknowns
    dilatation_gradient: Array


NO_PRESSURE = np.empty(0)


@dataclass(frozen=True)
class Formulation(ABC):
    """A law on a discretisation; here without pressure unknowns."""

    space: Discretisation
    laws: Laws

    @property
    def unknowns(self) -> int:
        """Number of pressure unknowns v."""
        return 0

    @property
    def element_unknowns(self) -> Index:
        """(e, 4, 10 or 14) nodes of each element, the pressures counted on as n, n + 1, ..."""
        return self.space.nodes

    @abstractmethod
    def evaluate(self, strain: Array, pressure: Array) -> LawValues:
        """The law at strains (e, q, 6) and pressures (v,)."""

    def pressure_of(self, strain: Array) -> Array:
        """The pressures (v,) that belong to the strains (e, q, 6) of a displacement."""
        return NO_PRESSURE

    def pressure_residual(self, law_values: LawValues, change: Array, pressure: Array) -> Array:
        """d Pi / d p (v,), theta to first order at strains that differ by change (e, q, 6) from the evaluated ones."""
        return NO_PRESSURE

    def stress_change(self, law_values: LawValues, pressure: Array) -> Array | float:
        """Change of the stress (e, q, 6) with a change of the pressures (v,)."""
        return 0.0

    def offsets(self, pattern: Pattern) -> PressureOffsets:
        """Where in the pattern the columns of the pressures begin."""
        return np.empty((*self.space.nodes.shape, 0), dtype=np.int64), np.empty((0, 3), dtype=np.int32)

    def scatter_pressures(
        self, pattern: Pattern, offsets: PressureOffsets, data: Array, displacement: Array, law_values: LawValues
    ) -> None:
        """Add the rows and columns of the pressures to the reduced upper triangle data (nnz,)."""
        return

    def pressure_coupling(self, law_values: LawValues, change: Array) -> Array:
        """Change of d Pi / d p (v,) with a change of the strains (e, q, 6)."""
        return NO_PRESSURE


def formulation_of(space: Discretisation, solid: Solid) -> Formulation:
    """The laws on a discretisation, with pressure unknowns where it was made for them; raises `MaterialError`."""
    laws = Laws.on(solid, space.regions, space.nodes.shape[0])
    return Mixed(space, laws) if space.element.volumetric is Volumetric.PRESSURE else DisplacementOnly(space, laws)


@final
@dataclass(frozen=True)
class DisplacementOnly(Formulation):
    """The volumetric part is evaluated at the displacement's strain: at all points, or at the centroid alone."""

    def evaluate(self, strain: Array, pressure: Array) -> LawValues:
        if self.space.element.fully_integrated:
            shear, volumetric = self.laws.shear(strain), self.laws.volumetric(strain)
            energy, stress = shear.energy + volumetric.energy, shear.stress + volumetric.stress
            tangent = shear.tangent + volumetric.tangent
        else:
            points = self.space.element.shape.points
            shear, volumetric = self.laws.shear(strain[:, :points]), self.laws.volumetric(strain[:, points:])
            energy = np.concatenate([shear.energy, volumetric.energy], axis=1)
            stress = np.concatenate([shear.stress, volumetric.stress], axis=1)
            tangent = np.concatenate([_per_point(shear, points), _per_point(volumetric, 1)], axis=1)
        # contiguous for all laws: a kernel is compiled once for each layout
        stress, tangent = np.ascontiguousarray(stress), np.ascontiguousarray(tangent)
        return LawValues(energy, stress, tangent, np.empty((0, 0)), np.empty((0, 0, 6)))


def _per_point(response: Response, points: int) -> Array:
    tangent = response.tangent
    return np.broadcast_to(tangent, (tangent.shape[0], points, 6, 6))


@final
@dataclass(frozen=True)
class Mixed(Formulation):
    """Linear pressure beside the quadratic displacement, continuous within each material. Raises `MaterialError`.

    Where two laws meet the pressure jumps, so that the vertices between them have one for each.
    """

    def __post_init__(self) -> None:
        for law, _ in self.laws.parts:
            if not law.volumetric_modulus > 0:
                raise MaterialError(
                    f"the mixed formulation needs a positive volumetric modulus, this law has "
                    f"{law.volumetric_modulus:g} MPa; take p2 or p2p0"
                )

    @cached_property
    def unknowns(self) -> int:
        return int(self._pressures.max()) + 1

    @cached_property
    def element_unknowns(self) -> Index:
        return np.concatenate([self.space.nodes, self._pressures + self.space.points.shape[0]], axis=1)

    @cached_property
    def _pressures(self) -> Index:
        """(e, 4) numbers of the pressures at the vertices of each element."""
        vertices, count = self.space.vertices, len(self.laws.parts)
        if count == 1:
            return vertices
        _, number = np.unique(vertices * count + self.laws.part_of_element[:, None], return_inverse=True)
        return np.ascontiguousarray(number.reshape(vertices.shape), dtype=np.int64)

    @cached_property
    def _modulus(self) -> Array | float:
        """m of each element, (e, 1), MPa; one number where there is one law."""
        return self.laws.per_element(lambda law: law.volumetric_modulus)

    def evaluate(self, strain: Array, pressure: Array) -> LawValues:
        shear, theta = self.laws.shear(strain), self.laws.dilatation(strain)
        pressures, tangent = self._pressure_at_points(pressure), shear.tangent
        if theta.hessian.any():
            tangent = pressures[..., None, None] * theta.hessian
            tangent += shear.tangent
        return LawValues(
            shear.energy + pressures * (theta.value - 0.5 * pressures / self._modulus),
            shear.stress + pressures[..., None] * theta.gradient,
            tangent,
            theta.value,
            np.ascontiguousarray(theta.gradient),
        )

    def pressure_of(self, strain: Array) -> Array:
        theta = self.laws.dilatation(strain).value
        scale = self.laws.first.volumetric_modulus / self._pressure_unit
        return np.asarray(scale * self._mass_factor.solve(self._integrated(theta)))

    def pressure_residual(self, law_values: LawValues, change: Array, pressure: Array) -> Array:
        theta = law_values.dilatation + np.sum(law_values.dilatation_gradient * change, axis=-1)
        theta = theta - self._pressure_at_points(pressure) / self._modulus
        return self._integrated(theta) * self._pressure_unit

    def stress_change(self, law_values: LawValues, pressure: Array) -> Array | float:
        return self._pressure_at_points(pressure)[..., None] * law_values.dilatation_gradient

    def offsets(self, pattern: Pattern) -> PressureOffsets:
        nodes, pressures = self.space.nodes[:, :, None], self.element_unknowns[:, None, -4:]
        rows, columns, _ = self._compressibility
        return pattern.offset_of(*np.broadcast_arrays(nodes, pressures)), pattern.starts_of(rows, columns)

    def scatter_pressures(
        self, pattern: Pattern, offsets: PressureOffsets, data: Array, displacement: Array, law_values: LawValues
    ) -> None:
        space = self.space
        elements = space.arrays._replace(weight=self._pressure_unit * space.weight)
        gradient, matrix = law_values.dilatation_gradient, pattern.matrix(data)
        pressure_columns(elements, self._pressures, displacement, space.vertex_shape, gradient, offsets[0], matrix)
        pattern.scatter(data, *self._compressibility, offsets[1])

    def pressure_coupling(self, law_values: LawValues, change: Array) -> Array:
        return self._integrated(np.sum(law_values.dilatation_gradient * change, axis=-1)) * self._pressure_unit

    @property
    def _pressure_unit(self) -> float:
        """MPa per unit of the pressure unknowns."""
        return self.laws.first.shear_modulus

    def _pressure_at_points(self, pressure: Array) -> Array:
        """(e, q) MPa."""
        return self._pressure_unit * np.asarray(pressure[self._pressures] @ self.space.vertex_shape.T)

    def _integrated(self, values: Array) -> Array:
        """int N_v values dX (v,) of values (e, q)."""
        local = (values * self.space.weight) @ self.space.vertex_shape
        integrals = np.bincount(self._pressures.ravel(), local.ravel(), minlength=self.unknowns)
        return np.asarray(integrals, dtype=float)

    @cached_property
    def _mass(self) -> sp.csr_matrix:
        """(v, v) int N_v N_w dX, mm3, each element times the modulus m of the body over its own."""
        shape, numbers = self.space.vertex_shape, self._pressures
        weight = self.space.weight * (self.laws.first.volumetric_modulus / self._modulus)
        local = np.einsum("eq,qa,qb->eab", weight, shape, shape)
        rows, columns = np.repeat(numbers, 4, axis=1), np.tile(numbers, (1, 4))
        return sp.csr_matrix((local.ravel(), (rows.ravel(), columns.ravel())), shape=(self.unknowns,) * 2)

    @cached_property
    def _compressibility(self) -> tuple[Index, Index, Array]:
        """Second derivative by the pressures, which is constant, as blocks of pairs of unknowns."""
        mass = sp.triu(self._mass, format="coo")
        blocks = np.zeros((mass.nnz, 3, 3))
        blocks[:, 0, 0] = -(self._pressure_unit**2) / self.laws.first.volumetric_modulus * mass.data
        first = self.space.points.shape[0]
        return mass.row.astype(np.int64) + first, mass.col.astype(np.int64) + first, blocks

    @cached_property
    def _mass_factor(self) -> SuperLU:
        return splu(self._mass.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
