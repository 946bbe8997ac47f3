"""Rods in plain Python and compiled: the same numbers, when which is taken, and nothing is compiled in a run."""

import importlib.util
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.results.laws import law_of_record, law_record
from rod import Body, FiveParameters, Loading, Relaxation, Rod, Start, compile_kernels, move
from rod.arm import path, solver
from rod.arm.chain import solve_chain
from rod.arm.small_motions import lowest_of
from rod.compiled import source_stamp
from rod.weight import Mass
from tests.rod.arm_law.test_arm_law import law_of, straight_law

ARM = Rod(112.0, -0.012, FiveParameters(180.0, 400.0, 0.5, -0.2, 12.0))


def in_python(*args: object) -> object:
    """The solver, never compiled."""
    with np.errstate(all="ignore"):
        return solve_chain.function(*args)  # type: ignore[arg-type]


@pytest.mark.parametrize("loads", [{"end_y": 0.0}, {"force": (0.02, 0.03), "moment": 1.0}, {"end": (80.0, 20.0)}])
def test_plain_and_compiled_rods_are_equal(monkeypatch: pytest.MonkeyPatch, loads: dict[str, object]) -> None:
    import numba  # noqa: F401  where it is loaded every call is a compiled one

    compiled = ARM.solve(**loads)  # type: ignore[arg-type]
    monkeypatch.setattr(solver, "solve_chain", in_python)
    again = ARM.solve(**loads)  # type: ignore[arg-type]
    for array in ("x", "y", "theta", "moment", "force"):
        # stretch is next to rigid: a rounded length of 1e-16 is a force of 1e-8 alpha / l^2
        np.testing.assert_allclose(getattr(again, array), getattr(compiled, array), rtol=1e-7, atol=1e-7)


def test_an_absurd_force_raises_nothing_in_plain_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """Newton's method meets numbers that are not finite on the way."""
    monkeypatch.setattr(solver, "solve_chain", in_python)
    monkeypatch.setattr(path, "SMALLEST_STEP", 0.2)
    with pytest.raises(ValueError, match="No equilibrium was found beyond 0 % of the load"):
        ARM.solve(force=(0.0, 1e300))


def test_a_change_of_any_file_that_is_compiled_makes_the_cache_old(tmp_path: Path) -> None:
    def kernel_of(text: str) -> tuple[tuple[str, int, int], ...]:
        (tmp_path / "kernel.py").write_text(text, encoding="utf-8")
        spec = importlib.util.spec_from_file_location("kernel", tmp_path / "kernel.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return source_stamp((module.f, solve_chain.function))

    first = kernel_of("def f(): return 1")
    assert len(first) == 2
    assert kernel_of("def f(): return 12") != first


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


KERNELS = {"rods": solve_chain, "stability": lowest_of}
FIVE = FiveParameters(190.0, 400.0, -0.1, 0.5, 7.3)


def signatures() -> dict[str, list[str]]:
    """Argument types for which each kernel has been compiled, or loaded, in this test."""
    return {name: [str(types) for types in kernel._compiled.signatures] for name, kernel in KERNELS.items()}


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> dict[str, list[str]]:
    for kernel in KERNELS.values():
        monkeypatch.setattr(kernel, "_compiled", None)
        monkeypatch.setattr(kernel, "remaining", 20)
    compile_kernels()
    return signatures()


def test_nothing_is_compiled_once_a_run_has_begun(compiled: dict[str, list[str]]) -> None:
    """Arrays of another layout, or that cannot be written, would compile a kernel again, which takes ten seconds."""
    assert {name: len(types) for name, types in compiled.items()} == dict.fromkeys(KERNELS, 1)
    loads = ({"end_y": 0.0}, {"force": (0.0, 1e-3), "moment": 0.1}, {"end": (100.0, 5.0)})
    for rod in (Rod(112.0, -0.001, FIVE), Rod(112.0, -0.001, FIVE, weight=(0.0, -1e-5), weight_height=5.0)):
        for load in loads:
            rod.solve(**load)
    cell, clamp, tip = straight_law(5.0)
    repeated = replace(clamp, offset=np.broadcast_to(np.zeros(2), (9, 2)))
    by_columns = replace(tip, acts_at=np.asfortranarray(tip.acts_at))
    measured = law_of(straight_law(0.0), (cell, repeated, by_columns), straight_law(10.0, -0.001))
    for law in (measured, law_of_record(json.loads(json.dumps(law_record(measured))))):
        for pressure in (5.0, 7.5, 10.0):
            for load in loads[:2]:
                Rod(law.length, law=law.at(pressure)).solve(**load)
    body = Body(measured, Relaxation((0.1,), (0.1,)), Mass.even(measured.length, 10.0))
    motion = move(body, 7.5, 0.01, start=Start(5.0, Loading((0.0, 0.01))))
    assert motion.reason == ""
    assert signatures() == compiled
