"""Graded meshes: smaller elements at re-entrant edges or thin walls; symmetry, cells and volumes as without grading."""

from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from geometry import GRADINGS, BisectedCircle, Body, Design, PneuNet, Semicircular, SemicircularSingle
from pipeline.config.load import load_config
from tests.bodies import cell_boundaries, inside

DESIGNS = [PneuNet(chambers=4), Semicircular(chambers=4), SemicircularSingle(length=60), BisectedCircle(length=60)]
GRADED = [name for name in GRADINGS if name != "off"]


@pytest.fixture(params=DESIGNS, ids=lambda design: design.family)
def design(request: pytest.FixtureRequest) -> Design:
    return request.param


@pytest.fixture(params=GRADED)
def grading(request: pytest.FixtureRequest) -> str:
    return request.param


@cache
def body_of(design: Design, name: str) -> Body:
    """With elements of 4 mm."""
    return design.body(4, GRADINGS[name])


def size_near(body: Body, position: tuple[float, float, float], radius: float) -> float:
    """Mean length of the edges whose middle is within `radius` of a position, mm."""
    ends = body.mesh.points[body.mesh.edges]
    near = np.linalg.norm(ends.mean(axis=1) - position, axis=1) < radius
    assert near.sum() > 3
    return float(np.linalg.norm(ends[near, 0] - ends[near, 1], axis=1).mean())


def cell(body: Body, low: float, high: float) -> tuple[np.ndarray, set[tuple[int, ...]]]:
    """Sorted points between two planes, and the tetrahedra by the ranks of their points."""
    points, tets = inside(body.mesh, low, high)
    return points, set(map(tuple, np.sort(tets, axis=1).tolist()))


def test_cells_stay_equal_and_the_curve_stays_on_edges(design: Design, grading: str) -> None:
    body, cells = body_of(design, grading), cell_boundaries(design)
    points, tets = cell(body, cells[1], cells[2])
    for low, high in pairwise(cells[2:-1]):
        others, other_tets = cell(body, low, high)
        assert others == pytest.approx(points, abs=1e-9)
        assert other_tets == tets
    curve = body.mesh.points[body.curve_vertices]
    assert curve[[0, -1], 0] == pytest.approx([0, design.length], abs=1e-12)


def test_volumes_are_those_of_the_drawing(design: Design, grading: str) -> None:
    body, plain = body_of(design, grading), body_of(design, "off")
    for volume, coarse, exact in (
        (body.mesh.volume, plain.mesh.volume, design.solid_volume / 2),
        (body.mesh.enclosed_volume("cavity"), plain.mesh.enclosed_volume("cavity"), design.cavity_volume / 2),
    ):
        if isinstance(design, PneuNet):
            assert volume == pytest.approx(exact, rel=1e-12)
        else:  # the arcs of the circles are no longer than without grading
            assert abs(volume - exact) < 1.001 * abs(coarse - exact) < 3e-5 * exact


def test_elements_are_no_worse(design: Design, grading: str) -> None:
    body, plain = body_of(design, grading), body_of(design, "off")
    assert len(body.mesh.tets) > 1.1 * len(plain.mesh.tets)
    assert body.mesh.quality.minimum > 0.08
    assert body.mesh.quality.mean > 0.95 * plain.mesh.quality.mean


@pytest.mark.parametrize("name", GRADED)
def test_elements_are_small_at_the_graded_positions(name: str) -> None:
    design = PneuNet(chambers=2)
    body, plain = design.body(6, GRADINGS[name]), design.body(6)
    position = {"edges": (3.0, 2.0, 2.75), "walls": (2.5, 10.0, 2.0)}[name]
    assert size_near(body, position, 2.5) < 0.85 * size_near(plain, position, 2.5)
    away = (12.0, 0.5, 6.0)  # on the base, below a gap
    assert size_near(body, away, 2.5) > 0.8 * size_near(plain, away, 2.5)


def test_finer_grading_follows_the_size() -> None:
    """Both sizes scale with the mesh size, so that a series of graded meshes converges."""
    design = PneuNet(chambers=2)
    wall = (2.5, 10.0, 2.0)
    coarse, fine = (size_near(design.body(size, GRADINGS["walls"]), wall, 2.5) for size in (5, 2.5))
    assert fine == pytest.approx(coarse / 2, rel=0.25)


def test_a_cad_file_is_graded_too(configs: Path) -> None:
    design = load_config(configs / "finger.yaml").design
    body, plain = design.body(4, GRADINGS["edges"]), design.body(4)
    assert len(body.mesh.tets) > 1.3 * len(plain.mesh.tets)
    assert body.mesh.volume == pytest.approx(design.solid_volume / 2, rel=1e-2)


def test_grading_off_is_the_default() -> None:
    design = PneuNet(chambers=2)
    plain, off = design.body(5).mesh, design.body(5, GRADINGS["off"]).mesh
    assert np.array_equal(plain.points, off.points)
    assert np.array_equal(plain.tets, off.tets)
