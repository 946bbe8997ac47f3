"""Walls of a cavity that meet within a cell: the divider of a bisected circle on the round wall of the other cavity."""

from pathlib import Path

import numpy as np
import pytest

from fem import Discretisation
from fem.effects.contact import crossings
from pipeline.config.load import load_config
from pipeline.law.piece.measure import CellPoint, cell_without_moment
from pipeline.law.piece.pieces import ArmPieces
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from pipeline.values.pressure import in_MPa

#: design 33 of `make unseen SEED=59 N=60`, on a coarser mesh
DESIGN = """
name: bisected
geometry: {family: bisected_circle, length: 70.4 mm, radius: 6.55 mm, end_wall: 2.31 mm, wall: 1.19 mm,
           divider: 1.28 mm}
material: {law: mooney_rivlin, c10: 18.2 kPa, c01: 4.54 kPa, nu: 0.4984}
pressures: [4.95 kPa, 9.9 kPa]
mesh: {size: 3.5 mm}
"""


@pytest.fixture(scope="module")
def design(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bisected") / "bisected.yaml"
    path.write_text(DESIGN, encoding="utf-8")
    return path


def measure(design: Path, pressure_kPa: float, contact: str) -> tuple[CellPoint, bool]:
    """The cell without moment, and whether walls of the lower cavity pass through each other, by exact tests."""
    cell = ArmPieces(load_config(design, [f"effects.self_contact={contact}"]), None).cell
    point = cell_without_moment(cell, in_MPa(pressure_kPa))
    x = cell.space.points + point.state.state.displacement
    edges, _ = crossings(x, cell.space.surface("cavity_lower").triangles)
    return point, len(edges) > 0


def test_the_divider_stops_at_the_round_wall(design: Path) -> None:
    touching, crosses = measure(design, 9.9, "auto")
    assert touching.state.touches
    assert touching.state.gap > 0.0
    assert not crosses
    free, crosses = measure(design, 9.9, "off")
    assert crosses
    assert abs(touching.slopes.moment_by_angle / free.slopes.moment_by_angle - 1.0) > 0.03


def test_contact_does_nothing_before_walls_meet(design: Path) -> None:
    (apart, _), (free, _) = (measure(design, 4.95, contact) for contact in ("auto", "off"))
    assert not apart.state.touches
    assert apart.state.angle == pytest.approx(free.state.angle, rel=1e-9)


@pytest.mark.slow
def test_the_arm_is_as_wide_as_the_touching_cell(design: Path, tmp_path: Path) -> None:
    """Half the width of the plane in the middle of the arm, whose finite elements have contact too, in mm; without
    contact the cell is 3 % wider."""
    config = load_config(design)
    scene, pieces = Scene.meshed(config), ArmPieces(config, None)
    with open_store(tmp_path, config) as store:
        outcomes = simulate(scene, RunContext.alone(store, Silent()), ("II",))
    rest = Discretisation.of(scene.body.mesh, config.mesh.formulation).points
    planes = pieces.repetition.middle + 2.0 * pieces.repetition.half_pitch * np.arange(20)
    plane = planes[np.argmin(np.abs(planes - config.design.length / 2.0))]
    arm = (rest + outcomes["II"].records[-1].displacement)[np.abs(rest[:, 0] - plane) < 1e-6, 2].max()
    (touching, _), (free, _) = (measure(design, 9.9, contact) for contact in ("auto", "off"))
    cell = pieces.cell.space
    width, too_wide = (
        (cell.points + point.state.state.displacement)[cell.surface("clamp").unique_nodes, 2].max()
        for point in (touching, free)
    )
    assert width == pytest.approx(arm, rel=2e-3)
    assert too_wide > 1.02 * arm
