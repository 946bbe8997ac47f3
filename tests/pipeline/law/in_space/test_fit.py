"""Polynomials through states that were made from a polynomial."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry.arrays import Array
from pipeline.law.in_space.fit import PressureBasis, fit_cell
from pipeline.law.in_space.states import CellState, Curvatures, Pressures
from pipeline.law.table import space_sentences

DRAWN = np.random.default_rng(3)
ROWS = np.array([[20.0, 0.0, 5.0], [0.0, 20.0, 5.0], [10.0, 10.0, 5.0]])  # of rank two


def gradient(k: Array, p: Array) -> Array:
    """dw/dkappa of w = k.k/2 (300 + 2 p_0) + 1e4 k_y^2 k_z + 5e5 k_z^4 - p_1 k_y + 0.02 p_0^2 k_z."""
    y, z = k
    stiff = 300 + 2 * p[0]
    return np.array([stiff * y + 2e4 * y * z - p[1], stiff * z + 1e4 * y**2 + 2e6 * z**3 + 0.02 * p[0] ** 2])


def air(k: Array, p: Array) -> tuple[float, ...]:
    """mm2: minus dw/dp of the same w, in N per kPa, and what is there without curvature."""
    by_pressure = np.array([k @ k + 0.04 * p[0] * k[1], -k[0], 0.0])
    return tuple((40.0 + np.array([0.1, 0.0, 0.04]) * p - 1e3 * by_pressure).tolist())


def state(k: Curvatures, p: Pressures) -> CellState:
    y, z = k
    size = float(np.hypot(y, z))
    along = np.array([y, z]) / size
    across = np.array([along[1], -along[0]])
    frame, pressures, largest = np.array([across, along]), np.array(p), max(p)
    stiff = 300 + 2 * p[0]
    second = np.array([[stiff + 2e4 * z, 2e4 * y], [2e4 * y, stiff + 6e6 * z**2]])
    part = pressures / largest
    by_pressure = part[0] * (2 * np.array(k) + [0.0, 0.04 * p[0]]) - np.array([part[1], 0.0])

    def told(vector: Array) -> tuple[float, float]:
        first, other = frame @ vector
        return float(first), float(other)

    return CellState(
        p,
        k,
        (float(across[0]), float(across[1])),
        (float(along[0]), float(along[1])),
        told(gradient(np.array(k), pressures)),
        told(second @ along),
        told(by_pressure),
        1 + 1e-3 * p[0] + 2 * z,
        float(2 * along[1]),
        1e-3 * part[0],
        40.0,
        (0.0, 0.0),
        air(np.array(k), pressures),
    )


def drawn(count: int) -> list[CellState]:
    states = []
    for parts in DRAWN.dirichlet(np.ones(3), count):
        p0, p1, p2 = (float(value) for value in DRAWN.uniform(0.3, 1.0) * parts @ ROWS)
        y, z = (float(value) for value in DRAWN.uniform(-0.01, 0.01, 2))
        states.append(state((y, z), (p0, p1, p2)))
    return states


def test_a_potential_of_degree_four_is_found() -> None:
    spanned = PressureBasis(ROWS)
    assert spanned.onto.shape == (3, 2)
    fit = fit_cell(drawn(60), spanned, 0.01)
    assert fit.error < 1e-8
    for there in drawn(5):
        plane = fit.potential.at_last(np.array(there.pressures) @ spanned.onto)
        k = np.array(there.curvature)
        found = [plane.derivative(axis)(k)[0] for axis in (0, 1)]
        assert found == pytest.approx(gradient(k, np.array(there.pressures)), abs=1e-7)
        assert fit.stretch(np.array([[*k, *np.array(there.pressures) @ spanned.onto]]))[0, 0] == pytest.approx(
            there.stretch
        )
        assert fit.volume.at_last(np.array(there.pressures) @ spanned.onto)(k) == pytest.approx(there.volume, rel=1e-8)


def test_the_error_is_that_of_states_that_were_left_out() -> None:
    """Moments that no polynomial has are missed by about as much as they are off."""
    off = [
        CellState(**{**vars(one), "moment": (one.moment[0], one.moment[1] * (1 + 0.02 * float(DRAWN.normal())))})
        for one in drawn(60)
    ]
    assert 1e-3 < fit_cell(off, PressureBasis(ROWS), 0.01).error < 0.05


def test_a_law_says_how_far_from_the_unloaded_curvature_it_is_valid() -> None:
    law: Any = SimpleNamespace(law=SimpleNamespace(error=0.01, reach=0.003), states=9, changes=None, left=())
    assert space_sentences(law)[1] == "Valid up to 3 1/m from the unloaded curvature."
