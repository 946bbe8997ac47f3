"""Rods in plain Python and compiled: the same numbers, and when which is taken."""

import math
import subprocess
import sys

import numpy as np
import pytest

from geometry.arrays import Array
from rod import FiveParameters, Rod
from rod.arm_law import integration
from rod.compiled import CompiledLater
from rod.mechanics import continuation, shooting

ARM = Rod(112.0, -0.012, FiveParameters(180.0, 400.0, 0.5, -0.2, 12.0))


def plain(name: str) -> CompiledLater[..., object]:
    """The function of the integrator with this name, never compiled."""
    later: CompiledLater[..., object] = getattr(shooting, name)

    def run(*args: object) -> object:
        with np.errstate(all="ignore"):
            return later.function(*args)

    return run  # type: ignore[return-value]


@pytest.mark.parametrize("loads", [{"end_y": 0.0}, {"force": (0.02, 0.03), "moment": 1.0}, {"end": (80.0, 20.0)}])
def test_plain_and_compiled_rods_are_equal(monkeypatch: pytest.MonkeyPatch, loads: dict[str, object]) -> None:
    import numba  # noqa: F401  where it is loaded every call is a compiled one

    compiled = ARM.solve(**loads)  # type: ignore[arg-type]
    for name in ("sweep", "converge"):
        monkeypatch.setattr(continuation, name, plain(name))
    again = ARM.solve(**loads)  # type: ignore[arg-type]
    for array in ("x", "y", "theta", "moment", "force"):
        np.testing.assert_allclose(getattr(again, array), getattr(compiled, array), rtol=1e-12, atol=1e-12)


def test_a_path_without_equilibrium_is_told_in_plain_python_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Newton's method meets numbers that are not finite on the way; plain Python raises nothing there."""
    unknowns = np.array([1e5, 1e9, 1e9])
    steps = 20
    rod = shooting.RodArrays(
        np.linspace(0.0, 1.0, steps + 1),
        np.zeros((steps, 6)),
        np.ones((steps, 6)),
        np.ones(steps),
        np.zeros(steps),
        np.zeros((steps, 6)),
        0.0,
        0.0,
        0.0,
    )
    states: Array = np.empty((steps + 1, 4))
    result = plain("converge")(rod, unknowns, np.zeros(4), np.zeros(3), np.ones(3, bool), states)
    assert result == (False, 0.0)
    assert not math.isfinite(states[-1, 0]) or abs(states[-1, 0]) > 1e3


def test_an_absurd_force_on_the_arm_law_raises_nothing_in_plain_python() -> None:
    law = integration.LawArrays(-1.0, 1.0, *(np.full(3, value) for value in (0.0, 0.01, 1.0, 0.0, 50.0, 10.0)))
    states: Array = np.empty((6, 4))
    with np.errstate(all="ignore"):
        nothing = np.zeros(2)
        load = integration.EndLoad(50.0, nothing, 0.0, np.zeros(2, bool), nothing, np.zeros((6, 4)))
        outside = integration.integrate(law, load, np.array([0.0, 1e308]), np.zeros(4), states)
    assert outside == math.inf


def test_a_program_that_solves_many_rods_compiles() -> None:
    program = """
import sys
from rod.compiled import CompiledLater
def twice(x): return 2.0 * x
later = CompiledLater(twice, (), 2)
assert [later(1.0), later(2.0)] == [2.0, 4.0] and "numba" not in sys.modules
later.compiled = lambda: lambda x: -x
assert later(3.0) == -3.0 and later(4.0) == -4.0
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)
