"""Motions of a rod out of its plane against those of beams."""

import numpy as np
import pytest

from rod.arm_law.sideways import PlanarRod, SidewaysResponse, arc, sideways, twisting_compliance

LENGTH = 100.0
GIVEN = {"lateral_rigidity": 1500.0, "torsional_rigidity": 350.0, "lateral_shear_rigidity": 12.0, "twist_axis": 0.5}
B, GJ, GA, AXIS = GIVEN.values()
RIGID = np.zeros((2, 2))


def test_a_straight_beam_under_a_force_beside_its_axis_of_twist() -> None:
    rod, lever = arc(LENGTH, 0.0, 1.0, GIVEN, 401), 2.0
    found = sideways(rod, RIGID, 0.0, np.array([0.0, lever]))
    bent = LENGTH**3 / (3 * B) + LENGTH / GA
    assert found.end_lift == pytest.approx(bent + (lever - AXIS) ** 2 * LENGTH / GJ, rel=1e-5)
    assert found.end_turn[0] == pytest.approx((lever - AXIS) * LENGTH / GJ, rel=1e-5)
    assert found.is_stable


def test_a_quarter_circle() -> None:
    radius = 2.0 * LENGTH / np.pi
    given = {**GIVEN, "lateral_shear_rigidity": 1e9, "twist_axis": 0.0}
    found = sideways(arc(LENGTH, -1.0 / radius, 1.0, given, 801), RIGID, 0.0, np.zeros(2))
    assert found.end_lift == pytest.approx(radius**3 * (np.pi / 4 / B + (3 * np.pi / 4 - 2) / GJ), rel=1e-4)


def test_the_compliance_of_an_arc_is_symmetric() -> None:
    found = arc(LENGTH, -0.01, 1.02, GIVEN, 801).compliance()
    assert found == pytest.approx(found.T, rel=1e-4)
    assert found[2, 2] == pytest.approx(
        sideways(arc(LENGTH, -0.01, 1.02, GIVEN, 801), RIGID, 0.0, np.zeros(2)).end_lift
    )


def test_the_clamp_gives_way() -> None:
    rod, clamp = arc(LENGTH, 0.0, 1.0, GIVEN, 101), np.diag([1e-3, 2e-3])
    rigid, soft = (sideways(rod, held, 0.0, np.zeros(2)).end_lift for held in (RIGID, clamp))
    assert soft - rigid == pytest.approx(2e-3 * LENGTH**2)


def loaded(force: float) -> SidewaysResponse:
    """A straight deep beam under a force (N) in its plane on the end."""
    s = np.linspace(0.0, LENGTH, 801)
    along = np.column_stack([np.ones_like(s), np.zeros_like(s)])
    stiff = twisting_compliance(*(np.full_like(s, value) for value in (GJ, 1e9, 0.0)))
    moment, forces = force * (LENGTH - s), np.tile([0.0, force], (len(s), 1))
    rod = PlanarRod(s, np.zeros_like(s), along, moment, forces, np.full_like(s, B), stiff)
    return sideways(rod, RIGID, 0.0, np.zeros(2))


def test_a_force_in_the_plane_beyond_the_end_acts_as_through_a_rigid_part() -> None:
    """A deep beam whose last 20 mm are rigid, beside one of 80 mm with the force 20 mm ahead of its end."""

    def lift(length: float, lever: float) -> float:
        s = np.linspace(0.0, length, 1601)
        stiff = np.where(s > 80.0 + 1e-9, 1e7, 1.0)
        twisting = twisting_compliance(GJ * stiff, np.full_like(s, 1e12), np.zeros_like(s))
        along, force = np.column_stack([np.ones_like(s), np.zeros_like(s)]), 0.1
        moment, forces = force * (100.0 - s), np.tile([0.0, force], (len(s), 1))
        rod = PlanarRod(s, np.zeros_like(s), along, moment, forces, B * stiff, twisting)
        return sideways(rod, RIGID, 0.0, np.array([lever, 0.0])).end_lift

    assert lift(80.0, 20.0) == pytest.approx(lift(100.0, 0.0), rel=2e-3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_deep_beam_buckles_sideways_at_the_force_of_timoshenko(sign: float) -> None:
    """S. P. Timoshenko and J. M. Gere, "Theory of Elastic Stability", 6.3: F = 4.013 sqrt(B GJ) / l^2."""
    critical = 4.013 * np.sqrt(B * GJ) / LENGTH**2
    assert loaded(sign * 0.997 * critical).is_stable
    assert not loaded(sign * 1.003 * critical).is_stable
