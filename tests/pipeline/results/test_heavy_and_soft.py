"""Arms under a tenth to a hundred times the weight that their law bears have records and verdicts of numbers alone."""

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.config.load import load_config
from pipeline.results.files import read_results, save_value
from pipeline.results.unloaded import unloaded_states, weight_not_borne
from pipeline.results.verdict import verdict_of
from pipeline.stages import _tolerances
from pipeline.store.result_folder import ResultFolder
from pipeline.values.reasons import report_reason
from pipeline.values.record import RunRecord
from rod import ArmLaw
from rod.weight import Mass
from tests.measured_arm import result_folder
from tests.pipeline.answers.rods.test_budget import CONFIG, scaled_law


def heavy(times: float, across: float = -1.0) -> ArmLaw:
    """The law of the coarse arm under a weight along y, or along the arm, in parts of the one that it bears lying."""
    law = scaled_law()
    borne = min(float(cell.moment[-1] - cell.moment[0]) for cell in law.cells) / law.length**2
    along = -math.sqrt(1.0 - across**2)
    grams = 1e3 * times * borne * law.length / 9.81
    weight = (times * borne * along, times * borne * across)
    return replace(law, weight=weight, mass=Mass.even(law.length, grams))


@pytest.mark.parametrize("across", [-1.0, 1.0, 0.0])
@pytest.mark.parametrize("times", [0.1, 1.0, 3.0, 100.0])
def test_the_record_of_a_run_holds_numbers_alone(tmp_path: Path, times: float, across: float) -> None:
    law, config = heavy(times, across), load_config(CONFIG)
    remarks = tuple(map(report_reason, _tolerances(config, law)))
    assert not any(word in remark.text for remark in remarks for word in ("unknown", "infinite"))
    read = save_value(ResultFolder(tmp_path), "run.json", RunRecord(config=config.record(), remarks=remarks))
    assert read.remarks == remarks
    run = read_results(result_folder(tmp_path, law))
    assert run.law is not None
    run = replace(run, law=replace(run.law, unloaded=unloaded_states(law, [17.0, 37.0])), record=read)
    assert not any(word in " ".join(verdict_of(run).lines).split() for word in ("nan", "inf", "unknown", "infinite"))


def test_a_law_that_does_not_bear_its_own_weight_says_so() -> None:
    law = scaled_law()
    light, heavy = (replace(law, mass=Mass.even(law.length, grams)) for grams in (0.1, 30.0))
    assert weight_not_borne(replace(law, mass=None)) is None
    assert weight_not_borne(light) is None
    assert weight_not_borne(replace(heavy, weight=(0.0, -1e-4))) is None  # measured with its weight
    reason = weight_not_borne(heavy)
    # the moment at the clamp of a straight arm that lies is m g l / 2
    borne = -float(law.cells[0].moment[0]) / (0.5 * 30.0 * 9.81e-3 * law.length)
    assert reason.values["percent"] == pytest.approx(100.0 * borne, rel=0.15)
    assert report_reason(reason).text.startswith("At 0 kPa it bears ")


def test_tolerances_are_said_with_their_pressure_first() -> None:
    (reason,) = _tolerances(load_config(CONFIG), scaled_law())
    text = report_reason(reason).text
    assert re.fullmatch(
        r"At 37 kPa casting tolerances move the tip by ±[\d.]+ % of the length; measure material\.stiffness first: "
        r"±10 % of it alone give [\d.]+ %\.",
        text,
    ), text
