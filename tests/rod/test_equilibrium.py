"""The rod as a boundary-value problem.

Known solutions: those of the elastica are K. E. Bisshopp and D. C. Drucker (1945). A rod is the limit of two chains of
elements: of 60 and 120, its error is about 1e-7 of the length where it turns by a radian.
"""

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from rod import FiveParameters, Load, Rod, RodError
from rod.arm import path
from rod.mechanics import lines

PLAIN = FiveParameters(1.0, 1.0, 0.0, 0.0, 0.13)
TWO_LINES = FiveParameters(2.0, 1.0, 0.1, -0.05, 0.13)
#: the gapped pneu-net at about 31 kPa
ARM = Rod(112.0, 0.03, FiveParameters(180.0, 400.0, 0.5, -0.2, 12.0))


#: F l^2 / EI; deflection and shortening over l and angle of the end of a cantilever (Bisshopp and Drucker)
ELASTICA = pytest.mark.parametrize(
    ("load", "deflection", "shortening", "angle"),
    [
        (1.0, 0.3017208, 0.0564332, 0.4613519),
        (5.0, 0.7137915, 0.3876284, 1.2153681),
        (10.0, 0.8106090, 0.5549956, 1.4302855),
    ],
)


@ELASTICA
def test_elastica_under_a_dead_transverse_load(load, deflection, shortening, angle):
    shape = Rod(1.0, 0.0, PLAIN).solve(force=(0.0, load))
    assert (shape.y[-1], 1.0 - shape.x[-1], shape.theta[-1]) == pytest.approx((deflection, shortening, angle), abs=1e-6)


@pytest.mark.parametrize(
    ("law", "x", "y", "angle", "moment"),
    [
        (PLAIN, 0.70097483, 0.56834236, 1.54170958, -0.98514601),
        (TWO_LINES, 0.64205249, 0.61692984, 1.66617274, -0.95051741),
    ],
)
def test_piecewise_law_with_curved_rest_shape(law, x, y, angle, moment):
    shape = Rod(1.0, 2.0, law).solve(force=(0.5, -1.0))
    assert (shape.x[-1], shape.y[-1], shape.theta[-1], shape.moment[0]) == pytest.approx(
        (x, y, angle, moment), abs=1e-7
    )


def test_agreement_with_scipy_solve_bvp():
    law, force, moment, weight = TWO_LINES, (0.5, -1.0), 0.2, (0.0, -0.7)
    shape = Rod(1.0, lambda s: 2.0 + 0.4 * np.sin(9.0 * s), law).under(Load(force, moment, weight))

    def rates(t, z):  # both pieces on one unit interval, so that nothing jumps
        out = []
        for a, b, (theta, m, _x, _y), alpha, m0 in ((0, law.d, z[:4], 2.0, 0.1), (law.d, 1, z[4:], 1.0, -0.05)):
            s = a + (b - a) * t
            nx, ny = force[0] + weight[0] * (1 - s), force[1] + weight[1] * (1 - s)
            rate = [
                2.0 + 0.4 * np.sin(9.0 * s) + (m - m0) / alpha,
                nx * np.sin(theta) - ny * np.cos(theta),
                np.cos(theta),
                np.sin(theta),
            ]
            out += [(b - a) * r for r in rate]
        return np.array(out)

    def ends(a, b):
        return np.array([a[0], a[2], a[3], *(a[4:] - b[:4]), b[5] - moment])

    reference = solve_bvp(rates, ends, np.linspace(0, 1, 40), np.zeros((8, 40)), tol=1e-10, max_nodes=20000)
    assert reference.success
    tip = [shape.theta[-1], shape.moment[-1], shape.x[-1], shape.y[-1]]
    assert tip == pytest.approx(reference.y[4:, -1], abs=2e-6)


def test_moment_at_the_clamp_balances_the_end_force():
    shape = ARM.solve(force=(0.04, 0.06), moment=1.5)
    arm_x, arm_y = shape.x[-1] - shape.x, shape.y[-1] - shape.y
    assert shape.moment == pytest.approx(arm_x * 0.06 - arm_y * 0.04 + 1.5, abs=1e-10)


def test_elements_converge_with_the_square_of_their_length_and_their_limit_with_the_fourth_power(monkeypatch):
    ends = []
    for count in (10, 20, 40, 80):
        monkeypatch.setattr(lines, "ELEMENTS", count)
        model = lines._Model(ARM.arm, ARM.arm._section(is_loaded=True))
        found = path.follow(model, Load((0.03, -0.05)), path.PathOptions())
        ends.append([found.chains[0].place[-1], found.nodes.place[-1]])
    differences = np.abs(np.diff(np.array(ends), axis=0)).max(axis=2)
    rates = np.log2(differences[:-1] / differences[1:])
    assert rates[-1, 0] == pytest.approx(2.0, abs=0.1)
    assert rates[-1, 1] == pytest.approx(4.0, abs=0.5)


def test_prescribed_end_gives_back_the_force():
    dead = ARM.solve(force=(0.0, -0.05))
    held = ARM.solve(end_y=dead.y[-1], order="pressure first")
    assert held.force == pytest.approx([0.0, -0.05], abs=1e-10)
    assert held.x == pytest.approx(dead.x, abs=1e-6 * ARM.length)
    both = ARM.solve(end=(dead.x[-1], dead.y[-1]))
    assert both.force == pytest.approx([0.0, -0.05], abs=1e-7)
    pushed = ARM.solve(force=(0.03, 0.0))
    assert ARM.solve(end_x=pushed.x[-1]).force == pytest.approx([0.03, 0.0], abs=1e-10)


def test_an_end_held_while_the_pressure_rises_arches():
    """III: the curvature changes sign (paper, Fig. 8); with the end moved afterwards the arm stays curled."""
    arch, curl = ARM.solve(end_y=0.0), ARM.solve(end_y=0.0, order="pressure first")
    assert abs(arch.y[-1]) < 1e-9
    assert abs(curl.y[-1]) < 1e-9
    assert arch.x[-1] > 0.7 * ARM.length
    assert curl.x[-1] < 0.0
    assert arch.kappa[0] < 0.0 < arch.kappa[-1]
    assert ARM.solve(order="together").x == pytest.approx(ARM.solve().x)


def test_elastica_with_prescribed_end_height():
    """The transverse load of the known answer P = 5 from its deflection (experiment III)."""
    shape = Rod(1.0, 0.0, PLAIN).solve(end_y=0.7137915236)
    assert shape.force == pytest.approx([0.0, 5.0], abs=1e-5)


def test_end_moment_bends_a_circle():
    shape = Rod(1.0, 0.0, PLAIN).solve(moment=1.5)
    assert shape.kappa == pytest.approx(1.5, abs=1e-12)
    assert (shape.x[-1], shape.y[-1]) == pytest.approx((math.sin(1.5) / 1.5, (1 - math.cos(1.5)) / 1.5), abs=1e-10)


def test_gravity_bends_a_light_cantilever_as_the_linear_theory_says():
    shape = Rod(1.0, 0.0, PLAIN).under(Load(weight=(0.0, -1e-3)))
    assert shape.y[-1] == pytest.approx(-1e-3 / 8, rel=1e-5)


def test_without_load_the_shape_is_that_of_kappa_0():
    shape = Rod(1.0, 2.0, TWO_LINES, theta0=0.3, start=(1.0, -2.0)).solve()
    assert shape.kappa == pytest.approx(2.0)
    assert shape.x == pytest.approx(1.0 + (np.sin(0.3 + 2 * shape.s) - math.sin(0.3)) / 2, abs=1e-9)
    held = Rod(1.0, 2.0, TWO_LINES).solve(end_y=(1 - math.cos(2.0)) / 2, order="pressure first")
    assert held.force == pytest.approx([0.0, 0.0], abs=1e-6)


def test_forms_of_kappa_0_agree():
    def wave(s):
        return 0.03 + 0.004 * np.sin(2 * np.pi * s / 40.0)

    s = np.linspace(0.0, 112.0, 2001)
    forms = [wave, wave(s), np.column_stack([s, wave(s)])]
    tips = [dataclasses.replace(ARM, kappa_0=form).solve(end_y=0.0) for form in forms]
    for tip in tips[1:]:
        assert (tip.x[-1], tip.force[1]) == pytest.approx((tips[0].x[-1], tips[0].force[1]), abs=1e-4)


def test_positions_between_nodes_lie_on_the_circle():
    shape = Rod(1.0, 2.0, PLAIN).solve()
    s = np.linspace(0.0, 1.0, 333)
    assert shape.positions(s) == pytest.approx(np.column_stack([np.sin(2 * s) / 2, (1 - np.cos(2 * s)) / 2]), abs=1e-8)
    with pytest.raises(RodError, match="no point at s"):
        shape.positions(np.array([1.2]))


def test_a_thousand_solves_stay_on_the_path_of_one():
    """The solution for a large load does not depend on the steps by which it was reached."""
    rod = Rod(1.0, 2.0, TWO_LINES)
    whole = rod.solve(force=(-3.0, -8.0))
    assert whole.load_steps > 1
    tips = [rod.solve(force=(-3.0 * f, -8.0 * f)) for f in np.linspace(0.05, 1.0, 40)]
    turns = np.abs(np.diff([tip.theta[-1] for tip in tips]))
    assert turns.max() < 0.4
    assert tips[-1].theta == pytest.approx(whole.theta, abs=1e-9)


def test_large_forces_keep_their_accuracy():
    """At F l^2/alpha = 100 the rod bends within a tenth of its length; the tip angle follows from the first integral.

    (theta')^2/2 = P (sin theta_l - sin theta) for a dead transverse load, so kappa(0)^2 = 2 P sin theta_l.
    """
    shape = Rod(1.0, 0.0, PLAIN).solve(force=(0.0, 100.0))
    assert shape.kappa[0] ** 2 == pytest.approx(200.0 * math.sin(shape.theta[-1]), rel=5e-6)


def test_buckling_is_reported_not_stepped_over():
    with pytest.raises(RodError, match=r"The rod buckles at 9.* % of the load"):
        Rod(1.0, 0.0, PLAIN).under(Load((-2.5, 0.0)))  # Euler: pi^2/4 = 2.467
    straight = Rod(1.0, 0.0, PLAIN).solve(force=(-2.4, 0.0))
    assert straight.x[-1] == pytest.approx(1.0)
    imperfect = Rod(1.0, 1e-3, PLAIN).solve(force=(-5.0, 0.0))
    assert imperfect.y[-1] > 0.5


@pytest.mark.parametrize("kappa_0", [-0.006, -0.003])
def test_the_force_is_continuous_where_the_end_is_pushed_towards_the_clamp(kappa_0):
    """A rod that is nearly straight buckles in its lowest mode: others, with 7 to 100 times the force, are near by."""
    rod = Rod(112.0, kappa_0, FiveParameters(180.0, 290.0, 0.0, -0.25, 6.0))
    shapes = [rod.solve(end=(x, 0.0)) for x in np.arange(108.0, 70.0, -1.0)]
    forces = np.array([shape.force for shape in shapes])
    assert (np.diff(forces, axis=0) < [0.0, 0.009]).all()
    assert (np.diff(forces, axis=0) > [-0.02, 0.0]).all()
    # a straight rod, clamped at one end and pinned on its line at the other: 20.2 alpha/l^2 (Timoshenko and Gere, 2.1);
    # its next mode has 60 alpha/l^2
    assert (np.abs(forces[:, 0]) * 112.0**2 / 290.0 < 25.0).all()
    assert all(np.count_nonzero(np.diff(np.sign(shape.theta))) <= 2 for shape in shapes)


def test_ends_drawn_at_random_against_small_steps(monkeypatch):
    rng = np.random.default_rng(11)
    cases = []
    for _ in range(30):
        law = FiveParameters(*rng.uniform(100.0, 500.0, 2), *rng.uniform(-0.5, 0.5, 2), rng.uniform(5.0, 30.0))
        rod = Rod(112.0, rng.uniform(-4.0, 4.0) / 112.0, law)
        angle, reach = rng.uniform(-2.5, 2.5), 112.0 * rng.uniform(0.2, 0.995)
        where = {"end": (reach * math.cos(angle), reach * math.sin(angle))}
        cases.append((rod, where if rng.random() < 0.6 else {"end_x": float(rng.uniform(-0.2, 0.995) * 112.0)}))

    def forces():
        values = []
        for rod, where in cases:
            try:
                values.append(rod.solve(**where).force)
            except RodError:
                values.append(np.full(2, np.nan))
        return np.array(values)

    usual = forces()
    monkeypatch.setattr(path, "SMOOTH", 0.1)
    monkeypatch.setattr(path, "LARGEST_TURN", 0.05)
    np.testing.assert_allclose(usual, forces(), rtol=1e-6, atol=1e-9)
    assert np.isfinite(usual).all(axis=1).mean() > 0.8
