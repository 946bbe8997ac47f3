"""Fields of a state per element, for pictures: stretch, J and Cauchy stress."""

import numpy as np

from fem.equations.formulation import formulation_of
from fem.kernels.element import VOIGT
from fem.materials.regions import Solid
from fem.post.extremes import principal_stretches
from fem.solution import Step
from geometry.arrays import Array


def element_fields(step: Step, material: Solid) -> dict[str, Array]:
    """Largest and smallest principal stretch in a tetrahedron (e,), and means over it of J (e,) and of the Cauchy
    stress (e, 6; xx, yy, zz, xy, yz, xz; MPa). Tetrahedra are in the order of the mesh."""
    space = step.space
    strain, jacobian = space.strain_of(step.displacement)
    law = formulation_of(space, material)
    stress = law.evaluate(strain, law.pressure_of(strain)).stress
    points = space.element.shape.points
    second = stress[:, :points].mean(axis=1) + stress[:, points:].sum(axis=1)
    gradient = _mean_deformation_gradient(step)
    matrix = np.empty((second.shape[0], 3, 3))
    for v, (i, j) in enumerate(VOIGT):
        matrix[:, i, j] = matrix[:, j, i] = second[:, v]
    cauchy = np.einsum("eij,ejk,elk->eil", gradient, matrix, gradient) / np.linalg.det(gradient)[:, None, None]
    stretches = principal_stretches(strain)
    fields = {
        "stretch": stretches[..., 2].max(axis=1),
        "smallest_stretch": stretches[..., 0].min(axis=1),
        "J": jacobian[:, space.shear_points].mean(axis=1),
        "cauchy_stress_MPa": np.stack([cauchy[:, i, j] for i, j in VOIGT], axis=1),
    }
    return {name: values[space.of_tets] for name, values in fields.items()}


def _mean_deformation_gradient(step: Step) -> Array:
    """(e, 3, 3), mean over the points of the quadrature rule."""
    space = step.space
    reference, inverse = space.reference[space.shear_points], space.inverse[:, space.shear_points]
    if inverse.shape[1] == 1:
        gradients = np.einsum("ak,eki->eai", reference.mean(axis=0), inverse[:, 0])
    else:
        gradients = np.einsum("qak,eqki->eai", reference, inverse) / reference.shape[0]
    return np.eye(3) + np.einsum("eai,eaj->eij", step.displacement[space.nodes], gradients)
