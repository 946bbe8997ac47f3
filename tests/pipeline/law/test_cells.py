"""The check of the law between two pressures: in which order the cell is bent, and what it finds."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from pipeline.law import cells
from pipeline.law.cells import CHECKS, largest_deviation
from rod.arm_law.curves import CellCurve

EI, HALF_PITCH = 500.0, 5.0


def curve(pressure: float) -> CellCurve:
    """A cell of constant rigidity without curvature at zero moment, at any pressure."""
    kappa = np.linspace(-0.02, 0.02, 9)
    ones = np.ones(len(kappa))
    return CellCurve(
        pressure=pressure,
        moment=EI * kappa,
        kappa=kappa,
        rigidity=EI * ones,
        moment_by_pressure=0 * ones,
        stretch=ones,
        stretch_by_kappa=0 * ones,
        stretch_by_pressure=0 * ones,
        axial_rigidity=60 * ones,
        shear_rigidity=10 * ones,
        contact=np.zeros(len(kappa), dtype=bool),
        min_J=ones,
        s=np.array([0.0, HALF_PITCH]),
        ripple=np.zeros((len(kappa), 2, 2)),
    )


@dataclass
class Cell:
    """A cell that is softer on one side by a moment, and that changes to another branch when it is bent across zero."""

    missing: float = 0.0  #: N mm, where the curvature is negative
    body: SimpleNamespace = field(default_factory=lambda: SimpleNamespace(length=HALF_PITCH))

    def solve(self, pressure: float, angle: float, start: SimpleNamespace) -> SimpleNamespace:
        assert pressure == 0.01
        assert abs(angle) >= abs(start.angle)
        other_branch = start.other_branch or angle * start.angle < -1e-3
        moment = EI * angle / HALF_PITCH + (self.missing if angle < 0 else 0.0) + 5.0 * other_branch
        return SimpleNamespace(angle=angle, moment=moment, other_branch=other_branch)


@pytest.fixture(autouse=True)
def start(monkeypatch: pytest.MonkeyPatch) -> None:
    def inflated(_cell: Cell, _pressure: float, angle: float) -> SimpleNamespace:
        return SimpleNamespace(angle=angle, moment=EI * angle / HALF_PITCH, other_branch=False)

    monkeypatch.setattr(cells, "inflated", inflated)


def test_the_cell_is_bent_to_either_side_from_the_state_of_the_smallest_moment() -> None:
    assert CHECKS >= 5
    assert largest_deviation(Cell(), curve(0.0), curve(20.0)) < 1e-12


def test_a_difference_of_the_moment_is_told_as_one_of_the_curvature() -> None:
    largest = largest_deviation(Cell(missing=0.25), curve(0.0), curve(20.0))
    assert largest == pytest.approx(0.25 / EI, rel=1e-9)
