"""An error indicator for a solved state: the difference between its stress and a smoother one recovered from it.

Source: O. C. Zienkiewicz, J. Z. Zhu, "The superconvergent patch recovery and a posteriori error estimates", parts 1 and
2, Int. J. Numer. Meth. Engng 33 (1992) 1331-1382. Around every vertex a quadratic polynomial is fitted to the stress at
the stress points of the elements that meet there. The polynomials of an element's vertices, weighed by the vertices'
linear shape functions, are the recovered stress (T. Blacker, T. Belytschko, Int. J. Numer. Meth. Engng 37 (1994)).

The stress is the second Piola-Kirchhoff stress S of the shear part of the law. Its difference is measured in the energy
norm of that part at rest, int S : S / (2 mu) dX; for St. Venant-Kirchhoff's law that is the strain's. The volumetric
part is left out: near incompressibility the pressure of `p2p0` oscillates from element to element, and its contribution
does not fall steadily while displacements converge (docs/theory.md).
"""

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp

from fem.discretisation import Discretisation
from fem.kernels.recovery import TERMS, Patches, blended, normal_equations
from fem.materials.regions import Laws, Solid, laws_of
from fem.reasons import position_of
from fem.solution import Step
from geometry.arrays import Array, Index

#: least ratio of the stress points of a patch to the terms of its polynomial; smaller patches take in neighbours
MIN_POINTS_PER_TERM = 2
#: added to the mean squares of the terms, so that stress points on a common quadric give a polynomial too
RIDGE = 1e-10
#: mean shear stress over the shear modulus below which a body counts as free of stress
STRESS_FREE = 1e-10
#: how often each Voigt component occurs in the tensor
MULTIPLICITY = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


@dataclass(frozen=True)
class StressError:
    """The difference of recovered and computed stress."""

    energy: float  #: of the difference over that of the computed stress: the square of the relative energy norm
    fraction: Array = field(repr=False)  #: (e,) of that energy in each element; they sum to 1, or are 0 without stress
    worst_at: tuple[float, float, float]  #: centre at rest of the element with the largest fraction, mm


def stress_error(step: Step, material: Solid) -> StressError:
    """How far the stress of a state is from the one recovered from it; zero for a body at rest.

    Between two materials the stress jumps: it is recovered in each by itself.
    """
    space, modulus = step.space, laws_of(material)[""].shear_modulus
    laws = Laws.on(material, space.regions, space.nodes.shape[0])
    strain, _ = space.strain_of(step.displacement)
    shear, weight = laws.shear(strain[:, space.shear_points]).stress, space.weight[:, space.shear_points]
    smooth = np.empty_like(shear)
    for _, elements in laws.parts:
        smooth[elements] = recovered(space, shear[elements], elements)
    relative = weight * laws.per_element(lambda law: modulus / law.shear_modulus)
    computed = _squares(shear, relative)
    squares = _squares(smooth - shear, relative)
    if computed.sum() <= (STRESS_FREE * modulus) ** 2 * weight.sum():
        squares = np.zeros_like(squares)
    total = float(squares.sum())
    return StressError(
        energy=total / float(computed.sum()) if total else 0.0,
        fraction=squares / total if total else squares,
        worst_at=position_of(space.points[space.vertices[int(np.argmax(squares))]].mean(axis=0)),
    )


def _squares(stress: Array, weight: Array) -> Array:
    """int S : S dX (e,) of stresses (e, q, 6)."""
    return np.asarray(np.einsum("eqv,eqv,v,eq->e", stress, stress, MULTIPLICITY, weight))


def recovered(space: Discretisation, values: Array, elements: Index | None = None) -> Array:
    """Values (m, q, c) of the recovered field at the stress points, from the values (m, q, c) of the elements (m,)
    there; of all elements where none are given.

    Quadratic fields are reproduced exactly. q is 4, or 1 in linear elements.
    """
    shape = space.vertex_shape[: values.shape[1]]
    chosen = space.vertices if elements is None else space.vertices[elements]
    used, local = np.unique(chosen, return_inverse=True)
    # in one layout for all elements and laws: the kernels are compiled once
    vertices, values = np.ascontiguousarray(local.reshape(chosen.shape), dtype=np.int64), np.ascontiguousarray(values)
    positions = np.ascontiguousarray(np.einsum("qa,eai->eqi", shape, space.points[chosen]))
    begin, members = _patches(vertices, values.shape[1])
    count, terms = begin.shape[0] - 1, TERMS
    origin = np.ascontiguousarray(space.points[used])
    offset = positions[members] - np.repeat(origin, np.diff(begin), axis=0)[:, None]
    scale = np.sqrt(np.maximum.reduceat(np.sum(offset**2, axis=2).max(axis=1), begin[:-1]))
    left, right = np.zeros((count, terms, terms)), np.zeros((count, terms, values.shape[2]))
    patches = Patches(begin, members, origin, scale)
    normal_equations(patches, positions, values, left, right)
    left += RIDGE * left[:, :1, :1] * np.eye(terms)
    smooth = np.empty_like(values)
    blended(patches, np.linalg.solve(left, right), vertices, shape, positions, smooth)
    return smooth


def _patches(vertices: Index, points: int) -> tuple[Index, Index]:
    """The elements of every vertex's patch as (v + 1,) and (m,): members[begin[v]:begin[v + 1]] are those of v.

    A patch holds the elements that meet at the vertex and, where these have too few stress points, their neighbours.
    """
    elements, count = vertices.shape[0], int(vertices.max()) + 1
    corner = np.repeat(np.arange(elements), 4)
    incidence = sp.csr_matrix((np.ones(4 * elements, dtype=np.int64), (vertices.ravel(), corner)), (count, elements))
    few = np.flatnonzero(np.diff(incidence.indptr) * points < MIN_POINTS_PER_TERM * TERMS)
    if len(few):
        selection = sp.csr_matrix((np.ones(len(few), dtype=np.int64), (few, few)), (count, count))
        incidence = (incidence + selection @ incidence @ incidence.T @ incidence).tocsr()
    return incidence.indptr.astype(np.int64), incidence.indices.astype(np.int64)
