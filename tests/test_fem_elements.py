"""The table of elements against scikit-fem, and the default element for each Poisson ratio."""

import numpy as np
import pytest
import skfem
from bodies import box

from fem.discretisation import Discretisation
from fem.elements import ELEMENTS, Element, Volumetric, automatic_element, element_of


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


def test_an_unknown_element_is_refused() -> None:
    with pytest.raises(ValueError, match="formulation 'p3': allowed are p2p0, p2, mixed, p1"):
        element_of("p3")


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
