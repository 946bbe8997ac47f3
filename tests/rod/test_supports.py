"""Sections of an arm that supports hold, against beams of Euler and Bernoulli, Euler's columns, and the held end."""

import dataclasses
import re
from typing import Any

import numpy as np
import pytest

from geometry.arrays import Array
from pipeline.answers.rods.choice import rod_of_path
from rod import FiveParameters, LineLoad, Load, PointLoad, Rod, RodError, Support
from rod.along import Along
from rod.arm import solver
from rod.arm.assembly import assemble
from rod.arm.chain import room_for
from rod.arm.nodes import StateArrays, Tangent
from rod.mechanics import lines
from tests.coarse import COARSE
from tests.rod.arm_law.test_arm_law import EI, law_of, straight_law
from tests.rod.arm_law.test_arm_law import LENGTH as L
from tests.rod.arm_law.test_space_law import law as law_of_three_chambers
from tests.rod.arm_law.test_spatial import LENGTH as L_IN_SPACE
from tests.rod.arm_law.test_spatial import B, straight

#: N, under which deflections are those of straight beams
SMALL = 1e-6
FIVE = Rod(L, 0.0, FiveParameters(EI, EI, 0.0, 0.0, 50.0))
LAW = Rod(L, law=law_of(straight_law(0.0)).at(0.0))
IN_SPACE = Rod(L_IN_SPACE, law=straight())
BOTH = pytest.mark.parametrize("rod", [FIVE, LAW], ids=["five", "law"])
CURVED = [dataclasses.replace(FIVE, kappa_0=-0.01), Rod(L, law=law_of(straight_law(0.0, -0.01)).at(0.0))]
BOTH_CURVED = pytest.mark.parametrize("rod", CURVED, ids=["five", "law"])


def deflection(s: float, a: float) -> float:
    """Of a cantilever at s under a unit force at a, times the rigidity."""
    near, far = sorted((s, a))
    return near**2 * (3.0 * far - near) / 6.0


@BOTH
@pytest.mark.parametrize(("force_at", "places"), [(L, [60.0]), (30.0, [60.0, L]), (50.0, [33.3, 80.0, 100.0])])
def test_a_beam_on_supports(rod: Rod, force_at: float, places: list[float]) -> None:
    """A propped cantilever, and continuous beams: the reactions that keep the deflections there at zero."""
    shape = rod.solve(along=[PointLoad(force_at, (0.0, SMALL)), *(Support(s, y=0.0) for s in places)])
    matrix = np.array([[deflection(s, a) for a in places] for s in places])
    expected = np.linalg.solve(matrix, [-SMALL * deflection(s, force_at) for s in places])
    assert [one.s for one in shape.reactions] == places
    assert [one.force[1] for one in shape.reactions] == pytest.approx(expected, rel=1e-6)
    assert shape.clamp_moment == pytest.approx(SMALL * force_at + expected @ places, rel=1e-5)


@BOTH
def test_a_section_whose_angle_is_held(rod: Rod) -> None:
    """A couple there alone, and a line load between a clamp and a guided section: q l^2 / 12 each."""
    (reaction,) = rod.solve(along=[Support(60.0, angle=1e-4)]).reactions
    assert reaction.couple == pytest.approx(EI * 1e-4 / 60.0, rel=1e-6)
    assert reaction.force == (0.0, 0.0, 0.0)
    load = 1e-7
    shape = rod.solve(along=[LineLoad(0.0, 60.0, (0.0, load)), Support(60.0, y=0.0, angle=0.0)])
    assert shape.reactions[0].force[1] == pytest.approx(-load * 60.0 / 2.0, rel=1e-3)
    assert shape.reactions[0].couple == pytest.approx(load * 60.0**2 / 12.0, rel=2e-3)


@BOTH_CURVED
@pytest.mark.parametrize(
    ("held", "support"),
    [({"end_y": 12.0}, {"y": 12.0}), ({"end": (90.0, -30.0)}, {"x": 90.0, "y": -30.0}), ({"end_x": 92.0}, {"x": 92.0})],
)
def test_a_support_of_the_end_is_the_held_end(rod: Rod, held: dict[str, Any], support: dict[str, Any]) -> None:
    loads: list[Along] = [PointLoad(33.0, (0.01, -0.02)), Support(60.0, y=-12.0)]
    first, second = rod.solve(along=[*loads, Support(L, **support)]), rod.solve(along=loads, **held)
    np.testing.assert_array_equal(first.curve, second.curve)
    assert first.reactions == second.reactions
    assert first.reactions[1].force[:2] == pytest.approx(first.force)


@BOTH_CURVED
def test_large_motions_of_supports_and_the_forces_that_make_them(rod: Rod) -> None:
    """Dead loads of the size of the reactions bring the arm to the same shape."""
    held = rod.solve(along=[Support(55.0, y=-8.0), Support(L, y=-30.0, angle=-0.6)])
    along = [PointLoad(one.s, one.force, (0.0, 0.0, one.couple)) for one in held.reactions]
    assert rod.solve(along=along).curve == pytest.approx(held.curve, abs=2e-4)
    assert held.positions(np.array([55.0]))[0, 1] == pytest.approx(-8.0, abs=1e-7)
    assert (held.end[1], held.theta[-1]) == pytest.approx((-30.0, -0.6), abs=1e-7)
    ((x, y),) = rod.solve(along=[Support(55.0, x=52.0, y=-8.0)]).positions(np.array([55.0]))
    assert (x, y) == pytest.approx((52.0, -8.0), abs=1e-7)


def test_the_support_of_an_arm_is_one_of_its_material_curve() -> None:
    """It lies beside the axis, and moves with the turn of the section."""
    rod = rod_of_path(COARSE, "law").at(37.0)
    shape = rod.solve(along=[Support(56.0, y=-12.0)])
    assert shape.positions(np.array([56.0]))[0, 1] == pytest.approx(-12.0, abs=0.05)
    ((x, _),) = shape.positions(np.array([56.0]))
    assert shape.clamp_moment == pytest.approx(x * shape.reactions[0].force[1], rel=5e-3)


def test_elements_between_supports_converge_with_the_square_of_their_length(monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for count in (10, 20, 40, 80):
        monkeypatch.setattr(lines, "ELEMENTS", count)
        shape = Rod(L, -0.012, FIVE.law).solve(along=[Support(40.0, y=4.0), Support(90.0, y=-4.0)])
        found.append([value for one in shape.reactions for value in one.force[:2]])
    differences = np.abs(np.diff(np.array(found), axis=0)).max(axis=1)
    assert np.log2(differences[-2] / differences[-1]) == pytest.approx(4.0, abs=0.5)  # of the limit of two chains


def braced(length: float) -> float:
    """Buckling load over EI of a clamped column with a free end and a hinge in the middle.

    Above the hinge is a mast whose foot turns by phi: its moment there is EI k tan(k h) phi, h = l/2. Below it is a
    beam, clamped at its other end, whose stiffness against phi falls with the load (Timoshenko and Gere, 2.3).
    """
    u = np.linspace(0.5, 1.5, 1_000_001)
    below = u * (np.sin(u) - u * np.cos(u)) / (2.0 - 2.0 * np.cos(u) - u * np.sin(u))
    return float(u[np.argmax(u * np.tan(u) > below)] / (0.5 * length)) ** 2


@pytest.mark.parametrize(
    ("supports", "load"),
    [
        ((), np.pi**2 / (4.0 * L_IN_SPACE**2)),
        ((Support(L_IN_SPACE, z=0.0),), 20.1907 / L_IN_SPACE**2),  # tan(k l) = k l
        ((Support(0.5 * L_IN_SPACE, z=0.0),), braced(L_IN_SPACE)),
    ],
    ids=["free", "hinged", "hinged in the middle"],
)
def test_columns_that_are_held_sideways(supports: tuple[Support, ...], load: float) -> None:
    """Clamped columns with a free end, a hinged end, and a hinge in the middle below a free end."""
    rod = straight(planar=10.0 * B)
    shape = rod.solve_in_space(Load((-0.9 * load * B, 0.0, 0.0), supports=supports))
    assert shape.stability.lowest == pytest.approx(0.1, abs=0.005)
    try:
        (told,) = rod.solve_in_space(Load((-1.05 * load * B, 0.0, 0.0), supports=supports)).notes
    except RodError as refused:  # a hinged column has no stable shape near by: its bow twists out of the way
        told = str(refused)
    assert re.search(r"buckles out of its plane at 95\.\d %", told)


def test_an_arm_with_three_chambers_is_held_along_its_length() -> None:
    law = law_of_three_chambers().at((4.0, 3.0, 1.0))
    rod: Any = Rod(law.length, law=law)
    free = rod.solve()
    i = int(np.abs(free.s - 40.0).argmin())
    _, y, z = free.axis[i]
    held = rod.solve(along=[Support(free.s[i], y=y + 1.0, z=z - 1.0)])
    ((_, force, _),) = held.reactions
    assert rod.solve(along=[PointLoad(free.s[i], force)]).end == pytest.approx(held.end, abs=1e-5)
    assert held.axis[i, 1:] == pytest.approx([y + 1.0, z - 1.0], abs=1e-8)
    # the height of its end alone
    low = rod.solve(end_y=free.end[1] - 2.0)
    assert rod.solve(force=low.force).end == pytest.approx(low.end, abs=1e-5)


@pytest.mark.parametrize("held", [{"x": 40.0}, {"x": 40.0, "y": -10.0}, {"y": -10.0, "angle": -0.5}])
def test_what_holds_an_arm_has_an_exact_tangent(held: dict[str, Any]) -> None:
    """Places and angles by motions, and forces on the nodes by reactions, against differences."""
    law: Any = rod_of_path(COARSE, "law").at(37.0).law
    arm, load = law.posed(Load(supports=(Support(56.0, **held), Support(law.length, **held))))
    made = solver.Solver(arm, arm.positions((56.0,)), load, in_space=False)
    state = made.rest()
    state.reaction[:] = 0.1 + 0.01 * np.arange(len(state.reaction))

    def parts(moved: StateArrays) -> tuple[Array, Array, Tangent]:
        room = room_for(made.chain, len(state.reaction))
        assemble(made.arrays(), made.load, moved, 1.0, room, False)
        return room.residual, room.missed, room

    def difference(name: str, place: int) -> tuple[Array, Array]:
        sides = []
        for sign in (1.0, -1.0):
            moved = StateArrays(*(values.copy() for values in state))
            getattr(moved, name)[place] += sign * 1e-5
            sides.append(parts(moved)[:2])
        (residual, place_ahead), (residual_behind, place_behind) = sides
        return (residual - residual_behind) / 2e-5, (place_ahead - place_behind) / 2e-5

    _, _, tangent = parts(state)
    for c, (node, _) in enumerate(made.load.held):
        by_reaction, places = difference("reaction", c)
        assert by_reaction[3 * (node - 1) : 3 * node] == pytest.approx(tangent.by_reaction[c, :3], abs=1e-6)
        assert places == pytest.approx(tangent.direct[:, c], abs=1e-8)
        _, turned = difference("angle", node)
        assert turned[c] == pytest.approx(tangent.by_motion[c, 2], abs=1e-6)
