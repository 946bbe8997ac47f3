"""Sentences that users meet most: each stands in its plain form, and its former one is gone from all sources."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pipeline.answers.measured.calibration import NextMeasurement
from pipeline.answers.rods.export import judged
from pipeline.config.load import load_config
from pipeline.law.study import _refuse_effects
from pipeline.law.table import space_sentences
from pipeline.results.unloaded import weight_not_borne
from pipeline.stages import _tolerances
from pipeline.values.errors import InputError
from pipeline.values.reasons import report_reason
from rod.weight import Mass
from tests.coarse import coarse_run
from tests.pipeline.answers.rods.test_budget import CONFIG, scaled_law

ROOT = Path(__file__).resolve().parents[2]
#: of former sentences
FORMER = (
    "Most would help",
    "tolerances move its tip",
    "It is known within",
    "law in space has no weight",
    "EI/l^2 / 50",
    "however small, the offsets",
    "It holds from",
    "for which law",
    "agrees with it in two directions",
    "without one at equal pressures",
    "use the arm's own law",
    "because the mesh makes an error",
)


@pytest.mark.parametrize("former", FORMER)
def test_former_sentences_are_gone(former: str) -> None:
    for room in ("rod", "pipeline"):
        for path in (ROOT / room).rglob("*.py"):
            joined = re.sub(r'"\s*\n\s*f?"', "", path.read_text(encoding="utf-8"))
            assert former not in joined, path


def test_the_next_measurement() -> None:
    free = NextMeasurement(40.0, 0.0, 2.1, 0.8)
    assert free.text == (
        "Best next measurement: the unloaded tip at 40 kPa. It lowers the tip's standard deviation from 2.1 to 0.8 mm."
    )
    assert "the tip at 40 kPa under 0.02 N in y. It" in replace(free, force_y_N=0.02).text


def test_tolerances_are_said_with_their_pressure_first() -> None:
    (reason,) = _tolerances(load_config(CONFIG), scaled_law())
    text = report_reason(reason).text
    assert re.fullmatch(
        r"At 37 kPa casting tolerances move the tip by ±[\d.]+ % of the length; measure material\.stiffness first: "
        r"±10 % of it alone give [\d.]+ %\.",
        text,
    ), text


def test_the_law_in_space(tmp_path: Path) -> None:
    law: Any = SimpleNamespace(error=0.01, reach=0.003)
    lines = space_sentences(SimpleNamespace(law=law, states=9, changes=None, left=()))  # type: ignore[arg-type]
    assert lines[1] == "Valid up to 3 1/m from the unloaded curvature."
    config = load_config(CONFIG, ["effects.gravity=on"])
    with pytest.raises(
        InputError, match=r"effects\.gravity must be off: the law in space excludes weight; add it with"
    ):
        _refuse_effects(config)


def test_a_file_beside_its_rod() -> None:
    at = SimpleNamespace(rigidity=300.0, solve=lambda *_: 0.0, curve=lambda _: 0.0, s=[0.0, 112.0])
    robot: Any = SimpleNamespace(has=lambda _: False, known=(), length=112.0, solid=None, at=lambda _: at)
    told = judged(robot, coarse_run(), scaled_law())
    assert told.endswith(
        "Under small tip forces (EI/50l², EI/10l²) the file deviates from its rod by at most 0 % of the length."
    )


def test_a_law_that_does_not_bear_its_own_weight_says_so() -> None:
    law = scaled_law()
    light, heavy = (replace(law, mass=Mass.even(law.length, grams)) for grams in (0.1, 30.0))
    assert weight_not_borne(replace(law, mass=None)) is None
    assert weight_not_borne(light) is None
    assert weight_not_borne(replace(heavy, weight=(0.0, -1e-4))) is None  # measured with its weight
    reason = weight_not_borne(heavy)
    assert reason is not None
    # the moment at the clamp of a straight arm that lies is m g l / 2
    borne = -float(law.cells[0].moment[0]) / (0.5 * 30.0 * 9.81e-3 * law.length)
    assert reason.values["percent"] == pytest.approx(100.0 * borne, rel=0.15)
    assert report_reason(reason).text.startswith("At 0 kPa it bears ")
