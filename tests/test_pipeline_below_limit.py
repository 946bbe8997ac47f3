"""An arm that bears none of its pressures has parameters at pressures below its limit."""

from dataclasses import replace
from pathlib import Path

import pytest
from test_pipeline_limits import LIMIT_KPA, THIN, VACUUM
from test_pipeline_plausibility import CONFIGS

from pipeline.config.load import load_config
from pipeline.context import RunContext
from pipeline.progress import Silent
from pipeline.simulation.below_limit import with_states_below_limit
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import simulate
from pipeline.store.store import open_store


def followed(folder: Path, *changes: str) -> tuple[Outcomes, Outcomes, str]:
    """The outcomes of II and III, those with states below the limit, and the sentence about them."""
    settings = [*THIN, VACUUM, "experiments=[II, III]", *changes]
    config = load_config(CONFIGS / "semicircular_single_coarse.yaml", settings)
    with open_store(folder, config) as store:
        context = RunContext.alone(store, Silent())
        scene = Scene.meshed(config)
        outcomes = simulate(scene, context)
        return outcomes, *with_states_below_limit(scene, context, outcomes)


def test_states_below_the_limit_replace_pressures_that_the_arm_does_not_bear(tmp_path: Path) -> None:
    without, outcomes, sentence = followed(tmp_path, "pressures=[1.5 kPa, 3 kPa]")
    assert without.records == ()
    pressures = [record.pressure_kPa for record in outcomes["II"].records]
    assert pressures == [record.pressure_kPa for record in outcomes["III"].records]
    assert pressures == pytest.approx([0.4 * LIMIT_KPA, 0.8 * LIMIT_KPA], rel=0.01)
    assert outcomes.failures == without.failures
    assert sentence.startswith(
        "the arm bears none of the pressures of the configuration, the lowest of which is 1.5 kPa"
    )
    assert f"at {pressures[0]:g} kPa and {pressures[1]:g} kPa" in sentence


def test_nothing_is_added_where_a_pressure_is_reached_or_no_parameters_are_wanted(tmp_path: Path) -> None:
    without, outcomes, sentence = followed(tmp_path / "reached", "pressures=[0.5 kPa, 3 kPa]")
    assert (outcomes, sentence) == (without, "")
    assert len(outcomes.records) == 2
    without, outcomes, sentence = followed(tmp_path / "cell", "pressures=[1.5 kPa]", "law=cell")
    assert (outcomes, sentence) == (without, "")


def test_nothing_is_added_without_a_named_limit(tmp_path: Path) -> None:
    config = load_config(CONFIGS / "semicircular_single_coarse.yaml", [*THIN, VACUUM, "pressures=[1.5 kPa]"])
    with open_store(tmp_path, config) as store:
        context = RunContext.alone(store, Silent())
        scene = Scene.meshed(config)
        outcomes = simulate(scene, context, ["II", "III"])
        unnamed = {o.name: replace(o, failure=replace(o.failure, limit_kPa=0.0)) for o in outcomes if o.failure}
        assert len(unnamed) == 2
        assert with_states_below_limit(scene, context, Outcomes(unnamed)) == (Outcomes(unnamed), "")
