"""A rod whose curvature was measured under its weight, and the identification of such an arm."""

import numpy as np
import pytest

from geometry import Centreline
from rod import (
    FiveParameters,
    Load,
    Rod,
    cell_averaged,
    end_displacement_closure,
    identify,
    moment_between,
    moment_from_load,
)

LENGTH, RIGIDITY = 110.0, 300.0
WEIGHT, HEIGHT = (4e-4, -1.5e-3), 6.0  #: N/mm and mm; it bends the arm by more than a radian
WEIGHT_ALONE = Load(weight=WEIGHT, weight_height=HEIGHT)
LINE = FiveParameters(RIGIDITY, RIGIDITY, 0.0, 0.0, 15.0)
S = np.linspace(0.0, LENGTH, 441)
#: an arm that does not know its weight yet
LIGHT = Rod(LENGTH, 0.012, LINE)


def shape(rod: Rod, load: Load, end_y: float | None = None) -> tuple[Centreline, Load]:
    """The curve and, as finite elements give it, what acts on it."""
    solution = rod.under(load, end_y=end_y)
    force = (float(solution.force[0]), float(solution.force[1]))
    return Centreline(S, *solution.positions(S).T), Load(force, load.couple, load.weight, load.weight_height)


def heavy(law: FiveParameters = LINE, **others: object) -> Rod:
    """The arm with the curvature that it has under its weight."""
    sagged, load = shape(LIGHT, WEIGHT_ALONE)
    kappa = 0.012 + moment_from_load(sagged, load).value / RIGIDITY
    return Rod(LENGTH, np.column_stack([S, kappa]), law, weight=WEIGHT, weight_height=HEIGHT, **others)  # type: ignore[arg-type]


def test_without_load_it_has_the_curvature_under_its_weight() -> None:
    sagged, rod = LIGHT.under(WEIGHT_ALONE), heavy(FiveParameters(200.0, 400.0, 3.0, -2.0, 30.0))
    alone = rod.solve()
    assert sagged.end_angle < LIGHT.solve().end_angle - 1.0
    assert alone.positions(S) == pytest.approx(sagged.positions(S), abs=2e-4 * LENGTH)
    assert np.interp(S, alone.s, alone.kappa) == pytest.approx(np.interp(S, sagged.s, sagged.kappa), abs=1e-5)
    # M is that of all loads
    assert alone.clamp_moment == pytest.approx(sagged.clamp_moment, rel=1e-3)


@pytest.mark.parametrize(
    "load", [Load((0.01, 0.03), weight_height=HEIGHT), Load((0.0, 0.01), 2.0, (1e-4, 2e-4), HEIGHT)]
)
def test_under_load_it_is_the_rod_that_carries_its_weight(load: Load) -> None:
    both = Load(load.force, load.couple, (load.weight[0] + WEIGHT[0], load.weight[1] + WEIGHT[1]), load.weight_height)
    expected, found = LIGHT.under(both), heavy().under(load)
    assert found.positions(S) == pytest.approx(expected.positions(S), abs=2e-4 * LENGTH)
    assert found.clamp_moment == pytest.approx(expected.clamp_moment, rel=1e-3)


def test_a_held_end_of_a_rod_with_weight() -> None:
    expected, found = LIGHT.under(WEIGHT_ALONE, end_y=0.0), heavy().solve(end_y=0.0)
    assert found.force[1] == pytest.approx(expected.force[1], rel=1e-3)
    assert found.positions(S) == pytest.approx(expected.positions(S), abs=2e-4 * LENGTH)


def test_the_rigidity_of_an_arm_that_sags_is_identified() -> None:
    """The moments of the end force alone give a rigidity that is far off."""
    (free, _), (loaded, load) = shape(LIGHT, WEIGHT_ALONE), shape(LIGHT, WEIGHT_ALONE, end_y=0.0)
    kappa_0, kappa = cell_averaged(free, 10.0), cell_averaged(loaded, 10.0)
    closure = end_displacement_closure(free, loaded, load)
    found = identify(kappa_0, kappa, moment_between(free, loaded, load), closure)
    assert found.single_line.alpha.value == pytest.approx(RIGIDITY, rel=0.01)
    alone = identify(kappa_0, kappa, moment_from_load(loaded, Load(load.force)), closure)
    assert abs(alone.single_line.alpha.value / RIGIDITY - 1.0) > 0.3
