"""The sparsity pattern of the reduced upper triangle against dense matrices."""

import numpy as np
import pytest

from fem.discretisation import Discretisation
from fem.equations.pattern import Pattern, element_keys
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
