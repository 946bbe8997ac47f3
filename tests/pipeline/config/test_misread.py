"""Values of a configuration or a sweep that could be read as something else than their user means."""

from pathlib import Path

import pytest

from pipeline.answers.rods.solid import young_modulus
from pipeline.config.load import load_config
from pipeline.study.sweep.spec import read_sweep
from pipeline.values.errors import InputError
from rod import RodError

HERE = Path(__file__).parent.parent.parent
COARSE = HERE.parent / "configs" / "pneunet_coarse.yaml"


def refused(*overrides: str) -> str:
    with pytest.raises(InputError) as caught:
        load_config(COARSE, overrides)
    return str(caught.value)


@pytest.mark.parametrize("written", ["010", "011", "1:30", "0x10", "1_1", "0b11"])
def test_whole_numbers_of_yaml_1_1_are_refused(written: str) -> None:
    """They would be 8, 9, 90, 16, 11 and 3."""
    assert "geometry.chambers: " in (sentence := refused(f"geometry.chambers={written}"))
    assert "is not a whole number" in sentence
    assert load_config(COARSE, ["geometry.chambers=9"]).design.repeats


def test_numbers_that_no_float_holds_are_refused() -> None:
    huge = "9" * 400
    assert "is too large" in refused(f"material.nu={huge}")
    assert "is too large" in refused(f"effects.pressure={{cavities: {{cavity: {huge}}}}}")


@pytest.mark.parametrize("written", ["1.001", "8", ".inf", "-1.5"])
def test_a_second_mesh_that_shows_no_convergence_is_refused(written: str) -> None:
    assert "is not allowed; allowed: 1.1 to 5" in refused(f"mesh.coarser={written}")


@pytest.mark.parametrize(
    ("key", "answer"),
    [
        ("fibre", "write effects: {hoops: {threads: {EA: 40 N, pitch: 2 mm}}}; a sheet is"),
        ("dynamics", "the arm moves by pneurod move"),
        ("creep", "write material: {relaxation: "),
        ("friction", "slide without friction"),
        ("tip_load", "write end: {y: -0.1 N}"),
        ("gravity", "write effects: {gravity: hanging}"),
        ("volume_control", "fem.follow_volume"),
        ("rest_curvature", "arms are straight at rest"),
        ("absolute_pressure", "differences to the air outside"),
    ],
)
def test_what_is_not_there_is_said_where_it_is_looked_for(key: str, answer: str) -> None:
    assert f"{key}: unknown key; " in (sentence := refused(f"{key}=1"))
    assert answer in sentence
    written = {"tip_load": ["end.y=-0.1 N"], "gravity": ["effects.gravity=hanging"]}
    assert load_config(COARSE, written.get(key, [])).name


def test_parameters_of_an_effect_go_beside_its_state() -> None:
    """The file has `self_contact: auto`."""
    effect = load_config(COARSE, ["effects.self_contact.dhat=0.1 mm"]).effects.self_contact
    assert (effect.state, effect.dhat_mm) == ("auto", 0.1)
    assert load_config(
        COARSE, ["effects.self_contact=off", "effects.self_contact.dhat=0.1 mm"]
    ).effects.self_contact.off


def test_the_override_is_named_and_not_the_file() -> None:
    assert refused("material.E=1.2 Pa").startswith("--set material.E: 37 kPa is")


@pytest.mark.parametrize(
    "axes",
    [
        "[{mesh.size: [4 mm, 5 mm]}, {mesh: [{size: 6 mm}, {size: 7 mm}]}]",
        "[{mesh: [{size: 6 mm}, {size: 7 mm}]}, {mesh.size: [4 mm, 5 mm]}]",
    ],
)
def test_an_axis_within_another_one_is_refused(axes: str, tmp_path: Path) -> None:
    """The table would have the sizes of one, and the points those of the other."""
    sweep = tmp_path / "sweep.yaml"
    sweep.write_text(f"name: s\nbase: {COARSE}\naxes: {axes}\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"axes: mesh and mesh.size are both given, and the first replaces the second"):
        read_sweep(sweep)


def test_the_modulus_of_an_exported_rod_is_that_of_its_law() -> None:
    material = {"law": "neo_hooke", "mu": 0.02, "kappa": 2.0, "density_tonne_mm3": 1e-9}
    assert young_modulus(material) == pytest.approx(9 * 2.0 * 0.02 / (3 * 2.0 + 0.02))
    with pytest.raises(RodError, match="The material of the file is not a law with its constants"):
        young_modulus({"law": "steel"})
