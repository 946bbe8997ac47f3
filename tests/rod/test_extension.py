"""The extensible rod against a boundary-value solver, and the identification of its eccentricity."""

import dataclasses

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from geometry import Centreline
from rod import (
    Extension,
    FiveParameters,
    Load,
    Rod,
    RodError,
    extension,
    moment_about_neutral_axis,
    moment_between,
)
from tests.bodies import difference

LAW = FiveParameters(200.0, 400.0, 0.0, -0.3, 12.0)
LENGTH, ECCENTRICITY = 112.0, 1.3
NODES = np.linspace(0.0, LENGTH, 225)
#: stretched at rest by 1 % at the clamp and 3 % at the end
REST = Extension(NODES, 1.01 + 0.02 * NODES / LENGTH, ECCENTRICITY)
PLAIN = Rod(LENGTH, 0.03, LAW)


def curve(shape, s=NODES):
    return Centreline(s, *shape.positions(s).T)


def test_agreement_with_scipy_solve_bvp():
    rod = dataclasses.replace(PLAIN, extension=REST)
    shape = rod.solve(end_y=10.0)

    def rates(t, z, p):  # both pieces on one unit interval, so that nothing jumps
        out = []
        for a, b, (theta, m, _x, _y), alpha, m0 in (
            (0.0, LAW.d, z[:4], LAW.alpha1, LAW.m01),
            (LAW.d, LENGTH, z[4:], LAW.alpha2, LAW.m02),
        ):
            about_neutral_axis = m + ECCENTRICITY * p[0] * np.sin(theta)
            s, delta = a + (b - a) * t, (about_neutral_axis - m0) / alpha
            stretch = 1.01 + 0.02 * s / LENGTH + ECCENTRICITY * delta
            terms = (0.03 + delta, -stretch * p[0] * np.cos(theta), stretch * np.cos(theta), stretch * np.sin(theta))
            out += [(b - a) * term for term in terms]
        return np.array(out)

    def ends(za, zb, p):
        return np.array([*za[[0, 2, 3]], *(zb[:4] - za[4:]), zb[5], zb[7] - 10.0])

    t = np.linspace(0.0, 1.0, 41)
    s = np.vstack([t * LAW.d, LAW.d + t * (LENGTH - LAW.d)])
    guess = np.vstack(
        [np.vstack([np.interp(part, shape.s, getattr(shape, n)) for n in ("theta", "moment", "x", "y")]) for part in s]
    )
    solution = solve_bvp(rates, ends, t, guess, p=[float(shape.force[1])], tol=1e-9, max_nodes=20000)
    assert solution.success
    assert shape.force[1] == pytest.approx(solution.p[0], rel=1e-7)
    assert (shape.x[-1], shape.theta[-1], shape.moment[0]) == pytest.approx(
        (solution.y[6, -1], solution.y[4, -1], solution.y[1, 0]), rel=1e-7
    )


def test_an_unloaded_rod_keeps_its_angles_and_gets_longer():
    plain, longer = PLAIN.solve(), dataclasses.replace(PLAIN, extension=REST).solve()
    assert longer.theta == pytest.approx(plain.theta, abs=1e-12)
    assert curve(longer).stretch == pytest.approx(1.02, abs=1e-4)
    assert np.all(plain.stretch == 1.0)


def test_without_rest_stretch_and_eccentricity_nothing_changes():
    nothing = Extension(NODES, np.ones(len(NODES)), 0.0)
    a, b = (rod.solve(end_y=0.0) for rod in (PLAIN, dataclasses.replace(PLAIN, extension=nothing)))
    assert b.force[1] == pytest.approx(a.force[1], rel=1e-12)
    assert b.y == pytest.approx(a.y, abs=1e-10)


def test_the_moment_of_the_clamp_balances_the_end_force():
    shape = dataclasses.replace(PLAIN, extension=REST).solve(force=(0.01, -0.05))
    assert shape.moment[0] == pytest.approx(shape.x[-1] * -0.05 - shape.y[-1] * 0.01, rel=1e-9)


def test_both_are_read_back_from_the_shapes():
    rod = dataclasses.replace(PLAIN, extension=REST)
    free, loaded = curve(rod.solve()), curve(rod.solve(end_y=0.0))
    identified = extension(free, loaded, 10.0)
    assert identified.eccentricity == pytest.approx(ECCENTRICITY, rel=2e-3)
    assert identified.eccentricity_std < 0.01
    assert identified.rest_stretch[5:-5] == pytest.approx(REST.rest_stretch[5:-5], abs=1e-4)


def test_the_moment_about_the_neutral_axis_gives_back_the_rigidity():
    """The end is pulled along the arm, so that the axial force is large; the moment about the curve is not enough."""
    law = FiveParameters(300.0, 300.0, 0.0, 0.0, 12.0)
    rod = dataclasses.replace(PLAIN, law=law, extension=REST, kappa_0=0.02)
    loaded = rod.solve(force=(0.05, -0.05))
    load = Load((0.05, -0.05))
    free, bent = curve(rod.solve()), curve(loaded)
    about_axis = moment_about_neutral_axis(free, bent, load, ECCENTRICITY)
    delta = np.interp(NODES, loaded.s, loaded.kappa) - 0.02
    assert about_axis.value == pytest.approx(300.0 * delta, abs=2e-4 * np.abs(about_axis.value).max())
    assert about_axis.value == pytest.approx(np.interp(NODES, loaded.s, loaded.bending_moment), abs=2e-3)
    apart = np.abs(moment_between(free, bent, load).value - about_axis.value).max()
    assert apart > 0.005 * np.abs(about_axis.value).max()


@pytest.mark.parametrize("weight", [(0.0, 0.0), (3e-4, -1e-3)])
def test_the_compliance_is_symmetric(weight):
    """The rod is elastic: its end moves by F_y along x as by F_x along y, and the same of a couple and the angle."""
    rod = dataclasses.replace(PLAIN, extension=REST, weight=weight, weight_height=4.0)

    def end(load):
        shape = rod.under(Load(tuple(load[:2]), load[2], (1e-4, -2e-4), 4.0))
        return np.array([shape.x[-1], shape.y[-1], shape.theta[-1]])

    # of the size of the loads, so that the end of 100 mm is known to 1e-10 of itself and the quotient to 1e-6
    at, steps = np.array([0.01, -0.02, 0.5]), np.diag([1e-4, 1e-4, 1e-2])
    compliance = np.column_stack([difference(end, at, h / h.sum(), h.sum()) for h in steps])
    scale = np.sqrt(np.outer(np.diag(compliance), np.diag(compliance)))
    assert np.abs((compliance - compliance.T) / scale).max() < 1e-5
    assert np.all(np.linalg.eigvalsh(0.5 * (compliance + compliance.T)) > 0.0)


def test_an_end_out_of_reach_of_a_rod_that_does_not_stretch_is_within_it():
    straight = Rod(LENGTH, 0.0, LAW)
    with pytest.raises(RodError, match="inextensible"):
        straight.solve(end=(113.0, 1.0))
    longer = dataclasses.replace(straight, extension=Extension(NODES, np.full(len(NODES), 1.05), 0.0))
    # a straight rod that is compressed
    assert longer.solve(end=(113.0, 1.0)).x[-1] == pytest.approx(113.0)
    assert dataclasses.replace(longer, kappa_0=0.003).solve(end=(113.0, 1.0)).x[-1] == pytest.approx(113.0)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ((NODES[::-1], np.ones(225), 1.0), "that rise"),
        ((NODES, np.zeros(225), 1.0), "must be positive"),
        ((NODES, np.ones(225), float("nan")), "finite number"),
    ],
)
def test_refusals(given, sentence):
    with pytest.raises(RodError, match=sentence):
        Extension(*given)
    straight = curve(PLAIN.solve())
    with pytest.raises(RodError, match="nothing bends"):
        extension(straight, straight, 10.0)
