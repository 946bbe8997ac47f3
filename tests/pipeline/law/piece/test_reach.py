"""The range of a law against the moments and curvatures of a rod of constant rigidity under the same loads."""

from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from geometry.arrays import Array
from pipeline.config.load import load_config
from pipeline.law.piece.reach import LARGEST, LEAST_TURN, STRETCHED, Reach
from rod import FiveParameters, Load, Rod, RodSolution
from rod.weight import gravity_direction

LENGTH, RIGIDITY = 100.0, 400.0
LINE = FiveParameters(RIGIDITY, RIGIDITY, 0.0, 0.0, LENGTH / 2.0)


def rod(kappa_0: float) -> Rod:
    return Rod(LENGTH, law=LINE, kappa_0=kappa_0)


def is_within(solution: RodSolution, reach: Reach, kappa_0: float) -> bool:
    """Whether no moment of a rod needs a cell beyond the last state that its sweep would have."""
    for side in (1, -1):
        moments = np.linspace(0.0, 0.999 * side * max((side * solution.moment).max(), 0.0), 20)
        if moments[-1] and reach.range_from(kappa_0, RIGIDITY, side).left(moments, moments / RIGIDITY) <= 0.0:
            return False
    return True


@pytest.mark.parametrize(("turn", "end_y"), [*product((-0.02, -0.3, -1.2, -2.0, 0.8), (0.0, 10.0, -20.0))])
def test_the_range_holds_the_end_at_every_height_of_the_configuration(turn: float, end_y: float) -> None:
    kappa_0 = turn / LENGTH
    reach = Reach(LENGTH, 0.0, abs(end_y), kappa_0)
    assert is_within(rod(kappa_0).solve(end_y=end_y), reach, kappa_0)


@pytest.mark.parametrize(("turn", "force"), [*product((-0.02, -0.6, -1.8), (0.03, -0.03, 0.1))])
def test_the_range_bears_the_forces_of_the_configuration(turn: float, force: float) -> None:
    kappa_0 = turn / LENGTH
    assert is_within(rod(kappa_0).solve(force=(0.0, force)), Reach(LENGTH, abs(force), 0.0, kappa_0), kappa_0)


def test_an_arm_that_hardly_bends_is_measured_over_a_small_range() -> None:
    """Its cells are not bent to where they lose their stability."""
    small = Reach(LENGTH, 0.0, 0.0, -0.02 / LENGTH)
    for side in (1, -1):
        held = small.range_from(small.bend, RIGIDITY, side)
        assert held.turn < LEAST_TURN / LENGTH
        assert abs(held.first_moment) < 0.05 * held.farthest * RIGIDITY


def test_curves_of_all_pressures_are_straightened_equally_far() -> None:
    """Between two pressures the law is known up to the smaller one of their largest curvatures."""
    reach = Reach(LENGTH, 0.05, 10.0, -2.0 / LENGTH)
    kappas = np.array([0.0, -1.0, -2.0]) / LENGTH
    largest, lowest = ([reach.range_from(kappa, RIGIDITY, side).turn for kappa in kappas] for side in (1, -1))
    np.testing.assert_allclose(kappas + largest, largest[0])
    np.testing.assert_allclose(lowest, lowest[0])


def test_a_cell_that_becomes_stiff_beyond_the_straight_one_is_followed_to_a_moment() -> None:
    """On the way its rigidity doubles, and beyond it is ten times as large: the mean rigidity of the way counts."""
    turn = 1.0 / LENGTH
    until = Reach(LENGTH, 0.0, 0.0, -turn).range_from(-turn, RIGIDITY, 1)
    mean = 1.5 * RIGIDITY
    turns = np.array([0.0, turn / 2.0, turn, 1.1 * turn])
    moments = np.array([0.0, RIGIDITY * turn / 2.0, mean * turn, 2.0 * mean * turn])
    assert until.turn == pytest.approx(1.75 * turn)
    assert until.left(moments[:3], turns[:3]) == pytest.approx(0.75 * turn * mean)
    assert until.left(moments, turns) == pytest.approx(-0.25 * turn * mean)


def stiffening(meets: float, ratio: float) -> Callable[[Array], Array]:
    """Moment over the change of the curvature (1/mm) of a cell; from the change `meets` on stiffer by `ratio`."""
    return lambda turns: RIGIDITY * (turns + (ratio - 1.0) * np.maximum(turns - meets, 0.0))


def moment_at_clamp(kappa_0: float, law: Callable[[Array], Array]) -> float:
    """Of a rod with this law that a force along y at its end holds at the height of its clamp, N mm.

    With the angle a and M(s) = F (x(l) - x(s)) from the clamp on: M' = -F cos a, a' = kappa(M), integrated as an
    initial value problem, and M and F at the clamp such that M and y vanish at the end.
    """
    moments = law(turns := np.linspace(-0.1, 0.2, 60_001))

    def at_end(unknown: Array) -> Array:
        moment, force = unknown

        def slopes(_: float, state: Array) -> list[float]:
            angle, _, bending = state
            kappa = kappa_0 + float(np.interp(bending, moments, turns))
            return [kappa, np.sin(angle), -force * np.cos(angle)]

        solved = solve_ivp(slopes, (0.0, LENGTH), [0.0, 0.0, moment], rtol=1e-9, atol=1e-10)
        return np.array([solved.y[2, -1] / RIGIDITY * LENGTH, solved.y[1, -1] / LENGTH])

    unknown, lacking, _, said = fsolve(
        at_end, [-1.5 * RIGIDITY * kappa_0, -1.5 * RIGIDITY * kappa_0 / LENGTH], full_output=True
    )
    assert np.abs(at_end(unknown)).max() < 1e-6, (lacking, said)
    return float(unknown[0])


@pytest.mark.parametrize(("part", "ratio"), [*product((0.05, 0.3, 0.6, 0.9), (4.0, 20.0))])
def test_a_cell_that_becomes_stiff_before_it_is_straight_is_followed_to_what_the_rod_needs(
    part: float, ratio: float
) -> None:
    """Walls meet at a part of the way to the straight cell."""
    bend = 1.0 / LENGTH
    law = stiffening(part * bend, ratio)
    until = Reach(LENGTH, 0.0, 0.0, -bend).range_from(-bend, RIGIDITY, 1)
    turns = np.linspace(0.0, 2.0 * bend, 401)
    followed = next(n for n in range(1, 402) if until.left(law(turns[:n]), turns[:n]) <= 0.0)
    assert law(turns[:followed])[-1] > moment_at_clamp(-bend, law)


def test_no_range_is_larger_than_a_stated_moment() -> None:
    """Where the end is prescribed along x as well, its moment is not known beforehand."""
    whole = Reach(LENGTH, 0.0, np.inf, -1.0 / LENGTH).range_from(-1.0 / LENGTH, RIGIDITY, 1)
    expected = (1.0 + LARGEST) * RIGIDITY / LENGTH
    assert whole.first_moment == pytest.approx(expected)
    for part in (0.99, 1.0):
        states = np.array([0.0, part * expected])
        assert whole.left(states, states / RIGIDITY) == pytest.approx((1.0 - part) * expected)


@pytest.mark.parametrize(
    ("end", "force", "end_y"),
    [
        ("{y: 0 mm}", 0.05, 20.0),
        ("{y: -25 mm}", 0.05, 25.0),
        ("{x: 1 mm, y: 0 mm}", 0.05, np.inf),
        ("{x: 0.12 N, y: 0.09 N}", 0.15, 20.0),
    ],
)
def test_the_loads_are_those_of_experiment_iii_and_of_the_validation(end: str, force: float, end_y: float) -> None:
    config = load_config(
        Path(__file__).resolve().parent.parent.parent.parent.parent / "configs" / "pneunet.yaml",
        [f"end={end}", "validation.end_y=[10 mm, -20 mm]", "validation.forces=[[0.03 N, 0.04 N]]"],
    )
    reach = Reach.of(config, -0.01)
    assert (reach.length, reach.end_y, reach.bend) == (112.0, end_y, -0.01)
    assert reach.force == pytest.approx(STRETCHED * force)


@pytest.mark.parametrize("ratio", [0.5, 5.0, 30.0])
@pytest.mark.parametrize("direction", ["hanging", "lying", "standing", "180 deg"])
def test_the_weight_in_any_direction_is_within(ratio: float, direction: str) -> None:
    """ratio: W l^2 / EI."""
    weight = ratio * RIGIDITY / LENGTH**2
    load = Load(weight=tuple(weight / LENGTH * component for component in gravity_direction(direction)))
    shape = rod(-1.0 / LENGTH).under(load)
    assert is_within(shape, Reach(LENGTH, 0.0, 0.0, -1.0 / LENGTH, weight), -1.0 / LENGTH)


def test_the_weight_counts_where_gravity_is_on() -> None:
    path = Path(__file__).resolve().parent.parent.parent.parent.parent / "configs" / "pneunet.yaml"
    assert Reach.of(load_config(path), -0.01).weight == 0.0
    assert Reach.of(load_config(path, ["effects.gravity=hanging"]), -0.01).weight == pytest.approx(0.1623, rel=0.01)
