"""Rubbers by name, constants as other programs write them, and rubber in time: branches and a loss factor."""

from pathlib import Path

import numpy as np
import pytest

import pneurod
from pipeline.answers.material.laws import STATES, is_stable, stretches
from pipeline.config.load import load_config
from pipeline.config.material import Branch, Material
from pipeline.config.rubbers import RUBBERS
from pipeline.simulate.design_notes import check_load
from pipeline.values.errors import InputError
from pipeline.values.reasons import TEMPLATES

TERMS = "mu: [0.001887 MPa, 0.02225 MPa, 0.003574 MPa], alpha: [-3.848, 0.663, 4.225], nu: 0.48"


def material(configs: Path, written: str) -> Material:
    return load_config(configs / "pneunet_coarse.yaml", [f"material={{{written}}}", "pressures=[1 kPa]"]).material


def refused(configs: Path, written: str) -> str:
    with pytest.raises(InputError) as caught:
        material(configs, written)
    return str(caught.value)


@pytest.mark.parametrize("name", RUBBERS)
def test_a_rubber_by_name_is_stable_where_it_holds(name: str, configs: Path) -> None:
    rubber = material(configs, f"name: {name}")
    law = rubber.built()
    low, high = rubber.holds_between or (0.5, 2.0)
    for state in STATES:
        assert is_stable(law, state, stretches(low if state == "uniaxial" else 1.0, high)).all()
    assert rubber.name == name
    assert 1e12 * (rubber.density_tonne_mm3 or 0.0) == pytest.approx(1100, abs=100)
    assert 0.04 < law.young_modulus < 0.7
    assert law.poisson_ratio == pytest.approx(0.495)


def test_a_name_is_kept_with_what_stands_beside_it(configs: Path) -> None:
    rubber = material(configs, "name: dragon_skin_30, nu: 0.49, density: 1100 kg/m^3")
    assert rubber.record()["name"] == "dragon_skin_30"
    assert rubber.built().poisson_ratio == pytest.approx(0.49)
    assert rubber.density_tonne_mm3 == pytest.approx(1.1e-9)
    assert "name" not in material(configs, "law: neo_hooke, mu: 0.1 MPa").record()
    assert pneurod.NamedRubber("dragon_skin_30").values == {"name": "dragon_skin_30"}
    assert repr(pneurod.NamedRubber("mold_star_16", nu=0.49)) == "NamedRubber(name='mold_star_16', nu=0.49)"


def test_a_run_says_that_another_batch_differs(configs: Path) -> None:
    named = load_config(configs / "pneunet_coarse.yaml", ["material={name: dragon_skin_30}", "pressures=[5 kPa]"])
    [reason] = [reason for reason in check_load(named) if reason.code == "named_rubber"]
    assert reason.values["names"] == ["dragon_skin_30"]
    assert "named_rubber" in TEMPLATES
    plain = load_config(configs / "pneunet_coarse.yaml")
    assert not [reason for reason in check_load(plain) if reason.code == "named_rubber"]


def test_terms_of_abaqus_are_asked_about_and_read(configs: Path) -> None:
    sentence = refused(configs, f"law: ogden, {TERMS}")
    assert "form: abaqus if the energy has 2 mu / alpha^2 (shear modulus 0.02771 MPa)" in sentence
    assert "form: ogden if it has mu / alpha as here (0.0113 MPa)" in sentence
    for form, modulus in (("abaqus", 0.02771), ("ogden", 0.0113)):
        law = material(configs, f"law: ogden, form: {form}, {TERMS}").built()
        assert law.shear_modulus == pytest.approx(modulus, rel=1e-2)
    assert material(configs, "law: ogden, mu: [0.2 MPa, -0.05 MPa], alpha: [3, -2]").built().shear_modulus > 0
    two = material(configs, "law: ogden, form: abaqus, mu: [0.1 MPa], alpha: [2]").built()
    one, s = material(configs, "law: neo_hooke, mu: 0.1 MPa").built(), np.array([1.5])
    np.testing.assert_allclose(two.uniaxial(s).nominal, one.uniaxial(s).nominal)


def test_one_term_of_febio(configs: Path) -> None:
    """c / m^2 before the powers: E at rest is 3 c / 2, a sixth of which the same numbers have as mu / alpha."""
    for form, modulus in (("ogden", 0.66), ("ansys", 0.66), ("abaqus", 0.24), ("febio", 0.12)):
        law = material(configs, f"law: ogden, form: {form}, mu: [80 kPa], alpha: [5.5], nu: 0.4999").built()
        assert law.young_modulus == pytest.approx(modulus, rel=1e-3), form


def test_branches_of_abaqus_are_parts_of_the_modulus_at_once(configs: Path) -> None:
    branches = "relaxation: [{g: 0.4, tau: 1 s}, {g: 0.35, tau: 10 s}]"
    for form, kept in (("", 57.1), ("form: febio, ", 57.1), ("form: abaqus, ", 25.0), ("form: ansys, ", 25.0)):
        rubber = material(configs, f"law: neo_hooke, {form}mu: 0.1 MPa, {branches}")
        assert f"a held stretch keeps {kept:.3g} % of its stress" in rubber.told
        assert [branch.tau_s for branch in rubber.relaxation] == [1.0, 10.0]
    assert [branch.g for branch in rubber.relaxation] == pytest.approx([1.6, 1.4])
    named = material(configs, f"name: ecoflex_00_30, form: abaqus, {branches}")
    assert named.relaxation == rubber.relaxation
    assert "held" not in material(configs, "law: neo_hooke, mu: 0.1 MPa").told


COARSE = "pneunet_coarse.yaml"


def material_of(configs: Path, *overrides: str) -> Material:
    return load_config(configs / COARSE, overrides).material


def test_branches_and_a_band_are_read_with_their_units(configs: Path) -> None:
    given = material_of(
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
    assert material_of(configs, "material.relaxation={g: 0.08, tau: 0.9 s}").relaxation == (Branch(0.08, 0.9),)


def test_the_modulus_is_that_at_long_times(configs: Path) -> None:
    plain, slow = material_of(configs), material_of(configs, "material.relaxation={g: 0.5, tau: 1 s}")
    assert slow.built().young_modulus == plain.built().young_modulus


def test_a_configuration_without_them_has_the_same_record(configs: Path) -> None:
    assert material_of(configs).record().keys() == {"law", "E", "nu", "density_tonne_mm3"}


def test_the_moduli_of_rubbers_by_name_are_in_the_order_of_their_hardness(configs: Path) -> None:
    """Ecoflex 00-30 and 00-50, Dragon Skin 10 A, Mold Star 16 A, Dragon Skin 20 A and 30 A."""
    names = ("ecoflex_00_30", "ecoflex_00_50", "dragon_skin_10", "mold_star_16", "dragon_skin_20", "dragon_skin_30")
    moduli = [material(configs, f"name: {name}").built().young_modulus for name in names]
    assert moduli == sorted(moduli)
