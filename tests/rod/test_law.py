"""The five-parameter law: paper, equations (4) and (8)."""

import dataclasses

import numpy as np
import pytest

from rod import FiveParameters

LAW = FiveParameters(alpha1=55.0, alpha2=400.0, m01=5.0, m02=-0.3, d=14.0)


def test_two_lines_meet_at_d_and_d_belongs_to_the_second():
    s = np.array([0.0, 13.999, 14.0, 100.0])
    assert LAW.rigidity(s).tolist() == [55.0, 55.0, 400.0, 400.0]
    assert LAW.moment(s, 0.01) == pytest.approx([5.55, 5.55, 3.7, 3.7])


def test_deviation_is_the_inverse_of_moment():
    s = np.linspace(0.0, 112.0, 50)
    moment = np.linspace(7.0, 0.0, 50)
    assert LAW.moment(s, LAW.deviation(s, moment)) == pytest.approx(moment, abs=1e-12)


def test_rest_curvature_carries_the_intercepts():
    s, kappa, kappa_0 = np.linspace(0.0, 112.0, 50), np.linspace(-0.01, 0.04, 50), 0.03
    expected = LAW.moment(s, kappa - kappa_0)
    assert LAW.rigidity(s) * (kappa - LAW.kappa_rest(s, kappa_0)) == pytest.approx(expected, abs=1e-12)


def test_the_law_is_a_frozen_value():
    with pytest.raises(dataclasses.FrozenInstanceError):
        LAW.alpha1 = 1.0  # type: ignore[misc]
    assert FiveParameters(55, 400, 5, -0.3, 14) == LAW
