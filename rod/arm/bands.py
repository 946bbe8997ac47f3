"""The tangent of a chain of elements: a band matrix, factorized without pivoting.

A row of `band` is a row of the matrix from `half` columns before its diagonal to `half` columns behind it. Without
pivoting the signs of the pivots of a symmetric matrix are those of its eigenvalues (Sylvester), which counts the
unstable directions of an arm. Both ends make the matrix slightly unsymmetric, so that it is L U instead of L D L^T.
"""

from geometry.arrays import Array


def factorize(band: Array, half: int, tiny: float) -> bool:
    """Overwrite a band matrix (n, 2 half + 1) by its factors L and U; False where a pivot is smaller than tiny."""
    n = len(band)
    for k in range(n):
        pivot = band[k, half]
        if not abs(pivot) > tiny:
            return False
        last = min(half, n - 1 - k)
        for i in range(1, last + 1):
            row = k + i
            factor = band[row, half - i] / pivot
            if factor == 0.0:
                continue
            band[row, half - i] = factor
            for j in range(1, last + 1):
                band[row, half - i + j] -= factor * band[k, half + j]
    return True


def solve(band: Array, half: int, columns: Array) -> None:
    """Overwrite columns (n, c) by the solutions of a factorized system."""
    n = len(band)
    for c in range(columns.shape[1]):
        for k in range(n):
            value = columns[k, c]
            for i in range(1, min(half, k) + 1):
                value -= band[k, half - i] * columns[k - i, c]
            columns[k, c] = value
        for k in range(n - 1, -1, -1):
            value = columns[k, c]
            for i in range(1, min(half, n - 1 - k) + 1):
                value -= band[k, half + i] * columns[k + i, c]
            columns[k, c] = value / band[k, half]


def solve_small(matrix: Array, columns: Array) -> float:
    """Overwrite columns (k, c) by the solutions of a small system, by elimination with row exchanges.

    The matrix (k, k) is overwritten. Returns its determinant; 0.0 where the matrix is singular, columns are then not
    solved.
    """
    n = len(matrix)
    determinant = 1.0
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if not abs(matrix[best, k]) > 0.0:
            return 0.0
        if best != k:
            determinant = -determinant
            for j in range(n):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            for c in range(columns.shape[1]):
                columns[k, c], columns[best, c] = columns[best, c], columns[k, c]
        determinant *= matrix[k, k]
        for i in range(k + 1, n):
            factor = matrix[i, k] / matrix[k, k]
            for j in range(k + 1, n):
                matrix[i, j] -= factor * matrix[k, j]
            for c in range(columns.shape[1]):
                columns[i, c] -= factor * columns[k, c]
    for k in range(n - 1, -1, -1):
        for c in range(columns.shape[1]):
            value = columns[k, c]
            for j in range(k + 1, n):
                value -= matrix[k, j] * columns[j, c]
            columns[k, c] = value / matrix[k, k]
    return determinant
