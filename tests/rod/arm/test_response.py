"""Derivatives of solved arms by loads and laws: closed forms, and difference quotients of solved states."""

import numpy as np
import pytest

from rod import FiveParameters, Load, PointLoad, Rod, Support
from tests.coarse import coarse_run
from tests.quotients import SOLVED, quotient
from tests.rod.arm_law.test_space_law import law as space_law

LENGTH, RIGIDITY = 100.0, 400.0
STRAIGHT = FiveParameters(RIGIDITY, RIGIDITY, 0.0, 0.0, 50.0)
#: of one solution with a tangent that is next to rigid against stretch, about 1e8 times the rounding of a number
DIGITS = 2e-5
#: N; the law of a cell is made of cubics, whose second derivatives jump: wider quotients see them
NARROW = 1e-3


def test_a_quarter_circle_gives_way_as_castigliano_says() -> None:
    """A quarter of a circle, clamped at one end, under forces and a couple on the other one."""
    radius = 2.0 * LENGTH / np.pi
    shape = Rod(LENGTH, 1.0 / radius, STRAIGHT).solve(force=(0.0, 0.0))
    x, y, couple = (shape.derivative(Load(*load)) for load in (((1.0, 0.0),), ((0.0, 1.0),), ((0.0, 0.0), 1.0)))
    unit = radius**3 / RIGIDITY
    assert y.end[:2] == pytest.approx([-unit / 2.0, unit * (3.0 * np.pi / 4.0 - 2.0)], rel=DIGITS)
    assert x.end[0] == pytest.approx(unit * np.pi / 4.0, rel=DIGITS)
    assert couple.turn[-1, 2] == pytest.approx(LENGTH / RIGIDITY, rel=DIGITS)
    assert couple.end[1] == pytest.approx(radius**2 / RIGIDITY * (0.5 * np.pi - 1.0), rel=DIGITS)
    assert x.end[1] == pytest.approx(y.end[0], rel=DIGITS)  # Maxwell and Betti


def test_a_column_gives_way_without_bound_at_the_force_of_euler() -> None:
    """Sideways by a force across: tan(k l) / k - l over the thrust."""
    thrust = 0.9 * np.pi**2 * RIGIDITY / (4.0 * LENGTH**2)
    k = np.sqrt(thrust / RIGIDITY)
    shape = Rod(LENGTH, 0.0, STRAIGHT).solve(force=(-thrust, 0.0))
    given = shape.derivative(Load((0.0, 1.0)))
    assert given.end[1] == pytest.approx((np.tan(k * LENGTH) / k - LENGTH) / thrust, rel=1e-4)


def test_the_first_mode_of_a_nearly_straight_rod_holds_its_end() -> None:
    """Clamped at one end and pinned at the other, pushed to 0.6 of its length: about 22.9 EI/l^2, not a higher mode."""
    shape = Rod(LENGTH, 1e-4 / LENGTH, STRAIGHT).solve(end=(0.6 * LENGTH, 0.0))
    assert -shape.force[0] * LENGTH**2 / RIGIDITY == pytest.approx(22.9, abs=0.1)


@pytest.mark.parametrize("loads", [{"force": (0.0, 0.01)}, {"end_y": -5.0}, {"direction": "hanging", "tip_mass": 1.0}])
def test_of_an_arm_with_its_own_law_as_of_its_neighbours(loads: dict[str, object]) -> None:
    law = coarse_run().law
    width, at = 2e-3, law.plane.at
    shape, less, more = (Rod(law.plane.length, law=at(10.0 + k * width)).solve(**loads) for k in (0.0, -0.5, 0.5))
    given = shape.derivative((at(10.0 - 0.5 * width), at(10.0 + 0.5 * width)))
    found = quotient([*more.end, *(1e3 * more.force)], [*less.end, *(1e3 * less.force)], width, SOLVED)
    rate = np.array([*given.end[:2], *(1e3 * given.force[:2])]) / width
    assert rate == found.within(rel=1e-3, abs=1e-3 * np.abs(rate).max())


def test_forces_payloads_and_loads_along_the_arm_as_small_ones() -> None:
    law = coarse_run().law
    rod = Rod(law.plane.length, law=law.plane.at(10.0))
    shape = rod.solve(force=(0.0, 0.01))
    middle = PointLoad(0.5 * rod.length, (0.0, 1.0))
    for load in (Load((1.0, 0.0)), Load(along=(middle,))):
        (x, y, _), along = load.force, load.along
        ends = []
        for sign in (-0.5, 0.5):
            moved = [PointLoad(one.s, (0.0, sign * NARROW)) for one in along]
            ends.append(rod.solve(force=(sign * NARROW * x, 0.01 + sign * NARROW * y), along=moved).end)
        found = quotient(ends[1], ends[0], NARROW, SOLVED)
        assert shape.derivative(load).end[:2] == found.within(rel=3e-3)


def test_of_an_arm_that_a_support_holds_in_its_middle() -> None:
    """Its end by a force there, and the force on its end, where it is held too, by a load before it."""
    law = coarse_run().law
    rod = Rod(law.plane.length, law=law.plane.at(10.0))
    middle, end = Support(0.5 * rod.length, y=-2.0), Support(rod.length, y=-5.0)
    width = 0.1 * NARROW  # a newton moves the end of this arm by half a meter
    for name, s, held in (("end", rod.length, (middle,)), ("force", 0.75 * rod.length, (middle, end))):
        loads = ((0.0, 0.01 + part * width) for part in (0.0, -0.5, 0.5))
        shape, less, more = (rod.solve(along=[PointLoad(s, load), *held]) for load in loads)
        by = Load((0.0, 1.0)) if s == rod.length else Load(along=(PointLoad(s, (0.0, 1.0)),))
        given, found = shape.derivative(by), quotient(getattr(more, name), getattr(less, name), width, SOLVED)
        rate = getattr(given, name)[:2]
        assert rate == found.within(rel=1e-3, abs=1e-3 * np.abs(rate).max())
        i = int(np.abs(shape.s - middle.s).argmin())
        assert given.axis[i, 1] == pytest.approx(0.0, abs=1e-3 * np.abs(given.axis[:, 1]).max())


def test_of_an_arm_in_space_and_of_one_whose_end_is_held() -> None:
    arm, load = space_law(stretch_slope=0.3, cubic=2.0, turn=0.1).at((5.0, 3.0, 0.0)), Load((0.0, 0.01, 0.02))
    shape = arm.solve_in_space(load)
    given, width = shape.derivative(Load((0.0, 0.0, 1.0), (0.5, 0.0, 0.0))), 2e-4
    less, more = (
        arm.solve_in_space(load.plus(Load((0.0, 0.0, 1.0), (0.5, 0.0, 0.0)), part * width)) for part in (-0.5, 0.5)
    )
    assert given.end == quotient(more.end, less.end, width, SOLVED).within(rel=1e-4, abs=1e-4 * np.abs(given.end).max())
    supports = (Support(arm.length, *map(float, np.add(shape.end, [-1.0, 1.0, 0.0]))),)
    held = arm.solve_in_space(Load(supports=supports))
    by_couple = held.derivative(Load(couple=(0.0, 0.0, 1.0)))
    couples = ((0.0, 0.0, sign) for sign in (-0.01, 0.01))
    less, more = (arm.solve_in_space(Load(couple=couple, supports=supports)) for couple in couples)
    assert by_couple.end == pytest.approx(np.zeros(3), abs=1e-7)
    assert by_couple.force == quotient(more.force, less.force, 0.02, SOLVED).within(
        rel=1e-3, abs=1e-3 * np.abs(by_couple.force).max()
    )
