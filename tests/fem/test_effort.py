"""How long an equilibrium is sought with an increment."""

from types import SimpleNamespace
from typing import Any

import pytest

from fem.path.effort import ITERATIONS_NEAR_LIMIT, MAX_UNSTABLE, MAX_UNSTABLE_RETRY, RETRY_ITERATIONS, Effort, effort_of

AT_REST = SimpleNamespace(value=0.0, touching=False)


def effort(
    *,
    cutbacks: int = 0,
    small: bool = False,
    nears: bool = False,
    stable: bool = True,
    load: bool = True,
    from_rest: bool = False,
    **last: Any,
) -> Effort:
    """Of the increment to 1 from the last point, by default at 0.5."""
    increments: Any = SimpleNamespace(cutbacks=cutbacks, is_small=small, nears_limit=nears, passes_limit=False)
    points: Any = [AT_REST]
    if not from_rest:
        points.append(SimpleNamespace(**{"value": 0.5, "touching": False, **last}))
    control: Any = SimpleNamespace(value=1.0, gives_load=load)
    return effort_of(control, increments, points, stable)


def test_the_first_increment_to_a_target_may_take_long() -> None:
    assert effort() == Effort(None, MAX_UNSTABLE)
    assert effort(load=False) == effort(stable=False) == Effort(None)


def test_an_increment_much_longer_than_the_last_one_is_given_up_early() -> None:
    assert effort(value=0.1) == Effort(None, MAX_UNSTABLE_RETRY, True)


@pytest.mark.parametrize("touching", [False, True])
def test_a_smaller_increment_may_begin_with_an_indefinite_tangent(touching: bool) -> None:
    """As that of an arm that turns far under its weight; contact is not needed for it."""
    assert effort(cutbacks=1, touching=touching) == Effort(RETRY_ITERATIONS, MAX_UNSTABLE_RETRY, True)
    assert effort(cutbacks=1, from_rest=True) == Effort(RETRY_ITERATIONS, 0, True)
    assert effort(cutbacks=1, small=True) == Effort(RETRY_ITERATIONS, MAX_UNSTABLE)


def test_near_a_limit_only_contact_excuses_an_indefinite_tangent() -> None:
    for touching, unstable in ((False, 0), (True, MAX_UNSTABLE_RETRY)):
        near = effort(cutbacks=1, nears=True, touching=touching)
        assert near == Effort(ITERATIONS_NEAR_LIMIT, unstable, True, True)
    assert effort(cutbacks=1, nears=True, stable=False).unstable is None
