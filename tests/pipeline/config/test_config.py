"""A configuration is read with its units, and errors are refused in one sentence with file and key."""

import dataclasses
import json
import pickle
import shutil
from pathlib import Path

import pytest

import fem
from fem.materials import LAWS, Constant
from geometry import FAMILIES, PneuNet
from pipeline.config.config import Config, End, IdentificationSettings, Validation
from pipeline.config.effects import EFFECTS
from pipeline.config.load import load_config
from pipeline.config.units import DENSITY, LENGTH, PRESSURE, STRESS, Dimension, convert
from pipeline.law.piece.pieces import ArmPieces, NoArmLaw
from pipeline.simulate.design_notes import check_design
from pipeline.simulate.scene import material_of
from pipeline.values.errors import InputError


def refusal(path: Path, *overrides: str) -> str:
    with pytest.raises(InputError) as refused:
        load_config(path, overrides)
    sentences = refused.value.sentences
    assert str(refused.value).split("\n") == list(sentences)
    assert "pydantic" not in str(refused.value)
    assert all(sentence.startswith((f"{path}: ", "--set ")) for sentence in sentences)
    return sentences[0]


def written_to(folder: Path) -> Path:
    """A copy of the coarse configuration that a test may spoil."""
    return Path(shutil.copy("configs/pneunet_coarse.yaml", folder / "arm.yaml"))


@pytest.fixture
def written(tmp_path: Path) -> Path:
    return written_to(tmp_path)


def spoil(path: Path, old: str, new: str) -> Path:
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), encoding="utf-8")
    return path


def test_values_arrive_in_mm_N_MPa(configs: Path) -> None:
    config = load_config(configs / "pneunet.yaml")
    assert config.design == PneuNet()
    assert config.design.length == 112.0
    assert config.material.built() == fem.StVenantKirchhoff(1.2, 0.495)
    assert config.material.constants == {"E": 1.2, "nu": 0.495}
    assert config.material.density_tonne_mm3 == 1.13e-9
    assert config.pressures_kPa == (5.0, 17.0, 31.0, 45.0)
    assert config.end.y_mm == 0.0
    assert config.mesh.formulation == "p2p0"
    assert {name: getattr(config.effects, name).state for name in EFFECTS} == dict.fromkeys(EFFECTS, "auto")


def test_the_record_has_the_keys_of_the_yaml_with_their_units(configs: Path) -> None:
    record = load_config(configs / "pneunet_coarse.yaml", ["effects.self_contact={dhat: 0.1 mm}"]).record()
    keys = ["name", "geometry", "material", "pressures_kPa", "experiments", "end", "identification"]
    assert list(record) == [*keys, "validation", "law", "newton", "accuracy", "effects", "mesh"]
    assert record["end"] == {"x_mm": None, "y_mm": 0.0, "force_N": [0.0, 0.0]}
    assert record["mesh"] == {"size_mm": 4.0, "formulation": "p2p0", "coarser": None, "grading": "off"}
    effects = record["effects"]
    assert list(effects) == list(EFFECTS)
    assert effects["self_contact"] == {"state": "on", "dhat_mm": 0.1, "faces": None}
    assert effects["gravity"] == {"state": "auto", "acceleration_mm_s2": [0.0, -9810.0, 0.0]}
    assert effects["pressure"] == {"state": "auto", "cavities": {"cavity": {"fraction": 1.0, "constant_kPa": 0.0}}}


def test_experiment_one_may_be_left_out_and_the_others_may_not(written: Path) -> None:
    assert load_config(written).experiments == ("I", "II", "III")
    assert load_config(written, ["experiments=[III, II]"]).experiments == ("II", "III")
    assert load_config(written, ["experiments=[III, II]"]).hash == load_config(written, ["experiments=[II, III]"]).hash


def test_an_accuracy_is_one_percent_unless_it_is_given_or_switched_off(written: Path) -> None:
    assert load_config(written).accuracy == 0.01
    assert load_config(written, ["accuracy=2 %"]).accuracy == 0.02
    assert load_config(written, ["accuracy=off"]).accuracy is None


def test_a_configuration_travels_to_other_processes(configs: Path) -> None:
    config = load_config(configs / "pneunet.yaml")
    assert pickle.loads(pickle.dumps(config)) == config
    assert json.loads(json.dumps(config.record())) == config.record()
    with pytest.raises(dataclasses.FrozenInstanceError):
        config.name = "other"  # type: ignore[misc]


def test_the_hash_knows_values_not_spellings(configs: Path) -> None:
    def hashed(*overrides: str) -> str:
        return load_config(configs / "pneunet_coarse.yaml", overrides).hash

    assert hashed("material.E=1200 kPa", "pressures=[0.017 MPa, 0.37 bar]", "end.y=0 m") == hashed()
    different = {hashed(), hashed("mesh.size=3 mm"), hashed("pressures=[17 kPa]"), hashed("effects.symmetry=off")}
    assert len(different) == 4


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_every_family_reads_its_own_keys(written: Path, family: str) -> None:
    keys = [field.name for field in dataclasses.fields(FAMILIES[family])]
    geometry = f"geometry={{family: {family}}}"
    config = load_config(written, [geometry])
    assert config.design == FAMILIES[family]()
    assert refusal(written, geometry, "geometry.wings=2").endswith(f"allowed here: family, {', '.join(keys)}")


def test_what_is_left_out_has_a_default(written: Path) -> None:
    text = "name: short\ngeometry: {family: pneunet}\nmesh: {size: 4 mm}\n"
    written.write_text(text + "material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}\n", encoding="utf-8")
    config = load_config(written)
    assert config.pressures_kPa == (5.0, 17.0, 31.0, 45.0)
    assert {name: getattr(config.effects, name).state for name in EFFECTS} == dict.fromkeys(EFFECTS, "auto")


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("name: " + "[" * 5000, "is nested too deeply"),
        ("name: " + "9" * 5000, "has an invalid value"),
        ("\x00", "write 'key: value' lines"),
    ],
)
def test_a_text_that_cannot_be_quoted_is_refused(written: Path, text: str, complaint: str) -> None:
    written.write_text(text, encoding="utf-8")
    assert complaint in refusal(written)


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    assert "no such file" in refusal(tmp_path / "none.yaml")
    assert "cannot be read" in refusal(tmp_path)
    binary = tmp_path / "binary.yaml"
    binary.write_bytes(b"\xff\xfe\x80")
    assert "not a text in UTF-8" in refusal(binary)


def test_a_sentence_stays_short_whatever_it_quotes(written: Path) -> None:
    laughter = "[&a0 [x]" + "".join(f", &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 30)) + "]"
    for value in (laughter, "'" + "x\\n" * 1000 + "'", "0x" + "f" * 5000, "{" + "k" * 900 + ": 1}"):
        assert len(refusal(written, f"mesh.size={value}")) < 400


def refusals(path: Path, *overrides: str) -> list[str]:
    with pytest.raises(InputError) as refused:
        load_config(path, overrides)
    return [sentence.removeprefix(f"{path}: ") for sentence in refused.value.sentences]


def test_all_mistakes_of_the_keys_are_named_at_once(written: Path) -> None:
    for old, new in [("nu: 0.495", "nu: 0.7"), ("size: 4 mm", "sise: 4 mm"), ("family: pneunet", "family: pneunett")]:
        spoil(written, old, new)
    named = refusals(written, "colour=red")
    assert [sentence.partition(": ")[0] for sentence in named] == [
        *("--set colour", "geometry.family", "material.nu", "mesh.sise")
    ]
    assert "did you mean 'pneunet'?" in named[1]
    assert "did you mean 'size'?" in named[3]
    assert not any("mesh.size: is missing" in sentence for sentence in named)


def test_all_mistakes_of_the_geometry_are_named_at_once(written: Path) -> None:
    spoil(spoil(written, "wall: 1 mm  ", "wall: 5 mm  "), "strip: 3 mm", "strip: -3 mm")
    named = refusals(written, "geometry.roof=20 mm", "geometry.side_wall=8 mm", "mesh.size=1 km")
    assert [sentence.partition(": ")[0] for sentence in named] == [
        *("geometry.strip", "geometry.wall", "--set geometry.side_wall", "--set geometry.roof")
    ]
    assert "wall 5 mm must be less than half of chamber_length, 4 mm: the two walls leave no cavity" in named[1]


def test_all_mistakes_between_keys_are_named_at_once(written: Path) -> None:
    spoil(spoil(written, "wall: 1 mm  ", "wall: 5 mm  "), "[17 kPa, 37 kPa]", "[17 kPa, 37 MPa]")
    named = refusals(written, "mesh.formulation=p2", "effects.incompressibility=on")
    assert len(named) == 3
    assert named[0].startswith("geometry.wall: ")
    assert "contradict each other" in named[1]
    assert named[2].startswith("pressures: 37000 kPa is 30.8 E")


def test_a_rubber_law_takes_nu_instead_of_kappa(configs: Path) -> None:
    coarse = configs / "pneunet_coarse.yaml"
    for constants in (
        "neo_hooke, mu: 0.4 MPa",
        "mooney_rivlin, c10: 0.15 MPa, c01: 0.05 MPa",
        "yeoh, c10: 0.2 MPa, c20: 0 MPa, c30: 0 MPa",
        "ogden, mu: [0.4 MPa], alpha: [2]",
        "ogden, mu: 0.4 MPa, alpha: 2",
    ):
        config = load_config(coarse, [f"material={{law: {constants}, nu: 0.49}}"])
        assert config.material.built().poisson_ratio == pytest.approx(0.49, rel=1e-12)
        assert config.material.constants["kappa"] == pytest.approx(2 * 0.4 * 1.49 / (3 * 0.02))
        neither = load_config(coarse, [f"material={{law: {constants}}}"])
        assert neither.material.built().poisson_ratio == pytest.approx(0.495, rel=1e-12)


@pytest.mark.parametrize(
    ("value", "state"), [("on", "on"), ("off", "off"), ("yes", "on"), ("no", "off"), ("auto", "auto"), ("'on'", "on")]
)
def test_switches_survive_the_booleans_of_yaml(written: Path, value: str, state: str) -> None:
    assert (
        load_config(spoil(written, "self_contact: auto", f"self_contact: {value}")).effects.self_contact.state == state
    )


def test_overrides_replace_values_before_the_check(written: Path) -> None:
    overrides = ["mesh.size=3 mm", "pressures=[17 kPa, 37 kPa, 45 kPa]", "geometry.wall=1.5 mm", "effects.symmetry=off"]
    config = load_config(spoil(written, "size: 4 mm", "size: 4"), overrides)
    assert (config.mesh.size_mm, config.design.wall) == (3.0, 1.5)
    assert config.pressures_kPa == (17.0, 37.0, 45.0)
    assert config.effects.symmetry.off


@pytest.mark.parametrize(
    ("text", "dimension", "number"),
    [
        ("112 mm", LENGTH, 112.0),
        ("11.2cm", LENGTH, 112.0),
        ("0.112 m", LENGTH, 112.0),
        ("1.2e6 N/m^2", STRESS, 1.2),
        ("0.45 bar", PRESSURE, 45.0),
        ("0.017 MPa", PRESSURE, 17.0),
        ("1130 kg/m^3", DENSITY, 1.13e-9),
        ("1.13 g/cm**3", DENSITY, 1.13e-9),
        ("-3 mm", LENGTH, -3.0),
    ],
)
def test_units_are_converted(text: str, dimension: Dimension, number: float) -> None:
    assert convert(text, dimension) == number


@pytest.mark.parametrize("name", LAWS)
def test_a_configuration_takes_every_law_with_its_constants(configs: Path, name: str) -> None:
    kinds, usual = LAWS[name].constants(), {Constant.POISSON_RATIO: 0.3}
    values: dict[str, float | tuple[float, ...]] = {name: usual.get(kind, 0.5) for name, kind in kinds.items()}
    texts = [f"{constant}: {value}{kinds[constant].unit}" for constant, value in values.items()]
    for constant, kind in kinds.items():
        if kind in (Constant.STRESSES, Constant.EXPONENTS):
            values[constant] = (0.5,)
    material = f"material={{law: {name}, density: 1130 kg/m^3, {', '.join(texts)}}}"
    config = load_config(configs / "pneunet_coarse.yaml", [material])
    assert config.material.built() == LAWS[name](**values)


def test_the_terms_of_ogden_are_lists(configs: Path) -> None:
    coarse = configs / "pneunet_coarse.yaml"
    terms = "mu: [630 kPa, 0.0012 MPa, -0.01 MPa], alpha: [1.3, 5, -2]"
    config = load_config(coarse, [f"material={{law: ogden, {terms}, nu: 0.495}}"])
    assert config.material.built() == fem.Ogden(
        (0.63, 0.0012, -0.01), (1.3, 5.0, -2.0), config.material.constants["kappa"]
    )
    assert config.record()["material"]["mu"] == [0.63, 0.0012, -0.01]
    assert config.material.built().poisson_ratio == pytest.approx(0.495)


def test_chambers_that_are_not_equal(configs: Path) -> None:
    coarse = configs / "pneunet_coarse.yaml"
    chambers, heights = "geometry.chambers=3", "geometry.chamber_heights=[12 mm, 1.1 cm, 8 mm]"
    config = load_config(coarse, [chambers, heights])
    assert config.design == PneuNet(chambers=3, chamber_heights=(12.0, 11.0, 8.0))
    assert config.record()["geometry"]["chamber_heights"] == [12.0, 11.0, 8.0]
    assert not {"chamber_heights", "chamber_lengths", "gaps"} & set(load_config(coarse).record()["geometry"])
    with pytest.raises(NoArmLaw, match="repeats no cell"):
        ArmPieces(config, None)
    longer = load_config(coarse, ["geometry.chambers=7", f"geometry.gaps=[{', '.join(['2 mm'] * 7)}, 3 mm]"])
    assert any(reason.code == "unequal_cells" for reason in check_design(longer))
    for equal_or_too_short in (config, load_config(coarse)):
        assert not any(reason.code == "unequal_cells" for reason in check_design(equal_or_too_short))


def test_a_dimension_beside_the_list_that_replaces_it_is_refused(configs: Path, tmp_path: Path) -> None:
    """The dimension was ignored, also where an override of the command line gave it."""
    heights, three = "geometry.chamber_heights=[12 mm, 11 mm, 8 mm]", "geometry.chambers=3"
    coarse, both = configs / "pneunet_coarse.yaml", tmp_path / "both.yaml"
    text = coarse.read_text(encoding="utf-8")
    both.write_text(text.replace("geometry:\n", "geometry:\n  gaps: [2 mm, 2 mm, 2 mm, 2 mm]\n"), encoding="utf-8")
    assert "gap:" in text
    wrong = "exclude each other; give one of them"
    assert refusal(both, three) == f"{both}: geometry.gap: gap and gaps {wrong}"
    assert refusal(coarse, three, heights, "geometry.chamber_height=9 mm") == (
        f"--set geometry.chamber_height: chamber_height and chamber_heights {wrong}"
    )
    # the list on the command line replaces the dimension in the file
    assert load_config(coarse, [three, heights]).design.chamber_height == 12.0


def test_a_region_has_a_material_of_its_own(configs: Path) -> None:
    coarse = configs / "pneunet_coarse.yaml"
    base = "materials.base={law: neo_hooke, mu: 0.6 MPa, nu: 0.49, density: 2000 kg/m^3}"
    config, plain = load_config(coarse, [base]), load_config(coarse)
    assert config.materials["base"].built().shear_modulus == 0.6
    assert config.record()["materials"]["base"]["law"] == "neo_hooke"
    assert "materials" not in plain.record()
    assert config.hash != plain.hash
    assert config.poisson_ratio == plain.poisson_ratio == 0.495
    volume = config.design.region_volumes["base"]
    assert config.mass_tonne == pytest.approx(plain.mass_tonne + volume * (2000 - 1130) * 1e-12)
    material = material_of(config)
    assert isinstance(material, fem.ByRegion)
    assert material.body == plain.material.built()


def test_a_load_between_the_pressures_with_the_end_elsewhere_is_part_of_every_run(configs: Path) -> None:
    coarse = configs / "pneunet_coarse.yaml"
    assert load_config(coarse).validation == Validation((27.0,), (11.2,), (), with_experiments=False)
    wider = load_config(coarse, ["pressures=[5 kPa, 17 kPa, 37 kPa]", "end.y=-2 mm"]).validation
    assert (wider.pressures_kPa, wider.end_y_mm) == ((27.0,), (9.2,))
    single = load_config(coarse, ["pressures=[17 kPa]"]).validation
    assert (single.pressures_kPa, single.end_y_mm) == ((17.0,), (11.2,))
    assert load_config(coarse, ["validation=off"]).validation == Validation((), (), ())


def test_validation_pressures_written_with_six_digits_are_those_of_the_run(configs: Path) -> None:
    in_psi = "pressures=[0.4 psi, 0.8 psi]"
    loads = "validation={pressures: [2.7579 kPa, 4 kPa, 5.51581 kPa], end_y: [5 mm]}"
    config = load_config(configs / "pneunet_coarse.yaml", [in_psi, loads])
    low, high = config.pressures_kPa
    assert config.validation.pressures_kPa == (low, 4.0, high)


@pytest.mark.parametrize(
    ("reached", "pressures"),
    [((17.0, 37.0), (27.0,)), ((17.0, 30.0), (27.0,)), ((17.0,), (17.0,)), ((5.0, 8.0, 16.0), (12.0,)), ((), ())],
)
def test_the_load_that_the_program_chooses_is_among_reached_pressures(
    configs: Path, reached: tuple[float, ...], pressures: tuple[float, ...]
) -> None:
    coarse = configs / "pneunet_coarse.yaml"
    chosen = load_config(coarse).validation.among(reached)
    assert chosen.pressures_kPa == pressures
    assert chosen.end_y_mm == ((11.2,) if pressures else ())
    given = load_config(coarse, ["validation={pressures: [20 kPa], end_y: [5 mm]}"]).validation
    assert given.among(reached) == given
    highest = max(reached, default=0.0)
    assert given.up_to(highest) == (given if highest >= 20.0 else Validation((), (), ()))


def test_the_end_that_the_program_chooses_is_beyond_that_of_III(configs: Path) -> None:
    coarse = configs / "pneunet_coarse.yaml"
    chosen = load_config(coarse, ["end.y=2 mm"]).validation
    assert chosen.end_y_mm == (13.2,)
    assert chosen.beyond(2.0, is_held_down=False) == chosen
    assert chosen.beyond(2.0, is_held_down=True).end_y_mm == (-9.2,)
    given = load_config(coarse, ["validation={pressures: [20 kPa], end_y: [5 mm]}"]).validation
    assert given.beyond(0.0, is_held_down=True) == given


@pytest.mark.parametrize(
    ("written_end", "end"),
    [
        ("{}", End()),
        ("{y: 5 mm}", End(y_mm=5.0)),
        ("{x: 0.7 mm}", End(x_mm=0.7, y_mm=0.0)),
        ("{x: 0.7 mm, y: -1 mm}", End(0.7, -1.0)),
        ("{x: 0.175 N}", End(None, 0.0, (0.175, 0.0))),
        ("{x: 175 mN, y: 0.07 N}", End(None, None, (0.175, 0.07))),
        ("{x: 0.7 mm, y: 0 N}", End(0.7, None)),
    ],
)
def test_the_end_has_a_displacement_or_a_force_along_each_axis(configs: Path, written_end: str, end: End) -> None:
    assert load_config(configs / "pneunet_coarse.yaml", [f"end={written_end}"]).end == end


def test_a_given_d_is_read(configs: Path) -> None:
    coarse = configs / "pneunet_coarse.yaml"
    assert load_config(coarse).identification == IdentificationSettings()
    given = load_config(coarse, ["identification={d: 1.4 cm}"])
    assert given.identification.d_mm == pytest.approx(14.0)


def test_validation_loads_are_read(configs: Path) -> None:
    coarse = configs / "pneunet_coarse.yaml"
    config = load_config(coarse, ["validation={end_y: [1 cm, -10 mm], forces: [[0 N, 0.05 N]]}"])
    assert config.validation == Validation((17.0, 37.0), (10.0, -10.0), ((0.0, 0.05),))
    assert load_config(coarse, ["validation.pressures=[24 kPa]"]).validation == Validation((24.0,), (), ())


@pytest.mark.parametrize("number", ["1e-6", "1.0e-6", "0.000001", "1E-6"])
def test_a_number_with_an_exponent_needs_no_decimal_point(written: Path, number: str) -> None:
    """YAML 1.1 reads 1e-6 as a text."""
    assert load_config(written, [f"newton.tolerance={number}"]).newton.tolerance == 1e-6
    with written.open("a", encoding="utf-8") as file:
        file.write(f"\nnewton: {{tolerance: {number}}}\n")
    assert load_config(written).newton.tolerance == 1e-6


HERE = Path(__file__).parent.parent.parent
COARSE = HERE.parent / "configs" / "pneunet_coarse.yaml"


def test_parameters_of_an_effect_go_beside_its_state() -> None:
    """The file has `self_contact: auto`."""
    effect = load_config(COARSE, ["effects.self_contact.dhat=0.1 mm"]).effects.self_contact
    assert (effect.state, effect.dhat_mm) == ("auto", 0.1)
    assert load_config(
        COARSE, ["effects.self_contact=off", "effects.self_contact.dhat=0.1 mm"]
    ).effects.self_contact.off


def test_shipped_configurations_say_where_numbers_come_from(configs: Path) -> None:
    files = sorted(configs.glob("*.yaml"))
    assert len(files) >= 2
    for path in files:
        assert isinstance(load_config(path), Config)
        for line in path.read_text(encoding="utf-8").splitlines():
            value = line.partition("#")[0]
            if any(character.isdigit() for character in value):
                assert "paper" in line or "choice" in line, f"{path.name}: {line}"
