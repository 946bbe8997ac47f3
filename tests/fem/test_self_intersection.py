"""Bodies that intersect themselves without contact, and extreme stretches with their reasons."""

from dataclasses import replace

import numpy as np
import pytest

from fem import NeoHooke, StVenantKirchhoff, crossing_at_rest, outside_stable_range, self_intersection
from fem.discretisation import Discretisation
from fem.effects.contact import crossings
from fem.post.extremes import extremes_of, principal_stretches
from fem.reasons import sentence
from fem.solution import Extremes
from geometry import Mesh
from geometry.arrays import Array
from tests.bodies import box, fork, hollow_box

LENGTH = 24.0


@pytest.fixture(scope="module")
def beam() -> Discretisation:
    return Discretisation.of(box((24, 1, 1), (LENGTH, 1.0, 1.0)), "p2")


def curled(space: Discretisation, turns: float) -> Array:
    """The beam as an arc of a circle."""
    x, y, z = space.points.T
    radius = LENGTH / (2 * np.pi * turns)
    angle = x / radius
    return np.column_stack([(radius - y) * np.sin(angle), radius - (radius - y) * np.cos(angle), z])


@pytest.mark.parametrize("turns", [0.1, 0.5, 0.9])
def test_a_beam_curled_by_less_than_a_turn_does_not_intersect_itself(beam: Discretisation, turns: float) -> None:
    assert self_intersection(beam, curled(beam, turns), half=False) is None


def test_a_beam_curled_by_more_than_a_turn_passes_through_itself(beam: Discretisation) -> None:
    reason = self_intersection(beam, curled(beam, 1.1), half=False)
    assert reason.code == "crosses_itself"
    x, y, _ = reason.where
    radius = LENGTH / (2 * np.pi * 1.1)
    # the ends overlap over 0.1 turns beside the clamp, at the bottom of the circle
    assert 0.0 <= np.arctan2(x, radius - y) <= 2 * np.pi * 0.1 + 0.2


def test_half_a_body_that_crosses_its_plane_of_symmetry() -> None:
    space = Discretisation.of(hollow_box(half=True), "p2")
    assert self_intersection(space, space.points, half=True) is None
    x = space.points.copy()
    x[space.surface("cavity").unique_nodes, 2] -= 0.7
    assert self_intersection(space, x, half=True).code == "crosses_mirror_image"


def test_walls_that_are_close_at_rest_are_not_examined() -> None:
    space = Discretisation.of(fork(0.4), "p2")
    x = space.points.copy()
    x[x[:, 1] > 1.2, 1] -= 0.6
    assert self_intersection(space, x, half=False) is None


def test_a_crossing_of_neighbouring_walls_is_not_counted(beam: Discretisation) -> None:
    """Two ends of the beam come near each other without crossing, and a node is pushed through its own corner."""
    x = curled(beam, 0.93)
    assert self_intersection(beam, x, half=False) is None
    surface = np.unique(np.concatenate([faces.triangles for faces in beam.surfaces.values()]))
    rest = beam.points[surface]
    corner = surface[int(np.argmin(np.linalg.norm(rest - (12.0, 0.0, 0.0), axis=1)))]
    x[corner] += 2.0 * (x[surface[int(np.argmin(np.linalg.norm(rest - (12.0, 1.0, 0.5), axis=1)))]] - x[corner])
    triangles = np.concatenate([faces.triangles for faces in beam.surfaces.values()])
    assert crossings(x, triangles)[0].size > 0
    assert self_intersection(beam, x, half=False) is None


def test_a_boundary_that_crosses_itself_at_rest_is_found_where_it_does() -> None:
    """A vertex of one prong is pulled through the other one: its elements are stretched, none is turned over."""
    mesh = fork(0.4)
    assert crossing_at_rest(mesh) is None
    points = np.array(mesh.points)
    tip = points[:, 0].max()
    lower = points[:, 1] < 1.01
    moved = int(np.flatnonzero((points[:, 0] == tip) & lower & (points[:, 2] > 0))[-1])
    points[moved, 1] += 2.5
    crossing = crossing_at_rest(Mesh(points, mesh.tets, {}))
    assert tip - 2.0 <= crossing[0] <= tip
    assert crossing[1] > 0.9


LAW = StVenantKirchhoff(1.2, 0.495)
MILD = Extremes(0.95, 1.2, 0.8, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), (7.0, 8.0, 9.0))


def test_no_reason_for_stretches_within_the_stable_range() -> None:
    assert outside_stable_range(MILD, LAW) is None
    assert outside_stable_range(replace(MILD, min_stretch=0.5), NeoHooke(0.4, 40.0)) is None


def test_compression_beyond_the_limit_point_of_the_law() -> None:
    reason = outside_stable_range(replace(MILD, min_stretch=0.5), LAW)
    assert sentence((reason,)) == (
        "a stretch of 0.5 at (7.0, 8.0, 9.0) mm is below 0.577, where the law svk in compression is no longer stable"
    )


def test_tension_beyond_zero_volume() -> None:
    reason = outside_stable_range(replace(MILD, max_stretch=1.8), LAW)
    assert (reason.code, reason.where) == ("stretch_too_large", (4.0, 5.0, 6.0))
    assert (reason.values["stretch"], reason.values["law"]) == (1.8, "svk")
    assert reason.values["limit"] == pytest.approx(1.74, abs=5e-3)


@pytest.mark.parametrize("size", [0.0, 1e-9, 0.02, 0.3])
def test_extremes_are_those_of_all_stress_points(size: float) -> None:
    """Only the points that can have an extreme stretch are evaluated; the result must not depend on that."""
    space = Discretisation.of(box((3, 2, 2), (1.0, 1.0, 1.0)), "p2p0")
    displacement = size * np.random.default_rng(5).normal(size=space.points.shape)
    strain, jacobian = space.strain_of(displacement)
    stretches = principal_stretches(strain)
    extremes = extremes_of(space, strain, jacobian)
    assert (extremes.min_stretch, extremes.max_stretch) == (stretches.min(), stretches.max())
    centres = space.points[space.nodes[:, :4]].mean(axis=1)
    np.testing.assert_array_equal(extremes.max_stretch_at, centres[stretches[..., 2].max(axis=1).argmax()])
    np.testing.assert_array_equal(extremes.min_stretch_at, centres[stretches[..., 0].min(axis=1).argmin()])
