"""Load cases: pressures and the load factors that stand for them."""

from pathlib import Path

from pipeline.config.load import load_config
from pipeline.simulate.loadcase import PressureSchedule, identification_case, schedule


def test_load_factors_are_pressures_over_the_largest_of_the_run() -> None:
    of_run = PressureSchedule((5.0, 17.0, 31.0, 45.0), 45.0)
    assert of_run.reference_MPa == 0.045
    assert of_run.factors == (0.005 / 0.045, 0.017 / 0.045, 0.031 / 0.045, 1.0)
    assert f"{of_run.pressure_at(0.4):.4g}" == "18"


def test_a_schedule_may_unload() -> None:
    assert PressureSchedule((37.0, 5.0), 37.0).factors == (1.0, 0.005 / 0.037)


def test_other_pressures_are_scaled_by_the_largest_of_the_run(configs: Path) -> None:
    config = load_config(configs / "pneunet_coarse.yaml")
    assert identification_case(config, "III").schedule == PressureSchedule((17.0, 37.0), 37.0)
    assert schedule(config, (24.0,)) == PressureSchedule((24.0,), 37.0)
