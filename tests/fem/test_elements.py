"""The table of elements against scikit-fem, and the default element for each Poisson ratio."""

import numpy as np
import pytest
import skfem

from fem.discretisation import Discretisation
from fem.elements import ELEMENTS, Element, Volumetric, automatic_element
from fem.kernels.element import internal_force
from geometry import SemicircularSingle
from tests.bodies import box


@pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS)
def test_weights_are_integrals_of_the_shape_functions(element: Element) -> None:
    tetrahedron = skfem.ElementTetP2() if element.quadratic else skfem.ElementTetP1()
    positions, weights = skfem.quadrature.get_quadrature(skfem.refdom.RefTet, 2)
    count = len(element.shape.nodal_weights)
    integrals = [6 * np.sum(weights * tetrahedron.lbasis(positions, a)[0]) for a in range(count)]
    np.testing.assert_allclose(element.shape.nodal_weights, integrals, atol=1e-14)
    line = skfem.ElementLineP2() if element.quadratic else skfem.ElementLineP1()
    positions, weights = skfem.quadrature.get_quadrature(skfem.refdom.RefLine, 2)
    first, last, *middle = (np.sum(weights * line.lbasis(positions, a)[0]) for a in range(element.shape.degree + 1))
    np.testing.assert_allclose(element.shape.edge_weights, [first, *middle, last], atol=1e-14)


@pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS)
def test_a_discretisation_has_the_nodes_and_stress_points_of_its_element(element: Element) -> None:
    mesh = box((1, 1, 1), (1.0, 2.0, 3.0))
    space = Discretisation.of(mesh, element.name)
    assert space.element is element
    assert space.nodes.shape == (mesh.tets.shape[0], len(element.shape.nodal_weights))
    at_centroid = element.volumetric is Volumetric.CENTROID
    assert space.weight.shape == (mesh.tets.shape[0], element.shape.points + at_centroid)
    np.testing.assert_allclose(space.volume.sum(), 6.0)
    np.testing.assert_allclose(space.weight.sum(), 12.0 if at_centroid else 6.0)


@pytest.mark.parametrize(
    ("nu", "against_locking", "name"),
    [
        (0.3, None, "p2"),
        (0.3, True, "p2p0"),
        (0.4, None, "p2p0"),
        (0.4, False, "p2"),
        (0.4989, None, "p2p0"),
        (0.499, None, "mixed"),
        (0.499, False, "p2"),
    ],
)
def test_the_automatic_element_follows_from_poissons_ratio(nu: float, against_locking: bool | None, name: str) -> None:
    assert automatic_element(nu, against_locking).name == name


@pytest.mark.parametrize("formulation", ["p2", "p2p0", "mixed"])
def test_elements_with_curved_edges_pass_the_patch_test(formulation: str) -> None:
    """An affine displacement of a body with round walls has the same strain at all stress points, and its volume."""
    design = SemicircularSingle(length=12)
    space = Discretisation.of(design.body(5).mesh, formulation)
    assert space.inverse.shape[1] == space.weight.shape[1] > 1
    assert space.volume.sum() == pytest.approx(design.solid_volume / 2, rel=1e-4)
    gradient = np.array([[0.2, 0.1, 0.0], [-0.1, 0.3, 0.05], [0.0, 0.2, -0.1]])
    strain, jacobian = space.strain_of(space.points @ gradient.T)
    uniform = (gradient + gradient.T + gradient.T @ gradient) / 2
    for v, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]):
        np.testing.assert_allclose(strain[..., v], uniform[i, j] * (1 if v < 3 else 2), atol=1e-12)
    np.testing.assert_allclose(jacobian, np.linalg.det(np.eye(3) + gradient), rtol=1e-12)


def test_a_uniform_stress_has_no_force_inside_curved_elements() -> None:
    """The internal forces of one stress at all points are those of its tractions on the surface."""
    mesh = SemicircularSingle(length=12).body(5).mesh
    space = Discretisation.of(mesh, "p2")
    stress = np.broadcast_to([1.0, 2.0, 3.0, 0.4, 0.5, 0.6], (*space.weight.shape, 6)).copy()
    force = np.zeros_like(space.points)
    internal_force(space.arrays, np.zeros_like(force), stress, force)
    inner = np.setdiff1d(
        np.arange(len(space.points)), np.concatenate([f.unique_nodes for f in space.surfaces.values()])
    )
    # the rule of p2 is exact for straight elements; with curved ones a part of third order remains
    assert np.abs(force[inner]).max() < 2e-3 * np.abs(force).max()
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-10)
