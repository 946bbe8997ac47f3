"""`pneurod run` at pairs of pressures: folders, files and sentences, with laws in closed form for finite elements."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pipeline.config.config import Config
from pipeline.results.laws import law_record
from pipeline.store.result_folder import ResultFolder
from pipeline.values.law import DeliveredLaw
from pipeline.values.run import Run, State
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import direction_of
from tests.commands import done, refused
from tests.pair_laws import ray

DESIGN = """
name: two
geometry: {family: bisected_circle, length: 70 mm}
material: {law: svk, E: 1.2 MPa, nu: 0.495}
pressures: [[30 kPa, 0 kPa], [30 kPa, 30 kPa]]
"""


def law_for(config: Config) -> ArmLaw:
    one, other = (cavity.fraction for cavity in config.effects.pressure.cavities.values())
    return ray(direction_of((one, other))[1])


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The words of the command."""

    def solved(config: Config, out: Path, *_: Any) -> Any:
        content = law_record(law_for(config))
        ResultFolder(out).save_json("law.json", content)
        states = (State("III", 30.0, reaction_N=(0.0, 0.0123)),)
        return SimpleNamespace(results=Run(out, states=states, law=DeliveredLaw(law=law_for(config))))

    def measured(config: Config, *_: Any) -> Any:
        return SimpleNamespace(measured=SimpleNamespace(law=law_for(config)))

    monkeypatch.setattr("pipeline.study.pairs.run.run", solved)
    monkeypatch.setattr("pipeline.study.pairs.run.measure_law", measured)
    (tmp_path / "two.yaml").write_text(DESIGN, encoding="utf-8")
    return ["run", str(tmp_path / "two.yaml"), "--out", str(tmp_path / "out"), "-q"]


def test_the_command_writes_a_folder_for_each_ratio_and_the_law_of_both(run: list[str], tmp_path: Path) -> None:
    printed = done(*run)
    assert "0.0123" in printed
    assert "has the ratios 1 to 0, 1 to 0.5, 1 to 1; between them it is interpolated to" in printed
    saved = json.loads((tmp_path / "out" / "law.json").read_text(encoding="utf-8"))
    assert saved["pressures_kPa_by_folder"] == {"1_to_0": [30.0], "1_to_1": [30.0]}
    page = (tmp_path / "out" / "pairs.html").read_text(encoding="utf-8")
    assert '<a href="1_to_0/report.html">' in page
    assert "Moment over curvature" in page
    out = str(tmp_path / "out")
    assert "the arm's own law" in done("rod", out, "--pressure", "[30 kPa, 10 kPa]")
    solve = ["solve", out, "--angle", "1 deg"]
    assert "its law has the pressures of cavity, cavity_lower; give their ratio, such as --ratio" in refused(*solve)
    for ratio, is_between in (("1:0", False), ("1:0.3", True)):  # of a folder of its own, and between two ratios
        found = done(*solve, "--ratio", ratio)
        assert "bends by 1.00°" in found
        assert ("kPa (" in found) == is_between


def test_other_commands_take_a_ratio(run: list[str], tmp_path: Path) -> None:
    done(*run)
    out = str(tmp_path / "out")
    export = ["export", out, "--to", "json", "--ratio"]
    done(*export, "1:0.5")
    between = refused(*export, "1:0.3")
    assert "takes a law at a measured ratio of its pressures, one of 1:0, 1:0.5, 1:1" in between
    assert "its law has no derivatives" in refused("budget", out, "--ratio", "1:0.5")
    (tmp_path / "arm.csv").write_text("pressure_kPa,tip_x_mm,tip_y_mm\n20,60,0.1\n", encoding="utf-8")
    done("compare", out, str(tmp_path / "arm.csv"), "--ratio", "1:0.3")
    alone = refused("solve", str(tmp_path / "out" / "1_to_0"), "--angle", "1 deg", "--ratio", "1:0")
    assert "has one pressure; leave it out" in alone


def test_the_verdict_as_json(run: list[str]) -> None:
    assert json.loads(done(*run, "--json"))["cavities"] == ["cavity", "cavity_lower"]


def test_a_folder_with_another_run_is_refused(run: list[str], tmp_path: Path) -> None:
    ResultFolder(tmp_path / "out").save_json("states/configuration.json", {})
    assert "holds the results of a run; give another --out" in refused(*run)
