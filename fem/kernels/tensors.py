"""Tensors of material laws, compiled by numba; p is a stress point, a and b are principal axes.

Components as in `fem.materials.tensors`: v and m count 11, 22, 33, 12, 23, 13.
"""

import numpy as np
from numba import njit

from fem.kernels.element import FAST, VOIGT
from geometry.arrays import Array

ROW, COLUMN = VOIGT[:, 0].copy(), VOIGT[:, 1].copy()
#: pairs of principal axes, and sweeps of Jacobi's method, of which five leave nothing but rounding
PAIRS, SWEEPS = VOIGT[3:].copy(), 12


@njit(cache=True, fastmath=FAST)
def cauchy_green(strain: Array, smallest: float, tensor: Array, inverse: Array, invariants: Array) -> None:
    """C = 2 E + I (p, v), C^-1 (p, v), and det C, tr C, (tr(C)^2 - tr C^2) / 2 (p, 3), of strains (p, v) with
    engineering shear. The determinant is at least `smallest`."""
    for p in range(strain.shape[0]):
        a, b, c = 2.0 * strain[p, 0] + 1.0, 2.0 * strain[p, 1] + 1.0, 2.0 * strain[p, 2] + 1.0
        d, e, f = strain[p, 3], strain[p, 4], strain[p, 5]
        minor_a, minor_b, minor_c = b * c - e * e, a * c - f * f, a * b - d * d
        minor_d, minor_e, minor_f = e * f - c * d, d * f - a * e, d * e - b * f
        determinant = max(a * minor_a + d * minor_d + f * minor_f, smallest)
        tensor[p, 0], tensor[p, 1], tensor[p, 2] = a, b, c
        tensor[p, 3], tensor[p, 4], tensor[p, 5] = d, e, f
        inverse[p, 0], inverse[p, 1], inverse[p, 2] = minor_a, minor_b, minor_c
        inverse[p, 3], inverse[p, 4], inverse[p, 5] = minor_d, minor_e, minor_f
        for v in range(6):
            inverse[p, v] /= determinant
        invariants[p, 0], invariants[p, 1], invariants[p, 2] = determinant, a + b + c, minor_a + minor_b + minor_c


@njit(cache=True, fastmath=FAST)
def add_products(factors: Array, tensor: Array, inverse: Array, out: Array) -> None:
    """Add to out (p, v, m) the products of I, C and C^-1 with the factors (p, 6), in the order of
    `fem.materials.tensors.Products`."""
    full = np.empty((3, 3))
    for p in range(out.shape[0]):
        one_one, one_inverse, inverse_inverse = factors[p, 0], factors[p, 1], factors[p, 2]
        derivative, tensor_inverse, symmetric = factors[p, 3], factors[p, 4], factors[p, 5]
        for v in range(6):
            full[ROW[v], COLUMN[v]] = full[COLUMN[v], ROW[v]] = inverse[p, v]
        for v in range(6):
            i, j = ROW[v], COLUMN[v]
            one_v = 1.0 if v < 3 else 0.0
            for m in range(v, 6):
                k, n = ROW[m], COLUMN[m]
                one_m = 1.0 if m < 3 else 0.0
                value = inverse_inverse * inverse[p, v] * inverse[p, m]
                value += 0.5 * derivative * (full[i, k] * full[j, n] + full[i, n] * full[j, k])
                value += one_one * one_v * one_m
                value += one_inverse * (one_v * inverse[p, m] + one_m * inverse[p, v])
                value += tensor_inverse * (tensor[p, v] * inverse[p, m] + tensor[p, m] * inverse[p, v])
                if v == m:
                    value += symmetric if v < 3 else 0.5 * symmetric
                out[p, v, m] += value
                if v != m:
                    out[p, m, v] += value


@njit(cache=True, fastmath=FAST)
def principal(axes: Array, values: Array, diagonal: Array, rotation: Array, stress: Array, tangent: Array) -> None:
    """Stress (p, v) and tangent (p, v, m) from what they are in the principal axes, the columns of axes (p, 3, 3).

    With N_a the axes, n_a = N_a N_a^T and r_k = N_a N_b^T + N_b N_a^T for the pairs 01, 12, 02: stress sum_a values_a
    n_a, tangent sum_ab diagonal_ab n_a n_b + sum_k rotation_k r_k r_k, with values (p, 3), diagonal (p, 3, 3) and
    rotation (p, 3).
    """
    basis = np.empty((6, 6))
    half = np.empty((6, 6))
    for p in range(axes.shape[0]):
        for v in range(6):
            i, j = ROW[v], COLUMN[v]
            for a in range(3):
                basis[a, v] = axes[p, i, a] * axes[p, j, a]
                b = (a + 1) % 3
                first, second = (a, b) if a < b else (b, a)
                basis[3 + a, v] = axes[p, i, first] * axes[p, j, second] + axes[p, i, second] * axes[p, j, first]
            stress[p, v] = values[p, 0] * basis[0, v] + values[p, 1] * basis[1, v] + values[p, 2] * basis[2, v]
        for m in range(6):
            for a in range(3):
                half[a, m] = (
                    diagonal[p, a, 0] * basis[0, m] + diagonal[p, a, 1] * basis[1, m] + diagonal[p, a, 2] * basis[2, m]
                )
                half[3 + a, m] = rotation[p, a] * basis[3 + a, m]
        for v in range(6):
            for m in range(v, 6):
                value = 0.0
                for a in range(6):
                    value += basis[a, v] * half[a, m]
                tangent[p, v, m] = tangent[p, m, v] = value


@njit(cache=True)
def principal_axes(tensor: Array, smallest: float, values: Array, axes: Array) -> None:
    """Eigenvalues (p, a) of symmetric tensors (p, v), at least `smallest`, and eigenvectors in the columns of axes
    (p, 3, 3), by Jacobi's rotations (G. H. Golub, C. F. Van Loan, Matrix Computations, 8.5)."""
    full = np.empty((3, 3))
    for p in range(tensor.shape[0]):
        axes[p] = 0.0
        for v in range(6):
            full[ROW[v], COLUMN[v]] = full[COLUMN[v], ROW[v]] = tensor[p, v]
        for a in range(3):
            axes[p, a, a] = 1.0
        for _ in range(SWEEPS):
            rest = 0.0
            for a in range(3):
                rest = max(rest, rotate(full, axes[p], PAIRS[a, 0], PAIRS[a, 1]))
            if rest == 0.0:
                break
        for a in range(3):
            values[p, a] = max(full[a, a], smallest)


@njit(cache=True)
def rotate(full: Array, axes: Array, first: int, second: int) -> float:
    """Turn two axes so that the component between them vanishes; its amount before, 0 where it is only rounding."""
    beside = full[first, second]
    difference = full[second, second] - full[first, first]
    if abs(beside) <= 1e-17 * (abs(full[first, first]) + abs(full[second, second])):
        return 0.0
    half = difference / (2.0 * beside)
    tangent = (1.0 if half >= 0.0 else -1.0) / (abs(half) + np.sqrt(half * half + 1.0))
    cosine = 1.0 / np.sqrt(tangent * tangent + 1.0)
    sine, other = tangent * cosine, 3 - first - second
    full[first, first] -= tangent * beside
    full[second, second] += tangent * beside
    full[first, second] = full[second, first] = 0.0
    x, y = full[other, first], full[other, second]
    full[other, first] = full[first, other] = cosine * x - sine * y
    full[other, second] = full[second, other] = sine * x + cosine * y
    for i in range(3):
        x, y = axes[i, first], axes[i, second]
        axes[i, first], axes[i, second] = cosine * x - sine * y, sine * x + cosine * y
    return abs(beside)


@njit(cache=True)
def powers_of_stretches(
    squares: Array, mu: Array, alpha: Array, energy: Array, stress: Array, diagonal: Array, rotation: Array
) -> None:
    """Ogden's energy (p,), and stress (p, a) and tangent in the principal axes for `principal`, from the squares (p, a)
    of the principal stretches and mu and alpha (i,) of the terms."""
    power, log, ratio = np.empty(3), np.empty(3), np.empty(3)
    for p in range(squares.shape[0]):
        value = squares[p]
        for a in range(3):
            log[a] = np.log(value[a])
            ratio[a] = log_of_ratio(value[PAIRS[a, 0]], value[PAIRS[a, 1]])
        log_size = -(log[0] + log[1] + log[2]) / 3.0
        energy[p], stress[p], diagonal[p], rotation[p] = 0.0, 0.0, 0.0, 0.0
        for i in range(mu.shape[0]):
            half = 0.5 * alpha[i]
            for a in range(3):
                power[a] = np.exp(half * (log[a] + log_size))
            mean = (power[0] + power[1] + power[2]) / 3.0
            energy[p] += mu[i] / alpha[i] * 3.0 * (mean - 1.0)
            for a in range(3):
                first, second = value[PAIRS[a, 0]], value[PAIRS[a, 1]]
                power_rate = power[PAIRS[a, 1]] / second
                quotient = difference_of_powers(first, second, ratio[a], power_rate, half - 1.0)
                rotation[p, a] += mu[i] * (quotient + mean / (first * second))
                stress[p, a] += mu[i] * (power[a] - mean) / value[a]
                for b in range(3):  # 2 d (power_a - mean) / d ln c_b
                    slope = mean - power[a] - power[b] + (3.0 * power[a] if a == b else 0.0)
                    diagonal[p, a, b] += mu[i] * alpha[i] / 3.0 * slope / (value[a] * value[b])
        for a in range(3):
            diagonal[p, a, a] -= 2.0 * stress[p, a] / value[a]


@njit(cache=True)
def log_of_ratio(x: float, y: float) -> float:
    """ln(x / y) of positive x and y, accurate where they are close."""
    return np.log1p((x - y) / y) if abs(x - y) < 0.5 * y else np.log(x / y)


@njit(cache=True)
def difference_of_powers(x: float, y: float, log: float, power: float, exponent: float) -> float:
    """(x^p - y^p) / (x - y) of positive x and y with ln(x / y) and y^p, p y^(p-1) where x = y; accurate where they are
    close. As power any multiple of y^p may be given, for that multiple."""
    return power * (exponent / y if x == y else np.expm1(exponent * log) / (x - y))
