"""A limit is named at little cost and from steps of any size; experiments tell each other, and go on below it."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fem
from fem.path import follower
from fem.path.newton import Converged, StepFailed
from fem.path.solver import Increment, IncrementSolver
from geometry import Reason
from pipeline.config.load import load_config
from pipeline.simulate.case_path import CasePath
from pipeline.simulate.known_limit import EndOfII
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import add_states_below_limit, simulate
from tests.pipeline.simulate.test_design_notes import CONFIGS
from tests.solved import alone

#: a half disc with a wall of 0.6 mm, whose round wall snaps through under a vacuum of 1.03 kPa
LIMIT_KPA = 1.0317
THIN = ["geometry.length=30 mm", "geometry.wall=0.6 mm", "mesh.size=6 mm", "effects.self_contact=off"]
VACUUM = "effects.pressure={cavities: {cavity: -1}}"


@pytest.fixture(scope="module")
def model() -> fem.Model:
    scene = Scene.meshed(load_config(CONFIGS / "semicircular_single_coarse.yaml", [*THIN, VACUUM]))
    experiment = fem.Experiment.of("II", scene.body, 0.0)
    return experiment.model(scene.material, scene.effects(1e-3), scene.config.mesh.formulation)


def end_of(model: fem.Model, *pressures_kPa: float) -> tuple[fem.End, fem.Solution]:
    with pytest.raises(fem.NotConverged) as ended:
        fem.follow(model, pressures_kPa)
    return ended.value.end, ended.value.partial


@pytest.mark.parametrize(
    "pressures_kPa", [(0.5, 1.0, 1.25), (1.02, 1.25), (1.03, 1.2), (0.5, 5.0), (5.0,), (20.0,), (37.0,)]
)
def test_small_and_large_steps_end_at_the_same_limit_point(model: fem.Model, pressures_kPa: tuple[float, ...]) -> None:
    """One step of 5 kPa led to a stable state beyond it, or to an unstable one, as the processor rounded."""
    end, partial = end_of(model, *pressures_kPa)
    assert [step.factor for step in partial.steps] == list(pressures_kPa[:-1])
    assert end.limit == pytest.approx(LIMIT_KPA, rel=5e-3)
    assert 0.99 * LIMIT_KPA < end.reached < LIMIT_KPA
    assert "limit_point" in [reason.code for reason in end.reasons]
    # a state takes 3 to 7; from rest on the search takes 34 to 42, and took 330 to 465
    assert end.factorizations < (50 if len(pressures_kPa) == 1 else 20)


def under_a_constant_load(setting: str, experiment: str) -> fem.Model:
    config = load_config(CONFIGS / "semicircular_single_coarse.yaml", [*THIN, VACUUM, setting])
    scene = Scene.meshed(config)
    loaded = fem.Experiment.of(experiment, scene.body, config.end.y_mm, config.end.force_N, config.end.x_mm)
    return loaded.model(scene.material, scene.effects(1e-3), scene.config.mesh.formulation)


@pytest.mark.parametrize(
    ("setting", "experiment", "limit"),
    [("effects.gravity=on", "II", 1.0422), ("end={x: 0.02 N, y: 0 mm}", "III", 1.0373)],
)
@pytest.mark.parametrize("pressure_kPa", [1.5, 5.0, 37.0])
def test_no_jump_on_the_way_to_the_first_pressure_with_a_constant_load(
    setting: str, experiment: str, limit: float, pressure_kPa: float
) -> None:
    """Under its weight the half disc ended in states beyond its limit, with a wall that had moved by 4 mm."""
    end, partial = end_of(under_a_constant_load(setting, experiment), pressure_kPa)
    assert partial.steps == ()
    assert end.limit == pytest.approx(limit, rel=2e-3)
    assert 0.99 * limit < end.reached < limit
    assert end.factorizations < 60


@pytest.mark.parametrize("bears", [False, True])
def test_where_the_constant_load_is_not_borne_alone_both_grow_together(
    bears: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """bears: a half of it, so that the way together begins at rest again."""
    heavy = under_a_constant_load("effects.gravity=on", "II")
    (first,) = fem.follow(heavy, [1.0]).steps
    solve = IncrementSolver.solve

    def without_all_of_the_load(self: IncrementSolver, increment: Increment) -> Converged:
        control = increment.control
        if control.value <= follower.CONSTANTS_FIRST and not (bears and control.constant_fraction == 0.5):
            raise StepFailed(Reason("nothing_tried"))
        return solve(self, increment)

    monkeypatch.setattr(IncrementSolver, "solve", without_all_of_the_load)
    (both,) = fem.follow(heavy, [1.0]).steps
    assert np.abs(first.displacement - both.displacement).max() < 1e-8 * np.abs(first.displacement).max()
    assert both.cutbacks == 0


def test_a_constant_load_alone_is_nothing_of_the_pressure(monkeypatch: pytest.MonkeyPatch) -> None:
    solve = IncrementSolver.solve

    def without_pressure(self: IncrementSolver, increment: Increment) -> Converged:
        if increment.control.value > follower.CONSTANTS_FIRST:
            raise StepFailed(Reason("nothing_tried"))
        return solve(self, increment)

    monkeypatch.setattr(IncrementSolver, "solve", without_pressure)
    end, partial = end_of(under_a_constant_load("effects.gravity=on", "II"), 1.0)
    assert (end.reached, end.constant_fraction, partial.steps) == (0.0, 1.0, ())


def test_a_constant_load_that_bends_the_arm_far_grows_with_the_pressure(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the force first, `pneunet` of 2.5 mm took 54 factorizations instead of 16."""
    asked: list[float] = []
    reach = follower.PathFollower._reach

    def recorded(self: Any, target: float, *rest: Any, **given: Any) -> Any:
        asked.append(target)
        return reach(self, target, *rest, **given)

    monkeypatch.setattr(follower.PathFollower, "_reach", recorded)
    scene = Scene.meshed(load_config(CONFIGS / "pneunet_coarse.yaml", ["geometry.chambers=5", "mesh.size=6 mm"]))
    for force, first in ((0.23, [1.0]), (0.046, [follower.CONSTANTS_FIRST, 1.0])):
        asked.clear()
        dead = fem.Experiment.of("dead", scene.body, None, (0.0, force))
        fem.follow(dead.model(scene.material, scene.effects(0.024), scene.config.mesh.formulation), [1.0])
        assert asked == first


def test_before_the_first_pressure_nobody_is_asked_whether_it_is_worth_the_search() -> None:
    asked: list[float] = []
    options = fem.PathOptions(give_up=lambda target: bool(asked.append(target)))
    heavy = under_a_constant_load("effects.gravity=on", "II")
    fem.follow(heavy, [0.8, 0.9], options)
    assert asked == [0.9]


@pytest.mark.parametrize("relative", [1e-9, -1e-9])
def test_rounding_does_not_decide_where_the_path_ends(model: fem.Model, relative: float) -> None:
    law = model.material
    changed = replace(model, material=fem.StVenantKirchhoff(law.E * (1 + relative), law.nu))
    end, _ = end_of(changed, 5.0)
    assert end.limit == pytest.approx(LIMIT_KPA, rel=5e-3)


def test_a_limit_just_passed_costs_no_more_than_a_few_states(model: fem.Model) -> None:
    small, before = end_of(model, 0.5, 1.0, 1.25)
    assert len(before.steps) == 2
    # an attempt behind the limit, from near, and the equilibria on the way to it
    assert small.factorizations <= 3 * max(step.factorizations for step in before.steps)


def test_two_tells_its_limit_and_one_does_not_search_its_own(tmp_path: Path) -> None:
    """I is not tried at 5 kPa, and says so; closely above 0.95 kPa it finds its own limit."""
    for lower, largest, expected in ((0.5, 5.0, "end_of_II"), (0.95, 1.05, "has_limit")):
        pressures = f"pressures=[{lower} kPa, {largest} kPa]"
        config = load_config(CONFIGS / "semicircular_single_coarse.yaml", [*THIN, VACUUM, pressures])
        with alone(tmp_path / str(largest), config) as context:
            outcomes = simulate(Scene.meshed(config), context, ["I", "II"])
        failures = [outcome.failure for outcome in outcomes]
        assert all(len(outcome.records) == 1 for outcome in outcomes)
        assert failures[1].limit_kPa == pytest.approx(LIMIT_KPA, rel=0.01)
        assert expected in failures[0].codes
        assert "limit_point" in failures[1].codes
        assert failures[1].brief == (Reason("has_limit", {"limit_kPa": failures[1].limit_kPa}),)
        if largest == 5.0:
            assert failures[0].limit_kPa == 0.0
            assert failures[0].factorizations == 0  # II has ended before I goes on to this pressure


@pytest.mark.parametrize("pressures", ["pressures=[0.5 kPa, 5 kPa]", "pressures=[5 kPa]"])
def test_two_tells_where_it_ends_without_a_limit_that_it_could_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pressures: str
) -> None:
    made = CasePath._failure
    monkeypatch.setattr(CasePath, "_failure", lambda *given: replace(made(*given), limit_kPa=0.0))
    config = load_config(CONFIGS / "semicircular_single_coarse.yaml", [*THIN, VACUUM, pressures])
    with alone(tmp_path, config) as context:
        outcomes = simulate(Scene.meshed(config), context, ["I", "II", "III"])
    failures = {name: outcomes[name].failure for name in ("I", "II", "III")}
    assert failures["I"].reasons[-1].values["end"] == "last equilibrium"
    assert failures["I"].not_followed
    assert failures["III"].codes == ["followed_near_end_of_II"]
    assert failures["III"].reached_kPa == pytest.approx(0.95 * failures["II"].reached_kPa)


@pytest.mark.parametrize(
    ("chambers", "size", "second", "codes", "limit_kPa"),
    [
        # II has its limit at 64.9 kPa; that of III is lower, and pairs of both need pressures below it
        pytest.param(*(11, 7, 37, ["ends_beyond", "has_limit"], 52.29), marks=pytest.mark.slow),
        # here that of III is a little higher, and is not searched
        (2, 6, 45, ["followed_near_end_of_II"], 0.0),
        # III has passed that part of the limit already
        (2, 6, 62, ["followed_to", "end_of_II"], 0.0),
    ],
)
def test_three_is_followed_up_to_the_limit_of_two(
    tmp_path: Path, chambers: int, size: int, second: int, codes: list[str], limit_kPa: float
) -> None:
    pressures = f"pressures=[17 kPa, {second} kPa, 90 kPa]"
    settings = [f"geometry.chambers={chambers}", f"mesh.size={size} mm", pressures]
    config = load_config(CONFIGS / "pneunet_coarse.yaml", settings)
    with alone(tmp_path, config) as context:
        outcomes = simulate(Scene.meshed(config), context, ["II", "III"])
    stored = {path.stem for path in (tmp_path / "states").glob("*.npz")}
    failure = outcomes["III"].failure
    assert failure.codes[: len(codes)] == codes
    assert failure.limit_kPa == pytest.approx(limit_kPa, rel=1e-3)
    assert failure.not_followed == (limit_kPa == 0.0)
    assert stored == {f"{name}_{pressure}kPa" for name in ("II", "III") for pressure in (17, second)}


def test_the_end_of_two_concerns_pressures_not_closely_above_one_of_its_states() -> None:
    end = EndOfII(37.0, 40.0, is_limit=True)
    assert not end.is_below(41.0)
    assert end.is_below(47.0)
    assert not EndOfII(30.0, 48.0, is_limit=True).is_below(47.0)
    assert not EndOfII(0.0, 0.0, is_limit=False).is_below(55.0)
    assert EndOfII(0.0, 40.0, is_limit=False).is_below(47.0)


@pytest.mark.parametrize("pressures", ["[0.4 kPa, 2 kPa]", "[0.5 kPa, 0.8 kPa]", "[2 kPa]"])
def test_a_lower_limit_of_the_free_body_is_named(pressures: str, tmp_path: Path) -> None:
    """In vacuum the half disc buckles at 0.525 kPa in I, while its clamp keeps it stable in II: at 2 kPa it has a state
    there, from which the released body comes to a stable state in three iterations, beyond the limit of its path."""
    thin = ["geometry.length=30 mm", "geometry.wall=0.4 mm", "mesh.size=6 mm", "effects.self_contact=off", VACUUM]
    config = load_config(CONFIGS / "semicircular_single_coarse.yaml", [*thin, f"pressures={pressures}"])
    with alone(tmp_path, config) as context:
        outcomes = simulate(Scene.meshed(config), context, ["I", "II"])
    assert outcomes["II"].failure is None
    failure = outcomes["I"].failure
    assert failure.limit_kPa == pytest.approx(0.525, rel=3e-3)


#: long enough for five parameters
LONG = [*THIN, VACUUM, "geometry.length=70 mm", "mesh.size=9 mm"]


def followed(folder: Path, *changes: str) -> tuple[Outcomes, Outcomes, Reason | None]:
    """The outcomes of II and III, those with states below the limit, and the remark on them."""
    settings = [*LONG, "experiments=[II, III]", *changes]
    config = load_config(CONFIGS / "semicircular_single_coarse.yaml", settings)
    with alone(folder, config) as context:
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
    with alone(tmp_path, config) as context:
        scene = Scene.meshed(config)
        outcomes = simulate(scene, context, ["II", "III"])

        def ending(limit_kPa: float, reached_kPa: float, **changes: float) -> Outcomes:
            end = {"limit_kPa": limit_kPa, "reached_kPa": reached_kPa, **changes}
            changed = {o.name: replace(o, failure=replace(o.failure, **end)) for o in outcomes if o.failure}
            assert len(changed) == 2
            return Outcomes(changed)

        ended = outcomes["II"].failure
        assert 0.9 * ended.limit_kPa < ended.reached_kPa < 5.0
        added, _ = add_states_below_limit(scene, context, ending(0.0, 1.0))
        assert [record.pressure_kPa for record in added["II"].records] == [0.4, 0.8]
        crossing = ending(0.0, 0.0, pressure_kPa=1.0, passes_through_itself=True)
        added, remark = add_states_below_limit(scene, context, crossing)
        assert [record.pressure_kPa for record in added["II"].records] == [0.4, 0.8]
        assert remark.values["limit_kPa"] == 1.0
        at_rest = ending(0.0, 0.0)
        assert add_states_below_limit(scene, context, at_rest) == (at_rest, None)
