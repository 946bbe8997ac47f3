"""Every kernel of the rod is compiled once, before the run."""

import json
from dataclasses import replace

import numpy as np
import pytest

from pipeline.results.laws import law_of_record, law_record
from rod import Body, FiveParameters, Loading, Relaxation, Rod, Start, compile_kernels, move
from rod.arm.chain import solve_chain
from rod.arm.small_motions import lowest_of
from rod.weight import Mass
from tests.rod.arm_law.test_arm_law import law_of, straight_law

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
