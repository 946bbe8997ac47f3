"""An arm that bears none of its pressures has states at pressures below its limit."""

from dataclasses import replace
from pathlib import Path

import pytest

from geometry import Reason
from pipeline.config.load import load_config
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import add_states_below_limit, simulate
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from tests.pipeline.simulate.test_design_notes import CONFIGS
from tests.pipeline.simulate.test_limits import THIN, VACUUM

#: long enough for five parameters
LONG = [*THIN, VACUUM, "geometry.length=70 mm", "mesh.size=9 mm"]


def followed(folder: Path, *changes: str) -> tuple[Outcomes, Outcomes, Reason | None]:
    """The outcomes of II and III, those with states below the limit, and the remark on them."""
    settings = [*LONG, "experiments=[II, III]", *changes]
    config = load_config(CONFIGS / "semicircular_single_coarse.yaml", settings)
    with open_store(folder, config) as store:
        context = RunContext.alone(store, Silent())
        scene = Scene.meshed(config)
        outcomes = simulate(scene, context)
        return outcomes, *add_states_below_limit(scene, context, outcomes)


def test_states_below_the_limit_replace_pressures_that_the_arm_does_not_bear(tmp_path: Path) -> None:
    without, outcomes, remark = followed(tmp_path, "pressures=[5 kPa, 7 kPa]")
    assert without.records == ()
    pressures = [record.pressure_kPa for record in outcomes["II"].records]
    assert pressures == [record.pressure_kPa for record in outcomes["III"].records]
    limits = [o.failure.limit_kPa for o in without if o.failure and o.failure.limit_kPa]
    limit = min(limits)
    assert pressures == pytest.approx([0.4 * limit, 0.8 * limit], rel=0.01)
    assert outcomes.failures == without.failures
    assert remark is not None
    assert remark.values == {"reached_kPa": pressures, "limit_kPa": pytest.approx(limit, rel=5e-3)}


@pytest.mark.slow
def test_nothing_is_added_where_a_pressure_is_reached_or_the_arm_is_short(tmp_path: Path) -> None:
    without, outcomes, remark = followed(tmp_path / "reached", "pressures=[1 kPa, 7 kPa]")
    assert (outcomes, remark) == (without, None)
    assert len(outcomes.records) == 2
    without, outcomes, remark = followed(tmp_path / "short", "pressures=[5 kPa]", "geometry.length=60 mm")
    assert (outcomes, remark) == (without, None)
    assert without.records == ()


@pytest.mark.slow
def test_the_last_equilibrium_stands_for_a_limit_that_is_not_named(tmp_path: Path) -> None:
    config = load_config(CONFIGS / "semicircular_single_coarse.yaml", [*LONG, "pressures=[5 kPa]"])
    with open_store(tmp_path, config) as store:
        context = RunContext.alone(store, Silent())
        scene = Scene.meshed(config)
        outcomes = simulate(scene, context, ["II", "III"])

        def ending(limit_kPa: float, reached_kPa: float, **changes: float) -> Outcomes:
            end = {"limit_kPa": limit_kPa, "reached_kPa": reached_kPa, **changes}
            changed = {o.name: replace(o, failure=replace(o.failure, **end)) for o in outcomes if o.failure}
            assert len(changed) == 2
            return Outcomes(changed)

        ended = outcomes["II"].failure
        assert ended
        assert 0.9 * ended.limit_kPa < ended.reached_kPa < 5.0
        added, _ = add_states_below_limit(scene, context, ending(0.0, 1.0))
        assert [record.pressure_kPa for record in added["II"].records] == [0.4, 0.8]
        crossing = ending(0.0, 0.0, pressure_kPa=1.0, passes_through_itself=True)
        added, remark = add_states_below_limit(scene, context, crossing)
        assert [record.pressure_kPa for record in added["II"].records] == [0.4, 0.8]
        assert remark is not None
        assert remark.values["limit_kPa"] == 1.0
        at_rest = ending(0.0, 0.0)
        assert add_states_below_limit(scene, context, at_rest) == (at_rest, None)
