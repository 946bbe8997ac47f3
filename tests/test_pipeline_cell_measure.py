"""The arm's own law from a half cell and two ends, against finite elements of a whole arm on the same kind of mesh."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest

import fem
from fem.cell.piece import BendingPiece, PieceFailed
from geometry import GRADINGS, PneuNet
from pipeline.cell.measure import Reach, sweep_cell
from pipeline.cell.measure_ends import clamp_curve, tip_curve
from rod.arm_law.curves import CellCurve, ClampCurve
from rod.arm_law.law import ArmLaw

DESIGN = PneuNet(chambers=5)
SIZE, DHAT, PRESSURE = 5.0, 0.04, 20.0
RUBBER = fem.StVenantKirchhoff(E=1.2, nu=0.495)


@dataclass(frozen=True)
class Measured:
    """A cell and two ends at one pressure."""

    force: float  #: N, for which the law is made

    @cached_property
    def cell(self) -> CellCurve:
        piece = BendingPiece(DESIGN.half_cell(SIZE), RUBBER, "mirror", dhat=DHAT)
        sweep = sweep_cell(piece, PRESSURE, Reach(DESIGN.length, self.force))
        assert sweep.limits == []
        assert sweep.error < 1e-3
        return sweep.curve(piece.body.length)

    @cached_property
    def clamp(self) -> ClampCurve:
        curve, limits = clamp_curve(self._end("clamp"), self.cell)
        assert limits == []
        return curve

    @cached_property
    def law(self) -> ArmLaw:
        free, held = (tip_curve(self._end(start), self.cell) for start in ("free", "held"))
        middle = DESIGN.repetition(SIZE, GRADINGS["off"]).middle
        return ArmLaw(DESIGN.pitch, middle, DESIGN.length, (self.cell,), (self.clamp,), (free,), (held,))

    def _end(self, start: str) -> BendingPiece:
        return BendingPiece(DESIGN.end_piece(1, SIZE), RUBBER, start, dhat=DHAT)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def measured() -> Measured:
    return Measured(0.1)


@pytest.mark.parametrize(("name", "end_y", "force"), [("II", 0.0, 0.0), ("III", 0.0, 0.0), ("dead", 0.0, -0.08)])
def test_the_rod_agrees_with_finite_elements_of_the_whole_arm(
    measured: Measured, name: str, end_y: float, force: float
) -> None:
    experiment = fem.Experiment.of(name, DESIGN.body(SIZE), end_y, (0.0, force))
    effects = [fem.Pressure("cavity", PRESSURE / 1000.0), fem.SelfContact("gap", DHAT, starts_inactive=False)]
    step = fem.follow(experiment.model(RUBBER, effects, "p2p0"), [1.0]).steps[-1]
    curve = experiment.centreline(step)
    rod = measured.law.at(PRESSURE)
    solution = rod.solve(end_y=end_y) if name == "III" else rod.solve((0.0, force))
    distance = solution.positions(curve.s) + np.array([0.0, DESIGN.curve_y]) - np.stack([curve.x, curve.y], axis=1)
    assert np.linalg.norm(distance, axis=1).max() < 3e-3 * DESIGN.length
    if name == "III":  # the arm is short: the law does not know that the couple of the support depends on its force
        assert solution.force[1] == pytest.approx(experiment.end_force(step)[1], rel=1e-2)


def test_slopes_of_the_clamped_end_are_those_of_its_curve(measured: Measured) -> None:
    """Between two states the mean of the slopes is the difference quotient, but for the curvature of the curve."""
    clamp = measured.clamp
    steps = np.diff(clamp.moment)
    for name in ("rotation", "offset"):
        values = getattr(clamp, name).reshape(len(clamp.moment), -1)
        slopes = getattr(clamp, f"{name}_by_moment").reshape(len(clamp.moment), -1)
        quotient = np.diff(values, axis=0) / steps[:, None]
        mean = (slopes[1:] + slopes[:-1]) / 2.0
        bound = 0.75 * np.abs(np.diff(slopes, axis=0)) + 0.02 * np.abs(slopes).max(axis=0)
        assert np.mean(np.abs(quotient - mean) <= bound) > 0.9


def test_the_curves_of_a_cell_rise_and_name_their_contact(measured: Measured) -> None:
    cell = measured.cell
    assert np.all(np.diff(cell.moment) > 0.0)
    assert np.all(np.diff(cell.kappa) > 0.0)
    assert cell.contact.any()
    assert not cell.contact.all()


def test_a_pressure_that_the_cell_does_not_bear_is_named() -> None:
    piece = BendingPiece(DESIGN.half_cell(SIZE), RUBBER, "mirror", dhat=DHAT)
    with pytest.raises(PieceFailed, match=r"half cell at .* kPa"):
        sweep_cell(piece, 2000.0, Reach(DESIGN.length, 0.1))
