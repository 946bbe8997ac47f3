"""Pressures and arms without five parameters, and what that means for a run."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry import Reason
from pipeline.config.load import load_config
from pipeline.identify import parameters as module
from pipeline.identify.parameters import identify_run
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.too_short import too_short
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent

CONTEXT = RunContext.alone(None, Silent())  # type: ignore[arg-type]
NONE = Outcomes({})


@pytest.fixture
def arm(configs: Path) -> Scene:
    """A scene of the right length."""
    config = load_config(configs / "pneunet_coarse.yaml", ["pressures=[10 kPa, 20 kPa, 30 kPa]"])
    mesh = SimpleNamespace(points=np.linspace([0.0] * 3, [112.0, 0.0, 0.0], 57))
    body: Any = SimpleNamespace(length=112.0, pitch=10.0, mesh=mesh, curve_vertices=np.arange(57))
    return Scene(config, body)


@pytest.mark.parametrize(
    ("identified", "other_rod", "fails"), [(("parameters",), False, False), ((), True, False), ((), False, True)]
)
def test_a_pressure_without_parameters_fails_a_run_only_where_it_leaves_no_rod(
    monkeypatch: pytest.MonkeyPatch, arm: Scene, identified: tuple[str, ...], other_rod: bool, fails: bool
) -> None:
    reason = Reason("not_identified", {"pressure_kPa": 10.0, "why": "the rod carries no moment"})
    monkeypatch.setattr(module, "identify_all", lambda *given, **options: (identified, (reason,)))
    made = identify_run(arm, CONTEXT, NONE)
    assert (made.failures(other_rod), made.remarks(other_rod)) == (((reason,), ()) if fails else ((), (reason,)))
    assert made.parameters == identified


def test_an_arm_that_is_too_short_has_the_same_reason_before_and_after(arm: Scene, configs: Path) -> None:
    config = load_config(configs / "pneunet_coarse.yaml", ["geometry.chambers=6"])
    (reason,) = identify_run(replace(arm, config=config), CONTEXT, NONE).failures(other_rod=False)
    assert reason == too_short(config)
