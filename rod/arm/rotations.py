"""Rotations and products of vectors and matrices in three dimensions, as the elements use them."""

import math

from geometry.arrays import Array


def cross_into(a: Array, b: Array, out: Array) -> None:
    """a x b, (3,) each."""
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


def skew(a: Array, out: Array) -> None:
    """The matrix (3, 3) of a x."""
    out[0, 0] = out[1, 1] = out[2, 2] = 0.0
    out[0, 1], out[0, 2], out[1, 2] = -a[2], a[1], -a[0]
    out[1, 0], out[2, 0], out[2, 1] = a[2], -a[1], a[0]


def turn_matrix(turn: Array, first: float, second: float, out: Array) -> None:
    """The matrix (3, 3) I + first [turn] + second [turn]^2 of a rotation vector (3,)."""
    square = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]
    for i in range(3):
        for j in range(3):
            out[i, j] = second * turn[i] * turn[j]
        out[i, i] += 1.0 - second * square
    out[0, 1] -= first * turn[2]
    out[1, 0] += first * turn[2]
    out[0, 2] += first * turn[1]
    out[2, 0] -= first * turn[1]
    out[1, 2] -= first * turn[0]
    out[2, 1] += first * turn[0]


def exponential(turn: Array, out: Array) -> None:
    """The rotation (3, 3) of a rotation vector (3,), rad."""
    square = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]
    angle = math.sqrt(square)
    if angle < 1e-4:
        first, second = 1.0 - square / 6.0, 0.5 - square / 24.0
    else:
        half = math.sin(0.5 * angle)
        first, second = math.sin(angle) / angle, 2.0 * half * half / square
    turn_matrix(turn, first, second, out)


def logarithm(frame: Array, out: Array) -> None:
    """The rotation vector (3,) of a rotation (3, 3) by less than half a turn."""
    out[0] = 0.5 * (frame[2, 1] - frame[1, 2])
    out[1] = 0.5 * (frame[0, 2] - frame[2, 0])
    out[2] = 0.5 * (frame[1, 0] - frame[0, 1])
    sine = math.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])
    cosine = 0.5 * (frame[0, 0] + frame[1, 1] + frame[2, 2] - 1.0)
    angle = math.atan2(sine, cosine)
    factor = angle / sine if sine > 1e-7 else 1.0
    for i in range(3):
        out[i] *= factor


def copy_into(matrix: Array, out: Array) -> None:
    """Copy a matrix (3, 3). To copy slices, numba compiles the text of an error, too."""
    for i in range(3):
        for j in range(3):
            out[i, j] = matrix[i, j]


def multiply(a: Array, b: Array, out: Array) -> None:
    """a b of two matrices (3, 3)."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


def multiply_transposed(a: Array, b: Array, out: Array) -> None:
    """a^T b of two matrices (3, 3)."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[0, i] * b[0, j] + a[1, i] * b[1, j] + a[2, i] * b[2, j]


#: what the elements call
CALLS = (cross_into, skew, turn_matrix, exponential, logarithm, copy_into, multiply, multiply_transposed)
