"""The search at rest for the walls that may touch, and half a body beside its mirror image."""

import numpy as np
import pytest

from fem import SelfContact, StVenantKirchhoff
from fem.discretisation import Discretisation
from fem.effects.barrier import FacingTerm
from fem.effects.effect import Blocks, Term
from geometry import BisectedCircle, Mesh, PneuNet, SemicircularSingle
from geometry.arrays import Array
from tests.bodies import hollow_box

LAW = StVenantKirchhoff(E=1.0, nu=0.4)
#: coordinates, mm, rounded for comparison
Spot = tuple[float, ...]


def facing(mesh: Mesh, face: str) -> dict[Spot, set[Spot]]:
    """The centres of the triangles that each node at z >= 0 of a face is paired with; where the node is on the plane of
    symmetry, those of the half z >= 0."""
    space = Discretisation.of(mesh, "p2p0")
    pairs = SelfContact(face).bind(space, LAW).pairs
    sign = np.where(pairs.is_mirrored, -1.0, 1.0)[:, None] ** [0, 0, 1]
    faced: dict[Spot, set[Spot]] = {}
    for node, triangle in zip(
        space.points[pairs.nodes], space.points[pairs.triangles].mean(axis=1) * sign, strict=True
    ):
        if node[2] > -1e-9:
            faced.setdefault(spot(node), set()).add(spot(triangle if node[2] > 1e-9 else np.abs(triangle)))
    return faced


def spot(point: Array) -> Spot:
    return tuple(np.round(point, 6) + 0.0)


@pytest.mark.parametrize(
    ("design", "face"),
    [
        (BisectedCircle(length=40), "cavity_lower"),
        (SemicircularSingle(length=30), "cavity"),
        (PneuNet(chambers=3), "gap"),
        (PneuNet(chambers=2, width=6, side_wall=1.2), "cavity"),
    ],
    ids=["round", "half disc", "gap", "narrow"],
)
def test_a_node_of_half_a_body_faces_what_it_faces_in_the_whole(design: BisectedCircle | PneuNet, face: str) -> None:
    """Nodes may look across the plane of symmetry, and at the mirror image of their own wall."""
    half = design.body(4.0).mesh
    of_half, of_whole = facing(half, face), facing(half.mirrored(), face)
    assert len(of_half) > 100
    assert of_half == of_whole


def gradient(term: Term, x: Array) -> Array:
    out = np.zeros_like(x)
    term.gradient(x, 1.0, out)
    return out


def times(blocks: Blocks, dx: Array) -> Array:
    """The second derivative times dx (n, 3)."""
    out, off = np.zeros_like(dx), blocks.rows != blocks.columns
    np.add.at(out, blocks.rows, np.einsum("mij,mj->mi", blocks.values, dx[blocks.columns]))
    np.add.at(out, blocks.columns[off], np.einsum("mij,mi->mj", blocks.values[off], dx[blocks.rows[off]]))
    return out


def squeezed(space: Discretisation) -> Array:
    """The hollow box with its side walls 0.1 to 0.3 mm apart, and sheared along x; symmetric about z = 0."""
    x, y, z = space.points.T
    closed = np.clip(2.0 * np.abs(z), 0.0, 1.0) * np.sign(z) * (0.1 + 0.08 * (x - 1.5) ** 2 + 0.06 * (y - 1.5))
    far = np.sign(z) * np.clip(np.abs(z) - 0.5, 0.0, None)
    return np.column_stack([x + 0.1 * y**2 + 0.1 * z**2, y - 0.05 * x * z**2, 0.7 * closed + far])


def bound(mesh: Mesh) -> tuple[Discretisation, FacingTerm]:
    space = Discretisation.of(mesh, "p2")
    return space, SelfContact("cavity", dhat=0.25, overlap=0.0).bind(space, LAW)


def test_walls_of_half_a_body_press_on_their_mirror_images_as_in_the_whole() -> None:
    half = hollow_box(half=True, parts=2)
    (space, term), (whole, of_whole) = bound(half), bound(half.mirrored())
    x, y = squeezed(space), squeezed(whole)
    energy, force = term.energy(x, 1.0), gradient(term, x)
    assert energy > 0
    assert of_whole.energy(y, 1.0) == pytest.approx(2.0 * energy, rel=1e-10)
    assert of_whole.gap(y) == pytest.approx(term.gap(x), rel=1e-10)
    in_plane = np.isin(np.arange(len(x)), space.surface("sym").unique_nodes)
    free = np.column_stack([np.ones((len(x), 2)), ~in_plane])  # what the plane of symmetry bears is no part of it
    number = {spot(point): node for node, point in enumerate(whole.points)}
    in_whole = gradient(of_whole, y)[[number[spot(point)] for point in space.points]]
    share = np.where(in_plane, 0.5, 1.0)[:, None]
    np.testing.assert_allclose(force * free, share * in_whole * free, atol=1e-10 * np.abs(force).max())


def test_derivatives_of_the_contact_with_mirror_images() -> None:
    space, term = bound(hollow_box(half=True, parts=2))
    assert (term.pairs.nodes[:, None] == term.pairs.triangles).any(), "some face the image of their own triangle"
    random, step, in_plane = np.random.default_rng(1), 1e-6, space.surface("sym").unique_nodes
    x, dx = squeezed(space), random.normal(size=space.points.shape)
    x += 0.005 * random.normal(size=x.shape)
    x[in_plane, 2] = dx[in_plane, 2] = 0.0
    ahead, behind = x + step * dx, x - step * dx
    slope = (term.energy(ahead, 1.0) - term.energy(behind, 1.0)) / (2 * step)
    assert np.vdot(gradient(term, x), dx) == pytest.approx(slope, rel=1e-6)
    change = (gradient(term, ahead) - gradient(term, behind)) / (2 * step)
    product = times(term.blocks(x, 1.0, convex=False), dx)
    product[in_plane, 2] = change[in_plane, 2] = 0.0
    np.testing.assert_allclose(product, change, atol=1e-5 * np.abs(change).max())
