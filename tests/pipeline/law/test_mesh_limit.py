"""A law that is moved to the limit of its mesh."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.law.mesh_limit import Corrections, corrected
from pipeline.results.files import read_plane_law
from rod.arm_law.curves import CellCurve, ClampCurve
from tests.coarse import COARSE

LAW = read_plane_law(COARSE / "law.json")
SOME = Corrections(np.array([0.0, 17.0, 37.0]), np.array([0.0, 2e-4, 5e-4]), np.array([1.0, 1.02, 1.05]))


def test_the_limit_is_reached_where_it_is_known() -> None:
    moved = corrected(LAW, SOME)
    for before, after in zip(LAW.cells, moved.cells, strict=True):
        move = SOME.at(before.pressure)
        shift, ratio = move.shift, move.ratio
        assert after.at(0.0)[0] == pytest.approx(before.at(0.0)[0] + shift, abs=1e-12)
        assert after.at(ratio * 0.5)[0] - after.at(0.0)[0] == pytest.approx(before.at(0.5)[0] - before.at(0.0)[0])
        assert after.at(ratio * 0.5)[1] == pytest.approx(before.at(0.5)[1])


def test_slopes_by_the_pressure_are_those_of_the_moved_law() -> None:
    """A law of which every curve is the same has only the slopes of the correction."""
    step, cell, clamp = 1e-3, LAW.cells[-1], LAW.clamps[-1]
    still = cell.moment_by_pressure * 0.0
    fixed = replace(cell, moment_by_pressure=still, stretch_by_pressure=still)
    turned = replace(clamp, rotation_by_pressure=clamp.rotation_by_pressure * 0.0)

    def at(pressure: float) -> tuple[CellCurve, ClampCurve]:
        cells, clamps, tips = ((replace(one, pressure=pressure),) for one in (fixed, turned, LAW.tips[-1]))
        moved = corrected(replace(LAW, cells=cells, clamps=clamps, tips=tips), SOME)
        return moved.cells[0], moved.clamps[0]

    (low, low_clamp), (middle, middle_clamp), (high, high_clamp) = (at(25.0 + k * step) for k in (-1, 0, 1))
    moment = float(middle.moment[4])
    turning = (high.at(moment)[0] - low.at(moment)[0]) / (2.0 * step)  # at fixed moment
    expected = -middle.moment_by_pressure[4] / middle.rigidity[4]
    assert turning == pytest.approx(expected, rel=1e-4)
    held = float(middle_clamp.moment[1])
    turning = (high_clamp.at(held)[0] - low_clamp.at(held)[0]) / (2.0 * step)
    assert turning == pytest.approx(middle_clamp.rotation_by_pressure[1], rel=1e-4)
