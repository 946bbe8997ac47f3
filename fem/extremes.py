"""The extreme stretches of a state and where they sit."""

import numpy as np
from numpy.typing import NDArray

from fem import kernels
from fem.discretisation import Discretisation
from fem.solution import Extremes

Array = NDArray[np.float64]


def strain_at_stress_points(space: Discretisation, displacement: Array) -> tuple[Array, Array]:
    """Green-Lagrange strain (e, q, 6) and det F (e, q) for displacements (n, 3)."""
    strain = np.empty((*space.weight.shape, 6))
    jacobian = np.empty(space.weight.shape)
    kernels.green_lagrange(space.nodes, space.inverse, space.reference, displacement, strain, jacobian)
    return strain, jacobian


def principal_stretches(strain: Array) -> Array:
    """Ascending principal stretches (..., 3) of Green-Lagrange strains (..., 6)."""
    c = np.empty((*strain.shape[:-1], 3, 3))
    for v, (i, j) in enumerate(kernels.VOIGT):
        c[..., i, j] = c[..., j, i] = 2 * strain[..., v] + 1 if v < 3 else strain[..., v]
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(c), 0.0)))


def extremes_of(space: Discretisation, displacement: Array, jacobian: Array) -> Extremes:
    """Extreme J and stretches over all stress points, with the element centres (mm) they belong to."""
    strain, _ = strain_at_stress_points(space, displacement)
    stretches = principal_stretches(strain)

    def centre(element: int) -> tuple[float, float, float]:
        x, y, z = space.points[space.nodes[element, :4]].mean(axis=0)
        return float(x), float(y), float(z)

    return Extremes(
        min_J=float(jacobian.min()),
        max_stretch=float(stretches[..., 2].max()),
        min_stretch=float(stretches[..., 0].min()),
        min_J_at=centre(int(np.argmin(jacobian.min(axis=1)))),
        max_stretch_at=centre(int(np.argmax(stretches[..., 2].max(axis=1)))),
        min_stretch_at=centre(int(np.argmin(stretches[..., 0].min(axis=1)))),
    )
