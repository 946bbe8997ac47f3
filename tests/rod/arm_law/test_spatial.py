"""The rod in space against closed forms, against the planar rod, and against itself turned."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from geometry.arrays import Array
from rod import Load, Rod, RodSolution, SpatialSolution, Support
from rod.along import triple
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.law_rod import LawRod
from rod.arm_law.tabulated import TabulatedSection
from rod.frames import rotation
from rod.mechanics.unloaded import arc_compliance
from rod.weight import Mass
from tests.quotients import SOLVED, quotient

LENGTH = 100.0
B, GJ = 1500.0, 350.0
RIGID = 1e8


def straight(**given: float) -> LawRod:
    """A rod of that law."""
    return law_of_straight(**given).at(10.0)


def law_of_straight(
    *,
    kappa_0: float = 0.0,
    planar: float = RIGID,
    lateral: float = B,
    torsional: float = GJ,
    shear: float = RIGID,
    height: float = 0.0,
    edge: float = 0.0,
    axial: float = RIGID,
    in_plane_shear: float = RIGID,
    slope: float = 0.0,
    clamp: float = 0.0,
    position: float = 0.0,
) -> ArmLaw:
    """Of an arm whose rigidities are the same at all moments, or grow as 1 + slope M."""
    moment = np.linspace(-500.0, 500.0, 9)

    def full(value: float) -> Array:
        return np.full(len(moment), float(value))

    cell = CellCurve(
        pressure=10.0,
        moment=moment,
        kappa=kappa_0 + moment / planar,
        rigidity=full(planar),
        moment_by_pressure=full(0.0),
        stretch=full(1.0),
        stretch_by_kappa=full(0.0),
        stretch_by_pressure=full(0.0),
        axial_rigidity=full(axial),
        shear_rigidity=full(in_plane_shear),
        contact=np.zeros(len(moment), bool),
        min_J=full(1.0),
        s=np.array([0.0, 5.0]),
        ripple=np.zeros((len(moment), 2, 2)),
        lateral_rigidity=lateral * (1.0 + slope * moment),
        torsional_rigidity=torsional * (1.0 + slope * moment),
        lateral_shear_rigidity=full(shear),
        twist_axis=full(height),
        tilt_by_torque=full(0.0),
    )
    turns = np.array([[-1.0, 1.0]]).T * clamp * 500.0
    clamped = ClampCurve(
        pressure=10.0,
        moment=moment[[0, -1]],
        rotation=turns[:, 0],
        rotation_by_moment=np.full(2, clamp),
        rotation_by_pressure=np.zeros(2),
        offset=np.column_stack([np.zeros(2), -position * turns[:, 0]]),
        offset_by_moment=np.tile([0.0, -position * clamp], (2, 1)),
        s=np.array([0.0, 5.0]),
        beside=np.zeros((2, 2, 2)),
        lateral_compliance=clamp * np.eye(2),
    )
    tip = TipCurve(
        pressure=10.0,
        s=np.array([-1.0, 0.0]),
        beside=np.zeros((2, 2)),
        edge=np.array([0.0, edge]),
        couple=np.zeros(4),
        acts_at=np.zeros((4, 2)),
        beside_held=np.zeros((4, 2, 2)),
        beside_pinned=np.zeros((2, 2)),
        pinned_by_pull=np.zeros((2, 2)),
    )
    mass = Mass.even(LENGTH, 20.0, 3.0)
    return ArmLaw(10.0, 5.0, LENGTH, (cell,), (clamped,), (tip,), mass)


@pytest.mark.parametrize(
    ("number", "lift", "shortening"),
    [(1.0, 0.3017208, 0.0564332), (5.0, 0.7137915, 0.3876284), (10.0, 0.8106090, 0.5549956)],
)
def test_a_force_across_the_plane_makes_the_elastica(number: float, lift: float, shortening: float) -> None:
    """K. E. Bisshopp and D. C. Drucker, Quart. Appl. Math. 3 (1945), with numbers of the closed form."""
    found = straight(planar=300.0, lateral=160.0).solve_in_space(Load((0.0, 0.0, number * 160.0 / LENGTH**2)))
    assert found.end[2] / LENGTH == pytest.approx(lift, abs=2e-7)
    assert 1.0 - found.end[0] / LENGTH == pytest.approx(shortening, abs=2e-7)


def test_a_round_bar_bends_alike_in_all_directions() -> None:
    rod = straight(kappa_0=0.0, planar=300.0, lateral=300.0, torsional=200.0)
    turn = rotation(np.array([0.7, 0.0, 0.0]))
    in_plane, about = np.array([-0.02, 0.1, 0.0]), np.array([10.0, 0.0, 8.0])
    first = rod.solve_in_space(Load(triple(in_plane, "force"), triple(about, "couple")))
    second = rod.solve_in_space(Load(triple(turn @ in_plane, "force"), triple(turn @ about, "couple")))
    np.testing.assert_allclose(second.end, turn @ first.end, atol=1e-6)
    assert second.stability.lowest == pytest.approx(first.stability.lowest, abs=1e-6)


@pytest.mark.parametrize(
    "loads", [Load((0.01, 0.05), couple=2.0), Load((-0.005, -0.04)), Load(weight=(2e-4, -3e-4), weight_height=3.0)]
)
def test_in_the_plane_it_is_the_planar_rod(loads: Load) -> None:
    rod = straight(kappa_0=-0.01, planar=160.0, axial=50.0, in_plane_shear=20.0, edge=2.0, clamp=1e-3, position=3.0)
    planar = rod.under(loads)
    _is_planar(rod.solve_in_space(loads), planar)


@pytest.mark.parametrize("held", [(None, -20.0), (75.0, -45.0)])
def test_with_a_held_end_in_the_plane_it_is_the_planar_rod(held: tuple[float | None, float]) -> None:
    rod = straight(kappa_0=-0.01, planar=160.0, axial=50.0, in_plane_shear=20.0)
    load = Load(supports=(Support(LENGTH, *held),))
    _is_planar(rod.solve_in_space(load), rod.under(Load(), held[1], held[0]))


def _is_planar(found: SpatialSolution, planar: RodSolution) -> None:
    assert np.abs(found.curve[:, :2] - planar.curve).max() < 1e-12 * LENGTH
    assert np.abs(found.moment[:, 2] - planar.moment).max() < 1e-10
    assert np.abs(found.force[:2] - planar.force).max() < 1e-10
    assert np.abs(found.curve[:, 2]).max() == 0.0


@pytest.mark.parametrize("position", [0.0, 0.1, 3.0, 5.0])
def test_the_clamp_turns_by_the_moment_at_its_position(position: float) -> None:
    rod, force, soft = straight(planar=160.0, clamp=1e-3, position=position), 1e-5, 1e-3
    expected = force * (LENGTH**3 / (3.0 * 160.0) + soft * (LENGTH - position) ** 2)
    assert rod.under(Load((0.0, force))).end[1] == pytest.approx(expected, rel=1e-6)
    assert rod.solve_in_space(Load((0.0, force, 0.0))).end[1] == pytest.approx(expected, rel=1e-6)


def test_an_end_is_pulled_back_by_the_force_that_moved_it() -> None:
    rod = Rod(LENGTH, law=straight(kappa_0=-0.01, planar=160.0, height=1.0))
    moved = rod.solve(force=(0.002, 0.01, 0.03))
    held = rod.solve(end=moved.end)
    # both are limits of two chains of elements, whose errors of the fourth order differ
    np.testing.assert_allclose(held.force, moved.force, atol=1e-7)
    np.testing.assert_allclose(held.curve, moved.curve, atol=1e-5)
    across = rod.solve(end=(None, None, moved.end[2]))
    assert across.force[2] > 0.0
    assert across.force[:2] == pytest.approx(0.0)


def test_a_force_beside_the_axis_of_twist() -> None:
    force, edge, height, shear = 1e-4, 2.0, 0.5, 12.0
    found = straight(height=height, edge=edge, shear=shear).solve_in_space(Load((0.0, 0.0, force)))
    turn = (edge - height) * LENGTH / GJ
    assert found.frames[-1, 2, 1] / force == pytest.approx(turn, rel=1e-5)
    axis = LENGTH**3 / (3.0 * B) + LENGTH / shear - height * turn
    assert found.axis[-1, 2] / force == pytest.approx(axis, rel=1e-5)


def test_a_quarter_circle_under_a_force_across_its_plane() -> None:
    radius = 2.0 * LENGTH / np.pi
    found = straight(kappa_0=-1.0 / radius).solve_in_space(Load((0.0, 0.0, 1e-5)))
    exact = radius**3 * (np.pi / 4 / B + (3 * np.pi / 4 - 2) / GJ)
    assert found.end[2] / 1e-5 == pytest.approx(exact, rel=1e-4)
    given = {"lateral_rigidity": B, "torsional_rigidity": GJ, "lateral_shear_rigidity": RIGID, "twist_axis": 0.0}
    linear = arc_compliance(LENGTH, -1.0 / radius, 1.0, given, 101)
    assert linear[5, 5] == pytest.approx(exact, rel=1e-6)
    across = linear[np.ix_([0, 1, 5], [0, 1, 5])]
    np.testing.assert_allclose(across, across.T, atol=1e-9 * np.abs(across).max())


def test_a_couple_about_the_axis_turns_the_end() -> None:
    found = straight().solve_in_space(Load(couple=(7.0, 0.0, 0.0)))
    turn = 7.0 * LENGTH / GJ
    assert math.atan2(found.frames[-1, 2, 1], found.frames[-1, 1, 1]) == pytest.approx(turn, rel=1e-9)


def test_rigidities_that_depend_on_the_moment_make_a_potential() -> None:
    """The work of a force along a closed path of loads is zero: the compliance of the end is symmetric."""
    rod = straight(planar=200.0, kappa_0=-0.008, height=1.5, edge=2.0, slope=1.5e-3, clamp=1e-3, position=3.0)
    force, step = np.array([0.003, 0.02, 0.04]), 1e-4

    def end(acting: Array) -> Array:
        # of the point in which the force acts: 2 mm above the axis
        found = rod.solve_in_space(Load(triple(acting, "force")))
        return np.asarray(found.axis[-1] + 2.0 * found.frames[-1, :, 1])

    more, less = ([end(force + sign * step * one) for one in np.eye(3)] for sign in (1.0, -1.0))
    compliance = quotient(more, less, 2.0 * step, SOLVED)
    assert compliance.within(abs=2e-5 * float(np.abs(compliance.value).max())) == compliance.value.T


def test_a_pair_beside_three_components_acts_in_the_plane() -> None:
    rod = Rod(LENGTH, law=straight(planar=200.0))
    couple = (3.0, 0.0, 0.0)
    assert rod.solve(force=(0.0, 0.01), moment=couple).end == rod.solve(force=(0.0, 0.01, 0.0), moment=couple).end


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_deep_beam_buckles_sideways_at_the_force_of_timoshenko(sign: float) -> None:
    """S. P. Timoshenko and J. M. Gere, "Theory of Elastic Stability", 6.3: F = 4.013 sqrt(B GJ) / l^2."""
    rod = straight()
    critical = sign * 4.013 * np.sqrt(B * GJ) / LENGTH**2
    below, above = (rod.stability(rod.under(Load((0.0, part * critical)))) for part in (0.9995, 1.0005))
    assert below.is_stable
    assert not above.is_stable
    assert np.abs(above.motion[:, 2]).max() == 1.0
    assert rod.buckling_part(Load((0.0, 1.25 * critical))) == pytest.approx(0.8, abs=2e-3)
    assert rod.buckling_part(Load((0.0, 0.9 * critical))) is None


def test_a_column_buckles_across_its_plane_at_the_force_of_euler() -> None:
    rod = straight(lateral=100.0, torsional=1e4)
    critical = np.pi**2 * 100.0 / (2.0 * LENGTH) ** 2
    for part in (0.5, 0.99, 1.01):
        assert rod.stability(rod.under(Load((-part * critical, 0.0)))).lowest == pytest.approx(1.0 - part, abs=1e-5)
    (told,) = rod.solve_in_space(Load((-1.5 * critical, 0.0, 0.0))).notes
    assert re.search(r"buckles out of its plane at 66\.[67] %", told)
    bent = rod.solve_in_space(Load((-1.1 * critical, 0.0, 1e-3 * critical)))
    assert bent.end[2] > 40.0
    assert bent.stability.is_stable


def test_weight_across_the_plane_is_that_of_its_mass_and_acts_above_the_axis() -> None:
    rod = Rod(LENGTH, law=straight())
    found = rod.solve(force=(0.0, 0.0, 0.0), direction=(0.0, 0.0, -1.0))
    assert found.weight == pytest.approx([0.0, 0.0, -20.0 * 9.81e-3], rel=1e-9)
    # the mass lies 3 mm above the axis
    assert found.frames[-1, 2, 1] == pytest.approx(-found.weight[2] * -3.0 * LENGTH / 2.0 / GJ, rel=0.1)
    with_payload = rod.solve(force=(0.0, 0.0, 0.0), direction=(0.0, 0.0, -1.0), weight=False, tip_mass="0.2 g")
    assert with_payload.end[2] == pytest.approx(-0.2 * 9.81e-3 * LENGTH**3 / (3.0 * B), rel=1e-3)


def test_strains_do_not_jump_where_states_of_the_law_join() -> None:
    """Rigidities out of the plane that follow straight lines would bend the rod in steps."""
    arm = law_of_straight(planar=200.0)
    kinked = np.where(arm.cells[0].moment < 0.0, B, B + 2.0 * arm.cells[0].moment)
    section = replace(arm, cells=(replace(arm.cells[0], lateral_rigidity=kinked),)).at(10.0).section
    moment = np.linspace(-0.5, 0.5, 1001) * (section.moment[1] - section.moment[0])
    acting = np.column_stack([np.zeros(1001), np.full(1001, 50.0), moment])
    curvature, _, _ = TabulatedSection(section, LENGTH).strains(acting, np.zeros((1001, 3)))
    steps = np.abs(np.diff(curvature[:, 2]))
    assert steps.max() < 3.0 * steps.mean()
