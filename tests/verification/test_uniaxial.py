"""Uniaxial tension and compression of every law against its closed form.

St. Venant-Kirchhoff: the lateral stretch follows from S22 = 0, 2 E22 = -2 nu E11, so t^2 = 1 - nu (s^2 - 1), and
P = E s (s^2 - 1) / 2. Hencky: ln t = -nu ln s, P = E ln(s) / s. Rubber, nearly
incompressible: P = 2 (s - 1/s^2) (w' + c / s) with w' at I1 = s^2 + 2/s (R. S. Rivlin, D. W. Saunders, Phil. Trans. R.
Soc. A 243 (1951) 251).
"""

import numpy as np
import pytest

import fem
from fem.elements import ELEMENTS
from tests.bodies import box

LENGTH, SIDE = 2.0, 1.0
BULK = 1e3


def pulled(law: fem.Material, stretch: float, formulation: str) -> tuple[fem.Step, float, float]:
    """The bar, its nominal stress in MPa and its lateral stretch."""
    mesh = box((2, 1, 1), (LENGTH, SIDE, SIDE))
    pull = fem.Prescribed("right", "x", (stretch - 1) * LENGTH)
    model = fem.Model(
        mesh, law, [fem.Fixed("left", "x"), fem.Fixed("bottom", "y"), fem.Fixed("back", "z"), pull], [], formulation
    )
    step = fem.follow(model, [0.5, 1.0], fem.PathOptions(fem.NewtonOptions(tolerance=1e-9))).steps[-1]
    top = step.displacement[step.space.surface("top").unique_nodes, 1]
    assert np.ptp(top) < 1e-8
    return step, float(step.reaction("right")[0]) / SIDE**2, 1 + float(top.mean()) / SIDE


@pytest.mark.parametrize("formulation", ELEMENTS)
@pytest.mark.parametrize(
    ("stretch", "stress", "lateral"), [(1.2, 0.2640, 0.884421), (0.8, -0.1440, 1.085449), (1.0, 0.0, 1.0)]
)
def test_saint_venant_kirchhoff(formulation: str, stretch: float, stress: float, lateral: float) -> None:
    step, nominal, across = pulled(fem.StVenantKirchhoff(E=1.2, nu=0.495), stretch, formulation)
    assert nominal / 1.2 == pytest.approx(stretch * (stretch**2 - 1) / 2, abs=1e-8)
    assert nominal / 1.2 == pytest.approx(stress, abs=1e-8)
    assert across == pytest.approx(lateral, abs=1e-6)
    assert step.min_J == pytest.approx(stretch * (1 - 0.495 * (stretch**2 - 1)), abs=1e-8)


@pytest.mark.parametrize("formulation", ELEMENTS)
@pytest.mark.parametrize("stretch", [0.6, 1.5, 2.5])
def test_hencky(formulation: str, stretch: float) -> None:
    _, nominal, across = pulled(fem.Hencky(E=1.2, nu=0.4), stretch, formulation)
    assert nominal == pytest.approx(1.2 * np.log(stretch) / stretch, rel=1e-8)
    assert across == pytest.approx(stretch**-0.4, rel=1e-8)


@pytest.mark.parametrize("formulation", ELEMENTS)
@pytest.mark.parametrize("stretch", [0.6, 1.5, 2.5])
@pytest.mark.parametrize(
    ("law", "slope", "second"),
    [
        (fem.NeoHooke(0.4, BULK), lambda x: 0.2, 0.0),
        (fem.MooneyRivlin(0.15, 0.05, BULK), lambda x: 0.15, 0.05),
        (fem.Yeoh(0.11, 0.02, 0.001, BULK), lambda x: 0.11 + 0.04 * x + 0.003 * x**2, 0.0),
        (fem.Ogden((0.3, -0.1), (2.0, -2.0), BULK), lambda x: 0.15, 0.05),
    ],
    ids=["neo-Hooke", "Mooney-Rivlin", "Yeoh", "Ogden"],
)
def test_rubber(formulation: str, stretch: float, law: fem.Material, slope, second: float) -> None:
    _, nominal, across = pulled(law, stretch, formulation)
    invariant = stretch**2 + 2 / stretch - 3
    expected = 2 * (stretch - stretch**-2) * (slope(invariant) + second / stretch)
    assert nominal == pytest.approx(expected, rel=5e-3)  # of the order of stress over bulk modulus
    assert across == pytest.approx(stretch**-0.5, rel=1e-3)


@pytest.mark.parametrize("formulation", ELEMENTS)
@pytest.mark.parametrize("stretch", [0.7, 1.5])
@pytest.mark.parametrize(
    "law",
    [
        fem.NeoHooke(0.4, 4.0),
        fem.MooneyRivlin(0.15, 0.05, 4.0),
        fem.Yeoh(0.11, 0.02, 0.001, 4.0),
        fem.Ogden((0.3, 0.02, -0.01), (1.3, 5.0, -2.0), 4.0),
    ],
    ids=lambda law: type(law).__name__,
)
def test_compressible_rubber(formulation: str, stretch: float, law: fem.Material) -> None:
    """The closed form with the volume change in it (`Material.uniaxial`), at a tenth of the usual bulk modulus."""
    _, nominal, across = pulled(law, stretch, formulation)
    bar = law.uniaxial(np.array([stretch]))
    assert abs(bar.stretch[0] * bar.lateral[0] ** 2 - 1) > 0.01
    assert nominal == pytest.approx(bar.nominal[0], rel=1e-8)
    assert across == pytest.approx(bar.lateral[0], rel=1e-8)


@pytest.mark.parametrize("formulation", ELEMENTS)
def test_rigid_rotation_strains_nothing(formulation: str) -> None:
    """A third of a turn about a skew axis."""
    mesh = box((2, 1, 1), (LENGTH, SIDE, SIDE))
    axis = np.array([1.0, 2.0, -1.0]) / np.sqrt(6)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + np.sin(2.1) * cross + (1 - np.cos(2.1)) * cross @ cross
    for law in (
        fem.StVenantKirchhoff(1.2, 0.495),
        fem.Hencky(1.2, 0.495),
        fem.NeoHooke(0.4, 40.0),
        fem.Yeoh(0.11, 0.02, 0.0, 40.0),
    ):
        system = fem.Model(mesh, law, [], [], formulation).system()
        points = system.space.points
        state = system.state_at(points @ turn.T + [3.0, -1.0, 2.0] - points, 1.0)
        assert np.abs(state.stress).max() < 1e-11
        assert system.energy(state.displacement, 1.0, ()) == pytest.approx(0.0, abs=1e-12)
