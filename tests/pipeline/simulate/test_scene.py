"""The effects that a configuration switches on, and the part of the body that is meshed for them."""

import pickle
from pathlib import Path

import pytest

import fem
from fem.cell.response import slopes
from geometry import Body, Mesh, PneuNet
from pipeline.config.config import Config
from pipeline.config.effects import CavityPressure, StrainLimitingLayer
from pipeline.config.load import load_config
from pipeline.law.piece.pieces import ArmPieces
from pipeline.simulate.scene import Scene
from pipeline.values.errors import InputError
from tests.foreign_bodies import bar
from tests.step_bodies import pneunet_as_step, save

BISECTED = ("geometry.length=30 mm", "mesh.size=5 mm")


@pytest.fixture
def arm(configs: Path) -> Path:
    return configs / "bisected_circle_coarse.yaml"


@pytest.fixture(scope="module")
def half() -> Body:
    return Scene.meshed(load_config("configs/bisected_circle_coarse.yaml", BISECTED)).body


def loads(config: Config, body: Body, largest_MPa: float) -> list[fem.Effect]:
    """All effects but contact."""
    every = Scene(config, body).effects(largest_MPa)
    return [effect for effect in every if not isinstance(effect, fem.SelfContact)]


def test_by_default_only_the_first_cavity_is_pressurised(arm: Path, half: Body) -> None:
    config = load_config(arm, BISECTED)
    assert config.effects.pressure.cavities == {
        "cavity": CavityPressure(1.0, 0.0),
        "cavity_lower": CavityPressure(0.0, 0.0),
    }
    assert loads(config, half, 0.037) == [fem.Pressure("cavity", 0.037)]


def test_cavities_may_carry_different_pressures(arm: Path, half: Body) -> None:
    config = load_config(arm, [*BISECTED, "effects.pressure={cavities: {cavity: 0.5, cavity_lower: 10 kPa}}"])
    assert config.effects.pressure.on
    assert loads(config, half, 0.04) == [fem.Pressure("cavity", 0.02), fem.Pressure("cavity_lower", 0.01, ramp=False)]
    assert loads(load_config(arm, [*BISECTED, "effects.pressure=off"]), half, 0.04) == []


@pytest.mark.parametrize("distance", ["2 mm", "2.5 mm"])
def test_an_activation_distance_that_walls_are_within_at_rest_is_refused(configs: Path, distance: str) -> None:
    """The gap of the arm is 2 mm; just below it is allowed. Faces that never meet have no gap."""
    short = ["geometry.chambers=2", "mesh.size=6 mm"]
    path = configs / "pneunet_coarse.yaml"
    with pytest.raises(
        InputError, match=rf"effects.self_contact.dhat: self-contact on 'gap': dhat, {distance}, must be"
    ):
        Scene.meshed(load_config(path, [*short, f"effects.self_contact={{dhat: {distance}}}"]))
    Scene.meshed(load_config(path, [*short, "effects.self_contact={dhat: 1.99 mm}"]))
    Scene.meshed(load_config(path, [*short, "effects.self_contact=off"]))
    named = "effects.self_contact={faces: [outer], dhat: 9 mm}"
    Scene.meshed(load_config(configs / "semicircular_coarse.yaml", [*short[1:], named]))


def test_gravity_across_the_plane_needs_the_whole_body(arm: Path) -> None:
    aside = "effects.gravity={acceleration: [0 m/s^2, 0 m/s^2, 9.81 m/s^2]}"
    assert Scene.meshed(load_config(arm, BISECTED)).body.half
    assert Scene.meshed(load_config(arm, [*BISECTED, "effects.gravity=on"])).body.half
    assert not Scene.meshed(load_config(arm, [*BISECTED, aside])).body.half
    assert not Scene.meshed(load_config(arm, [*BISECTED, "effects.symmetry=off"])).body.half


def test_parameters_switch_an_effect_on(arm: Path, half: Body) -> None:
    config = load_config(arm, [*BISECTED, "effects.strain_limiting_layer={thickness: 0.2 mm}", "effects.gravity=yes"])
    assert config.effects.strain_limiting_layer == StrainLimitingLayer("on", 0.2, 6500.0, 0.2)
    _, gravity, layer = loads(config, half, 0.04)
    assert gravity == fem.Gravity(1.13e-9, (0.0, -9810.0, 0.0), ramp=False)
    assert isinstance(layer, fem.StrainLimitingLayer)
    assert (layer.thickness, layer.E, layer.nu) == (0.2, 6500.0, 0.2)
    assert len(layer.triangles) == len(half.mesh.plane(1, 0.0)) > 0
    along_z = load_config(arm, [*BISECTED, "effects.gravity={state: auto, acceleration: [0 m/s^2, 0 m/s^2, 1 m/s^2]}"])
    assert loads(along_z, half, 0.04) == [fem.Pressure("cavity", 0.04)]


def test_one_effect_can_be_changed(arm: Path) -> None:
    config = load_config(arm, BISECTED)
    changed = config.with_effect("incompressibility", "off")
    assert (changed.mesh.formulation, changed.effects.incompressibility.state) == ("p2", "off")
    assert changed.hash != config.hash != config.with_effect("gravity", "on").hash


def contact(config: Config) -> list[fem.SelfContact]:
    return [effect for effect in Scene.meshed(config).effects(0.04) if isinstance(effect, fem.SelfContact)]


def test_contact_waits_unless_it_is_asked_for(configs: Path, half: Body) -> None:
    def arm(*overrides: str) -> Config:
        return load_config(configs / "pneunet_coarse.yaml", ["geometry.chambers=2", "mesh.size=6 mm", *overrides])

    cavity = fem.SelfContact("cavity", None, starts_inactive=True, overlap=0.0)
    assert contact(arm()) == [fem.SelfContact("gap", None, starts_inactive=True), cavity]
    assert contact(arm("effects.self_contact=on")) == [fem.SelfContact("gap", None, starts_inactive=False), cavity]
    assert contact(arm("effects.self_contact={dhat: 0.1 mm}"))[0].dhat == 0.1
    outer = arm("effects.self_contact={faces: outer}")
    assert contact(outer) == [fem.SelfContact("outer", None, starts_inactive=False), *contact(arm())]
    both = arm("effects.self_contact={state: auto, faces: [gap, cavity]}")
    assert contact(both) == contact(arm())
    off = arm("effects.self_contact=off")
    assert Scene.meshed(off).contact_faces == ()
    assert Scene(arm(), half).contact_faces == half.cavities


def test_an_arm_of_two_materials_is_softer_or_stiffer_than_one_of_one(configs: Path) -> None:
    """A half cell with a base six times as stiff, as the arm's own law takes it: between those of one material."""
    usual = ["mesh.size=6 mm", "geometry.chambers=3", "material={law: neo_hooke, mu: 0.1 MPa, nu: 0.49}"]
    stiff = "law: neo_hooke, mu: 0.6 MPa, nu: 0.49"
    rigidities = []
    for more in ([], [f"materials.base={{{stiff}}}"], [f"material={{{stiff}}}"]):
        scene = Scene.meshed(load_config(configs / "pneunet_coarse.yaml", [*usual, *more]))
        assert set(scene.body.mesh.regions) == ({"base"} if "materials" in str(more) else set())
        piece = ArmPieces(scene.config, None).cell
        rigidities.append(slopes(piece, piece.solve(0.0, 1e-6, piece.rest())).moment_by_angle)
    soft, both, stiffest = rigidities
    assert stiffest == pytest.approx(6 * soft, rel=1e-3)
    assert 1.5 * soft < both < 0.7 * stiffest


@pytest.mark.slow
def test_outer_walls_of_a_body_from_a_file_that_face_each_other_may_touch(tmp_path: Path) -> None:
    pneunet_as_step(tmp_path / "net.step", PneuNet(chambers=3))
    save(tmp_path / "bar.step", bar)
    contacts = {}
    for name, curve, effects in (
        ("net", 1.0, ""),
        ("net", 1.0, "effects: {self_contact: {faces: [outer]}}"),
        ("bar", 1.5, ""),
        ("bar", 1.5, "effects: {self_contact: on}"),
    ):
        (tmp_path / "own.yaml").write_text(
            f"name: own\ngeometry: {{family: own, file: {name}.step, curve: {curve} mm}}\n"
            f"material: {{law: svk, E: 1.2 MPa, nu: 0.495}}\npressures: [10 kPa]\nmesh: {{size: 5 mm}}\n{effects}\n"
        )
        scene = Scene.meshed(load_config(tmp_path / "own.yaml"))
        contacts[name, effects] = scene.contact_faces, scene.activation_distance, scene.outer_walls
    gapped = ("outer", "cavity"), pytest.approx(2.0 / 50.0), "outer"
    assert contacts["net", ""] == contacts["net", "effects: {self_contact: {faces: [outer]}}"] == gapped
    assert contacts["bar", ""] == contacts["bar", "effects: {self_contact: on}"] == (("cavity",), None, "")


def test_the_elements_of_the_scene_are_made_once(configs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both for the check of a given distance and for the distance that is told; a process makes its own."""
    made: list[str] = []
    of = fem.Discretisation.of

    def counted(mesh: Mesh, formulation: str) -> fem.Discretisation:
        made.append(formulation)
        return of(mesh, formulation)

    monkeypatch.setattr(fem.Discretisation, "of", counted)
    short = ["geometry.chambers=2", "mesh.size=6 mm", "effects.self_contact={dhat: 0.5 mm}"]
    scene = Scene.meshed(load_config(configs / "pneunet_coarse.yaml", short))
    assert (scene.activation_distance, scene.activation_distance, len(made)) == (0.5, 0.5, 1)
    sent = pickle.dumps(scene)
    assert len(sent) < 1.01 * len(pickle.dumps(Scene(scene.config, scene.body)))
    assert (pickle.loads(sent).activation_distance, len(made)) == (0.5, 2)
