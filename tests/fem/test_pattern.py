"""The sparsity pattern of the reduced upper triangle against dense matrices, and when it is made and analysed."""

import numpy as np
import pytest

from fem import Fixed, Model, NeoHooke
from fem.discretisation import Discretisation
from fem.equations.constraints import Constraints
from fem.equations.linearised import Linearised
from fem.equations.pardiso import available_solver
from fem.equations.pattern import Pattern, element_keys
from fem.equations.system import System
from fem.supports import SharedPlane
from geometry.arrays import Array, Mask
from tests.bodies import box


def random_pairs(nodes: int, count: int, seed: int) -> tuple[Array, Array]:
    pairs = np.random.default_rng(seed).integers(0, nodes, size=(count, 2))
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    return pairs[:, 0], pairs[:, 1]


def random_components(nodes: int, fraction: float, seed: int) -> Mask:
    return np.random.default_rng(seed).random((nodes, 3)) < fraction


def dense(pattern: Pattern, data: Array) -> Array:
    matrix = np.zeros((pattern.size, pattern.size))
    for row in range(pattern.size):
        columns = pattern.indices[pattern.indptr[row] : pattern.indptr[row + 1]]
        assert columns[0] == row
        assert (np.diff(columns) > 0).all()
        matrix[row, columns] = data[pattern.indptr[row] : pattern.indptr[row + 1]]
    return matrix


@pytest.mark.parametrize("fraction", [0.0, 0.3, 0.8, 1.0])
def test_blocks_are_added_where_a_dense_matrix_has_them(fraction: float) -> None:
    nodes = 25
    rows, columns = random_pairs(nodes, 120, seed=2)
    fixed = random_components(nodes, fraction, seed=7)
    off = rows != columns
    pattern = Pattern.of(fixed, np.unique(rows[off] * nodes + columns[off]))
    assert pattern.size == np.count_nonzero(~fixed)
    starts = pattern.starts_of(rows, columns)
    values = np.random.default_rng(1).normal(size=(rows.size, 3, 3))
    data = np.zeros(pattern.indices.size)
    pattern.scatter(data, rows, columns, values, starts)
    pattern.scatter(data, rows, columns, values, starts)
    full = np.zeros((nodes, 3, nodes, 3))
    for row, column, value in zip(rows, columns, values, strict=True):
        full[row, :, column] += 2 * value
    free = ~fixed.ravel()
    expected = np.triu(full.reshape(3 * nodes, 3 * nodes)[np.ix_(free, free)])
    np.testing.assert_array_equal(dense(pattern, data), expected)


@pytest.mark.parametrize("fraction", [0.0, 0.3, 0.8])
def test_the_columns_of_a_pair_begin_where_they_are_found(fraction: float) -> None:
    nodes = 25
    rows, columns = random_pairs(nodes, 120, seed=2)
    rows, columns = rows[rows != columns], columns[rows != columns]
    fixed = random_components(nodes, fraction, seed=7)
    pattern = Pattern.of(fixed, np.unique(rows * nodes + columns))
    starts = pattern.starts_of(rows, columns)
    assert starts.shape == (rows.size, 3)
    for row, column, row_starts in zip(rows, columns, starts, strict=True):
        free = pattern.node_dof[column][~fixed[column]]
        for dof, start in zip(pattern.node_dof[row], row_starts, strict=True):
            if dof < 0 or free.size == 0:
                assert start == -1
            else:
                assert pattern.indptr[dof] <= start < pattern.indptr[dof + 1]
                np.testing.assert_array_equal(pattern.indices[start : start + free.size], free)


def test_a_pattern_is_enlarged_by_new_pairs() -> None:
    nodes = 12
    fixed = random_components(nodes, 0.3, seed=3)
    small = Pattern.of(fixed, np.array([0 * nodes + 5, 2 * nodes + 3]))
    assert small.offset_of(np.array([0, 4]), np.array([5, 4])).shape == (2,)
    large = Pattern.of(fixed, np.array([0 * nodes + 5, 1 * nodes + 9, 2 * nodes + 3]))
    assert large.offset_of(np.array([0, 1, 2]), np.array([5, 9, 3])).shape == (3,)
    np.testing.assert_array_equal(large.node_dof, small.node_dof)
    assert large.keys.size == small.keys.size + 1


def test_element_keys_are_all_pairs_of_nodes_that_share_an_element() -> None:
    space = Discretisation.of(box((2, 1, 1), (1.0, 1.0, 1.0)), "p2")
    count = space.points.shape[0]
    together = np.zeros((count, count), dtype=bool)
    for nodes in space.nodes:
        together[np.ix_(nodes, nodes)] = True
    low, high = np.nonzero(np.triu(together, 1))
    np.testing.assert_array_equal(element_keys(space.nodes, count), low * count + high)


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
