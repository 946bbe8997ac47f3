"""Measured arms: their rows, and the angle of an arm that its cell foretells."""

import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.measured_arms.arms import BLIND, GIVEN, LONGER, MODELS, Arm, angles_of, forces_of
from benchmarks.measured_arms.forces import HeldArm
from benchmarks.measured_arms.free import BOTTOM, Factor, FreeArm, curvatures, direction, limit_at, prolonged

PRESSURES = np.linspace(0.0, 50.0, 26)
#: of a cell that bends more and more easily
BENDS = np.stack([PRESSURES, -1e-4 * PRESSURES - 1e-9 * PRESSURES**4], axis=1)


@pytest.mark.parametrize("arm", [GIVEN, LONGER, BLIND])
@pytest.mark.parametrize("model", MODELS)
def test_configurations_are_of_the_arms(arm: Arm, model: str) -> None:
    config = arm.config([10.0], model)
    lengths = {GIVEN: 52.0, LONGER: 70.0, BLIND: 70.0}
    assert config.design.length == pytest.approx(lengths[arm]) == pytest.approx(arm.length)
    assert config.draft


def test_rows_are_read() -> None:
    pressures, degrees = angles_of(LONGER)
    assert len(pressures) == 35
    assert degrees[pressures == 36.0] == pytest.approx(66.24)
    assert not len(angles_of(BLIND)[0])
    pressures, forces = forces_of(GIVEN)
    assert forces[pressures == 44.0] == pytest.approx(0.6381 - 0.0469)
    assert forces[pressures == 25.0] == pytest.approx(np.mean([0.0981 - 0.0608, 0.0980 - 0.0613, 0.0978 - 0.0609]))


@pytest.mark.parametrize("turn", [1e-6, 0.5, 2.0, 4.0])
def test_direction_is_that_of_arcs_and_straight_ends(turn: float) -> None:
    parts = 200_000
    s = (np.arange(parts) + 0.5) * GIVEN.length / parts
    end = 0.5 * GIVEN.wall
    theta = turn * np.clip((s - end) / (GIVEN.length - 2.0 * end), 0.0, 1.0)
    x, y = (np.sum(of(theta)) * GIVEN.length / parts for of in (np.cos, np.sin))
    x, y = x + BOTTOM * math.sin(turn), y - BOTTOM * math.cos(turn)
    expected = math.degrees(math.atan2(y, x)) % 360.0
    assert direction(turn, GIVEN) == pytest.approx(expected, abs=1e-6)


def test_factor_of_another_arm_is_found() -> None:
    law, stiffer = (FreeArm.of(GIVEN, BENDS * (scale, 1.0)) for scale in (1.0, 1.2))
    read = np.array([12.0, 25.0, 40.0])
    np.testing.assert_allclose(law.factors(read, stiffer.at(read)), 1.2, rtol=2e-3)
    np.testing.assert_allclose(law.at(read, 1.2), stiffer.at(read), rtol=1e-3)


def test_nine_of_ten_readings_are_in_their_intervals() -> None:
    rng, law, inside = np.random.default_rng(1), FreeArm.of(LONGER, BENDS), []
    pressures = np.linspace(12.0, 36.0, 9)
    for _ in range(400):
        factors = np.exp(0.05 * rng.standard_normal(10))
        read = np.array([law.at(np.array([p]), f)[0] for p, f in zip((*pressures, 30.0), factors, strict=True)])
        found = Factor.of(law.factors(pressures, read[:-1]))
        _, low, high = found.intervals(law, np.array([30.0]), another=False)
        inside.append(low[0] <= read[-1] <= high[0])
    assert np.mean(inside) == pytest.approx(0.9, abs=0.04)
    of_same, of_other = (found.intervals(law, pressures, another=one) for one in (False, True))
    assert np.all(of_other[2] - of_other[1] > of_same[2] - of_same[1])


def test_a_law_ends_at_its_limit() -> None:
    fallen = np.vstack([BENDS, [[49.0, -0.02], [48.0, -0.03], [60.0, -0.05]]])
    assert limit_at(fallen[:, 0]) == len(BENDS) - 1
    assert limit_at(BENDS[:, 0]) == len(BENDS) - 1
    law = FreeArm.of(GIVEN, fallen)
    assert np.isnan(law.at(np.array([50.1]))).all()
    assert law.steepest == pytest.approx(50.0, abs=1.0)


def test_curvatures_are_kept(tmp_path: Path) -> None:
    kept = tmp_path / f"{GIVEN.name}_{GIVEN.config([60.0]).hash[:12]}.csv"
    np.savetxt(kept, BENDS, delimiter=",")
    np.testing.assert_allclose(curvatures(GIVEN, "authors", 60.0, tmp_path), BENDS)


def test_a_way_goes_on_as_another_one() -> None:
    """A cell 1.25 times as stiff bends as far at pressures 1.25 times as large."""
    longer = prolonged(BENDS[:11] * (1.25, 1.0), BENDS)
    np.testing.assert_allclose(longer, BENDS * (1.25, 1.0))


def test_held_tip_of_an_even_arm_bears_one_and_a_half_moments_over_its_length() -> None:
    held = HeldArm(LONGER, np.array([[0.0, 0.0], [20.0, 10.0], [40.0, 20.0]]))
    np.testing.assert_allclose(held.at(np.array([10.0, 30.0]), 1.0), np.array([7.5, 22.5]) / 65.0)
    np.testing.assert_allclose(held.at(np.array([10.0, 30.0]), 2.0), np.array([7.5, 22.5]) / 65.0)
