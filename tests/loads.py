"""Loads for tests only: dead forces in the body and on its faces, given as functions of the position at rest."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
import skfem

from fem import Effect, Material
from fem.discretisation import Discretisation
from fem.effects.effect import Term
from fem.effects.loads import DeadForceTerm
from geometry.arrays import Array

#: maps positions (..., 3) at rest in mm to forces (..., 3) per volume or area
Density = Callable[[Array], Array]


def tetrahedron_rule(space: Discretisation, degree: int) -> tuple[Array, Array, Array, Array]:
    """Shape functions (q, a), gradients (e, q, a, 3), positions (e, q, 3) and weights (e, q) in the body at rest."""
    where, weight = skfem.quadrature.get_quadrature(skfem.refdom.RefTet, degree)
    element = skfem.ElementTetP2() if space.element.quadratic else skfem.ElementTetP1()
    values = [element.lbasis(where, a) for a in range(space.nodes.shape[1])]
    shape = np.stack([value for value, _ in values], axis=1)
    gradient = np.einsum("qak,eki->eqai", np.stack([slope.T for _, slope in values], axis=1), space.inverse[:, 0])
    positions = np.einsum("qa,eai->eqi", shape, space.points[space.nodes])
    return shape, gradient, positions, weight / np.abs(np.linalg.det(space.inverse[:, 0]))[:, None]


@final
@dataclass(frozen=True)
class BodyForce(Effect):
    """A dead force in N/mm3 at load factor 1."""

    density: Density

    def bind(self, space: Discretisation, material: Material) -> Term:
        shape, _, positions, weight = tetrahedron_rule(space, 6)
        force = np.zeros_like(space.points)
        np.add.at(force, space.nodes, np.einsum("eq,qa,eqi->eai", weight, shape, self.density(positions)))
        return DeadForceTerm("body_force", force)


@final
@dataclass(frozen=True)
class Traction(Effect):
    """A dead traction in MPa at load factor 1 on a named flat face."""

    where: str
    density: Density

    def bind(self, space: Discretisation, material: Material) -> Term:
        faces = space.surface(self.where)
        where, weight = skfem.quadrature.get_quadrature(skfem.refdom.RefTri, 6)
        element = skfem.ElementTriP2() if space.element.quadratic else skfem.ElementTriP1()
        shape = np.stack([element.lbasis(where, a)[0] for a in range(faces.nodes.shape[1])], axis=1)
        corners = space.points[faces.nodes[:, :3]]
        doubled = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        positions = np.einsum("qa,fai->fqi", shape, space.points[faces.nodes])
        shares = np.einsum("f,q,qa,fqi->fai", doubled, weight, shape, self.density(positions))
        force = np.zeros_like(space.points)
        np.add.at(force, faces.nodes, shares)
        return DeadForceTerm("traction", force)
