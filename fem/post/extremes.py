"""The extreme stretches of a state, their positions, and whether the law is stable at them."""

import numpy as np

from fem.discretisation import Discretisation
from fem.kernels.element import VOIGT, green_lagrange
from fem.materials import LAWS
from fem.materials.material import Material
from fem.materials.regions import ByRegion, Laws, Solid
from fem.solution import Extremes
from geometry import position_text
from geometry.arrays import Array, Index


def strain_at_stress_points(space: Discretisation, displacement: Array) -> tuple[Array, Array]:
    """Green-Lagrange strain (e, q, 6) and det F (e, q) for displacements (n, 3)."""
    strain = np.empty((*space.weight.shape, 6))
    jacobian = np.empty(space.weight.shape)
    green_lagrange(space.arrays, displacement, strain, jacobian)
    return strain, jacobian


def principal_stretches(strain: Array) -> Array:
    """Ascending principal stretches (..., 3) of Green-Lagrange strains (..., 6)."""
    c = np.empty((*strain.shape[:-1], 3, 3))
    for v, (i, j) in enumerate(VOIGT):
        c[..., i, j] = c[..., j, i] = 2 * strain[..., v] + 1 if v < 3 else strain[..., v]
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(c), 0.0)))


def extremes_of(
    space: Discretisation, strain: Array, jacobian: Array, elements: Index | slice = slice(None)
) -> Extremes:
    """Extreme J and stretches over all stress points of some elements, with the element centres (mm) they belong to,
    from the Green-Lagrange strain (e, q, 6) and det F (e, q)."""
    strain, jacobian, vertices = strain[elements], jacobian[elements], space.vertices[elements]
    low, high = _candidates(strain)
    least, largest = principal_stretches(strain[low])[..., 0], principal_stretches(strain[high])[..., 2]

    def centre(element: int) -> tuple[float, float, float]:
        x, y, z = space.points[vertices[element]].mean(axis=0)
        return float(x), float(y), float(z)

    return Extremes(
        min_J=float(jacobian.min()),
        max_stretch=float(largest.max()),
        min_stretch=float(least.min()),
        min_J_at=centre(int(np.argmin(jacobian.min(axis=1)))),
        max_stretch_at=centre(int(high[0][np.argmax(largest)])),
        min_stretch_at=centre(int(low[0][np.argmin(least)])),
    )


def _candidates(strain: Array) -> tuple[tuple[Index, ...], tuple[Index, ...]]:
    """Elements and stress points at which the smallest and the largest principal stretch can be; only there are
    eigenvalues computed.

    The eigenvalues of C are m + 2 s cos(phi), m + 2 s cos(phi -+ 2 pi / 3) with 0 <= phi <= pi / 3, where m is their
    mean and 6 s^2 = |C - m I|^2: the largest lies between m + s and m + 2 s, the smallest between m - 2 s and m - s.
    """
    diagonal, shear = 2 * strain[..., :3] + 1, strain[..., 3:]
    mean = diagonal.mean(axis=-1)
    square = np.sum((diagonal - mean[..., None]) ** 2, axis=-1) + 2 * np.sum(shear**2, axis=-1)
    size = np.sqrt(square / 6)
    slack = 1e-12 * np.abs(mean).max()
    low, high = mean - 2 * size <= (mean - size).min() + slack, mean + 2 * size >= (mean + size).max() - slack
    return np.nonzero(low), np.nonzero(high)


def unstable_stretch(space: Discretisation, displacement: Array, solid: Solid) -> str:
    """A clause that names a stretch at displacements (n, 3) outside the stable range of a law, and its region; empty
    where all are inside."""
    strain, jacobian = strain_at_stress_points(space, displacement)
    if not isinstance(solid, ByRegion):
        return outside_stable_range(extremes_of(space, strain, jacobian), solid)
    clauses = []
    for law, elements in Laws.on(solid, space.regions, space.nodes.shape[0]).parts:
        if clause := outside_stable_range(extremes_of(space, strain, jacobian, elements), law):
            names = [name for name, other in solid.regions.items() if other == law and law != solid.body]
            clauses.append(f"in the region {' and '.join(names)} {clause}" if names else clause)
    return "; ".join(clauses)


def outside_stable_range(extremes: Extremes, material: Material) -> str:
    """A clause that names a stretch outside the stable range of the law; empty where all are inside."""
    lowest, highest = material.stretch_limits
    law = next((name for name, known in LAWS.items() if known is type(material)), type(material).__name__)
    volume = f"the smallest volume ratio J is {extremes.min_J:.3g} at {position_text(extremes.min_J_at)}"
    if extremes.min_stretch < lowest:
        position = position_text(extremes.min_stretch_at)
        return (
            f"a stretch of {extremes.min_stretch:.3g} at {position} is below {lowest:.3g}, "
            f"where the law {law} in compression is no longer stable; {volume}"
        )
    if extremes.max_stretch > highest:
        position = position_text(extremes.max_stretch_at)
        return (
            f"a stretch of {extremes.max_stretch:.3g} at {position} is above {highest:.3g}, "
            f"the largest at which the law {law} is stable; {volume}"
        )
    return ""
