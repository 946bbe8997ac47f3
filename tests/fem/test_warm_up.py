"""Every kernel is compiled once, before the run."""

import gc
from types import ModuleType

import pytest

import fem
from fem.kernels import element, mixed, recovery, surface, tangent, tensors
from fem.memory import paused
from fem.post.recovery import stress_error
from tests.bodies import box

LAWS = (
    *(fem.StVenantKirchhoff(1.2, 0.3), fem.Hencky(1.2, 0.3), fem.NeoHooke(1.2, 20.0)),
    *(fem.MooneyRivlin(0.3, 0.1, 20.0), fem.Ogden((0.6, 0.001), (1.3, 5.0), 20.0)),
)


def signatures() -> set[tuple[str, str]]:
    """Names and argument types of all kernels that have been compiled or loaded in this process."""
    modules: tuple[ModuleType, ...] = (element, mixed, recovery, surface, tangent, tensors)
    kernels = {
        name: kernel for module in modules for name, kernel in vars(module).items() if hasattr(kernel, "signatures")
    }
    return {(name, str(signature)) for name, kernel in kernels.items() for signature in kernel.signatures}


@pytest.mark.parametrize("formulation", ["p1", "p2", "p2p0", "mixed"])
def test_nothing_is_compiled_once_a_run_has_begun(formulation: str) -> None:
    """A law or element whose arrays have another memory layout would compile the tangent again, which takes long."""
    mesh = box((2, 1, 1), (2.0, 1.0, 1.0))
    for law in LAWS:
        fem.compile_kernels("mixed" if formulation == "mixed" else "p2p0", law)
        before = signatures()
        supports = [fem.Fixed("left"), fem.Prescribed("right", "x", 0.01)]
        model = fem.Model(mesh, law, supports, [fem.Pressure("top", 1e-3)], formulation)
        stress_error(fem.follow(model, [1.0]).steps[0], law)
        assert signatures() == before


def test_the_garbage_collector_pauses_and_passes_over_what_was_loaded() -> None:
    assert gc.isenabled()
    with paused():
        assert not gc.isenabled()
        with paused():
            pass
        assert not gc.isenabled()
    assert gc.isenabled()
    fem.compile_kernels()
    assert gc.isenabled()
    assert gc.get_freeze_count() > 100_000
