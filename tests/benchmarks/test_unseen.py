"""Designs drawn at random: how they are drawn, how their outcomes are sorted, and one of them from end to end."""

import json
import pickle
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fem
from benchmarks.unseen.__main__ import main as campaigns_main
from benchmarks.unseen.__main__ import with_larger_elements
from benchmarks.unseen.checks import ALLOWED, Check, checks_of, followed, work_difference
from benchmarks.unseen.confirm import BY_VOLUME, UNEXPLAINED, end_of, judged, names_a_limit, second_law, turned
from benchmarks.unseen.designs import COMPRESSIBLE, LOAD, LOWER, Drawn, drawn
from benchmarks.unseen.sorting import (
    EARLY,
    LIMIT,
    NO_LIMIT,
    SOLVED,
    TOO_SLOW,
    TRACEBACK,
    WRONG,
    checks_in,
    has_numbers,
    outcome,
    rod_errors,
    states_of,
)
from benchmarks.unseen.table import largest_share, summary
from benchmarks.unseen.work import ERROR, FAILED, RAN, REFUSED, SLOW, Work, lost, outcome_of, outcomes_of
from fem.materials import LAWS
from fem.path.diagnosis import near_limit_point
from fem.path.predictor import PathPoint
from fem.solution import Extremes
from geometry import FAMILIES, Reason
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.simulate.loadcase import LoadCase, schedule
from pipeline.simulate.outcome import Failure, Record
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.values.errors import WorkerLost
from tests.bodies import box
from tests.loads import Traction
from tests.solved import alone

HERE = Path(__file__).resolve().parent.parent.parent

COUNT = 40
#: a design that takes seconds: few elements, five parameters alone, no second mesh
TINY: dict[str, Any] = {
    "name": "tiny",
    "geometry": {"family": "semicircular_single", "length": "70 mm", "radius": "7.5 mm", "wall": "1.5 mm"},
    "material": {"law": "neo_hooke", "mu": "0.4 MPa", "nu": 0.49},
    "pressures": ["10 kPa", "20 kPa"],
    "mesh": {"size": "7 mm", "formulation": "p2p0", "grading": "off", "coarser": "off"},
    "law": "five",
    "validation": {"state": "off"},
}


def config_of(folder: Path, document: Any) -> Config:
    path = folder / "design.yaml"
    path.write_text(json.dumps(document), encoding="utf-8")
    return load_config(path)


def test_a_seed_always_gives_the_same_designs() -> None:
    assert [asdict(design) for design in drawn(7, COUNT)] == [asdict(design) for design in drawn(7, COUNT)]
    assert drawn(7, COUNT)[0].document != drawn(8, COUNT)[0].document


def test_all_families_and_laws_are_drawn_equally_often() -> None:
    designs = drawn(5, COUNT)
    assert Counter(design.family for design in designs) == dict.fromkeys(FAMILIES, COUNT // len(FAMILIES))
    laws = Counter(design.law for design in designs)
    assert set(laws) == set(LAWS)
    assert max(laws.values()) - min(laws.values()) <= 1
    compressible = sum(design.document["material"]["nu"] < 0.45 for design in designs)
    assert compressible == pytest.approx(COMPRESSIBLE * COUNT, abs=1)


@pytest.mark.parametrize("seed", [1, 5])
def test_every_design_is_accepted_and_its_pressures_are_scaled_to_it(seed: int, tmp_path: Path) -> None:
    designs = drawn(seed, COUNT)
    loads = []
    for design in designs:
        config = config_of(tmp_path, design.document)
        low, high = config.pressures_kPa
        assert low == pytest.approx(LOWER * high, rel=0.006)
        law = config.material.built()
        modulus = 2.0 * law.shear_modulus * (1.0 + law.poisson_ratio)
        first = next(iter(config.design.cavity_volumes.values()))
        loads.append(high / 1000.0 * first / (modulus * config.design.solid_volume))
        assert loads[-1] == pytest.approx(design.load, rel=0.02)
    assert min(loads) == pytest.approx(LOAD[0], rel=0.1)
    assert max(loads) == pytest.approx(LOAD[1], rel=0.1)


def state(experiment: str, pressure: float, reached: bool = True) -> dict[str, Any]:
    return {"experiment": experiment, "pressure_kPa": pressure, "reached": reached}


def record(**changes: Any) -> dict[str, Any]:
    """A design that was solved, with passed checks, or with changes."""
    checks = [asdict(Check(name, 10.0, 0.1 * allowed)) for name, allowed in ALLOWED.items()]
    return {
        "number": 0,
        "family": "pneunet",
        "law": "svk",
        "words": "an arm",
        "sources": "abc1234",
        "load": 0.01,
        "pressures_kPa": [10.0, 20.0],
        "ended": RAN,
        "reason": "",
        "reasons": {},
        "seconds": {"run": 30.0, "checks": 10.0},
        "states": [state(name, p) for name in ("I", "II", "III") for p in (10.0, 20.0)],
        "checks": checks,
        "limits": [],
        "slow": [],
        "elements": "mixed",
        "size_mm": 3.0,
        "unknowns": 20000,
        "five_at_kPa": [10.0, 20.0],
        "has_arm_law": True,
        "turn_rad": 1.0,
        "rod": {
            "rod": "arm_law",
            "distance_over_length_in_sample": 0.002,
            "distance_over_length_out_of_sample": 0.004,
            "force_error_in_sample": None,
            "force_error_out_of_sample": -0.05,
        },
        **changes,
    }


REASON = ["ends_beyond", "has_limit", "tangent_indefinite"]
LIMIT_REASONS = tuple(map(Reason, REASON))
MISSED = {
    "reasons": dict.fromkeys(("I", "II"), REASON),
    "states": [state("I", 10.0), state("I", 20.0, False), state("II", 10.0), state("II", 20.0, False)],
}


def limit(confirmed: bool, experiment: str = "II", kPa: float = 12.6) -> dict[str, Any]:
    return {"experiment": experiment, "limit_kPa": kPa, "confirmed": confirmed, "sentence": BY_VOLUME}


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, SOLVED),
        (MISSED, LIMIT),
        ({**MISSED, "reasons": {"II": ["ends_beyond", "not_converged"]}}, NO_LIMIT),
        ({"ended": REFUSED}, EARLY),
        ({"ended": FAILED}, NO_LIMIT),
        ({"ended": SLOW}, TOO_SLOW),
        ({"ended": ERROR}, TRACEBACK),
        ({"broken": {"checks": "ValueError: x"}}, TRACEBACK),
    ],
)
def test_outcomes_are_sorted(changes: dict[str, Any], expected: str) -> None:
    assert outcome(record(**changes)) == expected


@pytest.mark.parametrize("name", ALLOWED)
def test_a_wrong_answer_is_called_wrong(name: str) -> None:
    """Whatever else is said of the design; and a check that could not be made is no proof of an error."""
    others = [asdict(Check(other, 10.0, 0.0)) for other in ALLOWED if other != name]
    wrong = Check(name, 10.0, 1.01 * ALLOWED[name])
    assert outcome(record(checks=[*others, asdict(wrong)])) == WRONG
    assert outcome(record(checks=[*others, asdict(wrong)], **MISSED)) == WRONG
    assert outcome(record(checks=[*others, asdict(replace(wrong, value=0.99 * ALLOWED[name]))])) == SOLVED
    unmade = Check(name, 10.0, None, "no equilibrium")
    assert not unmade.passed
    assert outcome(record(checks=[*others, asdict(unmade)])) == SOLVED


def test_states_count_as_explained_only_by_a_confirmed_limit() -> None:
    assert states_of(record()).solved == 6
    for limits, beyond in (([], 0), ([limit(False)], 0), ([limit(True)], 2), ([limit(True, kPa=26.0)], 1)):
        states = states_of(record(**MISSED, limits=limits))
        assert (states.solved, states.beyond, states.not_confirmed) == (2, beyond, 2 - beyond)
    # 26 kPa explains II, where it was found, but not that I ended before 20 kPa
    assert states_of(record(ended=SLOW, states=[])).not_tried == 6
    assert states_of(record(ended=REFUSED)).all == 0
    failed = [asdict(Check("work", 10.0, 1.0))]
    assert states_of(record(checks=failed)).good == 0.0


def test_a_prescribed_volume_confirms_a_limit_where_the_pressure_turns() -> None:
    said, agrees = turned([9.0, 10.1, 9.5], 10.0, "")
    assert said.startswith(BY_VOLUME)
    assert agrees
    assert turned([9.0, 10.0, 10.5], 10.0, "it ended") == ("no maximum of the pressure up to 10.5 kPa: it ended", None)
    assert turned([8.0, 9.0, 8.5], 10.0, "")[1] is None


@pytest.mark.parametrize("pressures", [[9.0, 12.0, 11.0], [9.0, 10.5, 11.0]])
def test_a_prescribed_volume_that_leads_beyond_a_limit_refutes_it(pressures: list[float]) -> None:
    assert turned(pressures, 10.0, "it ended")[1] is False


def test_a_second_law_confirms_a_limit_near_the_first() -> None:
    near, far = (Failure(20.0, LIMIT_REASONS, 0, 0, kPa) for kPa in (11.0, 19.0))
    of_body = Failure(20.0, LIMIT_REASONS, 0, 0, 12.6)
    assert judged(of_body, 12.6, "neo_hooke", near)[1]
    assert not judged(of_body, 12.6, "neo_hooke", far)[1]
    assert not judged(of_body, 12.6, "neo_hooke", None)[1]
    for law, stretches in ((fem.StVenantKirchhoff(1.0, 0.4), (0.3, 1.1)), (fem.Hencky(1.0, 0.4), (0.9, 2.8))):
        extremes = Extremes(0.5, max(stretches), min(stretches), (0.0,) * 3, (0.0,) * 3, (0.0,) * 3)
        of_law = replace(of_body, reasons=(Reason("ends_beyond"), fem.outside_stable_range(extremes, law)))
        assert judged(of_law, 12.6, "neo_hooke", None)[1]
    assert judged(of_law, 12.6, "neo_hooke", far)[1]  # it goes on well beyond the limit of the first law
    before, shortly_before, behind = (Failure(20.0, LIMIT_REASONS, 0, 0, kPa) for kPa in (9.0, 11.0, 15.9))
    assert not judged(of_law, 12.6, "neo_hooke", before)[1]
    assert judged(of_law, 12.6, "neo_hooke", shortly_before)[1]
    assert "the law is the cause" in judged(of_law, 12.6, "neo_hooke", behind)[0]
    crossing = Failure(20.0, (Reason("crosses_itself"),), 0, 0, reached_kPa=12.5, passes_through_itself=True)
    assert judged(crossing, 0.0, "neo_hooke", crossing)[1]
    assert not judged(crossing, 0.0, "neo_hooke", near)[1]
    assert (end_of(near), end_of(crossing)) == (11.0, 0.0)
    assert end_of(Failure(20.0, LIMIT_REASONS, 0, 0, reached_kPa=12.5)) == 12.5


STOPPED = Reason("ends_beyond"), Reason("not_converged")


def test_a_second_law_confirms_nothing_where_one_of_both_names_no_limit() -> None:
    stopped, named = Failure(20.0, STOPPED, 0, 0, 0.0, 12.5), Failure(20.0, LIMIT_REASONS, 0, 0, 12.6)
    assert judged(named, 12.6, "hencky", stopped) == (
        "with hencky the path ends at 12.5 kPa, and no limit is named there",
        False,
    )
    assert not judged(stopped, 12.5, "hencky", stopped)[1]
    said, agrees = judged(stopped, 12.5, "hencky", named)
    assert said.startswith("the run names no limit")
    assert not agrees


def test_an_end_that_nothing_explains_names_no_limit() -> None:
    compression = Traction("right", lambda x: np.broadcast_to([-0.001, 0.0, 0.0], x.shape))
    mesh, law = box((4, 1, 1), (4.0, 1.0, 1.0)), fem.StVenantKirchhoff(1.0, 0.0)
    system = fem.Model(mesh, law, [fem.Fixed("left")], [compression]).system()
    rest = PathPoint(0.0, 0.0, system.rest_state())
    unexplained = [reason.code for reason in near_limit_point(system, rest)]
    assert UNEXPLAINED in unexplained
    assert not names_a_limit(unexplained)
    assert not names_a_limit(["not_converged"])
    assert names_a_limit([reason.code for reason in near_limit_point(system, rest, limit_is_confirmed=True)])
    assert outcome(record(**{**MISSED, "reasons": {"I": REASON, "II": unexplained}})) == NO_LIMIT


@pytest.mark.parametrize("seed", [3])
def test_the_second_law_has_the_same_moduli(seed: int, tmp_path: Path) -> None:
    for design in drawn(seed, 10):
        config = config_of(tmp_path, design.document)
        first, second = config.material.built(), second_law(config).material.built()
        assert type(first) is not type(second)
        assert second.shear_modulus == pytest.approx(first.shear_modulus)
        assert second.poisson_ratio == pytest.approx(first.poisson_ratio)


@pytest.mark.slow
def test_a_design_is_run_checked_and_kept(tmp_path: Path) -> None:
    design = Drawn(0, 0, TINY, 0.01)
    work = Work(design, tmp_path, 200.0, finer=False)
    result = outcome_of(work)
    assert result["ended"] == RAN, result
    assert "broken" not in result, result
    assert [(check.name, check.passed) for check in checks_in(result)] == [(name, True) for name in ALLOWED]
    assert outcome(result) == SOLVED
    assert states_of(result).solved == 6
    begun = (tmp_path / "outcome.json").stat().st_mtime_ns
    assert outcome_of(work) == result
    assert (tmp_path / "outcome.json").stat().st_mtime_ns == begun
    other = Drawn(0, 0, {**TINY, "pressures": ["0 kPa"]}, 0.01)
    assert outcome_of(replace(work, design=other))["ended"] == REFUSED


def test_designs_are_worked_on_at_the_same_time_and_kept(tmp_path: Path) -> None:
    """Three designs that are refused, two at a time; what is stored is not worked on again."""
    designs = [Drawn(0, number, {**TINY, "pressures": ["0 kPa"]}, 0.01) for number in range(3)]
    works = [Work(design, tmp_path / design.name, 200.0, False) for design in designs]
    records = sorted(outcomes_of(works, 2), key=lambda record: record["number"])
    assert [(record["number"], record["ended"]) for record in records] == [(k, REFUSED) for k in range(3)]
    times = [(work.folder / "outcome.json").stat().st_mtime_ns for work in works]
    assert list(outcomes_of(works, 2)) == records
    assert [(work.folder / "outcome.json").stat().st_mtime_ns for work in works] == times


@pytest.mark.parametrize(("hung", "ended", "sorted_as"), [("", ERROR, TRACEBACK), ("Timeout", SLOW, TOO_SLOW)])
def test_a_process_that_ends_leaves_a_record_with_its_finished_stages(
    hung: str, ended: str, sorted_as: str, tmp_path: Path
) -> None:
    work, failure = Work(Drawn(0, 0, {**TINY, "pressures": ["8 kPa"]}, 0.01), tmp_path, 200.0, False), WorkerLost("no")
    assert work.kept.read() is None
    work.stages.save(record(ended=RAN, load=0.02))
    (tmp_path / "hung.txt").write_text(hung, encoding="utf-8")
    found = lost(work, failure)
    assert (found["ended"], found["reason"], found["load"]) == (ended, "no", 0.02)
    assert outcome(found) == sorted_as
    assert list(outcomes_of([work], 1)) == [found]  # it is kept


def test_a_process_that_hangs_is_ended(tmp_path: Path) -> None:
    """It uses no CPU time, and ends after as much wall time as its limit allows."""
    work = Work(Drawn(0, 0, TINY, 0.01), tmp_path, 0.01, False)
    program = """
import pickle, sys, time
from benchmarks.unseen import work
work._worked = lambda _: time.sleep(60.0)
work.work_on(pickle.load(sys.stdin.buffer))
"""
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, input=pickle.dumps(work), capture_output=True, timeout=50.0, check=False, cwd=HERE)
    assert done.returncode != 0
    assert "Timeout" in (tmp_path / "hung.txt").read_text(encoding="utf-8")
    assert lost(work, RuntimeError("ended"))["ended"] == SLOW


def test_checks_notice_a_state_that_is_slightly_wrong(tmp_path: Path) -> None:
    config = config_of(tmp_path, TINY)
    with alone(tmp_path / "run", config) as context:
        outcomes = simulate(Scene.meshed(config), context, ["II", "III"])

    def lifted(state: Record) -> Record:
        (x, y), height, curve = state.state.end_mm, 1e-4 * config.design.length, state.centreline
        moved = replace(state.state, end_x_mm=x, end_y_mm=y + height)
        return replace(state, state=moved, centreline=replace(curve, y=curve.y + height))

    free, held = (lifted(outcomes[name].records[0]) for name in ("II", "III"))
    by_name = {check.name: check for check in checks_of(config, [free], [held], tmp_path)}
    assert by_name["load steps"].failed
    assert by_name["load steps of III"].failed
    assert by_name["half and whole"].failed
    assert not by_name["other elements"].failed, "elements differ by more than that"


def test_states_at_other_pressures_than_those_of_the_design_are_checked(tmp_path: Path) -> None:
    """An arm that bears none of its pressures has states below its limit."""
    config = config_of(tmp_path, TINY)
    with alone(tmp_path / "run", config) as context:
        cases = [LoadCase(name, name, schedule(config, (4.0,)), config.end) for name in ("II", "III")]
        outcomes = simulate(Scene.meshed(config), context, cases)
    checks = checks_of(config, outcomes["II"].records, outcomes["III"].records, tmp_path)
    assert [(check.name, check.pressure_kPa, check.passed) for check in checks] == [
        (name, 4.0, True) for name in ALLOWED
    ]


def test_the_balance_of_work_is_not_checked_where_a_support_does_work(tmp_path: Path) -> None:
    config = config_of(tmp_path, {**TINY, "end": {"y": "1 mm"}})
    with alone(tmp_path / "run", config) as context:
        held = simulate(Scene.meshed(config), context, ["III"])["III"].records
    checks = checks_of(config, [], held, tmp_path)
    assert [check.name for check in checks] == ["load steps of III", "work of III"]
    assert [check.passed for check in checks] == [True, False]
    assert [check.note for check in checks] == ["", "a force or a support does work on the end"]
    assert not checks[1].failed


@pytest.mark.parametrize("name", ["II", "III"])
def test_work_and_energy_differ_where_the_state_is_no_equilibrium(tmp_path: Path, name: str) -> None:
    config = config_of(tmp_path, TINY)
    scene = Scene.meshed(config)
    model, steps = followed(scene, fem.Experiment.of(name, scene.body, 0.0), [0.01, 0.25, 0.5])
    assert work_difference(model, steps, 0.02, "cavity") < 0.1 * ALLOWED["work"]
    jumped = [*steps[:2], replace(steps[2], displacement=1.02 * steps[2].displacement)]
    assert work_difference(model, jumped, 0.02, "cavity") > ALLOWED["work"]


def test_an_experiment_that_ends_because_of_two_is_sorted_by_the_sentence_of_two() -> None:
    because, part = ["followed_to", "end_of_II"], ["followed_near_end_of_II"]
    record = {"ended": "ran", "checks": [], "reasons": {"I": because, "II": ["not_converged"], "III": part}}
    assert outcome(record) == NO_LIMIT
    assert outcome(record | {"reasons": {"I": because, "II": ["stretch_too_small"], "III": part}}) == LIMIT


def test_only_what_a_user_must_give_is_given() -> None:
    for design in drawn(2, COUNT):
        assert set(design.document) == {"name", "geometry", "material", "pressures"}


def test_numbers_are_parameters_or_a_law_or_an_early_refusal() -> None:
    assert has_numbers(record())
    assert has_numbers(record(five_at_kPa=[]))
    assert not has_numbers(record(five_at_kPa=[], has_arm_law=False))
    assert has_numbers(record(five_at_kPa=[], has_arm_law=False, ended=REFUSED))


def test_the_table_counts_designs_states_and_the_errors_of_the_rod() -> None:
    records = [record(), record(rod=None, limits=[limit(True)], **MISSED)]
    assert rod_errors(records) == {"shape": [0.004], "force": [0.05]}
    lines = summary(records).splitlines()
    for row in (
        f"| {SOLVED} | 1 |",
        f"| {LIMIT} | 1 |",
        "| states solved | 8 of 10 |",
        "| states beyond a confirmed limit | 2 |",
        "| limits confirmed | 1 of 1 |",
        "| designs with numbers or an early refusal | 2 of 2 |",
        "| shape error of the rod: median, largest | 0.4 %, 0.4 % |",
    ):
        assert row in lines, row


def test_larger_elements_are_those_of_the_program_times_a_factor(tmp_path: Path) -> None:
    """And nothing else of a design changes."""
    usual = drawn(2, 4)[3]
    (larger,) = with_larger_elements([usual], 1.5)
    sizes = []
    for design in (usual, larger):
        path = tmp_path / "design.yaml"
        path.write_text(json.dumps(design.document))
        sizes.append(load_config(path).mesh.size_mm)
    assert sizes[1] == pytest.approx(1.5 * sizes[0], rel=0.01)
    assert {**larger.document, "mesh": None} == {**usual.document, "mesh": None}
    assert with_larger_elements([usual], 1.0) == [usual]


def test_a_campaign_of_which_every_design_is_refused_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def status(*ended: str) -> int:
        def outcomes(works: Sequence[Work], jobs: int) -> Iterator[dict[str, Any]]:
            return (record(number=number, ended=end, states=[]) for number, end in enumerate(ended))

        monkeypatch.setattr("benchmarks.unseen.__main__.outcomes_of", outcomes)
        monkeypatch.setattr("sys.argv", ["unseen", "--seed", "2", "--count", "2", "--results", str(tmp_path)])
        return campaigns_main()

    assert status("refused", "refused") == 1
    assert status("refused", "ran") == 0


def test_few_designs_say_little() -> None:
    assert largest_share(0, 7) == pytest.approx(1.0 - 0.05 ** (1 / 7))
    assert largest_share(0, 40) == pytest.approx(0.0722, abs=1e-4)
    assert largest_share(3, 3) == 1.0
