"""The error model recovers the order and the ratios of error to indicator of made-up meshes with known errors."""

from dataclasses import replace

import pytest

from pipeline.accuracy.error_model import FASTEST, MIN_RATIO, SLOWEST, MeshErrorModel, Pilot
from pipeline.accuracy.measure import HEADLINE, RIGIDITY, RodNumbers

#: error over the indicator
RATIOS = {"kappa_0_per_mm": 0.4, "alpha2_N_mm2": -0.7, "force_N": 0.6}


def mesh(size: float, order: float, std: float = 0.0, **ratios: float) -> Pilot:
    """A mesh whose indicator is 0.08 at 4 mm."""
    indicator = 0.08 * (size / 4.0) ** order
    numbers = {name: 100.0 * (1.0 + ratio * indicator) for name, ratio in {**RATIOS, **ratios}.items()}
    rod = RodNumbers(
        pressure_kPa=17.0, alpha1_N_mm2=50.0, d_mm=10.0, end_mm=(100.0, -60.0),
        alpha2_std_N_mm2=std, stress_error=indicator, **numbers,
    )  # fmt: skip
    return Pilot(size, 30_000, 5.0, rod)


@pytest.mark.parametrize("order", [1.0, 1.7, 4.0])
def test_order_and_largest_error(order: float) -> None:
    model = MeshErrorModel.fit(mesh(6.0, order), mesh(4.0, order))
    assert model.order == pytest.approx(order)
    for size in (4.0, 2.0, 1.0):
        own = mesh(size, order)
        expected = 0.7 * own.numbers.stress_error
        assert model.at(size)[RIGIDITY] == pytest.approx(expected, rel=0.06)  # over the number of the finer pilot
        assert model.with_indicator(own.numbers.stress_error) == pytest.approx(model.at(size))
        assert model.size_for(model.at(size)[RIGIDITY]) == pytest.approx(size)


@pytest.mark.parametrize(("shown", "bounded"), [(0.3, SLOWEST), (6.0, FASTEST)])
def test_the_order_is_bounded_by_theory(shown: float, bounded: float) -> None:
    assert MeshErrorModel.fit(mesh(6.0, shown), mesh(4.0, shown)).order == bounded


def test_two_meshes_that_agree_by_chance_get_the_mean_ratio() -> None:
    model = MeshErrorModel.fit(mesh(6.0, 1.0, force_N=0.0), mesh(4.0, 1.0, force_N=0.0))
    assert model.ratios["force_N"] == pytest.approx(0.4 / 2**0.5, rel=0.06)


def test_an_uncertain_rigidity_gets_the_mean_ratio() -> None:
    jumping = [mesh(6.0, 1.0, std=12.0, alpha2_N_mm2=-0.8), mesh(4.0, 1.0, std=9.0, alpha2_N_mm2=0.5)]
    assert MeshErrorModel.fit(*jumping).ratios[RIGIDITY] == pytest.approx(0.5, rel=0.1)  # mean square of the other two
    certain = [replace(pilot, numbers=replace(pilot.numbers, alpha2_std_N_mm2=0.1)) for pilot in jumping]
    assert MeshErrorModel.fit(*certain).ratios[RIGIDITY] > 3.0


def test_the_rigidity_of_a_single_line_is_no_second_one_of_two_lines() -> None:
    """The coarse pilot of `pneunet` at 17 kPa has 262 N mm2 of a single line, the fine one 301 of two."""
    pilots = [mesh(6.0, 1.0, alpha2_N_mm2=-2.0), mesh(4.0, 1.0)]
    assert MeshErrorModel.fit(*pilots).ratios[RIGIDITY] > 2.0
    single = replace(pilots[0], numbers=replace(pilots[0].numbers, d_mm=None))
    usual = MeshErrorModel.fit(single, pilots[1]).ratios[RIGIDITY]
    assert usual == pytest.approx(0.5, rel=0.06)  # root mean square of the other two
    with_run = MeshErrorModel.fit(single, pilots[1], mesh(1.5, 1.0).numbers)
    assert with_run.ratios[RIGIDITY] == pytest.approx(0.7, rel=0.06)  # of the two meshes with two lines


def test_the_run_is_a_third_mesh() -> None:
    """Pilots too coarse for the model: the finer mesh of the run corrects it."""
    pilots = [mesh(6.0, 1.0, force_N=2.0), mesh(4.0, 1.0)]
    run = mesh(1.5, 1.0).numbers
    before, after = MeshErrorModel.fit(*pilots), MeshErrorModel.fit(*pilots, run)
    true = 0.6 * run.stress_error
    assert before.at(1.5)["force_N"] > 5.0 * true
    assert true < after.with_indicator(run.stress_error)["force_N"] < 4.0 * true


def test_three_meshes_show_the_scatter_around_the_line() -> None:
    pilots, run = [mesh(6.0, 1.0), mesh(4.0, 1.0)], mesh(1.5, 1.0).numbers
    jumped = replace(run, kappa_0_per_mm=1.01 * run.kappa_0_per_mm)
    straight, scattered = (MeshErrorModel.fit(*pilots, third).ratios["kappa_0_per_mm"] for third in (run, jumped))
    assert straight == pytest.approx(0.5, rel=0.1)  # root mean square of 0.4 and 0.6
    assert scattered > 0.01 / 0.08  # a jump of a per cent, weighed by the indicators of 0.12 to 0.03


def test_meshes_that_agree_in_everything_get_the_smallest_ratio() -> None:
    none = dict.fromkeys(HEADLINE, 0.0)
    model = MeshErrorModel.fit(mesh(6.0, 2.0, **none), mesh(4.0, 2.0, **none))
    assert model.ratios == dict.fromkeys(HEADLINE, MIN_RATIO)
