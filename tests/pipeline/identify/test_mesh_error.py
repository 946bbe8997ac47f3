"""The mesh error of the five parameters, from a second, coarser mesh."""

import json
import math
import re
from pathlib import Path
from typing import cast

import pytest

from pipeline.config.load import load_config
from pipeline.identify.mesh_error import mesh_deviations, of_single_line, with_mesh_error
from pipeline.identify.parameters import Parameters
from pipeline.results.files import read_results
from pipeline.results.rod_errors import mesh_errors
from pipeline.run import run
from pipeline.store.progress import Silent
from pipeline.values.richardson import extrapolate
from rod import Interval
from tests.solved import alone

SHORT = """
name: seven
geometry: {family: pneunet, chambers: 7}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [8 kPa]
law: five
validation: off
mesh: {size: 8 mm, formulation: p2p0, grading: off, coarser: 1.5}
"""


def test_deviations_are_those_of_the_extrapolation_and_no_less_than_usual() -> None:
    fine = [{"alpha1": 200.0, "d": 6.0}, {"alpha1": 210.0, "d": 6.0}]
    coarse = [{"alpha1": 208.0, "d": 6.5}, {"alpha1": 210.0, "d": 6.0}]
    first, second = mesh_deviations(fine, coarse, 4.0, 1.5)
    own = extrapolate((4.0, 6.0), (200.0, 208.0)).error_std
    assert first["alpha1"] == pytest.approx(own)
    # the meshes agree by chance
    assert second["alpha1"] / 210.0 == pytest.approx(own / 200.0 / math.sqrt(2.0))
    assert second["d"] == pytest.approx(first["d"] / math.sqrt(2.0))
    assert own > 8.0 / 1.5


def test_a_pressure_that_the_coarser_mesh_did_not_reach_gets_the_usual() -> None:
    fine = [{"alpha1": 200.0}, {"alpha1": 210.0}]
    first, second = mesh_deviations(fine, [{"alpha1": 208.0}, None], 4.0, 1.5)
    assert second["alpha1"] / 210.0 == pytest.approx(first["alpha1"] / 200.0)
    assert mesh_deviations(fine, [None, None], 4.0, 1.5) == ({}, {})


def test_the_difference_from_other_elements_is_the_least_error_at_every_pressure() -> None:
    fine = [{"alpha1": 200.0, "d": 6.0}, {"alpha1": 300.0, "d": 7.0}]
    coarse = [{"alpha1": 208.0, "d": 6.05}, None]
    known = mesh_deviations(fine, coarse, 4.0, 1.5)
    others = {"alpha1": 0.05, "d": 0.5}  # the first over the value, the second in mm
    first, second = mesh_deviations(fine, coarse, 4.0, 1.5, others)
    assert first == pytest.approx({"alpha1": known[0]["alpha1"], "d": 0.5})
    assert second == pytest.approx({"alpha1": known[1]["alpha1"], "d": 0.5})
    assert mesh_deviations(fine, coarse, 4.0, 1.5, {"alpha1": 0.5})[1]["alpha1"] == pytest.approx(150.0)


def test_both_pieces_of_a_single_line_have_one_error() -> None:
    stds = {"alpha1": 33.0, "alpha2": 16.0, "m01": 0.5, "m02": 0.03, "d": 0.7}
    assert of_single_line(stds) == {"alpha1": 16.0, "alpha2": 16.0, "m01": 0.03, "m02": 0.03, "d": 0.7}
    assert of_single_line({}) == {}


def test_a_further_error_widens_an_interval_to_both_sides() -> None:
    wide = Interval(10.0, 3.0, 4.0, 18.0).widened(4.0)
    assert (wide.value, wide.std) == (10.0, pytest.approx(5.0))
    assert wide.low == pytest.approx(10.0 - math.hypot(6.0, 1.96 * 4.0))
    assert wide.high == pytest.approx(10.0 + math.hypot(8.0, 1.96 * 4.0))
    assert Interval(10.0, 3.0, 4.0, 18.0).widened(0.0) == Interval(10.0, 3.0, 4.0, 18.0)


@pytest.mark.usefixtures("undrawn")
def test_the_files_of_a_run_say_what_the_mesh_contributes(tmp_path: Path) -> None:
    path = tmp_path / "seven.yaml"
    path.write_text(SHORT, encoding="utf-8")
    run(load_config(path), tmp_path / "out", 1, False, Silent())
    record = json.loads((tmp_path / "out" / "parameters.json").read_text(encoding="utf-8"))
    contribution = record["mesh_error"]
    assert contribution["sizes_mm"] == [8.0, 12.0]
    assert contribution["mixed_at_kPa"] == 8.0
    for key in ("alpha1_N_mm2_std", "alpha2_N_mm2_std", "m02_N_mm_std"):
        assert all(0.0 < of_mesh <= whole for of_mesh, whole in zip(contribution[key], record[key], strict=True)), key
    errors = mesh_errors(read_results(tmp_path / "out"), "five")
    assert errors.kappa_0 == max(contribution["kappa_0_relative"])
    assert all(error > 0.0 for name in ("alpha2", "force") for error in contribution[f"{name}_relative"])
    (evidence,), (is_single,) = record["evidence_of_choice"], record["single_line_suffices"]
    assert (evidence <= 0.0) == is_single
    for name in ("alpha", "m0"):
        first, second = (record[key] for key in record if re.fullmatch(rf"{name}[12]_N_mm2?_std", key))
        assert (first == second) == is_single
    assert record["evidence_for_two_lines"] == [evidence]  # a single pressure
    assert all(isinstance(two_lines, bool) for two_lines in record["two_lines_on_coarser_mesh"])


def test_a_second_mesh_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    path = tmp_path / "seven.yaml"
    path.write_text(SHORT.replace("coarser: 1.5", "coarser: 5"), encoding="utf-8")
    config, parameters = load_config(path), (cast(Parameters, object()),)
    with alone(tmp_path / "out", config) as context:
        same, (reason,) = with_mesh_error(config, context, parameters)
    assert same == parameters
    assert (reason.code, reason.values["factor"]) == ("coarser_not_meshed", 5.0)
