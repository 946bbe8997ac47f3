"""The file of a wish: what is read, and what is refused with its key."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.study.wishes.step import check_feasible
from pipeline.study.wishes.wish import rounded
from tests.pipeline.study.wishes.test_measured import SMALL, small


def test_a_file_is_complete_values(tmp_path: Path) -> None:
    file = small(tmp_path)
    wishes = file.wishes
    assert wishes.dimensions == ("geometry.wall", "geometry.base")
    assert wishes.start.tolist() == [1.0, 2.0, 22.5]  # of the base, and the middle of a pressure
    assert wishes.pressures_kPa(wishes.start) == (20.0, 22.5)
    assert [len(part) for part in wishes.parts(np.arange(6.0))] == [1, 2, 1, 1, 1]
    kappa_0, tip = wishes.wishes[:2]
    assert (kappa_0.target, kappa_0.within) == ((-6e-4,), pytest.approx(1.2e-5))
    found = np.concatenate([wishes.targets[:1], [40.0, -4.0], wishes.targets[3:]])
    assert wishes.misses(found) == pytest.approx([0.0, 2.0, 0.0, 0.0, 0.0])
    assert tip.text(tip.target) == "(40, -2) mm"
    config = file.config(rounded(np.array([1.23456789, 2.0, 25.0])))
    assert config.design.dimensions["wall"] == 1.23457
    assert config.pressures_kPa == (20.0, 25.0)
    assert config.end.y_mm == 0.0
    assert config.name == "small"
    loaded = small(tmp_path, SMALL.replace("0.1 deg}", "0.1 deg, under: {force: [0 N, -0.1 N]}}")).wishes.wishes[2]
    assert loaded.under.force == (0.0, -0.1)
    assert loaded.name == "angle at grip under force [0 N, -0.1 N]"


def test_a_wish_within_the_tolerance_of_another_one_and_wide_limits_are_feasible(tmp_path: Path) -> None:
    check_feasible(small(tmp_path))
    check_feasible(
        small(tmp_path, SMALL.replace("limits:", "  - {kappa_0: -0.62 1/m, at: 20 kPa, within: 2 %}\nlimits:"))
    )
