"""A run that was killed and continued may differ from an uninterrupted one in its seconds only."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.kills import compared, results_of
from fem import Fixed, Gravity, Model, Step, StVenantKirchhoff, follow, step_to_arrays
from tests.bodies import box


def test_states_are_equal_but_for_their_seconds(tmp_path: Path) -> None:
    model = Model(box((2, 1, 1), (2.0, 1.0, 1.0)), StVenantKirchhoff(1.0, 0.3), [Fixed("left")], [Gravity(5e-8)])
    step, again = (follow(model, [1.0]).steps[-1] for _ in range(2))
    assert (step.seconds, step.spent) != (again.seconds, again.spent)

    def results(name: str, step: Step) -> dict[str, object]:
        states = tmp_path / name / "states"
        states.mkdir(parents=True)
        np.savez(states / "II_8kPa.npz", allow_pickle=False, **step_to_arrays(step), cpu_seconds=step.seconds)
        return results_of(states.parent)

    first = results("first", step)
    assert compared(first, results("again", again)) == "equal"
    more = replace(again, newton_iterations=again.newton_iterations + 1)
    assert compared(first, results("more", more)) == "different at II_8kPa.npz/newton_iterations"
    moved = replace(again, displacement=again.displacement * (1 + 1e-15))
    assert compared(first, results("moved", moved)) == "different at II_8kPa.npz/displacement"
