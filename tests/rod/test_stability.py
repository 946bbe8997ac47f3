"""Nothing that has fallen over stands: columns, arms and strips against closed forms and an energy of their own.

Where an arm buckles its answer is the stable shape to which it falls, and says so.
"""

import math
import re
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from rod import FiveParameters, Load, Rod, RodError, RodSolution, RodWarning, SpatialSolution
from rod.arm_law import law_rod
from rod.frames import rotation
from rod.inverse import Branch
from rod.weight import WEIGHT_OF_GRAM, Mass
from tests.hard_cases.rods import COLUMN, EI, EULER, GREENHILL, LATERAL, LENGTH, arch, standing
from tests.hard_cases.rods import column as pushed
from tests.links import Links
from tests.rod.arm_law.test_spatial import LENGTH as DEEP
from tests.rod.arm_law.test_spatial import B, straight

TURN = np.array([0.0, 0.003, 0.003])
BEYOND = [1.01, 1.1, 2.0, 8.0, 9.5, 15.0, 24.0, 26.0, 60.0, 150.0]


def deep(part: float) -> SpatialSolution:
    return straight().solve_in_space(Load((0.0, part * LATERAL, 0.0)))


def said(solve: Any, *given: Any, **more: Any) -> tuple[Any, str]:
    """A shape, and its notes in one line."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RodWarning)
        shape = solve(*given, **more)
    return shape, " ".join(shape.notes)


def part_in(told: str) -> float:
    """The part of the load in a sentence."""
    (percent,) = (float(word) for word in told.split() if word.replace(".", "").isdigit())
    return percent / 100.0


@pytest.mark.parametrize("column", [pushed, standing])
@pytest.mark.parametrize("part", [0.5, 0.9, 0.99])
def test_below_its_limit_a_column_stands(column: Any, part: float) -> None:
    shape = column(part)
    assert shape.end == pytest.approx((LENGTH, 0.0), abs=1e-4)
    assert not shape.notes


@pytest.mark.parametrize("part", [0.5, 0.9, 0.99])
def test_below_its_limit_a_deep_strip_stays_in_its_plane(part: float) -> None:
    shape = deep(part)
    assert shape.end[2] == 0.0
    assert not shape.notes


@pytest.mark.parametrize("column", [pushed, standing])
@pytest.mark.parametrize("part", BEYOND)
def test_beyond_its_limit_a_column_falls_whatever_the_number_of_its_unstable_directions(
    column: Any, part: float
) -> None:
    """Beyond 9 times Euler's load two directions are unstable: a determinant does not see an even number."""
    with pytest.warns(RodWarning, match=r"its tip moves along y\. This is the stable shape to which it falls"):
        shape = column(part)
    assert part_in(shape.notes[0]) == pytest.approx(1.0 / part, rel=0.01)
    assert is_stable(shape)


@pytest.mark.parametrize("part", BEYOND)
def test_beyond_its_limit_a_deep_strip_falls_sideways(part: float) -> None:
    shape, told = said(deep, part)
    assert "buckles out of its plane" in told
    assert "its tip moves along z, and it twists. This is the stable shape" in told
    assert part_in(told) == pytest.approx(1.0 / part, rel=0.01)
    assert shape.stability.is_stable
    assert shape.end[2] > 1.0


def test_a_strip_that_falls_gives_a_warning_of_python() -> None:
    with pytest.warns(RodWarning, match="buckles out of its plane at 50 % of the load"):
        Rod(DEEP, law=straight()).solve(force=(0.0, 2.0 * LATERAL, 0.0))


@pytest.mark.parametrize("part", BEYOND)
def test_a_column_that_falls_is_the_elastica(part: float) -> None:
    """Timoshenko and Gere, 2.7: K(k) = (pi/2) sqrt(P / P_cr), k = sin(alpha/2), x_end = (2 E/K - 1) l, y_end = 2 k l/K.

    Where alpha nears pi digits of k are lost; its complement 1 - k^2 is found instead.
    """
    quarter = 0.5 * math.pi * math.sqrt(part)
    # K(1 - c) of a small complement c is its logarithm
    log = brentq(lambda log: float(ellipkm1(log)) - quarter, -80.0, -1e-12)
    k = math.sqrt(-math.expm1(log))
    x, y = (2.0 * ellipe(k * k) / quarter - 1.0) * LENGTH, 2.0 * k * LENGTH / quarter
    shape, _ = said(pushed, part)
    # 60 elements, of which the last bend of the elastica has 60 / (4 quarter) at the most load
    assert (shape.end[0], abs(shape.end[1])) == pytest.approx((x, y), abs=5e-6 * LENGTH)


def ellipkm1(log: float) -> float:
    """K of the parameter 1 - exp(log)."""
    return float(ellipk(-math.expm1(log))) if log > -30.0 else math.log(4.0) - 0.5 * log


def is_stable(shape: RodSolution, rod: Rod = COLUMN) -> bool:
    """Whether links settle in this shape, from a start beside it too, and are stable there."""
    links, angle = Links.of(rod, shape)
    settled, lowest = links.settled(angle)
    assert np.abs(settled - angle).max() < 0.05
    again, _ = links.settled(settled + 0.03 * np.linspace(0.0, 1.0, links.n) * min(1.0, 10.0 * lowest))
    return lowest > 0.0 and bool(np.abs(again - settled).max() < 1e-6)


def is_stable_in_space(shape: SpatialSolution, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether it is stable on shorter elements, and so is the shape beside it under a force that is turned a little."""
    rod: Any = shape.path.rod
    turned = rotation(TURN) @ shape.path.load.force
    shapes = [said(rod.solve_in_space, Load(turned))[0]]
    with monkeypatch.context() as patch:
        patch.setattr(law_rod, "ELEMENT", 0.7 * law_rod.ELEMENT)
        shapes.append(said(rod.solve_in_space, shape.path.load)[0])
    for other, apart in zip(shapes, (0.03, 2e-4), strict=True):
        # an arm that falls has two such shapes
        assert np.abs(other.end) == pytest.approx(np.abs(shape.end), abs=apart * DEEP)
    return all(one.stability.is_stable for one in (shape, *shapes))


def planar_case(random: np.random.Generator) -> tuple[Rod, dict[str, Any]]:
    """A column or an arm, straight or curved, under 0.5 to 150 times its limit: a force, or weight and payload."""
    bent = random.choice([0.0, 0.0, 0.0, 1e-5, 0.02, 0.5, 2.0]) * random.choice([-1.0, 1.0])
    soft = random.choice([1.0, 0.6])
    rod = Rod(LENGTH, bent / LENGTH, FiveParameters(soft * EI, EI, 0.0, 0.0, 9.0))
    part = 0.5 * 300.0 ** random.uniform()
    if random.uniform() < 0.5:
        turn = random.choice([0.0, 0.0, 0.1, 1.0]) * random.uniform(-1.0, 1.0)
        return rod, {"force": (-part * EULER * math.cos(turn), part * EULER * math.sin(turn))}
    grams = part * GREENHILL * EI / LENGTH**2 / WEIGHT_OF_GRAM
    lean = float(random.choice([0.0, 0.0, 0.02, 0.7]) * random.uniform(-1.0, 1.0))
    rod = replace(rod, mass=Mass.even(LENGTH, grams))
    gravity = (-math.cos(lean), math.sin(lean))
    return rod, {"direction": gravity, "tip_mass": float(random.choice([0.0, 0.3])) * grams}


def deep_case(random: np.random.Generator) -> Load:
    """A force on a deep strip in its plane, or nearly, of 0.5 to 150 times its limit."""
    part, turn = 0.5 * 300.0 ** random.uniform(), random.uniform(-0.5, 0.5)
    across = random.choice([0.0, 0.0, 1e-5, 0.02])
    return Load((part * LATERAL * math.sin(turn), part * LATERAL * math.cos(turn), part * LATERAL * across))


def test_of_sixty_random_rods_none_is_unstable_without_a_word(monkeypatch: pytest.MonkeyPatch) -> None:
    """Links settle in each shape from a start beside it, and finer elements of strips; what is refused says how."""
    random = np.random.default_rng(81)
    counts = dict.fromkeys(("stands", "fallen", "refused"), 0)
    for number in range(60):
        in_space = number % 3 == 0
        try:
            if in_space:
                shape, told = said(straight(planar=random.choice([20.0, 1e3]) * B).solve_in_space, deep_case(random))
                stable = is_stable_in_space(shape, monkeypatch)
            else:
                rod, given = planar_case(random)
                shape, told = said(rod.solve, **given)
                stable = is_stable(shape, rod)
        except RodError as refused:
            counts["refused"] += 1
            assert "buckles" in str(refused), f"{number}: {refused}"  # noqa: PT017
            continue
        assert stable, f"{number}: {told}"
        counts["fallen" if told else "stands"] += 1
    assert counts["refused"] == 0
    assert min(counts["stands"], counts["fallen"]) > 10


def test_an_end_that_is_pushed_towards_the_clamp_of_a_straight_rod_finds_its_first_mode() -> None:
    """From 20.19 EI/l^2 on (Timoshenko and Gere, 2.1: clamped and pinned); the second mode begins at 59.7."""
    forces = []
    for x in (0.999, 0.9, 0.6):
        shape, told = said(COLUMN.solve, end=(x * LENGTH, 0.0))
        assert re.match(r"The rod buckles at (once|0.0202 % of the load): it moves along y at s = 54 mm\. This", told)
        links, angle = Links.of(COLUMN, shape)
        assert links.settled(angle)[0] == pytest.approx(angle, abs=5e-3)
        forces.append(-shape.force[0] * LENGTH**2 / EI)
    assert forces == pytest.approx([20.198, 20.959, 22.916], abs=1e-3)
    nearly = replace(COLUMN, kappa_0=1e-4 / LENGTH).solve(end=(0.6 * LENGTH, 0.0))
    assert -nearly.force[0] * LENGTH**2 / EI == pytest.approx(forces[-1], rel=1e-4)


@pytest.mark.parametrize("kappa_0", [1e-7, -1e-7, 1e-3, -1e-3])
def test_a_rod_that_is_nearly_straight_falls_to_its_side(kappa_0: float) -> None:
    shape, _ = said(replace(COLUMN, kappa_0=kappa_0 / LENGTH).solve, force=(-30.0 * EULER, 0.0))
    assert math.copysign(1.0, shape.end[1]) == math.copysign(1.0, kappa_0)
    assert abs(shape.end[1]) == pytest.approx(abs(said(pushed, 30.0)[0].end[1]), rel=1e-2)


def test_what_cannot_say_that_an_arm_falls_refuses_it() -> None:
    load = Load((-2.0 * EULER, 0.0))
    with pytest.raises(RodError, match=r"The rod buckles at 50 % of the load: its tip moves along y\."):
        COLUMN.under(load)
    with pytest.raises(RodError, match="its tip moves along y"):
        Branch.all_of(lambda _: COLUMN, lambda rod: said(rod.solve, force=load.force[:2])[0], [0.0, 1.0])
    rod, beyond = straight(planar=B, lateral=1e3 * B), -2.0 * math.pi**2 * B / (4.0 * DEEP**2)
    assert "its tip moves along y" in said(rod.solve, (beyond, 0.0))[1]
    with pytest.raises(RodError, match=r"The rod buckles at 50 % of the load: its tip moves along y\."):
        rod.under(Load((beyond, 0.0)))


def test_an_arch_that_snaps_through_is_refused_with_its_load_and_direction() -> None:
    with pytest.raises(RodError, match=r"buckles at 49\.\d % of the load: it moves along y at s = 4.* No stable shape"):
        arch(1.0)


@pytest.mark.parametrize("solve", [Rod.solve, None])
def test_a_shape_in_the_plane_that_buckles_out_of_it_says_so(solve: Any) -> None:
    law = straight()
    rod, solve = (Rod(DEEP, law=law), solve) if solve else (law, type(law).solve)
    for part, is_said in ((0.9995, False), (1.0005, True), (9.5, True), (15.0, True)):
        shape, told = said(solve, rod, (0.0, part * LATERAL))
        assert ("buckles out of its plane before this load" in told) == is_said
        assert law.stability(shape).is_stable != is_said


def test_a_pressure_for_a_wish_knows_that_the_arm_buckles_out_of_its_plane() -> None:
    rod, load = Rod(DEEP, law=straight()), Load((0.0, 1.5 * LATERAL))
    [branch] = Branch.all_of(lambda _: rod, lambda one: one.under(load), [0.0, 5.0, 10.0])
    assert all("out of its plane" in at.path.sideways for at in branch.extremes(lambda states: states[:, 1]))
