"""Outcomes of experiments as values: merging, failures in the units of the configuration, rows of experiments.json."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fem import End, Seconds
from geometry import Centreline, Reason
from pipeline.config.config import End as ArmEnd
from pipeline.config.load import load_config
from pipeline.simulate.case_path import why_ended, why_left
from pipeline.simulate.effects_record import list_effects
from pipeline.simulate.known_limit import EndOfII
from pipeline.simulate.loadcase import LoadCase, PressureSchedule, identification_case, schedule
from pipeline.simulate.outcome import Failure, Outcome, Outcomes, Record
from pipeline.simulate.scene import Scene
from pipeline.values.reasons import render_all
from pipeline.values.run import State
from rod import Load

WHY = (Reason("not_tried"),)
CURVE = Centreline(np.arange(5.0), np.arange(5.0), np.zeros(5))


def record(pressure: float, stress_error: float = 0.1, factorizations: int = 3) -> Record:
    state = State(
        "II",
        pressure,
        end_x_mm=100.0,
        end_y_mm=-pressure,
        stress_error=stress_error,
        stress_error_at_mm=(0.0, 0.0, 0.0),
        newton_iterations=factorizations,
        factorizations=factorizations,
    )
    spent = Seconds(assembly=1.0, factorization=2.0, effects={"pressure": 0.25, "self_contact": 0.5})
    return Record(state, CURVE, Load(), np.zeros((2, 3)), {}, ("pressure",), spent, (False, False))


def outcome(name: str, *records: Record, failure: Failure | None = None) -> Outcome:
    seconds = sum((state.spent for state in records), Seconds(set_up=0.5))
    factorizations = sum(state.state.factorizations for state in records)
    return Outcome(name, records, failure, seconds, factorizations, 100, "LU", np.zeros((2, 3)), np.zeros((1, 4), int))


def test_states_restored_from_an_earlier_path_count_once() -> None:
    first = outcome("II", record(10.0), record(30.0))
    more = outcome("II", record(10.0), record(20.0, factorizations=5))
    merged = first.merged(more)
    assert [state.pressure_kPa for state in merged.records] == [10.0, 20.0, 30.0]
    assert merged.factorizations == 3 + 3 + 5
    assert merged.seconds.set_up == 1.0
    assert merged.seconds.factorization == 6.0


def test_a_failure_is_a_reason_and_a_row() -> None:
    stopped = outcome("III", record(10.0), failure=Failure(20.0, WHY, 2, 7))
    outcomes = Outcomes({"II": outcome("II", record(10.0), record(20.0)), "III": stopped})
    values = {"pressure_kPa": 20.0, "reached_kPa": 0.0, "limit_kPa": 0.0, "why": [*WHY]}
    assert outcomes.failures == (Reason("stopped", {"experiment": "III", **values}),)
    assert stopped.why_stopped("end at +3 mm") == Reason("load_stopped", {"load": "end at +3 mm", **values})
    states = outcomes.states
    assert [state.reached for state in states] == [True, True, True, False]
    failed = states[-1]
    assert (failed.experiment, failed.pressure_kPa, failed.reason) == ("III", 20.0, "it was not solved")
    assert np.isnan(failed.end_x_mm)
    assert stopped.at(20.0) is None
    assert stopped.at(10.0) is stopped.records[0]


def test_the_lowest_end_is_a_limit_or_the_last_equilibrium() -> None:
    ends = {
        "I": Failure(150.0, (), 0, 0, limit_kPa=64.7, reached_kPa=64.6),
        "II": Failure(150.0, (), 0, 0, reached_kPa=5.0, not_followed=True),
        "III": Failure(150.0, (), 0, 0, reached_kPa=40.0),
    }
    outcomes = Outcomes({name: outcome(name, record(5.0), failure=failure) for name, failure in ends.items()})
    assert outcomes.first_to_end == ("III", 40.0)
    assert outcomes.lowest_end_kPa() == 40.0
    assert outcomes.lowest_end_kPa("I", "II") == 64.7
    assert outcomes.lowest_end_kPa("II") == float("inf")
    assert Outcomes({"II": outcome("II", record(5.0))}).lowest_end_kPa() == float("inf")


def test_a_first_pressure_at_which_the_body_passes_through_itself_is_no_lower_than_the_end() -> None:
    at_first = Failure(128.0, (), 0, 0, passes_through_itself=True)
    assert at_first.end_kPa == 128.0
    assert replace(at_first, reached_kPa=64.0).end_kPa == 64.0
    assert replace(at_first, passes_through_itself=False).end_kPa == 0.0
    ends = {"II": Failure(257.0, (), 0, 0, limit_kPa=223.0), "III": at_first}
    outcomes = Outcomes({name: outcome(name, failure=failure) for name, failure in ends.items()})
    assert outcomes.first_to_end == ("III", 128.0)


def test_an_end_before_the_end_of_the_arm_is_where_it_is_held_is_no_limit_of_the_pressure() -> None:
    """II bears 20 kPa; III ends at 1.4 kPa, with 7 % of a displacement that the arm is too short for."""
    too_far = Failure(20.0, (), 0, 0, reached_kPa=1.4, with_part_of_end=True)
    assert too_far.end_kPa == 0.0
    outcomes = Outcomes({"II": outcome("II", record(20.0)), "III": outcome("III", failure=too_far)})
    assert outcomes.first_to_end is None


def test_the_indicator_is_that_of_the_worst_state() -> None:
    outcomes = Outcomes({"II": outcome("II", record(10.0, 0.1), record(20.0, 0.3), record(30.0, 0.2))})
    worst = outcomes.largest_indicator
    assert (worst.stress_error, worst.pressure_kPa) == (0.3, 20.0)
    assert "at most 30 % in energy, in II at 20 kPa" in worst.sentence
    assert Outcomes({}).largest_indicator is None


def test_seconds_by_stage_add_up_to_the_total() -> None:
    outcomes = Outcomes({"II": outcome("II", record(10.0)), "III": outcome("III", record(10.0), record(20.0))})
    stages = outcomes.seconds_by_stage
    assert sum(stages.values()) == outcomes.seconds.total
    assert stages["contact"] == 1.5
    assert stages["assembly"] == 3.75


@pytest.mark.parametrize(
    ("gaps", "reason"),
    [
        ((0.8, 0.25), "no walls came within the activation distance of contact; the smallest gap was 0.25 mm"),
        ((float("inf"),), "no walls came within the activation distance of contact; no walls face each other"),
    ],
)
def test_a_smallest_gap_is_named_where_there_is_one(gaps: tuple[float, ...], reason: str, configs: Path) -> None:
    states = [record(10.0 * (k + 1)) for k in range(len(gaps))]
    states = [
        replace(state, state=replace(state.state, min_gap_mm=gap)) for state, gap in zip(states, gaps, strict=True)
    ]
    body: Any = SimpleNamespace(half=True)
    scene = Scene(load_config(configs / "pneunet_coarse.yaml"), body)
    rows = {state.effect: state for state in list_effects(scene, Outcomes({"II": outcome("II", *states)}))}
    assert (rows["self_contact"].state, rows["self_contact"].reason) == ("off", reason)


def test_contact_acts_on_the_way_to_a_pressure_that_is_not_reached(configs: Path) -> None:
    scene = Scene(load_config(configs / "pneunet_coarse.yaml"), SimpleNamespace(half=True))  # type: ignore[arg-type]
    rows = {state.effect: state for state in list_effects(scene, Outcomes({"II": outcome("II")}))}
    assert (rows["self_contact"].state, rows["self_contact"].reason) == (
        "on",
        "no pressure was reached; on the way contact acts on walls that come near each other",
    )


def test_the_first_reason_is_not_that_another_experiment_has_ended() -> None:
    ends = {
        "I": Failure(150.0, (), 0, 0, not_followed=True),
        "II": Failure(150.0, (), 0, 0, limit_kPa=64.7, reached_kPa=64.6),
        "III": Failure(150.0, (), 0, 0, reached_kPa=40.0),
    }
    outcomes = Outcomes({name: outcome(name, record(5.0), failure=failure) for name, failure in ends.items()})
    assert [reason.values["experiment"] for reason in outcomes.failures] == ["II", "III", "I"]


SCHEDULE = PressureSchedule((45.0,), 45.0)
END = End("load factor", 1.0, 0.4, 0.5, 3, 40, (Reason("stiffer_contact_fails"),))


def test_where_a_path_ended_in_the_units_of_the_configuration() -> None:
    free, held, drawn = (
        LoadCase(name, name, SCHEDULE, at_end)
        for name, at_end in (("II", ArmEnd()), ("III", ArmEnd(y_mm=-30.0)), ("III", ArmEnd(force_N=(0.2, 0.0))))
    )
    assert why_ended(END, free) == (Reason("ends_beyond", {"reached_kPa": 18.0, "target_kPa": 45.0}), *END.reasons)
    first, limit, *_ = why_ended(replace(END, limit=0.5), held)
    assert (first.code, limit) == ("ends_with_part", Reason("has_limit", {"limit_kPa": 22.5}))
    assert first.values == {"reached_kPa": 18.0, "target_kPa": 45.0, "percent": 50.0, "on_end": "u_y = -30 mm"}
    assert why_ended(END, drawn)[0].values["on_end"] == "F_x = 0.2 N"
    assert why_ended(replace(END, constant_fraction=1.0), held)[0].code == "ends_beyond"
    assert render_all(why_ended(END, free)) == (
        "no equilibrium found beyond 18 kPa on the way to 45 kPa; more or stiffer contact does not help"
    )


def test_how_far_a_path_was_followed_that_was_given_up() -> None:
    case, second = LoadCase("I", "I", SCHEDULE, ArmEnd()), EndOfII(17.0, 20.0, is_limit=True)
    because = Reason("end_of_II", {"end": "limit", "end_kPa": 20.0})
    assert why_left(END, case, second) == (Reason("followed_to", {"reached_kPa": 18.0}), because)
    assert why_left(replace(END, reached=0.0), case, second) == (Reason("not_tried"), because)


def test_load_factors_are_pressures_over_the_largest_of_the_run() -> None:
    of_run = PressureSchedule((5.0, 17.0, 31.0, 45.0), 45.0)
    assert of_run.reference_MPa == 0.045
    assert of_run.factors == (0.005 / 0.045, 0.017 / 0.045, 0.031 / 0.045, 1.0)
    assert f"{of_run.pressure_at(0.4):.4g}" == "18"


def test_other_pressures_are_scaled_by_the_largest_of_the_run(configs: Path) -> None:
    config = load_config(configs / "pneunet_coarse.yaml")
    assert identification_case(config, "III").schedule == PressureSchedule((17.0, 37.0), 37.0)
    assert schedule(config, (24.0,)) == PressureSchedule((24.0,), 37.0)
