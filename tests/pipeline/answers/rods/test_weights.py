"""Arms of 0.1 to 100 times the weight that their law bears: each command ends with a result, or with one sentence."""

from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.results.files import read_results
from pipeline.results.verdict import verdict_of
from rod.weight import WEIGHT_OF_GRAM, Mass
from tests.commands import call
from tests.measured_arm import LENGTH, arm_law, result_folder

COMMANDS = (
    ("rod", "--pressure", "0 kPa", "--orientation", "lying"),
    ("rod", "--pressure", "40 kPa", "--orientation", "standing", "--tip-mass", "1 g"),
    ("rod", "--pressure", "20 kPa"),
    ("budget", "--pressure", "20 kPa"),
    ("solve", "--angle", "30 deg"),
    ("move", "--pressure", "0 kPa", "--orientation", "hanging", "--release", "--seconds", "0.1"),
)


@pytest.mark.parametrize("times", [0.1, 1.0, 100.0])
@pytest.mark.parametrize("with_weight", [False, True], ids=["law without weight", "law with weight"])
def test_light_and_heavy_arms(tmp_path: Path, times: float, with_weight: bool) -> None:
    mass = 70.0 * times  # g; the law bears 40 N mm, which 74 g bend it with, straight and lying
    weight = (0.0, -mass * WEIGHT_OF_GRAM / LENGTH) if with_weight else (0.0, 0.0)
    folder = result_folder(tmp_path / "arm", replace(arm_law(), mass=Mass.even(LENGTH, mass), weight=weight))
    words = [" ".join(verdict_of(read_results(folder)).lines)]
    for command, *options in COMMANDS:
        ended = call(command, str(folder), *options)
        assert isinstance(ended.exception, SystemExit | None)
        told = ended.stderr.split("pneurod: ")[1:]
        assert (len(told), ended.exit_code in (1, 2)) == ((1, True) if ended.exit_code else (0, False))
        words.append(ended.output)
    assert not {"nan", "inf", "Traceback"} & {*" ".join(words).split()}
    lying = call("rod", str(folder), "--pressure", "0 kPa", "--orientation", "lying")
    assert (lying.exit_code == 0) is (times <= 1.0)
