"""The patch test: B. M. Irons, "Engineering applications of numerical integration in stiffness methods", AIAA J. 4
(1966) 2035-2037; O. C. Zienkiewicz, R. L. Taylor, "The finite element method", 5th ed. 2000, volume 1, chapter 10.

The surface of a block of irregular tetrahedra is displaced linearly in the position; the interior nodes must have
the same linear displacement, and the strain must be uniform.
"""

import numpy as np
import pytest

from fem import Model, NewtonOptions, PathOptions, Prescribed, element_fields, follow
from fem.discretisation import Discretisation
from fem.elements import ELEMENTS
from geometry import Mesh
from tests.bodies import box
from tests.laws import LAWS

GRADIENT = np.array([[0.15, 0.1, -0.05], [0.0, -0.1, 0.2], [0.05, 0.0, 0.05]])


def irregular() -> Mesh:
    """A cube of 27 bricks of 1 mm whose inner vertices are shifted by up to a fifth of that along each axis."""
    mesh = box((3, 3, 3), (3.0, 3.0, 3.0))
    inner = ((mesh.points > 0.5) & (mesh.points < 2.5)).all(axis=1)
    shift = np.random.default_rng(8).uniform(-0.2, 0.2, size=mesh.points.shape)
    return Mesh(mesh.points + np.where(inner[:, None], shift, 0.0), mesh.tets, dict(mesh.faces))


@pytest.mark.parametrize("formulation", ELEMENTS)
@pytest.mark.parametrize("law", LAWS)
def test_a_linear_displacement_is_exact(law: str, formulation: str) -> None:
    mesh, material = irregular(), LAWS[law]
    space = Discretisation.of(mesh, formulation)
    points, motion = space.points, space.points @ GRADIENT.T
    held = np.unique(np.concatenate([space.surface(name).unique_nodes for name in mesh.faces]))
    assert len(points) - len(held) >= 8
    supports = [Prescribed(points[node], "xyz"[axis], motion[node, axis]) for node in held for axis in range(3)]
    model = Model(mesh, material, supports, [], formulation)
    step = follow(model, [1.0], PathOptions(NewtonOptions(tolerance=1e-11))).steps[0]
    np.testing.assert_allclose(step.displacement, motion, atol=1e-10)
    fields = element_fields(step, material)
    f = np.eye(3) + GRADIENT
    np.testing.assert_allclose(fields["J"], np.linalg.det(f), rtol=1e-10)
    np.testing.assert_allclose(fields["stretch"], np.linalg.svd(f)[1][0], rtol=1e-10)
    stress = fields["cauchy_stress_MPa"]
    np.testing.assert_allclose(stress, np.broadcast_to(stress[0], stress.shape), atol=1e-9)
    assert np.abs(stress[0]).max() > 0.01
