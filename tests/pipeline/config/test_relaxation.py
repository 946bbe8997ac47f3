"""Rubber in time in a configuration: branches of relaxation, and a loss factor between two frequencies."""

from pathlib import Path

from pipeline.config.load import load_config
from pipeline.config.material import Branch, Material

COARSE = "pneunet_coarse.yaml"


def material(configs: Path, *overrides: str) -> Material:
    return load_config(configs / COARSE, overrides).material


def test_branches_and_a_band_are_read_with_their_units(configs: Path) -> None:
    given = material(
        configs,
        "material.relaxation=[{g: 0.08, tau: 900 ms}, {g: 0.02, tau: 2 min}]",
        "material.loss_factor={value: 0.12, from: 1 Hz, to: 10 Hz}",
    )
    assert given.relaxation == (Branch(0.08, 0.9), Branch(0.02, 120.0))
    assert (given.loss_factor, given.loss_between_Hz) == (0.12, (1.0, 10.0))
    record = given.record()
    assert (record["relaxation_g"], record["relaxation_tau_s"]) == ([0.08, 0.02], [0.9, 120.0])
    assert (record["loss_factor"], record["loss_between_Hz"]) == (0.12, [1.0, 10.0])


def test_one_branch_needs_no_list(configs: Path) -> None:
    assert material(configs, "material.relaxation={g: 0.08, tau: 0.9 s}").relaxation == (Branch(0.08, 0.9),)


def test_the_modulus_is_that_at_long_times(configs: Path) -> None:
    plain, slow = material(configs), material(configs, "material.relaxation={g: 0.5, tau: 1 s}")
    assert slow.built().young_modulus == plain.built().young_modulus


def test_a_configuration_without_them_has_the_same_record(configs: Path) -> None:
    assert material(configs).record().keys() == {"law", "E", "nu", "density_tonne_mm3"}
