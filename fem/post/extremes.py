"""The extreme stretches of a state, their positions, and whether the law is stable at them."""

from collections.abc import Sequence

import numpy as np

from fem.discretisation import Discretisation
from fem.kernels.element import VOIGT
from fem.materials import LAWS
from fem.materials.material import Material
from fem.materials.regions import ByRegion, Laws, Solid
from fem.reasons import Reasons, position_of
from fem.solution import Extremes
from geometry import Reason
from geometry.arrays import Array, Index


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
        return position_of(space.points[vertices[element]].mean(axis=0))

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


def unstable_stretches(space: Discretisation, displacement: Array, solid: Solid) -> Reasons:
    """The stretch at displacements (n, 3) that is outside the stable range of its law, for each law where one is."""
    strain, jacobian = space.strain_of(displacement)
    reasons = []
    for law, elements in Laws.on(solid, space.regions, space.nodes.shape[0]).parts:
        names = []
        if isinstance(solid, ByRegion) and law != solid.body:
            names = [name for name, other in solid.regions.items() if other == law]
        if reason := outside_stable_range(extremes_of(space, strain, jacobian, elements), law, names):
            reasons.append(reason)
    return tuple(reasons)


def outside_stable_range(extremes: Extremes, material: Material, regions: Sequence[str] = ()) -> Reason | None:
    """The stretch that is outside the stable range of the law; None where all are inside."""
    lowest, highest = material.stretch_limits
    law = next((name for name, known in LAWS.items() if known is type(material)), type(material).__name__)
    named: dict[str, float | str] = {
        "law": law,
        "of_region": f" of the region {' and '.join(regions)}" if regions else "",
    }
    if extremes.min_stretch < lowest:
        named |= {"stretch": extremes.min_stretch, "limit": lowest}
        return Reason("stretch_too_small", named, extremes.min_stretch_at)
    if extremes.max_stretch > highest:
        named |= {"stretch": extremes.max_stretch, "limit": highest}
        return Reason("stretch_too_large", named, extremes.max_stretch_at)
    return None
