"""The pattern of a model is made when it is used, and analysed for a factorization where it is another one by then."""

import numpy as np
import pytest

from fem import Fixed, Model, NeoHooke
from fem.equations.constraints import Constraints
from fem.equations.linearised import Linearised
from fem.equations.pardiso import available_solver
from fem.equations.system import System
from fem.supports import SharedPlane
from tests.bodies import box

LAW = NeoHooke(0.4, 20.0)
SUPPORTS = [Fixed("left", "xyz"), Fixed("back", "z")]


class Counting(available_solver()):  # type: ignore[misc]
    """The solver of the machine; it fails at the analysis `fails_at`."""

    fails_at = 0

    def __init__(self) -> None:
        super().__init__()
        self.entries: list[int] = []  #: of the analysed patterns

    def analyse(self, indptr: np.ndarray, indices: np.ndarray) -> None:
        self.entries.append(indices.shape[0])
        if len(self.entries) == self.fails_at:
            raise MemoryError("the factor does not fit")
        super().analyse(indptr, indices)


def body() -> System:
    return Model(box((2, 2, 1), (1.0, 1.0, 1.0)), LAW, SUPPORTS, []).system(Counting)


def tangent(system: System) -> np.ndarray:
    state = system.rest_state()
    return system.tangent(state, system.assemble(state, ()), (), np.zeros_like(state.displacement), False)[0]


def linearised(system: System) -> Linearised:
    state = system.rest_state()
    return system.linearise(state, system.assemble(state, ()), ())


def apart(system: System) -> np.ndarray:
    """Two nodes that share no element and are free, (1,) each: at the corners of the end that is not held."""
    beside = system.space.points @ np.array([100.0, 1.0, 0.0])
    other = system.space.points @ np.array([100.0, -1.0, 0.0])
    return np.array([[int(np.argmax(beside))], [int(np.argmax(other))]])


def test_nothing_is_analysed_before_it_is_used() -> None:
    system = body()
    system.storage.hold(np.array([3]))
    system.storage.enlarge(*np.sort(apart(system), axis=0))
    system.storage.hold(np.empty(0, np.int64))
    values = tangent(system)
    assert system.solver.entries == []
    linearised(system)
    assert system.solver.entries == [values.shape[0]]


def test_the_pattern_is_enlarged_by_pairs_that_no_element_has() -> None:
    system = body()
    before = tangent(system)
    first, second = np.sort(apart(system), axis=0)
    inside = system.space.nodes[0]
    system.storage.enlarge(np.array([first[0], inside.min(), 5]), np.array([second[0], inside.max(), 5]))
    assert system.storage.added.tolist() == [int(first[0]) * system.space.points.shape[0] + int(second[0])]
    larger = tangent(system)
    linearised(system)
    assert system.solver.entries == [larger.shape[0]]
    assert larger.shape[0] > before.shape[0]
    np.testing.assert_array_equal(np.sort(larger[larger != 0]), np.sort(before[before != 0]))
    linearised(system)
    assert len(system.solver.entries) == 1


def test_a_pattern_is_analysed_again_after_an_analysis_that_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where the factor with exact distances between walls does not fit into memory, and the path goes on without."""
    monkeypatch.setattr(Counting, "fails_at", 2)
    system = body()
    expected = linearised(system).negative_pivots
    system.storage.enlarge(*np.sort(apart(system), axis=0))
    with pytest.raises(MemoryError):
        linearised(system)
    system.storage.hold(np.empty(0, np.int64))
    assert linearised(system).negative_pivots == expected == 0
    smaller, larger, again = system.solver.entries
    assert smaller == again < larger


def test_other_constraints_and_other_pairs_together_are_those_of_a_new_system() -> None:
    system, new = body(), body()
    planes = [[*SUPPORTS, SharedPlane("right", normal)] for normal in ((1.0, 0.0, 0.0), (1.0, 0.3, 0.0))]
    system.replace_constraints(Constraints.of(planes[0], system.space))
    tangent(system)
    system.storage.enlarge(*np.sort(apart(system), axis=0))
    for each in (system, new):
        each.replace_constraints(Constraints.of(planes[1], each.space))
    new.storage.hold(system.storage.added)
    np.testing.assert_array_equal(tangent(system), tangent(new))
