"""Forces, line loads and masses along rods: closed forms, loads on the end, and what is refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pneurod
from pipeline.answers.rods.choice import rod_of_path
from rod import FiveParameters, LineLoad, Load, PointLoad, Rod
from rod.weight import WEIGHT_OF_GRAM, Mass, position_along
from tests.coarse import COARSE
from tests.rod.arm_law.test_arm_law import EI, law_of, straight_law
from tests.rod.arm_law.test_arm_law import LENGTH as L
from tests.rod.arm_law.test_space_law import law as law_of_three_chambers
from tests.rod.arm_law.test_spatial import LENGTH as L_IN_SPACE
from tests.rod.arm_law.test_spatial import B, straight

#: N and N/mm, under which deflections are those of straight beams
SMALL, SLIGHT = 1e-6, 1e-7
FIVE = Rod(L, 0.0, FiveParameters(EI, EI, 0.0, 0.0, 50.0), mass=Mass.even(L, 15.0))
LAW = Rod(L, law=law_of(straight_law(0.0)).at(0.0))
CURVED = (Rod(L, -0.01, FiveParameters(EI, EI, 0.0, 0.0, 50.0)), Rod(L, law=law_of(straight_law(0.0, -0.01)).at(0.0)))
BOTH = pytest.mark.parametrize("rod", [FIVE, LAW], ids=["five", "law"])


def cantilever(a: float, length: float = L) -> float:
    """Deflection of the end under a unit force at a, times the rigidity."""
    return a**2 * (3.0 * length - a) / 6.0


@BOTH
@pytest.mark.parametrize("a", [20.0, 33.3, 56.0, 99.99, 109.999])
def test_a_force_along_a_cantilever(rod: Rod, a: float) -> None:
    shape = rod.solve(along=[PointLoad(a, (0.0, SMALL))])
    assert shape.end[1] == pytest.approx(SMALL * cantilever(a) / EI, rel=1e-5)
    assert shape.clamp_moment == pytest.approx(SMALL * a, rel=1e-6)
    assert shape.kappa[shape.s > a + 1e-6] == pytest.approx(0.0, abs=1e-13)
    assert shape.force == pytest.approx([0.0, 0.0])


@BOTH
@pytest.mark.parametrize(("start", "end"), [(0.0, L), (20.0, 70.0), (33.3, 35.1)])
def test_a_line_load_on_a_cantilever(rod: Rod, start: float, end: float) -> None:
    shape = rod.solve(along=[LineLoad(start, end, (0.0, SLIGHT))])
    low, high = (L * s**3 / 6.0 - s**4 / 24.0 for s in (start, end))
    assert shape.end[1] == pytest.approx(SLIGHT * (high - low) / EI, rel=1e-5)
    assert shape.clamp_moment == pytest.approx(SLIGHT * (end**2 - start**2) / 2.0, rel=1e-6)
    if (start, end) == (0.0, L):
        assert shape.end[1] == pytest.approx(SLIGHT * L**4 / (8.0 * EI), rel=1e-5)


@BOTH
def test_loads_on_the_end_and_all_along_are_those_that_were_there_before(rod: Rod) -> None:
    on_end, along = rod.solve(force=(0.01, 0.02)), rod.solve(along=[PointLoad(L, (0.01, 0.02))])
    assert along.curve == pytest.approx(on_end.curve, abs=1e-12)
    assert along.force == pytest.approx(on_end.force)
    spread, weight = rod.solve(along=[LineLoad(0.0, L, (1e-4, -2e-4))]), rod.under(Load(weight=(1e-4, -2e-4)))
    assert spread.end == pytest.approx(weight.end, abs=1e-6)
    halves = rod.solve(along=[PointLoad(40.0, (0.01, 0.02)), PointLoad(40.0, (0.01, 0.02))])
    assert halves.end == pytest.approx(rod.solve(along=[PointLoad(40.0, (0.02, 0.04))]).end, abs=1e-9)


@BOTH
def test_a_couple_along_the_arm_bends_the_part_before_it(rod: Rod) -> None:
    shape = rod.solve(along=[PointLoad(40.0, couple=(0.0, 0.0, 2.0))])
    assert shape.end[1] == pytest.approx(EI / 2.0 * (1.0 - np.cos(0.2)) + (L - 40.0) * np.sin(0.2), rel=1e-5)


@pytest.mark.parametrize("held", [{"end_y": -10.0}, {"end": (90.0, -40.0)}, {"force": (0.01, 0.02), "moment": 1.0}])
def test_both_rods_agree_under_large_loads_along_them(held: dict[str, Any]) -> None:
    loads = {"along": [PointLoad(33.0, (0.1, -0.2)), LineLoad(60.0, 90.0, (0.0, 2e-3))], **held}
    five, law = (rod.solve(**loads) for rod in CURVED)
    assert law.end == pytest.approx(five.end, abs=1e-3)
    assert law.force == pytest.approx(five.force, rel=1e-3, abs=1e-5)
    assert law.clamp_moment == pytest.approx(five.clamp_moment, rel=1e-3)


@pytest.mark.parametrize("place", ["0.5 l", "55 mm", 55.0])
def test_a_mass_hangs_anywhere(place: str | float) -> None:
    hung = FIVE.solve(hung=[(place, "5 g")], direction="lying", weight=False)
    pulled = FIVE.solve(along=[PointLoad(55.0, (0.0, -5.0 * WEIGHT_OF_GRAM))])
    assert hung.end == pytest.approx(pulled.end, abs=1e-9)
    on_end = FIVE.solve(hung=[("1 l", 5.0)], direction="lying")
    assert on_end.end == pytest.approx(FIVE.solve(tip_mass="5 g", direction="lying").end, abs=1e-9)
    assert position_along(" 0.25 l", 80.0) == position_along("2 cm", 80.0) == 20.0


def test_loads_across_the_plane_bend_the_arm_out_of_it() -> None:
    rod = Rod(L_IN_SPACE, law=straight())
    shape = rod.solve(along=[PointLoad(40.0, (0.0, 0.0, SMALL))])
    assert shape.end[2] == pytest.approx(SMALL * cantilever(40.0, L_IN_SPACE) / B, rel=1e-4)
    spread = rod.solve(along=[LineLoad(0.0, L_IN_SPACE, (0.0, 0.0, SLIGHT))])
    assert spread.end[2] == pytest.approx(SLIGHT * L_IN_SPACE**4 / (8.0 * B), rel=1e-4)
    on_end, along = (
        rod.solve(**load)
        for load in ({"force": (0.0, 0.0, 0.01)}, {"along": [PointLoad(L_IN_SPACE, (0.0, 0.0, 0.01))]})
    )
    assert along.end == pytest.approx(on_end.end, abs=1e-12)
    assert along.stability.lowest == pytest.approx(on_end.stability.lowest)


def test_an_arm_with_three_chambers_bears_loads_along_it() -> None:
    law = law_of_three_chambers().at((4.0, 3.0, 1.0))
    rod, force = Rod(law.length, law=law), (0.01, 0.02, 0.03)
    on_end = rod.solve(force=force)
    assert rod.solve(along=[PointLoad(law.length, force)]).end == pytest.approx(on_end.end, abs=1e-12)
    # what a small force at one place moves at another one, the other way round moves as much
    free = rod.solve(force=(0.0, 0.0, 0.0))
    at_middle = rod.solve(along=[PointLoad(40.0, (0.0, SMALL))])
    by_end = rod.solve(force=(0.0, SMALL, 0.0))
    moved = [np.interp(40.0, shape.s, shape.axis[:, 1]) for shape in (by_end, free)]
    assert at_middle.end[1] - free.end[1] == pytest.approx(moved[0] - moved[1], rel=1e-4)
    assert rod.solve(hung=[("0.5 l", "1 g")], direction=(0.0, 0.0, -1.0), weight=False).end[2] < free.end[2]


@pytest.mark.parametrize("s", [30.0, 56.0, 57.0, 80.0, 110.0])
def test_a_force_acts_on_the_material_curve(s: float) -> None:
    """Its moment at the clamp is that about the clamped end of the curve, which lies beside the axis."""
    rod, force = rod_of_path(COARSE, "law").at(37.0), (0.0, 0.005)
    shape = rod.solve(along=[PointLoad(s, force)])
    ((x, _),) = shape.positions(np.array([s]))
    assert shape.clamp_moment == pytest.approx(x * force[1], rel=1e-5)
    pulled = rod.solve(along=[PointLoad(s, (0.005, 0.0), beside=(0.0, 1.0))])
    ((_, y),) = pulled.positions(np.array([s]))
    theta = np.interp(s, pulled.s, pulled.theta)
    assert pulled.clamp_moment == pytest.approx(-(y + np.cos(theta)) * 0.005, rel=2e-3)


def test_the_stability_of_a_rod_knows_loads_along_it() -> None:
    """A force against the arm at its end buckles it; the same force near the clamp does not."""
    rod = straight()
    critical = np.pi**2 * B / (4.0 * L_IN_SPACE**2)
    near, far = (Load(along=(PointLoad(s, (-0.9 * critical, 0.0)),)) for s in (0.5 * L_IN_SPACE, L_IN_SPACE - 0.5))
    assert rod.stability(rod.under(near)).lowest > 0.5
    assert rod.stability(rod.under(far)).lowest == pytest.approx(0.1, abs=0.02)
    beyond = Load(along=(PointLoad(L_IN_SPACE, (-1.5 * critical, 0.0)),))
    assert rod.buckling_part(beyond) == pytest.approx(1.0 / 1.5, rel=5e-3)


def test_the_package_has_the_loads_and_python_takes_those_of_the_command_line() -> None:
    assert (pneurod.PointLoad, pneurod.LineLoad) == (PointLoad, LineLoad)
    found = pneurod.shape(Path(COARSE), "37 kPa", force_at="0.5 l: [0 N, 0.005 N]")
    assert found.shape.end == pytest.approx(found.rod.solve(along=[PointLoad(56.0, (0.0, 0.005))]).end)
