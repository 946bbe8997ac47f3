"""Elements against differences of their energy, and the band solver against dense linear algebra."""

from collections.abc import Callable

import numpy as np
import pytest

from geometry.arrays import Array
from rod.arm.bands import factorize, solve
from rod.arm.elements import plane_element, space_element
from rod.arm.rotations import exponential, logarithm

LENGTH = 1.3
#: of difference quotients: errors of the fourth order and rounding are about equal
STEP = 1e-3


def rotation(turn: Array) -> Array:
    out = np.empty((3, 3))
    exponential(np.asarray(turn, float), out)
    return out


def rotation_vector(frame: Array) -> Array:
    out = np.empty(3)
    logarithm(frame, out)
    return out


def derivatives(energy: Callable[[Array], float], size: int) -> tuple[Array, Array]:
    """Gradient and Hessian of an energy at zero, by central differences extrapolated once."""
    unit = np.eye(size)

    def first(step: float) -> Array:
        return np.array([(energy(step * e) - energy(-step * e)) / (2.0 * step) for e in unit])

    def second(step: float) -> Array:
        def mixed(a: Array, b: Array) -> float:
            ends = (energy(step * (s * a + t * b)) * s * t for s in (1.0, -1.0) for t in (1.0, -1.0))
            return sum(ends) / (4.0 * step**2)

        return np.array([[mixed(a, b) for b in unit] for a in unit])

    limits = [(4.0 * of(STEP) - of(2.0 * STEP)) / 3.0 for of in (first, second)]
    return limits[0], limits[1]


def law(
    random: np.random.Generator, size: int
) -> tuple[Callable[[Array], float], Callable[[Array], tuple[Array, Array]]]:
    """An energy of strains that is not quadratic; its forces and its stiffness."""
    half, rest = random.normal(size=(size, size)), 0.1 * random.normal(size=size)
    rest[size // 2 if size == 6 else 1] += 1.0  # the stretch
    stiffness = half @ half.T + np.eye(size)

    def energy(strain: Array) -> float:
        off = strain - rest
        return float(0.5 * off @ stiffness @ off + 0.1 * np.sum(off**3))

    def forces(strain: Array) -> tuple[Array, Array]:
        off = strain - rest
        return stiffness @ off + 0.3 * off**2, stiffness + np.diag(0.6 * off)

    return energy, forces


@pytest.mark.parametrize("turn", [0.0, 1e-3, 0.3, 1.2])
def test_gradient_and_hessian_of_an_element_in_space(turn: float) -> None:
    """The Hessian is that along exp(t psi), which is symmetric."""
    random = np.random.default_rng(1)
    energy_of, forces_of = law(random, 6)
    a, frame_a = random.normal(size=3), rotation(random.normal(size=3))
    frame_b = frame_a @ rotation(turn * random.normal(size=3))
    b = a + LENGTH * frame_a @ [1.0, 0.1, -0.2] + 0.1 * random.normal(size=3)

    def strains(at_a: Array, first: Array, at_b: Array, last: Array) -> tuple[Array, Array, Array]:
        theta = rotation_vector(first.T @ last)
        middle = first @ rotation(0.5 * theta)
        return np.concatenate([theta, middle.T @ (at_b - at_a)]) / LENGTH, theta, middle

    def energy(motion: Array) -> float:
        first, last = rotation(motion[3:6]) @ frame_a, rotation(motion[9:]) @ frame_b
        return LENGTH * energy_of(strains(a + motion[:3], first, b + motion[6:9], last)[0])

    strain, theta, middle = strains(a, frame_a, b, frame_b)
    force, stiffness = forces_of(strain)
    gradient, hessian = np.empty(12), np.empty((12, 12))
    work, state = np.zeros((16, 3, 3)), np.concatenate([strain, force, theta])
    space_element(LENGTH, middle, state, stiffness, force[3:].copy(), work, gradient, hessian)
    by_first, by_second = derivatives(energy, 12)
    assert gradient == pytest.approx(by_first, abs=1e-8)
    assert hessian == pytest.approx(by_second, abs=1e-6)
    assert hessian == pytest.approx(hessian.T, abs=1e-12)


def test_gradient_and_hessian_of_an_element_in_the_plane() -> None:
    energy_of, forces_of = law(np.random.default_rng(2), 3)
    nodes = np.array([0.0, 0.0, 0.3, 1.0, 0.4, 0.9])

    def strains(at: Array) -> tuple[Array, float]:
        angle = 0.5 * (at[2] + at[5])
        cosine, sine = np.cos(angle), np.sin(angle)
        x, y = (at[3:5] - at[:2]) / LENGTH
        return np.array([(at[5] - at[2]) / LENGTH, cosine * x + sine * y, cosine * y - sine * x]), float(angle)

    strain, angle = strains(nodes)
    force, stiffness = forces_of(strain)
    gradient, hessian = np.empty(6), np.empty((6, 6))
    plane_element(LENGTH, np.array([angle, *strain, 0.0]), force, stiffness, force[1:].copy(), gradient, hessian)
    by_first, by_second = derivatives(lambda motion: LENGTH * energy_of(strains(nodes + motion)[0]), 6)
    assert gradient == pytest.approx(by_first, abs=1e-8)
    assert hessian == pytest.approx(by_second, abs=1e-6)


def test_a_band_is_solved_and_its_pivots_count_the_negative_eigenvalues() -> None:
    random, n, half = np.random.default_rng(3), 40, 5
    full = random.normal(size=(n, n))
    full = np.tril(np.triu(full + full.T, -half), half) + np.diag(random.normal(size=n) * 20.0)
    band = np.zeros((n, 2 * half + 1))
    for i in range(n):
        for j in range(max(0, i - half), min(n, i + half + 1)):
            band[i, half + j - i] = full[i, j]
    columns = random.normal(size=(n, 2))
    expected = np.linalg.solve(full, columns)
    assert factorize(band, half, 1e-300)
    solve(band, half, columns)
    # without pivoting digits are lost where a pivot is small
    assert columns == pytest.approx(expected, rel=1e-6, abs=1e-9)
    assert np.count_nonzero(band[:, half] < 0.0) == np.count_nonzero(np.linalg.eigvalsh(full) < 0.0)
