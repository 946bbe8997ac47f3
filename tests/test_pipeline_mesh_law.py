"""Errors over the indicator and over the size, from numbers whose errors are known because they are made up."""

from typing import Any

import pytest

from pipeline.accuracy.error_model import FASTEST, LEAST, RIGIDITY, SLOWEST, MeshLaw
from pipeline.accuracy.reference import HEADLINE

#: error over the indicator
SHARES = {"kappa_0_per_mm": 0.4, "alpha2_N_mm2": -0.7, "force_N": 0.6}


def mesh(size: float, order: float, std: float = 0.0, **shares: float) -> dict[str, Any]:
    """A mesh whose indicator is 0.08 at 4 mm."""
    indicator = 0.08 * (size / 4.0) ** order
    return {
        "size_mm": size,
        "numbers": {key: 100.0 * (1.0 + share * indicator) for key, share in {**SHARES, **shares}.items()},
        "alpha2_std_N_mm2": std,
        "stress_error": indicator,
    }


@pytest.mark.parametrize("order", [1.0, 1.7, 4.0])
def test_the_order_and_the_largest_error_are_found(order: float) -> None:
    law = MeshLaw.of([mesh(6.0, order), mesh(4.0, order)])
    assert law.order == pytest.approx(order)
    for size in (4.0, 2.0, 1.0):
        own = mesh(size, order)
        expected = 0.7 * own["stress_error"]
        assert law.at(size)[RIGIDITY] == pytest.approx(expected, rel=0.06)  # over the number of the finer pilot
        assert law.with_indicator(own["stress_error"]) == pytest.approx(law.at(size))
        assert law.size_for(law.at(size)[RIGIDITY]) == pytest.approx(size)


@pytest.mark.parametrize(("shown", "taken"), [(0.3, SLOWEST), (6.0, FASTEST)])
def test_orders_that_theory_does_not_know_are_not_believed(shown: float, taken: float) -> None:
    assert MeshLaw.of([mesh(6.0, shown), mesh(4.0, shown)]).order == taken


def test_two_meshes_that_agree_by_chance_are_not_believed() -> None:
    law = MeshLaw.of([mesh(6.0, 1.0, force_N=0.0), mesh(4.0, 1.0, force_N=0.0)])
    assert law.share["force_N"] == pytest.approx(0.4 / 2**0.5, rel=0.06)


def test_a_rigidity_that_no_mesh_makes_surer_says_nothing_of_meshes() -> None:
    jumping = [mesh(6.0, 1.0, std=12.0, alpha2_N_mm2=-0.8), mesh(4.0, 1.0, std=9.0, alpha2_N_mm2=0.5)]
    assert MeshLaw.of(jumping).share[RIGIDITY] == pytest.approx(0.5, rel=0.1)  # mean square of the other two
    sure = [{**one, "alpha2_std_N_mm2": 0.1} for one in jumping]
    assert MeshLaw.of(sure).share[RIGIDITY] > 3.0


def test_the_run_is_a_third_mesh() -> None:
    """Pilots too coarse for the law: the finer mesh puts it right."""
    pilots = [mesh(6.0, 1.0, force_N=2.0), mesh(4.0, 1.0)]
    run = mesh(1.5, 1.0)
    before, after = MeshLaw.of(pilots), MeshLaw.of(pilots, run)
    true = 0.6 * run["stress_error"]
    assert before.at(1.5)["force_N"] > 5.0 * true
    assert true < after.with_indicator(run["stress_error"])["force_N"] < 4.0 * true


def test_three_meshes_show_the_scatter_around_the_line() -> None:
    pilots, run = [mesh(6.0, 1.0), mesh(4.0, 1.0)], mesh(1.5, 1.0)
    jumped = {**run, "numbers": {**run["numbers"], "kappa_0_per_mm": 1.01 * run["numbers"]["kappa_0_per_mm"]}}
    straight, scattered = (MeshLaw.of(pilots, third).share["kappa_0_per_mm"] for third in (run, jumped))
    assert straight == pytest.approx(0.5, rel=0.1)  # root mean square of 0.4 and 0.6
    assert scattered > 0.01 / 0.08  # a jump of a per cent, weighed by the indicators of 0.12 to 0.03


def test_meshes_that_agree_in_all_are_believed_to_have_errors() -> None:
    none = dict.fromkeys(HEADLINE, 0.0)
    law = MeshLaw.of([mesh(6.0, 2.0, **none), mesh(4.0, 2.0, **none)])
    assert law.share == dict.fromkeys(HEADLINE, LEAST)
