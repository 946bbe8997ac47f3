"""Claims of the paper that half cells decide, and the rod from three simulations."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.paper.claims import claims
from benchmarks.paper.claims.simulations import between, scaled_by_pressure
from benchmarks.paper.data import Data
from benchmarks.paper.free_lines import TestedCurves
from benchmarks.paper.random_cells import FILE, RandomCell, line_through, measure, read, write
from benchmarks.paper.reading import CONTRADICTED, REPRODUCED
from benchmarks.paper.states import State
from benchmarks.unseen.designs import drawn
from geometry import Centreline
from rod import FiveParameters

CELL = RandomCell(151, 0, "semicircular_single", "svk", 20.0, -0.1, 100.0, 110.0, 0.001)


def test_the_shape_without_load_follows_from_that_of_another_pressure() -> None:
    """A circle of curvature 1/100 at 37 kPa is one of 1/200 at half the pressure."""
    s = np.linspace(0.0, 100.0, 2001)

    def circle(radius: float) -> Centreline:
        return Centreline(s, radius * np.sin(s / radius), radius * (1.0 - np.cos(s / radius)))

    curves = TestedCurves(circle(100.0), circle(100.0), (0.0, 0.0))
    high = State(Path(), {}, 37.0, 10.0, curves, 0.0)
    free = scaled_by_pressure(replace(high, pressure=18.5), high).curves.free
    assert np.hypot(free.x - circle(200.0).x, free.y - circle(200.0).y).max() < 1e-4


def test_numbers_between_two_pressures_lie_on_straight_lines() -> None:
    low, high = FiveParameters(100.0, 200.0, 0.0, 1.0, 6.0), FiveParameters(200.0, 400.0, 2.0, 3.0, 8.0)
    assert between(low, high, 0.25) == FiveParameters(125.0, 250.0, 0.5, 1.5, 6.5)


def test_a_line_through_a_law_and_what_lies_off_it() -> None:
    kappa = np.linspace(-0.01, 0.0, 21)
    assert line_through(kappa, 300.0 * kappa + 2.0) == (pytest.approx(300.0), pytest.approx(0.0, abs=1e-12))
    _, off = line_through(kappa, np.where(kappa < -0.005, 100.0, 300.0) * (kappa + 0.005))
    assert off > 0.1


def test_rows_are_read_as_they_were_written_and_decide_the_claims(tmp_path: Path) -> None:
    cells = [
        replace(CELL, number=k, family=family)
        for family in ("semicircular_single", "bisected_circle")
        for k in range(9)
    ]
    write(tmp_path / FILE, [*cells, replace(CELL, number=99, rigidity_low=float("nan"), reason="no equilibrium")])
    assert read(tmp_path)[:-1] == cells
    assert not read(tmp_path)[-1].is_solved
    assert _verdicts(tmp_path) == (CONTRADICTED, CONTRADICTED)
    (tmp_path / FILE).unlink()
    write(tmp_path / FILE, [replace(cell, rigidity_high=90.0, off_line=0.1) for cell in cells])
    assert _verdicts(tmp_path) == (REPRODUCED, REPRODUCED)


def _verdicts(folder: Path) -> tuple[str, str]:
    found = {claim.number: claim.verdict for claim in claims(Data(folder))}
    return found["8c"], found["12b"]


def test_a_drawn_cell_is_measured(tmp_path: Path) -> None:
    cell = measure(drawn(151, 16)[0], tmp_path)
    assert cell.is_solved
    assert cell.rigidity_high == pytest.approx(126.3, rel=0.02)
    assert cell.off_line < 0.01
