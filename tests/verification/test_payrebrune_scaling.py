"""Arms of other lengths from one parameterization: de Payrebrune & O'Reilly, equations (9) and (10), Figs 12 and 13."""

import importlib.util
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent.parent.parent


@pytest.fixture(scope="module")
def rows():
    spec = importlib.util.spec_from_file_location("scaling", HERE / "benchmarks" / "scaling.py")
    scaling = importlib.util.module_from_spec(spec)
    sys.modules["scaling"] = scaling
    spec.loader.exec_module(scaling)
    return scaling.table(4.0, (17.0, 24.0, 31.0), 24.0)


@pytest.mark.slow
def test_more_cells_change_neither_curvature_nor_rigidity(rows) -> None:
    same = [row for row in rows if row.origin == row.pressure]
    assert {row.chambers for row in same} == {7, 11, 20}
    for row in same:
        assert row.kappa_0 == pytest.approx(1.0, abs=2e-3)  # measured: 1e-4
        assert row.alpha2 == pytest.approx(1.0, abs=0.05)  # measured: 0.03
        assert row.distance_II < 0.04  # measured: 0.028
        assert row.distance_III < 0.025  # measured: 0.017
        assert abs(row.force) < 0.10  # measured: 0.072


@pytest.mark.slow
def test_kappa_0_is_not_proportional_to_the_pressure(rows) -> None:
    """The part of equation (9) that does not hold: from 24 kPa to others."""
    far = [row for row in rows if row.origin != row.pressure]
    assert far
    assert max(row.distance_II for row in far) > 0.04  # measured: 0.078
    assert max(abs(row.force) for row in far) > 0.08  # measured: 0.16
    assert all(row.distance_III < 0.03 for row in far)  # measured: 0.025
