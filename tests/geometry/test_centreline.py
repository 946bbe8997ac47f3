"""The material curve: stretch, angle, and the curves that are refused."""

import numpy as np
import pytest

from geometry import Centreline


def test_arc_of_a_circle() -> None:
    s = np.linspace(0, 90, 200)
    line = Centreline(s, 50 * np.sin(s / 50), 50 * (1 - np.cos(s / 50)))
    assert line.length == 90
    assert line.stretch == pytest.approx(1, abs=1e-5)
    assert line.angle == pytest.approx((s[1:] + s[:-1]) / 2 / 50, abs=1e-12)


def test_angle_is_continuous_past_half_a_turn() -> None:
    s = np.linspace(0, 10, 60)
    line = Centreline(s, np.sin(s), 1 - np.cos(s))
    assert line.angle[-1] == pytest.approx((s[-1] + s[-2]) / 2)


def test_arrays_are_read_only_copies() -> None:
    s = np.arange(5.0)
    line = Centreline(s, 2 * s, 0 * s)
    s[0] = -7
    assert line.s[0] == 0
    assert line.stretch == 2
    for array in (line.s, line.x, line.y, line.angle, line.chords):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
