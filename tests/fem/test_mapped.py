"""States of a piece on one mesh, at the nodes of another one; and the factor of an earlier iteration, used again."""

from dataclasses import replace

import numpy as np
import pytest

from fem import NeoHooke, StVenantKirchhoff
from fem.cell import piece as pieces
from fem.cell.inflation import inflated
from fem.cell.piece import BendingPiece
from fem.discretisation import Discretisation
from fem.path.control import Control
from fem.path.newton import SHARPER, Converged, NewtonOptions, Start, Watch
from fem.post.mapped import fields_of, mapped, moved
from geometry import PneuNet, SemicircularSingle
from tests.pieces import half_cell

SVK = StVenantKirchhoff(E=1.2, nu=0.495)
RUBBER = NeoHooke(mu=0.2, kappa=20.0)
DESIGN = SemicircularSingle()


@pytest.mark.parametrize(("formulation", "degree"), [("mixed", 2), ("p1", 1)])
def test_fields_of_the_degree_of_the_elements_are_mapped_exactly(formulation: str, degree: int) -> None:
    first, second = (Discretisation.of(half_cell(PneuNet(), size).mesh, formulation) for size in (5.0, 4.0))

    def field(points: np.ndarray) -> np.ndarray:
        x, y, z = points.T
        return np.stack([1.0 + x - 2.0 * y, z + (x * y if degree == 2 else 0.0)], axis=1)

    values = mapped(first.points, first.nodes, field(first.points), second.points)
    np.testing.assert_allclose(values, field(second.points), atol=1e-9)


def test_a_mapped_state_is_near_the_equilibrium_of_a_finer_mesh() -> None:
    coarse, fine = (BendingPiece(half_cell(DESIGN, size), SVK, "mirror", "mixed") for size in (6.0, 4.0))
    known = inflated(coarse, 0.02, -0.02)
    fields = mapped(coarse.space.points, coarse.space.nodes, fields_of(coarse.space, known.state), fine.space.points)
    near = fine.solve_near(0.02, -0.02, moved(fine.system, fine.rest().state, fields, 0.02), fine.rest())
    from_rest = inflated(BendingPiece(fine.body, SVK, "mirror", "mixed"), 0.02, -0.02)
    assert near.moment == pytest.approx(from_rest.moment, rel=1e-6)
    assert near.factorizations <= from_rest.factorizations


def test_softer_elements_begin_with_the_volume_of_mixed_ones() -> None:
    mixed, soft = (BendingPiece(half_cell(PneuNet(), 5.0), RUBBER, "mirror", kind) for kind in ("mixed", "p2p0"))
    known = inflated(mixed, 0.016, -0.06)
    start = moved(soft.system, soft.rest().state, fields_of(mixed.space, known.state), 0.016)
    wanted = known.state.pressure[mixed.space.vertices] * RUBBER.shear_modulus / RUBBER.volumetric_modulus
    change = RUBBER.dilatation(start.strain).value - wanted @ soft.space.vertex_shape.T
    assert np.abs(change).mean() < 0.1 * np.abs(wanted).mean()
    near = soft.solve_near(0.016, -0.06, start, soft.rest())
    from_rest = inflated(soft, 0.016, -0.06)
    assert near.moment == pytest.approx(from_rest.moment, rel=1e-6)
    assert near.factorizations <= from_rest.factorizations


def test_a_factor_that_is_used_again_gives_the_same_equilibrium(monkeypatch: pytest.MonkeyPatch) -> None:
    body, found = half_cell(DESIGN, 5.0), []
    for reuses in (True, False):
        monkeypatch.setattr(pieces, "OPTIONS", replace(pieces.OPTIONS, reuses=reuses))
        found.append(inflated(BendingPiece(body, SVK, "mirror", "mixed"), 0.02, -0.02))
    again, anew = found
    assert again.factorizations < anew.factorizations
    assert again.moment == pytest.approx(anew.moment, rel=1e-6)


def test_an_equilibrium_within_the_tolerance_is_taken_at_the_last_iteration(monkeypatch: pytest.MonkeyPatch) -> None:
    """An earlier factor has led to it, so that one more iteration would be asked for if there was one left."""
    piece, residuals, newton = BendingPiece(half_cell(DESIGN, 5.0), SVK, "mirror", "mixed"), list[float](), pieces.solve

    def watched(start: Start, control: Control, options: NewtonOptions, _: Watch) -> Converged:
        return newton(start, control, options, lambda _, relative: residuals.append(relative))

    monkeypatch.setattr(pieces, "solve", watched)

    def attempt() -> float:
        return piece.solve_near(0.03, -0.03, piece.rest().state, piece.rest()).moment

    moment, tolerance = attempt(), pieces.OPTIONS.tolerance
    assert SHARPER * tolerance < residuals[-2] < tolerance
    monkeypatch.setattr(pieces, "PREDICTED_ITERATIONS", len(residuals) - 2)
    assert attempt() == pytest.approx(moment, rel=1e-5)
