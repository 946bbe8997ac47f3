"""States of an arm that is turned to itself: a state and its image, and how many are solved."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest

from geometry import GRADINGS
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.law.in_space.images import Images, Turns
from pipeline.law.in_space.states import CellState, EndState, across_state, cell_state, clamped_state
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.tasks import PieceCurves
from pipeline.simulate.scene import Scene
from pipeline.store.parallel import Pending
from pipeline.store.progress import Silent
from pipeline.store.store import Store, open_store
from tests.step_bodies import save

LENGTH, RADIUS, BORE, AWAY, END = 24.0, 6.0, 1.5, 3.4, 4.0
ANGLES = np.pi * np.array([1 / 2, 7 / 6, 11 / 6])  # from y to z
CONFIG = """
name: round
geometry:
  family: own
  file: round.step
  symmetric: false
  curve: 0 mm
  cell: {from: 10 mm, to: 12 mm}
  air: {c: [12 mm, 2.944 mm, -1.7 mm], a: [12 mm, 0 mm, 3.4 mm], b: [12 mm, -2.944 mm, -1.7 mm]}
material: {law: neo_hooke, mu: 0.1 MPa, nu: 0.49}
pressures: [12 kPa]
mesh: {size: 4 mm, formulation: p2p0, grading: off}
"""
PRESSURES, CURVATURE = (12.0, 0.0, 4.0), (0.004, 0.003)


def write_arm(folder: Path, moved: float = 0.0) -> Config:
    """A round arm with three holes around its axis; the first one may be moved outwards, mm."""
    away = AWAY + np.array([moved, 0.0, 0.0])
    places = np.column_stack([away * np.cos(ANGLES), away * np.sin(ANGLES)]).tolist()

    def draw(occ: Any) -> None:
        body = occ.addCylinder(0, 0, 0, LENGTH, 0, 0, RADIUS)
        occ.cut([(3, body)], [(3, occ.addCylinder(END, y, z, LENGTH - 2 * END, 0, 0, BORE)) for y, z in places])

    save(folder / "round.step", draw)
    (folder / "round.yaml").write_text(CONFIG, encoding="utf-8")
    return load_config(folder / "round.yaml")


@pytest.fixture(scope="module")
def pieces(tmp_path_factory: pytest.TempPathFactory) -> ArmPieces:
    return ArmPieces.of(Scene.meshed(write_arm(tmp_path_factory.mktemp("round"))))


@pytest.fixture(scope="module")
def turns(pieces: ArmPieces) -> Turns:
    return Turns.of(list(pieces.design.cavities), pieces.repetition.turned)


@pytest.fixture(scope="module")
def store(pieces: ArmPieces, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with open_store(tmp_path_factory.mktemp("states") / "out", pieces.config) as opened:
        yield opened


@pytest.fixture(scope="module")
def curves(pieces: ArmPieces, store: Store) -> PieceCurves:
    return PieceCurves(pieces, store, Silent())


def test_each_cavity_comes_to_the_place_of_the_next(pieces: ArmPieces, turns: Turns) -> None:
    """From y to z by 120 degrees: a hole above the axis in z comes to y < 0, that one to y > 0."""
    order = pieces.repetition.turned
    assert "".join((*order, *order)).count("abc") == 1
    by_name = dict(zip(pieces.design.cavities, turns.pressures(PRESSURES, 1), strict=True))
    before = dict(zip(pieces.design.cavities, PRESSURES, strict=True))
    assert [by_name[name] for name in "bca"] == [before[name] for name in "abc"]


def test_an_arm_with_one_hole_beside_its_place_is_not_turned(tmp_path: Path) -> None:
    design = write_arm(tmp_path, moved=0.05).design
    assert design.repetition(4.0, GRADINGS["off"]).turned == ()


@pytest.mark.parametrize("task", [cell_state, pytest.param(clamped_state, marks=pytest.mark.slow)])
def test_the_image_of_a_state_is_the_state_of_the_image(
    task: Callable[..., CellState | EndState], curves: PieceCurves, turns: Turns
) -> None:
    """To what the mesh, which is not turned with the arm, makes of it."""
    image = turns.state(task(curves, PRESSURES, CURVATURE), 1)
    solved = task(curves, turns.pressures(PRESSURES, 1), turns.across(CURVATURE, 1))
    assert image.pressures == solved.pressures
    names = ("vector", "beside") if isinstance(image, CellState) else ("moment", "turn", "place")
    for name in ("volume", *names):
        there, here = np.array(getattr(solved, name)), np.array(getattr(image, name))
        rounding = 2e-3 if name == "beside" else 0.0  # mm, of a place that is nearly on the axis
        assert np.linalg.norm(here - there) < 0.03 * np.linalg.norm(there) + rounding, name


def test_the_image_of_a_compliance_is_that_of_the_image(curves: PieceCurves, turns: Turns) -> None:
    image = np.array(turns.state(across_state(curves, PRESSURES), 1))
    solved = np.array(across_state(curves, turns.pressures(PRESSURES, 1)))
    assert np.abs(image - solved)[[0, 3, 5]] == pytest.approx(0.0, abs=0.03 * solved.max())


def test_three_turns_bring_a_state_back(curves: PieceCurves, turns: Turns) -> None:
    state = cell_state(curves, PRESSURES, CURVATURE)
    back = turns.state(turns.state(state, 1), 2)
    assert back.pressures == state.pressures
    assert back.vector == pytest.approx(state.vector)
    assert back.volume == state.volume


def test_of_images_one_is_solved(turns: Turns) -> None:
    tasks = MagicMock()
    tasks.submit.side_effect = lambda task, *given: Pending.done(task(*given))
    images = Images(tasks, turns)

    def task(pressures: Any, curvature: Any) -> CellState:
        return CellState(
            pressures, curvature, (0.0, 1.0), (1.0, 0.0), *[(0.0, 0.0)] * 3, *[1.0] * 4, (0.0, 0.0), pressures
        )

    wanted = images.around(PRESSURES, [CURVATURE, (0.0, 0.0)])
    assert len(wanted) == 6
    for pressures, curvature in wanted:
        state = images.submit(task, pressures, curvature).result()
        assert state.pressures == pytest.approx(pressures)
        assert state.curvature == pytest.approx(curvature)
        assert state.volume == pytest.approx(pressures)
    assert tasks.submit.call_count == 2
    assert images.distinct([pressures for pressures, _ in wanted]) == [PRESSURES]
    for times in range(3):  # under equal pressures the arm is the same after a turn
        curvature = turns.across(CURVATURE, times)
        assert images.submit(task, (8.0, 8.0, 8.0), curvature).result().curvature == pytest.approx(curvature)
    assert tasks.submit.call_count == 3
