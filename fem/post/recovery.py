"""An error indicator for a solved state: how far the stress of its elements is from a smoother one recovered from it.

Source: O. C. Zienkiewicz, J. Z. Zhu, "The superconvergent patch recovery and a posteriori error estimates", parts 1 and
2, Int. J. Numer. Meth. Engng 33 (1992) 1331-1382. Around every vertex a quadratic polynomial is fitted to the stress at
the stress points of the elements that meet there. The polynomials of an element's vertices, weighed by the vertices'
linear shape functions, are the recovered stress (T. Blacker, T. Belytschko, Int. J. Numer. Meth. Engng 37 (1994)).

The stress is the second Piola-Kirchhoff stress S of the shear part of the law. Its difference is measured in the energy
norm of that part at rest, int S : S / (2 mu) dX; for St. Venant-Kirchhoff's law that is the strain's. The volumetric
part is left out: near incompressibility the pressure of `p2p0` oscillates from element to element, and its share does
not fall steadily while displacements converge (measured: docs/theory.md).
"""

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp

from fem.discretisation import Discretisation
from fem.kernels.recovery import TERMS, Patches, blended, normal_equations
from fem.materials.material import Material
from fem.post.extremes import strain_at_stress_points
from fem.solution import Step
from geometry.arrays import Array, Index

#: stress points of a patch over the terms of its polynomial, below which the elements around are taken in
LEAST = 2
#: added to the mean squares of the terms, so that stress points on a common quadric give a polynomial too
RIDGE = 1e-10
#: a body whose shear stress is less than this over the shear modulus, in the mean, is at rest but for rounding
AT_REST = 1e-10
#: how often a Voigt component of the stress stands in the tensor
TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


@dataclass(frozen=True)
class StressError:
    """The difference of recovered and computed stress."""

    energy: float  #: of the difference over that of the computed stress: the square of the relative energy norm
    share: Array = field(repr=False)  #: (e,) of it in every element; they add up to 1
    worst_at: tuple[float, float, float]  #: centre at rest of the element with the largest share, mm


def stress_error(step: Step, material: Material) -> StressError:
    """How far the stress of a state is from the one recovered from it; zero for a body at rest."""
    space = step.space
    strain, _ = strain_at_stress_points(space, step.displacement)
    shear, weight = material.shear(strain[:, space.shear_points]).stress, space.weight[:, space.shear_points]
    computed = _squares(shear, weight)
    squares = _squares(recovered(space, shear) - shear, weight)
    if computed.sum() <= (AT_REST * material.shear_modulus) ** 2 * weight.sum():
        squares = np.zeros_like(squares)
    whole = float(squares.sum())
    x, y, z = space.points[space.vertices[int(np.argmax(squares))]].mean(axis=0)
    return StressError(
        energy=whole / float(computed.sum()) if whole else 0.0,
        share=squares / whole if whole else squares,
        worst_at=(float(x), float(y), float(z)),
    )


def _squares(stress: Array, weight: Array) -> Array:
    """int S : S dX (e,) of stresses (e, q, 6)."""
    return np.asarray(np.einsum("eqv,eqv,v,eq->e", stress, stress, TWICE, weight))


def recovered(space: Discretisation, values: Array) -> Array:
    """Values (e, q, c) of the recovered field at the stress points from those of the elements (e, q, c) there.

    Quadratic fields are given back as they are. q is 4, or 1 in linear elements.
    """
    shape = space.vertex_shape[: values.shape[1]]
    # in one layout for all elements and laws: the kernels are compiled once
    vertices, values = space.vertices, np.ascontiguousarray(values)
    positions = np.ascontiguousarray(np.einsum("qa,eai->eqi", shape, space.points[vertices]))
    begin, members = _patches(vertices, values.shape[1])
    count, terms = begin.shape[0] - 1, TERMS
    origin = space.points[:count]
    away = positions[members] - np.repeat(origin, np.diff(begin), axis=0)[:, None]
    scale = np.sqrt(np.maximum.reduceat(np.sum(away**2, axis=2).max(axis=1), begin[:-1]))
    left, right = np.zeros((count, terms, terms)), np.zeros((count, terms, values.shape[2]))
    patches = Patches(begin, members, origin, scale)
    normal_equations(patches, positions, values, left, right)
    left += RIDGE * left[:, :1, :1] * np.eye(terms)
    smooth = np.empty_like(values)
    blended(patches, np.linalg.solve(left, right), vertices, shape, positions, smooth)
    return smooth


def _patches(vertices: Index, points: int) -> tuple[Index, Index]:
    """The elements of every vertex's patch as (v + 1,) and (m,): members[begin[v]:begin[v + 1]] are those of v.

    Elements meeting at the vertex; where these have too few stress points, with those that touch them.
    """
    elements, count = vertices.shape[0], int(vertices.max()) + 1
    corner = np.repeat(np.arange(elements), 4)
    meets = sp.csr_matrix((np.ones(4 * elements, dtype=np.int64), (vertices.ravel(), corner)), (count, elements))
    few = np.flatnonzero(np.diff(meets.indptr) * points < LEAST * TERMS)
    if len(few):
        chosen = sp.csr_matrix((np.ones(len(few), dtype=np.int64), (few, few)), (count, count))
        meets = (meets + chosen @ meets @ meets.T @ meets).tocsr()
    return meets.indptr.astype(np.int64), meets.indices.astype(np.int64)
