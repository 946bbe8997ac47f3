"""The arm's own law of a body from a STEP file, against that of the family that draws the same body; with a layer."""

from pathlib import Path

import numpy as np
import pytest

from fem.effects.barrier import FacingTerm
from geometry import PneuNet
from pipeline.config.load import load_config
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.piece.pieces import ArmPieces
from pipeline.simulate.scene import Scene
from pipeline.values.errors import InputError
from tests.step_bodies import pneunet_as_step

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent / "configs"
NET = PneuNet(chambers=3)
DHAT = 0.04
#: pressures at which neighbouring chambers press on each other, kPa
PRESSURE = 30.0

OWN = """
name: own
geometry: {family: own, file: net.step, clamp: 0 mm, tip: 32 mm, curve: 1 mm, air: {cavity: [6 mm, 4 mm, 0 mm]},
           cell: {from: 16 mm, to: 21 mm}}
material: {law: svk, E: 1.2 MPa, nu: 0.495}
pressures: [30 kPa]
mesh: {size: 4 mm, formulation: p2p0}
effects: {self_contact: {faces: [outer], dhat: 0.04 mm}}
"""


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("own")
    pneunet_as_step(folder / "net.step", NET)
    (folder / "own.yaml").write_text(OWN, encoding="utf-8")
    return folder / "own.yaml"


def test_a_step_body_has_the_law_of_the_family_that_draws_it(own: Path) -> None:
    """Within 1 % of kappa_0 and 3 % of the moment that straightens the cell, the error of the mesh."""
    family = load_config(CONFIGS / "pneunet_coarse.yaml", ["geometry.chambers=3"])
    points, moments = [], []
    for config in (load_config(own), family):
        piece = ArmPieces(config, DHAT).cell
        points.append(cell_without_moment(piece, PRESSURE / 1000.0))
        assert points[-1].state.touches
        moments.append(piece.solve(PRESSURE / 1000.0, 0.0, points[-1].state).moment)
    ours, theirs = points
    assert ours.state.angle == pytest.approx(theirs.state.angle, rel=0.01)
    assert ours.axis.stretch == pytest.approx(theirs.axis.stretch, abs=1e-3)
    assert moments[0] == pytest.approx(moments[1], rel=0.03)


def test_contact_of_the_pieces_without_naming_their_walls(own: Path) -> None:
    named = ArmPieces.of(Scene.meshed(load_config(own)))
    found = ArmPieces.of(Scene.meshed(load_config(own, ["effects.self_contact=auto"])))
    assert found.outer == "outer"
    assert found.dhat == pytest.approx(named.dhat) == pytest.approx(DHAT)
    gaps = [
        [term.gap(pieces.cell.space.points) for term in pieces.cell.terms if isinstance(term, FacingTerm)]
        for pieces in (named, found)
    ]
    assert gaps[0] == gaps[1]
    assert gaps[0][:2] == [pytest.approx(1.0), np.inf]  # of the plane between two cells, of walls of the half cell


def test_planes_are_recorded_and_refused_with_the_key(own: Path) -> None:
    geometry = load_config(own).record()["geometry"]
    assert geometry["cell"] == {"from": 16.0, "to": 21.0}
    for value, sentence in (
        ("{from: 16 mm}", "write two planes, for example {from: 40 mm, to: 44 mm}"),
        ("{from: 16 mm, to: 80 mm}", "geometry.cell.to: x = 80 mm lies outside the arm"),
        ("{from: 15 mm, to: 21 mm}", "geometry.cell: the body is not symmetric about the plane x = 15 mm"),
        ("{from: 16 mm, to: 21 kPa}", "geometry.cell"),
    ):
        with pytest.raises(InputError) as refused:
            load_config(own, [f"geometry.cell={value}"])
        assert sentence in str(refused.value)
        assert "\n" not in str(refused.value)


def test_a_strain_limiting_layer_acts_in_the_cell() -> None:
    """It hardly stretches: the axis keeps its length, and the finger bends more; it adds its stiffness E t w to EA."""
    values = {}
    for state in ("on", "off"):
        config = load_config(CONFIGS / "finger.yaml", ["mesh.size=6 mm", f"effects.strain_limiting_layer={state}"])
        values[state] = cell_without_moment(ArmPieces(config, None).cell, 0.004)
    stretched = values["off"].axis.stretch - 1.0
    assert abs(values["on"].axis.stretch - 1.0) < 0.1 * stretched
    assert values["on"].state.angle < 1.5 * values["off"].state.angle < 0.0
    layer = config.effects.strain_limiting_layer
    rigidities = [4.0 / values[state].slopes.distance_by_force for state in ("on", "off")]
    assert rigidities[0] - rigidities[1] == pytest.approx(layer.E_MPa * layer.thickness_mm * 16.0, rel=0.02)
