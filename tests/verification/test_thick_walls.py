"""Thick-walled cylinder (plane strain) and sphere under internal follower pressure; radii 1 and 2.

St. Venant-Kirchhoff, E = 1.2: displacements of the inner and outer wall from the radial equilibrium
d(P_r)/dR + k (P_r - P_t) / R = 0 (k = 1, 2), solved as a boundary-value problem to nine digits. Incompressible
neo-Hooke, mu = 1: an integral over the hoop stretch, A. E. Green, W. Zerna, "Theoretical elasticity", 2nd ed. 1968.
The meshes have straight edges, so the error is of second order in their size, whatever the elements.
"""

import numpy as np
import pytest
from scipy.integrate import quad

import fem
from fem.discretisation import Discretisation
from geometry import Mesh
from geometry.arrays import Array
from tests.bodies import QUADRATIC, box


def cylinder(n: int) -> Mesh:
    """A quarter of the tube, n layers through the wall; faces of `box`: left is the inner wall, right the outer one."""
    mesh = box((n, 2 * n, 1), (1.0, 1.0, 1.0 / n))
    radius, angle = 1.0 + mesh.points[:, 0], 0.5 * np.pi * mesh.points[:, 1]
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), mesh.points[:, 2]])
    return Mesh(points, mesh.tets, dict(mesh.faces))


def sphere(n: int) -> Mesh:
    """An eighth of the ball: an octahedron's face in triangles, blown up; n layers of three tetrahedra per prism."""
    m = 2 * n
    corner = [(i, j, m - i - j) for i in range(m + 1) for j in range(m + 1 - i)]
    number = {key: k for k, key in enumerate(corner)}
    triangles = []
    for i, j, k in corner:
        if k > 0:
            triangles.append([(i, j, k), (i + 1, j, k - 1), (i, j + 1, k - 1)])
        if k > 1:
            triangles.append([(i + 1, j, k - 1), (i + 1, j + 1, k - 2), (i, j + 1, k - 1)])
    flat = np.array([sorted(number[key] for key in triangle) for triangle in triangles])
    ray = np.array(corner, dtype=float)
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    radii = np.linspace(1.0, 2.0, n + 1)
    points = (radii[:, None, None] * ray).reshape(-1, 3)
    a, b, c = (flat + len(corner) * np.arange(n)[:, None, None]).reshape(-1, 3).T
    up = len(corner)
    tets = np.concatenate(
        [np.column_stack(t) for t in ((a, b, c, c + up), (a, b, b + up, c + up), (a, a + up, b + up, c + up))]
    )
    mesh = Mesh(points, tets, {})
    corners = mesh.points[mesh.boundary]
    distance = np.linalg.norm(corners, axis=2)
    faces = {"left": np.isclose(distance, 1.0).all(axis=1), "right": np.isclose(distance, 2.0).all(axis=1)}
    faces |= {name: (np.abs(corners[..., axis]) < 1e-9).all(axis=1) for axis, name in enumerate("xyz")}
    return Mesh(mesh.points, mesh.tets, {name: mesh.boundary[marked] for name, marked in faces.items()})


CYLINDER = [fem.Fixed("bottom", "y"), fem.Fixed("top", "x"), fem.Fixed("back", "z"), fem.Fixed("front", "z")]
SPHERE = [fem.Fixed(name, name) for name in "xyz"]
BODIES = {"cylinder": (cylinder, CYLINDER), "sphere": (sphere, SPHERE)}


def inflate(body: str, n: int, law: fem.Material, pressure: float, formulation: str) -> tuple[fem.Step, float, float]:
    """The body and the mean radial displacements of its inner and outer wall, over the vertices."""
    make, supports = BODIES[body]
    mesh = make(n)
    model = fem.Model(mesh, law, supports, [fem.Pressure("left", pressure)], formulation)
    step = fem.follow(model, [1.0], fem.PathOptions(fem.NewtonOptions(tolerance=1e-9))).steps[0]
    plane = 2 if body == "cylinder" else 3
    walls = []
    for name in ("left", "right"):
        vertices = np.unique(mesh.faces[name])
        ray = mesh.points[vertices, :plane] / np.linalg.norm(mesh.points[vertices, :plane], axis=1, keepdims=True)
        walls.append(float(np.mean(np.sum(ray * step.displacement[vertices, :plane], axis=1))))
    return step, walls[0], walls[1]


@pytest.mark.parametrize("formulation", QUADRATIC)
@pytest.mark.parametrize(
    ("body", "nu", "pressure", "inner", "outer"),
    [
        ("cylinder", 0.3, 0.05, 0.082429672, 0.050885162),
        ("cylinder", 0.495, 0.1, 0.190058385, 0.088496034),
        ("sphere", 0.3, 0.1, 0.080249477, 0.027702589),
        ("sphere", 0.495, 0.1, 0.090162946, 0.020942116),
    ],
)
def test_walls_move_as_radial_equilibrium_says(
    body: str, nu: float, pressure: float, inner: float, outer: float, formulation: str
) -> None:
    sizes = (2, 4) if body == "sphere" else (2, 4, 8)
    errors = []
    for n in sizes:
        step, near, far = inflate(body, n, fem.StVenantKirchhoff(1.2, nu), pressure, formulation)
        assert step.factorizations <= 12
        errors.append((abs(near / inner - 1), abs(far / outer - 1)))
    rates = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    # measured: cylinder 1.1 to 1.6e-3 (p2 at nu = 0.495: 3.0e-3), rates 2.0 to 2.3; sphere 1.9 to 2.7e-2 (4.2e-2)
    assert rates[-1].min() > {"cylinder": 1.9, "sphere": 1.6}[body]
    assert max(errors[-1]) < {"cylinder": 0.0035, "sphere": 0.045}[body]


def rubber_sphere(stretch: float) -> float:
    """Pressure in MPa at a stretch of the inner wall: integral of 2 mu (s^2 - s^-4) / (s^4 - s) ds over the hoop
    stretch s from the outer to the inner wall."""
    outer = (1 + (stretch**3 - 1) / 8) ** (1 / 3)
    return float(quad(lambda s: 2 * (s**2 - s**-4) / (s**4 - s), outer, stretch)[0])


@pytest.mark.parametrize(("stretch", "pressure"), [(1.1, 0.28715485), (1.5, 0.75543312), (2.0, 0.80692660)])
def test_the_closed_form_of_the_rubber_sphere(stretch: float, pressure: float) -> None:
    assert rubber_sphere(stretch) == pytest.approx(pressure, abs=1e-8)


@pytest.mark.parametrize(("stretch", "pressure"), [(1.1, 0.28715485), (1.5, 0.75543312)])
def test_incompressible_rubber_sphere(stretch: float, pressure: float) -> None:
    """p2p0; bulk modulus a thousand times the shear modulus."""
    errors = []
    for n in (2, 4):
        _, near, _ = inflate("sphere", n, fem.NeoHooke(1.0, 1000.0), pressure, "p2p0")
        errors.append(abs((1 + near) / stretch - 1))
    assert errors[1] < 0.01  # measured: 1.9e-3 and 7.6e-3
    assert errors[1] < 0.35 * errors[0]


def ogden_sphere(law: fem.Ogden, stretch: float) -> float:
    """The same for Ogden's law: integral of dW/ds / (s^3 - 1), W of equibiaxial tension."""
    outer = (1 + (stretch**3 - 1) / 8) ** (1 / 3)
    slope = lambda s: sum(2 * mu * (s ** (a - 1) - s ** (-2 * a - 1)) for mu, a in law.terms)  # noqa: E731
    return float(quad(lambda s: slope(s) / (s**3 - 1), outer, stretch)[0])


@pytest.mark.parametrize("stretch", [1.1, 1.5])
def test_incompressible_sphere_of_ogden(stretch: float) -> None:
    """p2p0; three terms with the shear modulus 0.42 MPa, bulk modulus a thousand times that."""
    law = fem.Ogden((0.63, 0.0012, -0.01), (1.3, 5.0, -2.0), 420.0)
    assert ogden_sphere(fem.Ogden((1.0,), (2.0,), 1.0), 1.5) == pytest.approx(rubber_sphere(1.5), rel=1e-9)
    errors = []
    for n in (2, 4):
        _, near, _ = inflate("sphere", n, law, ogden_sphere(law, stretch), "p2p0")
        errors.append(abs((1 + near) / stretch - 1))
    assert errors[1] < 0.01  # measured: 1.9e-3 and 7.6e-3
    assert errors[1] < 0.35 * errors[0]


STRETCHES = np.linspace(1.1, 2.0, 10)


def held_open(n: int, formulation: str) -> Array:
    """Pressure (10,) in MPa of the sphere whose inner wall is held at `STRETCHES`, bulk modulus 1000.

    With u = (s - 1) X on the wall the elastic energy grows by R . X ds (R the reactions) and the cavity by 3 s^2 V ds,
    so their quotient is the pressure.
    """
    mesh = sphere(n)
    space = Discretisation.of(mesh, formulation)
    wall = space.surface("left").unique_nodes
    push = [
        fem.Prescribed(space.points[node], "xyz"[axis], space.points[node, axis]) for node in wall for axis in range(3)
    ]
    model = fem.Model(mesh, fem.NeoHooke(1.0, 1000.0), [*SPHERE, *push], [], formulation)
    steps = fem.follow(model, list(STRETCHES - 1), fem.PathOptions(fem.NewtonOptions(tolerance=1e-9))).steps
    assert sum(step.cutbacks for step in steps) == 0
    work = np.array([np.vdot(step.gradient[wall], step.points[wall]) for step in steps])
    at_rest = -mesh.points[mesh.faces["left"]]
    volume = np.linalg.det(at_rest).sum() / 6
    return np.asarray(work / (3 * STRETCHES**2 * volume))


@pytest.mark.parametrize("formulation", QUADRATIC)
def test_rubber_sphere_past_its_largest_pressure(formulation: str) -> None:
    """The pressure is largest at a stretch of 1.8; beyond, only the wall can be prescribed, not the pressure."""
    closed = np.array([rubber_sphere(stretch) for stretch in STRETCHES])
    coarse, fine = (held_open(n, formulation) for n in (2, 3))
    off = np.abs(fine / closed - 1)
    # measured: mixed 0.4 % at 1.1, 0.3 % at 2.0; p2p0 0.8 and 0.6 %; p2 locks, 4.8 and 0.5 %
    assert off.max() < {"p2": 0.055}.get(formulation, 0.01)
    assert off[-1] < 0.007
    assert (off < 0.5 * np.abs(coarse / closed - 1)).all()  # second order would be 0.44
    assert np.argmax(fine) == np.argmax(closed) == 7
