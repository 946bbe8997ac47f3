"""Hoops: where they run and what they resist, and their derivatives against finite differences."""

import numpy as np
import pytest

import fem
from fem.discretisation import Discretisation
from fem.effects.hoops import Hoops, faces_along
from fem.effects.membrane import LayerTerm
from geometry import Mesh
from geometry.arrays import Array
from tests.fem.test_membrane import HEIGHT, LENGTH, SOFT, WIDTH, check_derivatives, strip
from tests.verification.wound_tube import tube

LAW = fem.StVenantKirchhoff(E=SOFT, nu=0.3)


def wound(mesh: Mesh, angle: float, formulation: str) -> tuple[LayerTerm, Array]:
    """Hoops on all faces of the tube, and the positions of its nodes."""
    space = Discretisation.of(mesh, formulation)
    triangles = faces_along(mesh.points, np.concatenate([mesh.faces["inside"], mesh.faces["outside"]]))
    return Hoops(triangles, 0.1, 50.0, angle).bind(space, LAW), space.points


@pytest.fixture(scope="module", params=[("p2p0", 0.0), ("p2p0", 0.6), ("p1", 0.3)])
def bound(request: pytest.FixtureRequest) -> tuple[LayerTerm, Array]:
    """Hoops on curved faces, and positions in which they are bent and stretched."""
    formulation, angle = request.param
    term, x = wound(tube(2.0, 3.0, 1.0, (1, 3, 1)), angle, formulation)
    return term, x + np.random.default_rng(1).normal(scale=0.1, size=x.shape)


def test_force_and_tangent_are_the_derivatives_of_the_energy(bound: tuple[LayerTerm, Array]) -> None:
    check_derivatives(*bound)


@pytest.mark.parametrize("degrees", [0.0, 30.0])
def test_a_tube_that_is_wider_or_longer(degrees: float) -> None:
    """t/2 E e^2 per area with the strain e = e_x sin^2 + e_around cos^2 along the threads; loops resist no length."""
    term, x = wound(tube(2.0, 3.0, 1.0, (1, 8, 1)), np.radians(degrees), "p2p0")
    sine, cosine = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    area = np.pi / 2 * (2.0 + 3.0)
    for longer, wider in ((1.1, 1.0), (1.0, 1.1), (1.2, 0.9)):
        strain = (longer**2 - 1) / 2 * sine**2 + (wider**2 - 1) / 2 * cosine**2
        energy = term.energy(x * [longer, wider, wider], 1.0)
        stretches = term.sheet.stretches(term.stress(x * [longer, wider, wider]))
        assert stretches == pytest.approx(np.sqrt(1.0 + 2.0 * strain), rel=1e-3)
        assert energy == pytest.approx(area * 0.1 * 50.0 / 2 * strain**2, rel=2e-3, abs=1e-8)


def test_hoops_run_on_faces_along_the_arm_alone() -> None:
    mesh = strip((2, 1, 1))
    along = faces_along(mesh.points, mesh.boundary)
    across = np.abs(np.ptp(mesh.points[mesh.boundary][..., 0], axis=1)) < 1e-9
    assert len(along) == np.count_nonzero(~across)
    term = Hoops(along, 0.1, 50.0).bind(Discretisation.of(mesh, "p2"), LAW)
    assert term.arrays.weight.sum() == pytest.approx(0.1 * 2 * LENGTH * (HEIGHT + WIDTH))
