"""Derivatives of a half cell by its design, against central differences of solved half cells."""

from dataclasses import replace

import numpy as np
import pytest

from fem import Hencky, Hoops, StrainLimitingLayer, StVenantKirchhoff, faces_along
from fem.cell.axis import axis_of, length_of
from fem.cell.design_change import DesignChange, design_rates
from fem.cell.inflation import inflated
from fem.cell.lateral import lateral_rates, lateral_rigidities
from fem.cell.piece import BendingPiece
from fem.cell.response import slopes
from fem.effects.membrane import LayerTerm
from fem.materials.regions import Solid
from geometry.families import BisectedCircle, PneuNet, Semicircular, SemicircularSingle
from geometry.families.design import SymmetricDesign
from geometry.grading import OFF
from geometry.meshing.mirror import Repetition
from pipeline.law.piece.measure import CellPoint, cell_without_moment
from tests.quotients import quotient

pytestmark = pytest.mark.usefixtures("solved_tightly")

SVK = StVenantKirchhoff(E=1.2, nu=0.495)
#: mm, of a dimension in differences of solved cells
STEP = 1e-3
#: part to which logarithms of B_2 and GJ are known, which are differences of forces themselves: over other starts of
#: Newton's method and on other processors they scatter by up to 4e-10 of themselves
KNOWN_ACROSS = 5e-10
#: a design, its elements, activation distance of contact (mm), pressure (MPa), curvature (1/mm), and dimensions; those
#: of the first case are drawn, and its walls do not touch; they do in the second
CASES = {
    "pneunet": (PneuNet(), "p2p0", None, 0.017, -0.004, ("width", "gap", "wall", "base")),
    "contact": (PneuNet(), "mixed", 0.04, 0.024, -0.004, ("gap", "wall", "chamber_length")),
    "fillet": (PneuNet(fillet=0.7), "p2p0", None, 0.017, -0.004, ("fillet",)),
    "semicircular": (Semicircular(), "mixed", None, 0.02, -0.004, ("radius", "wall", "partition", "channel")),
    "single": (SemicircularSingle(), "p2", None, 0.02, -0.004, ("wall", "base")),
    "bisected": (BisectedCircle(), "mixed", None, 0.02, -0.004, ("radius", "divider")),
}


def _piece(
    design: SymmetricDesign, pieces: Repetition, elements: str, dhat: float | None, solid: Solid
) -> BendingPiece:
    body = design._body(pieces.half_cell(), pieces.half_pitch, pieces.half)
    return BendingPiece(body, solid, "mirror", elements, None, dhat)


def _solved(piece: BendingPiece, pressure: float, angle: float) -> np.ndarray:  # type: ignore[type-arg]
    """Moment, length of the axis, and logarithms of B_2 and GJ."""
    state = inflated(piece, pressure, angle)
    across = lateral_rigidities(piece, state)
    length = axis_of(piece, state, slopes(piece, state)).stretch * piece.body.length
    return np.array([state.moment, length, np.log(across.bending), np.log(across.torsion)])


def _rate(piece: BendingPiece, pressure: float, angle: float, change: DesignChange) -> np.ndarray:  # type: ignore[type-arg]
    piece.changes = {"it": replace(change, length=0.0)}  # at this angle
    state = inflated(piece, pressure, angle)
    known = slopes(piece, state)
    rates = design_rates(piece, state, known, piece.changes, stretch=True)
    across, rate = lateral_rates(piece, state, known, piece.changes, rates)["it"], rates["it"]
    length = length_of(angle, float(rate.end[0]), rate.start + float(rate.end[1]))
    return np.array([rate.moment, length, *across])


@pytest.mark.parametrize("case", CASES)
def test_by_dimensions(case: str) -> None:
    """The largest difference, of a wall and a gap of 1 mm, is what is left of the differences of solved cells."""
    design, elements, dhat, pressure, kappa, names = CASES[case]
    pieces = design.repetition(4.0, OFF)
    piece, movements = _piece(design, pieces, elements, dhat, SVK), design.movements(pieces)
    angle = kappa * piece.body.length
    assert inflated(piece, pressure, angle).touches == (case == "contact")
    for name in names:
        movement = movements[name]
        velocity = piece.space.positions_on(movement.moved(pieces, STEP).half_cell()) - piece.space.points
        change = DesignChange.of_dimension(piece, velocity / STEP, movement.edge - movement.middle)
        less, more = (
            _solved(
                _piece(
                    design.with_dimension(name, design.dimensions[name] + step),
                    movement.moved(pieces, step),
                    elements,
                    dhat,
                    SVK,
                ),
                pressure,
                angle,
            )
            for step in (-STEP, STEP)
        )
        found = _rate(piece, pressure, angle, change)
        assert found[:2] == quotient(more[:2], less[:2], 2.0 * STEP).within(rel=1e-4, abs=2e-6)
        # the derivative is a difference too, over 5e-5 mm of two logarithms of 8 at most
        expected = quotient(more[2:], less[2:], 2.0 * STEP, KNOWN_ACROSS)
        assert found[2:] == expected.within(rel=1e-3, abs=3e-4)


@pytest.mark.parametrize("name", ["E", "nu"])
def test_by_constants_of_the_material_with_contact(name: str) -> None:
    """Rigidities out of the plane change by a difference to one side, which is extrapolated from two of its steps."""
    design, law = PneuNet(), Hencky(E=1.2, nu=0.49)
    pieces = design.repetition(4.0, OFF)
    piece = _piece(design, pieces, "mixed", 0.04, law)
    angle, step = -0.004 * piece.body.length, 1e-3

    def changed(by: float) -> Hencky:
        return replace(law, **{name: getattr(law, name) + by})

    def rate(by: float) -> np.ndarray:  # type: ignore[type-arg]
        return _rate(piece, 0.024, angle, DesignChange.of_material(piece, changed(-by), changed(by), 2.0 * by))

    less, more = (_solved(_piece(design, pieces, "mixed", 0.04, changed(by)), 0.024, angle) for by in (-step, step))
    assert inflated(piece, 0.024, angle).touches
    assert rate(1e-5)[:2] == quotient(more[:2], less[:2], 2.0 * step).within(rel=1e-5)
    across = (2.0 * rate(3e-4) - rate(6e-4))[2:]
    # 8 times the uncertainty of a logarithm of 7 over 3e-4, and as much of third derivatives
    expected = quotient(more[2:], less[2:], 2.0 * step, KNOWN_ACROSS)
    assert across == expected.within(rel=2e-4, abs=1e-4)


def test_rigidities_out_of_the_plane_scale_with_the_modulus_at_pressures_that_scale() -> None:
    """B(p; c E) = c B(p/c; E), and the same of GJ: no change of the material is needed."""
    design, pressure, step, side, E = PneuNet(), 0.024, 1e-4, 3e-4, 1.2
    pieces = design.repetition(4.0, OFF)
    piece = _piece(design, pieces, "mixed", 0.04, Hencky(E=E, nu=0.49))
    angle = -0.004 * piece.body.length
    less, more = (_solved(piece, pressure + sign * step, angle)[2:] for sign in (-1.0, 1.0))
    by_pressure = quotient(more, less, 2.0 * step, KNOWN_ACROSS)
    solids = [Hencky(E=E + sign * side, nu=0.49) for sign in (-1.0, 1.0)]
    found = _rate(piece, pressure, angle, DesignChange.of_material(piece, *solids, 2.0 * side))[2:]
    # a difference to one side: half of it times a second derivative of 1/E^2, and 2e-5 of the digits
    tolerance = side / 2.0 / E**2 + 2e-5
    assert by_pressure.noise * pressure / E < 0.1 * tolerance
    assert found == pytest.approx((1.0 - pressure * by_pressure.value) / E, abs=tolerance)


def test_a_layer_follows_the_body() -> None:
    """A membrane of paper in a wider body is a wider membrane."""

    def made(design: PneuNet, pieces: Repetition) -> BendingPiece:
        body = design._body(pieces.half_cell(), pieces.half_pitch, pieces.half)
        layer = StrainLimitingLayer(body.mesh.plane(1, design.curve_y), 0.1, 1000.0, 0.2)
        return BendingPiece(body, SVK, "mirror", "p2p0", effects=[layer])

    design = PneuNet()
    pieces = design.repetition(4.0, OFF)
    movement = design.movements(pieces)["width"]
    piece = made(design, pieces)
    velocity = piece.space.positions_on(movement.moved(pieces, STEP).half_cell()) - piece.space.points
    change = DesignChange.of_dimension(piece, velocity / STEP, 0.0)
    less, more = (
        _solved(made(design.with_dimension("width", 15.0 + step), movement.moved(pieces, step)), 0.017, -0.02)
        for step in (-STEP, STEP)
    )
    found = _rate(piece, 0.017, -0.02, change)
    assert found[:2] == quotient(more[:2], less[:2], 2.0 * STEP).within(rel=1e-5, abs=2e-6)
    assert found[2:] == quotient(more[2:], less[2:], 2.0 * STEP, KNOWN_ACROSS).within(rel=1e-4, abs=3e-4)


@pytest.mark.parametrize("name", ["radius", "E", "thickness"])
def test_a_wound_body(name: str) -> None:
    """Hoops and a glued sheet follow round walls; their constants change a state as another dimension does."""
    design = Semicircular()

    def made(design: Semicircular, pieces: Repetition, **changed: float) -> BendingPiece:
        body = design._body(pieces.half_cell(), pieces.half_pitch, pieces.half)
        bottom = body.mesh.plane(1, float(body.mesh.points[:, 1].min()))
        around = Hoops(faces_along(body.mesh.points, body.mesh.faces["outer"]), 0.1, 20.0, 0.1)
        sheet = StrainLimitingLayer(bottom, 0.2, 100.0, 0.2)
        layers = [
            replace(layer, **{key: getattr(layer, key) + by for key, by in changed.items()})
            for layer in (around, sheet)
        ]
        return BendingPiece(body, SVK, "mirror", "p2p0", effects=layers)

    def steps(piece: BendingPiece, by: float) -> list[DesignChange]:
        """Of both layers."""
        layers = [term.sheet for term in piece.terms if isinstance(term, LayerTerm)]
        pairs = [[replace(one, **{name: getattr(one, name) + sign * by}) for sign in (-1, 1)] for one in layers]
        return [DesignChange.of_layer(piece, less, more, 2.0 * by) for less, more in pairs]

    pieces = design.repetition(6.0, OFF)
    piece, movement, step = made(design, pieces), design.movements(pieces)["radius"], {"E": 0.1}.get(name, STEP)
    if name == "radius":
        velocity = piece.space.positions_on(movement.moved(pieces, STEP).half_cell()) - piece.space.points
        changes = [DesignChange.of_dimension(piece, velocity / STEP, 0.0)]
        ends = [made(design.with_dimension(name, 7.5 + by), movement.moved(pieces, by)) for by in (-step, step)]
    else:
        changes = steps(piece, 1e-3 * step)
        ends = [made(design, pieces, **{name: by}) for by in (-step, step)]
    less, more = (_solved(end, 0.017, -0.02) for end in ends)
    found = np.sum([_rate(piece, 0.017, -0.02, change) for change in changes], axis=0)
    assert found[:2] == quotient(more[:2], less[:2], 2.0 * step).within(rel=1e-4, abs=2e-6)
    assert found[2:] == quotient(more[2:], less[2:], 2.0 * step, KNOWN_ACROSS).within(rel=2e-3, abs=3e-4)


@pytest.mark.parametrize("name", ["wall", "chamber_length"])
def test_largest_stretch_without_moment(name: str) -> None:
    """The cell turns with the dimension, so that it stays without moment."""
    design = PneuNet()
    pieces = design.repetition(4.0, OFF)
    movement = design.movements(pieces)[name]

    def solved(step: float) -> tuple[BendingPiece, CellPoint]:
        changed = design.with_dimension(name, design.dimensions[name] + step)
        piece = _piece(changed, movement.moved(pieces, step), "mixed", 0.04, SVK)
        return piece, cell_without_moment(piece, 0.02)

    piece, point = solved(0.0)
    velocity = piece.space.positions_on(movement.moved(pieces, STEP).half_cell()) - piece.space.points
    change = DesignChange.of_dimension(piece, velocity / STEP, movement.edge - movement.middle)
    less, more = (solved(step)[1].state.extremes.max_stretch for step in (-STEP, STEP))
    rate = design_rates(piece, point.state, point.slopes, {name: change}, stretch=True)[name]
    assert rate.largest_stretch == quotient(more, less, 2.0 * STEP).within(rel=1e-3)
