"""The rod compared with known shapes: distances, forces, curvatures, and shapes that cannot be compared."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fem import Seconds
from geometry import Centreline
from pipeline.answers.rods.choice import rod_of_path
from pipeline.identify.compare import Rods, compare_rods, curve_of
from pipeline.simulate.outcome import Record
from pipeline.values.formats import ARM_LAW, FIVE
from pipeline.values.run import RodError, State
from rod import FiveParameters, LawRod, Load, MomentRange, Rod
from rod.errors import RodError as NoRod

HERE = Path(__file__).resolve().parent.parent.parent
LENGTH, PITCH = 112.0, 10.0
ROD = Rod(LENGTH, -0.015, FiveParameters(190.0, 400.0, 0.0, 0.0, 6.0), 0.0, (0.0, 1.0))
S = np.linspace(0.0, LENGTH, 225)


#: any moment is known
ALL = MomentRange(-100.0, 100.0)


def rods(rod: Rod, moment_range: MomentRange = ALL) -> Rods:
    return {FIVE: replace(rod, moment_range=moment_range)}


def record(experiment: str, rod: Rod, **loads) -> Record:
    """What finite elements would give if they were this rod under these loads."""
    shape = rod.solve(**loads)
    x, y = shape.positions(S).T
    load = Load((float(shape.force[0]), float(shape.force[1])))
    empty = np.zeros((0, 3))
    return Record(
        summary(experiment), Centreline(S, x, y), load, empty, {}, (), Seconds(), (False, experiment == "III")
    )


def row_of(compared: Rods, solid: Record, load: str = "", rod: str = FIVE) -> RodError:
    """The row of a rod in validation.json; a load in words makes the state one out of sample."""
    rows = compare_rods(compared, solid, PITCH, load, in_sample=not load).errors
    return next(row for row in rows if row.rod == rod)


def summary(experiment: str) -> State:
    """A state of which only the experiment and the pressure matter."""
    return State(experiment, 24.0)


@pytest.mark.parametrize(
    ("experiment", "loads"), [("II", {}), ("III", {"end_y": 1.0}), ("dead", {"force": (0.0, 0.05)})]
)
def test_a_rod_agrees_with_itself_under_every_load(experiment: str, loads: dict) -> None:
    row = row_of(rods(ROD), record(experiment, ROD, **loads))
    assert row.distance_over_length < 1e-7
    assert row.distance_over_length_without_stretch < 1e-4  # chords instead of arcs
    assert abs(row.end_angle_error_rad) < 1e-6
    assert row.curvature_error < 1e-6
    assert (row.force_error is None) == (experiment != "III")
    assert row.reason == ""


def test_the_end_angle_is_that_of_the_same_chord_on_a_coarse_mesh() -> None:
    """Nodes 14 mm apart: the chord between the last two is 0.1 rad off the tangent, of both alike."""
    solid = record("II", ROD)
    x, y = ROD.solve().positions(coarse := np.linspace(0.0, LENGTH, 9)).T
    row = row_of(rods(ROD), replace(solid, centreline=Centreline(coarse, x, y)))
    assert abs(row.end_angle_error_rad) < 1e-9


def test_errors_are_those_put_in() -> None:
    stiffer = replace(ROD, law=FiveParameters(209.0, 440.0, 0.0, 0.0, 6.0))
    row = row_of(rods(stiffer), record("III", ROD, end_y=1.0), "end at +10 mm")
    assert row.force_error == pytest.approx(0.1, abs=2e-3)
    assert row.sample == "out"
    assert row.load == "end at +10 mm"
    shifted = record("II", ROD)
    moved = replace(shifted, centreline=Centreline(S, shifted.centreline.x, shifted.centreline.y + S / LENGTH))
    row = row_of(rods(ROD), moved)
    assert row.distance_over_length == pytest.approx(1.0 / LENGTH)
    assert row.distance_at_s_mm == LENGTH


def test_the_force_on_an_end_that_is_held_along_both_axes_counts_as_a_whole() -> None:
    """A small force across the arm beside a large one along it is no large error."""
    solid = replace(record("III", ROD, end_y=1.0), held=(True, True))
    row = row_of(rods(ROD), solid)
    across = solid.load.force[1]
    assert row.force_error < 1e-6
    assert row.force_N == pytest.approx(abs(across))
    pulled = replace(solid, load=Load((3.0 * across, across)))
    row = row_of(rods(ROD), pulled)
    assert row.force_error == pytest.approx(3.0 / 10.0**0.5, rel=1e-5)
    assert row.force_N == pytest.approx(10.0**0.5 * abs(across))
    assert row.rod_force_N == pytest.approx(abs(across), rel=1e-5)


def test_the_force_along_the_axis_that_is_held_is_compared() -> None:
    """Along x here; across the end is free."""
    shape = ROD.solve(end_x=100.0)
    x, y = shape.positions(S).T
    solid = record("III", ROD, end_y=1.0)
    solid = replace(solid, centreline=Centreline(S, x, y), load=Load((float(shape.force[0]), 0.0)), held=(True, False))
    row = row_of(rods(ROD), solid)
    assert abs(row.force_error) < 1e-6
    assert row.force_N == pytest.approx(shape.force[0])


def test_a_soft_place_is_found_where_it_is() -> None:
    soft = replace(ROD, law=FiveParameters(40.0, 400.0, 0.0, 0.0, 12.0))
    row = row_of(rods(ROD), record("III", soft, end_y=1.0))
    assert row.curvature_error_at_s_mm < 12.0


def test_a_load_without_solution_says_so() -> None:
    far = record("III", ROD, end_y=1.0)
    beyond = replace(far, centreline=Centreline(S, far.centreline.x, far.centreline.y + 3.0 * S))
    row = row_of(rods(ROD), beyond)
    assert row.reason.endswith(".")
    assert row.force_error is None
    assert np.isnan(curve_of(beyond, None, PITCH)["rod_x_mm"][0])


def test_loads_beyond_the_law_of_the_arm_say_which_moments_it_lacks() -> None:
    own = rod_of_path(HERE / "data" / "results_coarse", None).at(31.0)
    assert isinstance(own.law, LawRod)
    (low, high), s = own.law.moments, np.linspace(0.0, own.length, 113)
    straight = replace(record("dead", ROD), centreline=Centreline(s, s, 0.0 * s), load=Load((0.0, 2.0 * high / LENGTH)))
    reason = row_of({ARM_LAW: own}, straight, "dead", rod=ARM_LAW).reason
    assert "At 24 kPa its loads bend it with" in reason
    assert f"and its law has {low:.3g} to {high:.3g}; make the arm lighter or stiffer." in reason


def test_a_pressure_without_a_rod_is_a_row_with_the_reason() -> None:
    row = row_of({FIVE: NoRod("17 kPa lies outside.")}, record("II", ROD))
    assert row.reason == "17 kPa lies outside."
    assert row.distance_over_length is None


def test_the_couple_of_the_held_edge_is_part_of_the_load() -> None:
    held = record("III", ROD, end_y=1.0, moment=0.5)
    held = replace(held, load=replace(held.load, couple=0.5))
    assert abs(row_of(rods(ROD), held).force_error) < 1e-7


def test_moments_that_were_not_identified_are_said() -> None:
    held = record("III", ROD, end_y=1.0)
    row = row_of(rods(ROD, MomentRange(0.0, 1.0)), held)
    assert row.warning.startswith("The moment leaves the 0 to 1 N mm")
    assert row_of(rods(ROD), held).warning == ""
