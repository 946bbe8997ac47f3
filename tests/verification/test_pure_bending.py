"""Pure bending of beams between two mirror planes against closed forms.

Small curvature: M = E I kappa, axial force E A times the strain, shear rigidity 5/6 G A of a rectangle without lateral
contraction (S. Timoshenko, J. Goodier, "Theory of Elasticity", 3rd ed., articles 102 and 124). Large curvature: flexure
of a block of incompressible neo-Hooke material in plane strain (R. S. Rivlin, "Large elastic deformations of isotropic
materials V: The problem of flexure", Proc. R. Soc. Lond. A 195 (1949)).
"""

import numpy as np
import pytest

from fem import Fixed, NeoHooke, StrainLimitingLayer, StVenantKirchhoff
from fem.cell.axis import axis_of
from fem.cell.piece import BendingPiece
from fem.cell.response import shear_rigidity, slopes
from geometry import Body, Mesh
from geometry.meshing.mirror import name_faces
from geometry.meshing.shapes import RoundBar
from geometry.meshing.solid import Solid, mesh_solid
from tests.bodies import box, named, on_plane
from tests.laws import LAWS

HEIGHT, WIDTH, LENGTH = 4.0, 3.0, 2.0  # of the half z >= 0


def beam(counts: tuple[int, int, int], sides: tuple[float, float, float] = (LENGTH, HEIGHT, WIDTH)) -> Body:
    """Half of a rectangular beam; the material curve runs in the middle of its height."""
    mesh = box(counts, sides)
    planes = {"clamp": (0, 0.0), "tip": (0, sides[0]), "sym": (2, 0.0), "back": (2, sides[2])}
    faces = {name: on_plane(mesh, axis, value) for name, (axis, value) in planes.items()}
    faces["cavity"] = on_plane(mesh, 1, sides[1])  # a body has a cavity; no pressure acts here
    return Body(named(mesh, **faces), "beam", sides[0], 2 * sides[0], sides[1] / 2, True)


@pytest.mark.parametrize("formulation", ["p2", "p2p0", "mixed"])
@pytest.mark.parametrize("law", LAWS)
def test_a_beam_of_every_law_has_the_rigidity_of_beam_theory(formulation: str, law: str) -> None:
    material = LAWS[law]
    mu = material.shear_modulus
    lame = material.volumetric_modulus
    youngs = mu * (3 * lame + 2 * mu) / (lame + mu)
    counts, error = ((4, 12, 8), 1e-3) if formulation == "p2p0" else ((2, 6, 4), 1e-8)
    piece = BendingPiece(beam(counts), material, "mirror", formulation, pressures={})
    at = piece.solve(0.0, 1e-6, piece.rest())
    known = slopes(piece, at)
    inertia, area = 2 * WIDTH * HEIGHT**3 / 12, 2 * WIDTH * HEIGHT
    assert known.moment_by_angle * LENGTH == pytest.approx(youngs * inertia, rel=error)
    assert at.moment * LENGTH / at.angle == pytest.approx(youngs * inertia, rel=1e-3)
    assert LENGTH / known.distance_by_force == pytest.approx(youngs * area, rel=1e-3)


def test_a_layer_stiffens_a_beam_as_a_composite_section() -> None:
    """A sheet of E t per width at the middle of the height adds to EA alone, one at the bottom also to EI:
    EI + (EA EA_sheet / (EA + EA_sheet)) e^2 with the distance e of the sheet from the middle (Gere and Timoshenko),
    and its own E t^3 / 12 per width."""
    material, stiffness = StVenantKirchhoff(E=1.2, nu=0.0), 1.2 * HEIGHT  # N/mm, of sheet and beam alike
    axial, bending = 2 * WIDTH * stiffness, 2 * WIDTH * 1.2 * HEIGHT**3 / 12
    for y, added in ((HEIGHT / 2, 0.0), (0.0, axial / 2 * (HEIGHT / 2) ** 2)):
        body = beam((2, 6, 4))
        layer = StrainLimitingLayer(body.mesh.plane(1, y), 0.1, stiffness / 0.1, 0.0)
        piece = BendingPiece(body, material, "mirror", "p2", pressures={}, effects=[layer])
        known = slopes(piece, piece.solve(0.0, 1e-6, piece.rest()))
        own = 2 * WIDTH * stiffness / 0.1 * 0.1**3 / 12
        assert known.moment_by_angle * LENGTH == pytest.approx(bending + own + added, rel=1e-5)
    assert known.moment_by_angle * LENGTH > 2 * bending


def test_the_shear_rigidity_of_a_rectangle() -> None:
    piece = BendingPiece(beam((3, 8, 2)), StVenantKirchhoff(E=1.2, nu=0.0), "mirror", "p2", pressures={})
    at = piece.solve(0.0, 1e-6, piece.rest())
    expected = 5 / 6 * 0.6 * 2 * WIDTH * HEIGHT
    assert shear_rigidity(piece, at, slopes(piece, at)) == pytest.approx(expected, rel=2e-3)


def test_a_thick_walled_tube() -> None:
    """Against E times the second moment of the meshed section, which is a polygon."""
    outer, inner, length = 5.0, 3.0, 3.0
    bar = [[RoundBar(0, length, 0, outer, bottom=0.0)], [RoundBar(0, length, 0, outer, top=0.0)]]
    solid = mesh_solid(Solid({"cell": bar}, {"cavity": [RoundBar(0, length, 0, inner)]}), 1.2)
    planes = {"clamp": (0, 0.0), "tip": (0, length), "sym": (2, 0.0)}
    mesh = name_faces(solid.points, solid.regions["cell"], solid.walls, planes)
    y = float(mesh.points[np.unique(mesh.faces["sym"]), 1].max())
    body = Body(mesh, "tube", length, 2 * length, y, True)
    piece = BendingPiece(body, StVenantKirchhoff(E=1.2, nu=0.3), "mirror", "p2", pressures={})
    known = slopes(piece, piece.solve(0.0, 1e-6, piece.rest()))
    inertia = 2 * _second_moment(mesh)
    assert inertia == pytest.approx(np.pi / 4 * (outer**4 - inner**4), rel=0.06)
    assert known.moment_by_angle * length == pytest.approx(1.2 * inertia, rel=2e-3)


def _second_moment(mesh: Mesh) -> float:
    """Integral of y^2 over the face at the end, by the rule with the middles of the edges, exact for parabolas."""
    corners = mesh.points[mesh.faces["tip"]]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    middles = (corners + np.roll(corners, -1, axis=1))[..., 1] / 2
    return float(area @ (middles**2).mean(axis=1))


@pytest.mark.parametrize("curvature", [0.05, 0.2])
def test_flexure_of_an_incompressible_block(curvature: float) -> None:
    mu = 0.4
    body = beam((2, 8, 1), (LENGTH, HEIGHT, 1.0))
    material = NeoHooke(mu=mu, kappa=2000 * mu)
    piece = BendingPiece(body, material, "mirror", "mixed", pressures={}, supports=[Fixed("back", "z")])
    at = piece.solve(0.0, curvature * LENGTH, piece.rest())
    moment, inner, outer = rivlin(curvature, HEIGHT, mu)
    assert at.moment / 2.0 == pytest.approx(moment, rel=2e-3)
    y = (piece.space.points + at.state.displacement)[piece.plane]
    radius = at.distance / np.tan(at.angle) - y @ (-np.sin(at.angle), np.cos(at.angle), 0.0)
    assert (radius.min(), radius.max()) == pytest.approx((inner, outer), rel=1e-3)
    middle = np.sqrt((inner**2 + outer**2) / 2)  # r^2 is linear in X
    assert axis_of(piece, at, slopes(piece, at)).stretch == pytest.approx(curvature * middle, rel=1e-3)


def rivlin(curvature: float, height: float, mu: float) -> tuple[float, float, float]:
    """Moment per width (N), inner and outer radius (mm) of a block bent by `curvature` per rest length (1/mm).

    r^2 = 2 a X + b and a = 1 / curvature; free surfaces ask for r_i r_o = a^2, and then
    sigma_rr = mu/2 (r^2/a^2 + a^2/r^2 - K) and M = - int r sigma_rr dr.
    """
    a = 1.0 / curvature
    product, difference = a**4, 2 * a * height  # of r_o^2 and r_i^2
    outer2 = difference / 2 + np.sqrt(difference**2 / 4 + product)
    inner, outer = np.sqrt(outer2 - difference), np.sqrt(outer2)
    constant = inner**2 / a**2 + a**2 / inner**2

    def primitive(r: float) -> float:
        return r**4 / (4 * a**2) + a**2 * np.log(r) - constant * r**2 / 2

    return float(-mu / 2 * (primitive(outer) - primitive(inner))), float(inner), float(outer)
