"""The rod with the arm's own law against closed forms, against the five-parameter rod, and at the edges of the law."""

import json
from dataclasses import replace

import numpy as np
import pytest

from pipeline.results.laws import law_of_record, law_record
from rod import FiveParameters, Load, Rod, RodError
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.moved import power_of_modulus
from rod.arm_law.section import section_at
from tests.quotients import SOLVED, quotient
from tests.rod.test_equilibrium import ELASTICA

LENGTH, PITCH = 110.0, 10.0
EI, RIGID = 400.0, 1e12


def straight_law(
    pressure: float,
    kappa_0: float = 0.0,
    *,
    EA: float = RIGID,
    GA: float = RIGID,
    eccentricity: float = 0.0,
    reach: float = 60.0,
) -> tuple[CellCurve, ClampCurve, TipCurve]:
    """A cell with one straight line M = EI (kappa - kappa_0), and ends that are cells too."""
    moment = np.linspace(-reach, reach, 9)
    kappa = kappa_0 + moment / EI
    ones = np.ones(9)
    s, nothing = np.array([0.0, 2.5, 5.0]), np.zeros((9, 3, 2))
    cell = CellCurve(
        pressure=pressure,
        moment=moment,
        kappa=kappa,
        rigidity=EI * ones,
        moment_by_pressure=0 * ones,
        stretch=1.0 + eccentricity * kappa,
        stretch_by_kappa=eccentricity * ones,
        stretch_by_pressure=0 * ones,
        axial_rigidity=EA * ones,
        shear_rigidity=GA * ones,
        contact=np.zeros(9, bool),
        min_J=ones,
        s=s,
        ripple=nothing,
    )
    clamp = ClampCurve(
        pressure,
        moment,
        0 * ones,
        0 * ones,
        0 * ones,
        np.zeros((9, 2)),
        np.zeros((9, 2)),
        np.array([0.0, 10.0]),
        np.zeros((9, 2, 2)),
    )
    nothing = np.zeros((2, 2))
    tip = TipCurve(
        pressure,
        np.array([-10.0, 0.0]),
        nothing,
        np.zeros(2),
        np.zeros(4),
        np.zeros((4, 2)),
        np.zeros((4, 2, 2)),
        nothing,
        nothing,
    )
    return cell, clamp, tip


def law_of(*parts: tuple[CellCurve, ClampCurve, TipCurve]) -> ArmLaw:
    cells, clamps, tips = zip(*parts, strict=True)
    return ArmLaw(PITCH, 5.0, LENGTH, cells, clamps, tips)


@ELASTICA
def test_the_elastica_under_a_dead_force(load: float, deflection: float, shortening: float, angle: float) -> None:
    """K. E. Bisshopp, D. C. Drucker, "Large deflection of cantilever beams", Q. Appl. Math. 3 (1945)."""
    shape = law_of(straight_law(0.0)).at(0.0).solve((0.0, load * EI / LENGTH**2))
    assert shape.y[-1] / LENGTH == pytest.approx(deflection, abs=2e-6)
    assert 1 - shape.x[-1] / LENGTH == pytest.approx(shortening, abs=2e-6)
    assert shape.theta[-1] == pytest.approx(angle, abs=2e-6)


def test_shear_and_axial_force_in_the_small() -> None:
    """Timoshenko beam: F l^3 / 3 EI + F l / GA; axial force: F l / EA."""
    rod = law_of(straight_law(0.0, EA=60.0, GA=12.0)).at(0.0)
    force = 1e-4
    assert rod.solve((0.0, force)).y[-1] / force == pytest.approx(LENGTH**3 / (3 * EI) + LENGTH / 12.0, rel=2e-5)
    assert (rod.solve((force, 0.0)).x[-1] - LENGTH) / force == pytest.approx(LENGTH / 60.0, rel=1e-6)


def test_a_clamp_that_shifts_the_arm_by_a_moment_makes_no_state_unstable() -> None:
    """A shift along an arm whose height is held moves it as a whole; a negative pivot of the clamp passes on."""
    cell, clamp, tip = straight_law(0.0, kappa_0=-0.03, EA=60.0, GA=20.0)
    moment, along = clamp.moment[:, None], np.array([1.0, 0.0])
    turning = replace(clamp, rotation=0.01 * clamp.moment, rotation_by_moment=np.full(9, 0.01))
    shift, by_moment = 0.02 * moment + 0.0025 * moment**2, 0.02 + 0.005 * moment
    shifting = replace(turning, offset=shift * along, offset_by_moment=by_moment * along)
    fixed, moved = (law_of((cell, one, tip)).at(0.0).solve(end_y=0.0) for one in (turning, shifting))
    assert moved.force == pytest.approx(fixed.force, rel=1e-9)
    assert moved.x == pytest.approx(fixed.x + shifting.offset_at(fixed.moment[0])[0], rel=1e-9)


def test_work_over_a_closed_loop_of_forces_vanishes() -> None:
    """The clamped end moves along the arm by a moment, so that a force along the arm turns it (reciprocal theorem)."""
    cell, clamp, tip = straight_law(0.0, kappa_0=0.01)
    ones, along = np.ones(9), np.array([1.0, 0.0])
    clamp = replace(
        clamp,
        rotation=2e-3 * clamp.moment,
        rotation_by_moment=2e-3 * ones,
        offset=0.05 * clamp.moment[:, None] * along,
        offset_by_moment=0.05 * ones[:, None] * along,
    )
    rod = law_of((cell, clamp, tip)).at(0.0)

    def end(force: np.ndarray) -> np.ndarray:
        shape = rod.solve(tuple(force))
        return np.array([shape.x[-1], shape.y[-1]])

    base, size = np.array([0.02, 0.01]), 1e-3
    more, less = ([end(base + sign * size * axis) for axis in np.eye(2)] for sign in (1.0, -1.0))
    compliance = quotient(more, less, 2 * size, SOLVED)
    scale = np.sqrt(compliance.value[0, 0] * compliance.value[1, 1])
    assert compliance.within(abs=2e-3 * scale) == compliance.value.T


def test_it_agrees_with_the_five_parameter_rod() -> None:
    kappa_0 = -0.012
    own = law_of(straight_law(20.0, kappa_0)).at(20.0)
    five = Rod(LENGTH, kappa_0, FiveParameters(EI, EI, 0.0, 0.0, LENGTH / 2))
    for loads in (
        {"end_y": 0.0},
        {"force": (0.0, 0.05)},
        {"force": (0.03, -0.02), "moment": 1.5},
        {"end": (90.0, 10.0)},
    ):
        first, second = own.solve(**loads), five.solve(**loads)
        np.testing.assert_allclose(first.force, second.force, rtol=1e-5, atol=1e-8)
        np.testing.assert_allclose(first.positions(second.s), np.column_stack([second.x, second.y]), atol=1e-4)


def test_a_held_end_of_an_arm_that_curls_by_five_radians_is_reached_as_in_experiment_three() -> None:
    """Curvature without moment and height of the end grow together; from the curled arm another equilibrium follows."""
    kappa_0 = -5.0 / LENGTH
    own = law_of(straight_law(45.0, kappa_0)).at(45.0)
    five = Rod(LENGTH, kappa_0, FiveParameters(EI, EI, 0.0, 0.0, LENGTH / 2))
    for height in (0.0, 20.0, -20.0):
        first, second = own.solve(end_y=height), five.solve(end_y=height)
        np.testing.assert_allclose(first.force, second.force, rtol=1e-5)
        np.testing.assert_allclose(first.positions(second.s), np.column_stack([second.x, second.y]), atol=2e-4)


@pytest.mark.parametrize("force", [(-0.12, 0.004), (-0.2, 0.004), (0.0, 0.3), (0.8, 0.0)])
def test_a_force_leads_to_the_stable_equilibrium(force: tuple[float, float]) -> None:
    """Beyond the buckling load of 0.082 N, and where the arm is bent back: a single step led to unstable ones."""
    kappa_0 = -0.0002 if force[0] < 0.0 else -0.03
    own = law_of(straight_law(0.0, kappa_0, reach=150.0)).at(0.0).solve(force)
    five = Rod(LENGTH, kappa_0, FiveParameters(EI, EI, 0.0, 0.0, LENGTH / 2)).solve(force)
    assert own.end == pytest.approx(five.end, abs=2e-3)


def test_between_states_of_the_clamped_end_its_values_are_smooth_or_do_not_go_beyond_them() -> None:
    """Where walls meet, the slope of the rotation by the pressure jumps between two states close to each other."""
    moment = np.array([-60.0, 0.0, 0.6, 60.0])
    curve = straight_law(10.0)[1]
    rows = np.zeros((4, 2, 2))
    rows[:, 1, 1] = 1e-4 * moment**2
    names = ("rotation", "rotation_by_moment", "offset", "offset_by_moment")
    shorter = {name: getattr(curve, name)[:4] for name in names}
    jumping = np.array([0.0, 0.0, 1.0, 1.0])
    curve = replace(curve, moment=moment, rotation_by_pressure=jumping, beside=rows, **shorter)
    at = np.linspace(-70.0, 70.0, 1401)
    values = curve.slopes_at(curve.rotation_by_pressure, at)
    assert values.min() >= -1e-12
    assert values.max() <= 1.0 + 1e-12
    assert curve.beside_at(at)[:, 1, 1] == pytest.approx(1e-4 * np.clip(at, -60.0, 60.0) ** 2, abs=1e-9)


def test_the_support_of_a_turned_tip_is_a_couple_on_the_end() -> None:
    """Its couple and the point in which its force acts follow the turn; also where the end turns by more than pi."""
    for kappa_0 in (-0.3 / LENGTH, -5.0 / LENGTH):
        cell, clamp, tip = straight_law(45.0, kappa_0)
        turns = np.linspace(-np.pi, np.pi, 24, endpoint=False)
        points = 0.3 * np.column_stack([np.cos(turns), -np.sin(turns)])  # along x
        tip = replace(tip, couple=0.2 * np.cos(2.0 * turns), acts_at=points, beside_held=np.zeros((24, 2, 2)))
        shape = law_of((cell, clamp, tip)).at(45.0).solve(end_y=5.0)
        couple = 0.2 * np.cos(2.0 * shape.theta[-1]) + 0.3 * shape.force[1]
        assert shape.moment[-1] == pytest.approx(couple, rel=1e-3)
        plain = law_of(straight_law(45.0, kappa_0)).at(45.0).solve(end_y=5.0, moment=couple)
        assert shape.force[1] == pytest.approx(plain.force[1], rel=1e-3)


def test_an_end_that_is_held_along_x_gives_way() -> None:
    """A straight bar between its clamp and the point that holds its end: two springs in a row."""
    EA, compliance = 60.0, 0.4
    cell, clamp, tip = straight_law(0.0, EA=EA)
    tip = replace(tip, pinned_by_pull=np.array([[0.0, 0.0], [compliance, 0.0]]))
    rod = law_of((cell, clamp, tip)).at(0.0)
    for shape in (rod.solve(end=(LENGTH + 2.0, 0.0)), rod.under(Load(), end_x=LENGTH + 2.0)):
        assert shape.force[0] == pytest.approx(2.0 / (LENGTH / EA + compliance))
        assert shape.positions(np.array([LENGTH]))[0] == pytest.approx([LENGTH + 2.0, 0.0], abs=1e-9)


def test_a_support_along_x_is_one_at_a_height_a_quarter_turn_on() -> None:
    turns = np.linspace(-np.pi, np.pi, 24, endpoint=False)
    tip = replace(straight_law(0.0)[2], couple=np.sin(2.0 * turns), acts_at=np.zeros((24, 2)))
    tip = replace(tip, beside_held=np.zeros((24, 2, 2)))
    assert tip.held_along_x.couple == pytest.approx(np.sin(2.0 * (turns + np.pi / 2.0)))
    with pytest.raises(RodError, match="a multiple of four turns, not 6"):
        replace(tip, couple=np.zeros(6))


def test_a_dead_force_acts_in_the_middle_of_the_edge() -> None:
    cell, clamp, tip = straight_law(0.0)
    offset = np.array([0.5, -1.5])
    shape = law_of((cell, clamp, replace(tip, edge=offset))).at(0.0).solve((0.01, 0.1))
    cosine, sine = np.cos(shape.theta[-1]), np.sin(shape.theta[-1])
    lever = np.array([[cosine, -sine], [sine, cosine]]) @ offset
    assert shape.moment[-1] == pytest.approx(lever[0] * 0.1 - lever[1] * 0.01, rel=1e-9)
    np.testing.assert_allclose(shape.positions(shape.s[-1:])[0], [shape.x[-1], shape.y[-1]])


def test_the_moment_at_the_clamp_is_that_about_the_clamped_end_of_the_curve() -> None:
    """Where the axis runs 4 mm below the material curve; the force acts on the end of the curve."""
    cell, clamp, tip = straight_law(0.0)
    above = np.array([0.0, 4.0])
    cell = replace(cell, ripple=np.broadcast_to(above, (9, 3, 2)))
    clamp = replace(clamp, offset=np.broadcast_to(-above, (9, 2)), beside=np.broadcast_to(above, (9, 2, 2)))
    tip = replace(tip, edge=above, beside=np.broadcast_to(above, (2, 2)))
    shape = law_of((cell, clamp, tip)).at(0.0).solve((0.05, 0.02))
    assert shape.curve[0] == pytest.approx([0.0, 0.0], abs=1e-12)
    x, y = shape.end
    assert shape.clamp_moment == pytest.approx(x * 0.02 - y * 0.05, rel=1e-6)
    assert shape.moment[0] == pytest.approx(shape.clamp_moment - 4.0 * 0.05, rel=1e-6)


def test_a_couple_bends_a_rod_with_an_eccentric_axis_to_a_circle() -> None:
    eccentricity, moment = 1.5, 4.0
    shape = law_of(straight_law(0.0, eccentricity=eccentricity)).at(0.0).solve(moment=moment)
    kappa = moment / EI
    radius = (1.0 + eccentricity * kappa) / kappa
    assert shape.y[-1] == pytest.approx(radius * (1 - np.cos(kappa * LENGTH)), rel=1e-6)
    np.testing.assert_allclose(shape.stretch, 1.0 + eccentricity * kappa, rtol=1e-9)


def test_the_axial_force_bends_through_the_change_of_stretch() -> None:
    """M = w'(kappa) - N lambda'(kappa): a force along a straight arm acts at the distance lambda' from the axis."""
    eccentricity, force = 1.5, 1e-6
    shape = law_of(straight_law(0.0, eccentricity=eccentricity)).at(0.0).solve((force, 0.0))
    assert shape.theta[-1] == pytest.approx(force * eccentricity * LENGTH / EI, rel=1e-3)


def test_between_pressures_the_cubic_takes_the_slopes_of_both() -> None:
    """kappa_0 = -a p^2 with dkappa/dp = -2 a p: the cubic in p is exact."""
    a = 1e-5

    def part(p: float) -> tuple[CellCurve, ClampCurve, TipCurve]:
        cell, clamp, tip = straight_law(p, -a * p**2)
        return replace(cell, moment_by_pressure=np.full(9, EI * 2 * a * p)), clamp, tip

    law = law_of(part(0.0), part(20.0), part(40.0))
    for pressure in (7.0, 20.0, 33.0):
        assert section_at([cell.placed for cell in law.cells], pressure, pressure).kappa_0 == pytest.approx(
            -a * pressure**2, rel=1e-9
        )
    with pytest.raises(RodError, match="The law goes from 0 to 40 kPa; 41 kPa is outside"):
        law.at(41.0)


def test_between_pressures_the_rotation_of_the_clamped_end_takes_the_slopes_of_both() -> None:
    """rotation = -b p^2 + c M: the cubic in p is exact."""
    b, c, kappa_0_rate = 2e-5, 3e-3, -2e-4

    def part(p: float) -> tuple[CellCurve, ClampCurve, TipCurve]:
        cell, clamp, tip = straight_law(p, kappa_0_rate * p)
        ones = np.ones(len(clamp.moment))
        cell = replace(cell, moment_by_pressure=-EI * kappa_0_rate * ones)
        rotation = c * clamp.moment - b * p**2
        clamp = replace(clamp, rotation=rotation, rotation_by_moment=c * ones, rotation_by_pressure=-2.0 * b * p * ones)
        return cell, clamp, tip

    law = law_of(part(0.0), part(20.0), part(40.0))
    for pressure in (7.0, 20.0, 33.0):
        clamp = law.at(pressure).clamp
        np.testing.assert_allclose(clamp.rotation, c * clamp.moment - b * pressure**2, atol=1e-9)


def bulged(pressure: float, bulge: float) -> tuple[CellCurve, ClampCurve, TipCurve]:
    """A straight cell whose material curve lies `bulge` mm beside the axis, more at larger moments."""
    cell, clamp, tip = straight_law(pressure)
    beside = bulge * (1.0 + cell.moment / 100.0)
    offset = np.stack([0.0 * beside, -beside], axis=1)
    of_nodes = np.stack([np.zeros((9, 3)), np.repeat(beside[:, None], 3, axis=1)], axis=2)
    by_moment = np.tile([0.0, -bulge / 100.0], (9, 1))
    cell = replace(cell, ripple=of_nodes)
    clamp = replace(clamp, offset=offset, offset_by_moment=by_moment, beside=of_nodes[:, :2])
    return cell, clamp, replace(tip, beside=np.tile([0.0, bulge], (2, 1)), edge=np.array([0.0, bulge]))


def bulge_of(law: ArmLaw, pressure: float) -> list[float]:
    """Of cell and clamped end at a pressure, without moment and near 50 N mm, and of the tip; mm."""
    rod, parts = law.at(pressure), []
    for moment in (0.0, 50.0):
        i, k = (int(np.abs(part.moment - moment).argmin()) for part in (rod.section, rod.clamp))
        parts.append(rod.section.ripple[i, 1, 1] / (1.0 + rod.section.moment[i] / 100.0))
        both = np.array([-rod.clamp.offset[k, 1], rod.clamp.beside[k, 1, 1]])
        parts += list(both / (1.0 + rod.clamp.moment[k] / 100.0))
    return [*map(float, parts), float(rod.tip.beside[0, 1]), float(rod.tip.edge[1])]


@pytest.mark.parametrize(("pressure", "most"), [(2.5, 0.55), (7.5, 0.65), (15.0, 0.1), (30.0, 0.2)])
def test_between_pressures_a_bulge_that_grows_ever_less_is_followed(pressure: float, most: float) -> None:
    """bulge = p^(2/3): parts of the error that straight lines between the pressures have."""
    pressures = (0.0, 5.0, 10.0, 20.0, 40.0)
    law = law_of(*(bulged(p, p ** (2 / 3)) for p in pressures))
    true = pressure ** (2 / 3)
    straight = float(np.interp(pressure, pressures, np.power(pressures, 2 / 3)))
    for bulge in bulge_of(law, pressure):
        assert abs(bulge - true) < most * (true - straight)


def test_between_pressures_a_bulge_in_proportion_to_them_is_exact() -> None:
    pressures = (0.0, 5.0, 10.0, 20.0)
    for several in (pressures, pressures[:2]):
        law = law_of(*(bulged(p, 0.1 * p) for p in several))
        for pressure in (2.0, *several[1:]):
            assert bulge_of(law, pressure) == pytest.approx([0.1 * pressure] * 8, rel=1e-9)


def test_two_pressures_are_joined_by_straight_lines() -> None:
    law = law_of(bulged(0.0, 0.0), bulged(8.0, 4.0))
    assert bulge_of(law, 1.0) == pytest.approx([0.5] * 8, rel=1e-9)


def test_an_arm_of_another_length_has_the_same_law() -> None:
    assert law_of(straight_law(10.0)).at(10.0, 60.0).length == 60.0


def test_the_record_comes_back() -> None:
    law = law_of(straight_law(0.0), straight_law(20.0, -0.01, EA=60.0, GA=12.0, eccentricity=1.2))
    record = json.loads(json.dumps(law_record(law)))
    again = law_of_record(record)
    assert law_record(again) == record
    assert again.at(12.0).solve(end_y=3.0).force[1] == law.at(12.0).solve(end_y=3.0).force[1]
    with pytest.raises(ValueError, match="tip"):
        law_of_record({key: value for key, value in record.items() if key != "tip"})


def test_a_rod_takes_the_law_at_a_pressure_as_it_takes_five_parameters() -> None:
    law = law_of(straight_law(0.0, -0.01)).at(0.0)
    by_law = Rod(length=LENGTH, law=law, start=(3.0, 1.0)).solve((0.0, 0.02))
    by_five = Rod(LENGTH, -0.01, FiveParameters(EI, EI, 0.0, 0.0, 20.0), start=(3.0, 1.0)).solve((0.0, 0.02))
    s = np.linspace(0.0, LENGTH, 23)
    np.testing.assert_allclose(by_law.positions(s), by_five.positions(s), atol=1e-5)
    np.testing.assert_allclose(by_law.positions(s) - [3.0, 1.0], law.solve((0.0, 0.02)).positions(s), atol=1e-12)
    end = (float(by_law.x[-1]), float(by_law.y[-1]))
    np.testing.assert_allclose(Rod(length=LENGTH, law=law, start=(3.0, 1.0)).solve(end=end).force, [0, 0.02], atol=1e-6)


def test_what_the_law_has_itself_is_refused_beside_it() -> None:
    law = law_of(straight_law(0.0)).at(0.0)
    together = Rod(length=LENGTH, law=law).solve((0.0, 0.01), order="together")
    assert together.end == pytest.approx(Rod(length=LENGTH, law=law).solve((0.0, 0.01)).end, abs=1e-6)


def test_all_moduli_times_a_factor() -> None:
    """Pressures, moments and forces times the factor; the shapes are the same, and the range of pressures moves."""
    law = law_of(straight_law(10.0, -0.004, EA=1e4, GA=3e3), straight_law(30.0, -0.012, EA=1e4, GA=3e3))
    scaled = law.scaled(0.6)
    assert scaled.pressures == pytest.approx((6.0, 18.0))
    force = np.array([0.01, -0.02])
    known, other = law.at(20.0).solve(force), scaled.at(12.0).solve(0.6 * force)
    assert np.abs(other.positions(other.s) - known.positions(known.s)).max() < 1e-9 * LENGTH
    assert np.abs(other.moment - 0.6 * known.moment).max() < 1e-9 * np.abs(known.moment).max()
    assert [
        power_of_modulus(key) for key in ("moment_by_pressure_N_mm_per_kPa", "min_J", "offset_by_moment_per_N")
    ] == [*(0, 0, -1)]
    for factor in (0.0, -1.0, np.nan):
        with pytest.raises(RodError):
            law.scaled(factor)
