"""The search at rest for the walls that may touch."""

import numpy as np
import pytest

from fem import SelfContact, StVenantKirchhoff
from fem.discretisation import Discretisation
from geometry import BisectedCircle, Mesh, PneuNet
from geometry.arrays import Array

#: coordinates, mm, rounded for comparison
Spot = tuple[float, ...]


def facing(mesh: Mesh, face: str) -> dict[Spot, set[Spot]]:
    """The centres of the triangles that each node of a face is paired with, all moved to z >= 0."""
    space = Discretisation.of(mesh, "p2p0")
    pairs = SelfContact(face).bind(space, StVenantKirchhoff(E=1.0, nu=0.4)).pairs
    faced: dict[Spot, set[Spot]] = {}
    for node, triangle in zip(space.points[pairs.nodes], space.points[pairs.triangles].mean(axis=1), strict=True):
        if node[2] > -1e-9:
            faced.setdefault(spot(node), set()).add(spot(triangle))
    return faced


def spot(point: Array) -> Spot:
    return tuple(np.round(point * [1, 1, np.sign(point[2])], 6) + 0.0)


@pytest.mark.parametrize(
    ("design", "face"),
    [(BisectedCircle(length=40), "cavity_lower"), (PneuNet(chambers=3), "gap")],
    ids=["round", "gap"],
)
def test_a_node_of_half_a_body_faces_what_it_faces_in_the_whole(design: BisectedCircle | PneuNet, face: str) -> None:
    """Nodes on the edges of a cavity may look across the plane of symmetry, where the half has nothing."""
    half = design.body(4.0).mesh
    of_half, of_whole = facing(half, face), facing(half.mirrored(), face)
    assert len(of_half) > 100
    assert set(of_half) <= set(of_whole)
    assert sum(of_half[node] != of_whole[node] for node in of_half) == 0
    assert len(of_whole) - len(of_half) < 0.1 * len(of_whole)
