"""A limit is named at little cost, and a large step does not pass it without a word."""

import math

import pytest
from test_pipeline_plausibility import CONFIGS

import fem
from fem.path import follower
from pipeline.config.load import load_config
from pipeline.simulation.scene import Scene

#: a half disc with a wall of 0.6 mm, whose round wall snaps through under a vacuum of 1.12 kPa
LIMIT_KPA = 1.123


@pytest.fixture(scope="module")
def model() -> fem.Model:
    settings = ["geometry.length=30 mm", "geometry.wall=0.6 mm", "mesh.size=6 mm", "effects.self_contact=off"]
    vacuum = "effects.pressure={cavities: {cavity: -1}}"
    scene = Scene.meshed(load_config(CONFIGS / "semicircular_single_coarse.yaml", [*settings, vacuum]))
    experiment = fem.Experiment.of("II", scene.body, 0.0)
    return experiment.model(scene.material, scene.effects(1e-3), scene.config.mesh.formulation)


def end_of(model: fem.Model, *pressures_kPa: float) -> tuple[fem.End, fem.Solution]:
    with pytest.raises(fem.NotConverged) as ended:
        fem.follow(model, pressures_kPa)
    return ended.value.end, ended.value.partial


def test_small_and_large_steps_end_at_the_same_limit_point(model: fem.Model) -> None:
    """A step of 5 kPa led to an unstable state beyond it."""
    small, before = end_of(model, 0.5, 1.0, 1.25)
    large, _ = end_of(model, 5.0)
    for end in (small, large):
        assert end.reached == pytest.approx(LIMIT_KPA, rel=5e-3)
        assert "a limit point" in end.cause
    assert len(before.steps) == 2
    # it took 330 to 465 factorizations; a state takes 3 to 5, a failing attempt 9 to 13
    assert max(small.factorizations, large.factorizations) < 150


def test_a_path_that_was_not_followed_says_so(monkeypatch: pytest.MonkeyPatch, model: fem.Model) -> None:
    """Increments that lose the stability of the path are made smaller, and where even small ones do, it is said."""
    monkeypatch.setattr(follower, "STABLE_INCREMENT", math.inf)
    (step,) = fem.follow(model, [5.0]).steps
    assert "the path was not followed: it lost its stability between 0.0 and 50.0 % of the way" in step.instability
