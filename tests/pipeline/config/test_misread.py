"""Values of a configuration or a sweep that could be read as something else than their user means."""

from pathlib import Path

import pytest

from pipeline.answers.rods.solid import young_modulus
from pipeline.config.load import load_config

HERE = Path(__file__).parent.parent.parent
COARSE = HERE.parent / "configs" / "pneunet_coarse.yaml"


def test_what_is_written_in_place_of_unknown_keys_is_accepted() -> None:
    for setting in ("end.y=-0.1 N", "effects.gravity=hanging"):
        assert load_config(COARSE, [setting]).name


def test_parameters_of_an_effect_go_beside_its_state() -> None:
    """The file has `self_contact: auto`."""
    effect = load_config(COARSE, ["effects.self_contact.dhat=0.1 mm"]).effects.self_contact
    assert (effect.state, effect.dhat_mm) == ("auto", 0.1)
    assert load_config(
        COARSE, ["effects.self_contact=off", "effects.self_contact.dhat=0.1 mm"]
    ).effects.self_contact.off


def test_the_modulus_of_an_exported_rod_is_that_of_its_law() -> None:
    material = {"law": "neo_hooke", "mu": 0.02, "kappa": 2.0, "density_tonne_mm3": 1e-9}
    assert young_modulus(material) == pytest.approx(9 * 2.0 * 0.02 / (3 * 2.0 + 0.02))
