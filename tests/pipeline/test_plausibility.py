"""Sentences about designs that are possible but unusual, and pressures without parameters that do not end a run."""

import re
from dataclasses import replace
from math import inf
from pathlib import Path
from time import sleep
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from geometry import Body, CadFile, Mesh, MeshFile, PneuNet, position_text
from pipeline.cli import app
from pipeline.config.load import load_config
from pipeline.context import RunContext
from pipeline.identification import added_pressures
from pipeline.identification.added_pressures import identify_run
from pipeline.identification.too_short import too_coarse, why_too_short
from pipeline.plausibility.after import Solved, after_solving
from pipeline.plausibility.before import WELL_BELOW, Borne, before_solving
from pipeline.plausibility.body import (
    FLAT_ELEMENT,
    of_clamp,
    of_directions,
    of_half,
    of_mesh,
    of_straightened,
    of_volume,
)
from pipeline.plausibility.units import of_contact, of_units
from pipeline.progress import Silent
from pipeline.report.page import render_report
from pipeline.simulation.contact_check import ContactCheck, path_dependence
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.scene import Scene
from pipeline.simulation.waiting import remarks_while_waiting
from rod import Interval
from rod.identification.two_lines import CLEAR
from tests.bodies import bricks, named, on_plane
from tests.foreign_bodies import bar, meshed, two_chambers, write_mesh, write_surface
from tests.step_bodies import save

CONFIGS = Path(__file__).resolve().parent.parent.parent / "configs"
PRESSURES = "pressures=[10 kPa, 20 kPa, 30 kPa]"


def notes_before(*settings: str, config: str = "pneunet_coarse") -> str:
    return "; ".join(before_solving(load_config(CONFIGS / f"{config}.yaml", settings)))


@pytest.mark.parametrize("config", ["pneunet", "semicircular", "semicircular_single", "bisected_circle", "finger"])
def test_the_shipped_designs_are_plausible(config: str) -> None:
    sentences = notes_before(config=config)
    assert of_units(load_config(CONFIGS / f"{config}.yaml")) == ()
    assert not any(word in sentences for word in ("hardly", "balloons", "pitches")), sentences


@pytest.mark.parametrize(
    ("setting", "sentence"),
    [
        ("pressures=[0.1 MPa, 0.2 MPa, 0.4 MPa]", "inflate like balloons; check the units (kPa, MPa), or stay well"),
        ("pressures=[10 Pa, 20 Pa, 30 Pa]", "will hardly bend the arm; check the units (kPa, MPa, GPa), or give"),
        ("pressures=[10 Pa, 20 Pa]", "for example pressures: [4 kPa, 8 kPa, 12 kPa, 16 kPa]"),
        ("pressures=[17.3 kPa, 37.1 kPa]", "give three or more, for example pressures: [17.3 kPa, 27 kPa, 37.1 kPa]"),
        ("pressures=[36 kPa, 37 kPa]", "give three or more, for example pressures: [36 kPa, 36.5 kPa, 37 kPa]"),
        ("pressures=[37.1 kPa]", "give three or more, for example pressures: [9.2 kPa, 18 kPa, 28 kPa, 37.1 kPa]"),
        (
            "material.E=1200 MPa",
            "check the units of material and pressures (kPa, MPa, GPa): rubbers have a Young's modulus",
        ),
        ("material.E=300 MPa", "will hardly bend the arm"),
        (
            "geometry.chambers=6",
            "6.5 pitches; this arm of 62 mm has 6.2 of 10 mm; give more geometry.chambers",
        ),
        ("pressures=[20 kPa]", "one pressure cannot tell how the parameters change; give three or more"),
        (
            "pressures=[10 kPa, 20 kPa]",
            "two pressures cannot tell whether the parameters are linear in the pressure; give three",
        ),
    ],
)
def test_what_is_unusual_is_said_before_anything_is_solved(setting: str, sentence: str) -> None:
    assert sentence in notes_before(PRESSURES, setting)


@pytest.mark.parametrize(
    ("pressures", "bend_rad", "example"),
    [
        ("[2 kPa, 4 kPa]", 0.02, "for example pressures: [5 kPa, 10 kPa, 15 kPa, 20 kPa]"),  # 0.1 rad at 20 kPa
        ("[2 kPa, 4 kPa]", 0.0, "for example pressures: [9.2 kPa, 18 kPa, 28 kPa, 37 kPa]"),  # as much as an arm bears
        ("[2 kPa, 4 kPa]", 0.06, "for example pressures: [2 kPa, 3 kPa, 4 kPa]"),
        ("[40 kPa, 80 kPa]", 0.02, ""),  # more is no example
    ],
)
def test_pressures_for_an_arm_that_hardly_bends_are_higher(pressures: str, bend_rad: float, example: str) -> None:
    """Two notes contradicted each other: to give higher pressures, and, for example, as high ones as before."""
    config = load_config(CONFIGS / "pneunet_coarse.yaml", [f"pressures={pressures}"])
    (note,) = (n for n in before_solving(config, Borne(bend_rad=bend_rad)) if "give three or more" in n)
    assert note.endswith(example or "give three or more")


@pytest.mark.parametrize("kind", ["step", "vtk", "stl"])
def test_gravity_along_an_arm_that_is_turned(kind: str, tmp_path: Path) -> None:
    """Its x runs from the clamp to the tip, and so against that of the file."""
    write = {
        "step": lambda path: save(path, bar),
        "vtk": lambda path: write_mesh(path, *meshed(bar, 5.0)),
        "stl": lambda path: write_surface(path, bar, 50),
    }[kind]
    write(tmp_path / f"bar.{kind}")
    path = tmp_path / "hanging.yaml"
    path.write_text(
        f"name: hanging\ngeometry: {{family: own, file: bar.{kind}, curve: 1.5 mm}}\npressures: [10 kPa]\n"
        "material: {law: neo_hooke, mu: 0.4 MPa, nu: 0.49, density: 1070 kg/m^3}\n"
    )

    def is_said(x: str, *settings: str) -> bool:
        gravity = f"effects.gravity={{acceleration: [{x}, -1 m/s^2, 0 m/s^2]}}"
        return any(
            "against the x in which geometry.clamp" in note
            for note in before_solving(load_config(path, (gravity, *settings)))
        )

    assert is_said("9.81 m/s^2", "geometry.clamp=60 mm")
    assert not is_said("9.81 m/s^2")
    assert not is_said("0 m/s^2", "geometry.clamp=60 mm")


@pytest.mark.parametrize("pressures", ["[150 kPa]", "[17 kPa, 150 kPa]", "[0.1 MPa, 0.4 MPa]"])
@pytest.mark.parametrize("end", [64.7, 3.0, 1e3])
def test_pressures_that_are_suggested_lie_below_the_lowest_end_of_an_experiment(pressures: str, end: float) -> None:
    config = load_config(CONFIGS / "pneunet_coarse.yaml", [f"pressures={pressures}"])
    without, sentences = before_solving(config), before_solving(config, Borne(end))
    assert len(without) == len(sentences)
    suggested = re.findall(r"stay below ([\d.]+) kPa|([\d.]+) kPa(?=[,\]])", "; ".join(sentences))
    numbers = [float(number) for pair in suggested for number in pair if number]
    assert len(numbers) >= 3
    assert max(numbers) <= 1.01 * WELL_BELOW * end
    (few, few_after) = (next(text for text in both if "give three" in text) for both in (without, sentences))
    assert (few == few_after) == (end == 1e3)


def test_pressures_that_were_reached_are_suggested_though_they_are_near_the_end() -> None:
    config = load_config(CONFIGS / "pneunet_coarse.yaml", ["pressures=[20 kPa, 25 kPa]"])
    (unknown,), (known,) = before_solving(config, Borne(21.59)), before_solving(config, Borne(21.59, 20.0))
    assert unknown.endswith("pressures: [3.2 kPa, 6.5 kPa, 9.8 kPa, 13 kPa]")
    assert known.endswith("pressures: [5 kPa, 10 kPa, 15 kPa, 20 kPa]")
    assert Borne(20.8, 20.57).suggested(25.0) == 20.0


def test_a_high_pressure_has_an_estimate_before_and_the_end_of_an_experiment_after() -> None:
    config = load_config(CONFIGS / "pneunet_coarse.yaml", ["pressures=[10 kPa, 30 kPa, 500 kPa]"])
    (before,), (after,) = before_solving(config), before_solving(config, Borne(29.36))
    common, _, estimate = before.partition(", or ")
    assert re.fullmatch(r"stay well below [\d.]+ kPa, an estimate from stiffness and volumes alone", estimate)
    assert after == f"{common}, or stay below 18 kPa, because an experiment ended at 29.4 kPa"


LAYER = "effects.strain_limiting_layer={state: on, %s}"
STEEL = "materials={base: {law: svk, E: 200 GPa, nu: 0.3, density: 7850 %s}}"


@pytest.mark.parametrize(
    ("setting", "sentence"),
    [
        ("material.density=1.07 kg/m^3", "is 1.07 kg/m^3, and rubbers and foams have 20 to 3000 kg/m^3; perhaps"),
        ("material.density=1.07 kg/m^3", "perhaps 1.07 g/cm^3 is meant"),
        ("material.density=1070 g/cm^3", "perhaps 1070 kg/m^3 is meant"),
        ("material.density=5 kg/m^3", "5 kg/m^3, and rubbers and foams have 20 to 3000 kg/m^3; check its unit"),
        (STEEL % "g/cm^3", "materials.base.density is 7.85e+06 kg/m^3, and foams, rubbers and metals"),
        (
            STEEL.replace("200 GPa", "200 TPa") % "kg/m^3",
            "materials.base: Young's modulus is 2e+08 MPa, and foams, rubbers, papers and metals have 0.001 to",
        ),
        (LAYER % "E: 6500 GPa", "effects.strain_limiting_layer: Young's modulus is 6.5e+06 MPa"),
        (LAYER % "E: 6.5 kPa", "Young's modulus is 0.0065 MPa, less than that of the arm, 1.2 MPa, so"),
        (LAYER % "thickness: 10 mm", "strain_limiting_layer.thickness is 10 mm, and the arm is"),
        (LAYER % "thickness: 0.1 um", "strain_limiting_layer.thickness is 0.0001 mm, and the arm is"),
        ("end.y=20 cm", "end.y moves the end by 200 mm, 1.8 times the length of the arm, and an arm that is bent"),
        ("end.y=-20 um", "end.y moves the end by -0.02 mm, 0.00018 times the length of the arm, which is hardly"),
        ("validation={end_y: [5 mm, 1 m]}", "validation.end_y moves the end by 1000 mm, 8.9 times the length"),
        ("end.x=7 cm", "end.x moves the end by 70 mm, 0.62 times the length of the arm, a mean strain of 0.62 in"),
        ("end.x=-30 cm", "end.x moves the end by -300 mm, 2.7 times the length of the arm, towards the clamp, and an"),
        ("end={y: 50 N}", "end: a force of 50 N on the end is 28 times what would fold or tear a bar"),
        ("end={x: -50 N}", "a force of 50 N on the end is 28 times"),
        ("validation={forces: [[0 N, 0.05 N], [0 kN, 0.05 kN]]}", "validation.forces: a force of 50 N on the end"),
        ("end={x: 0.5 kN}", "a force of 500 N on the end is 6.4 times what would fold or tear"),
        ("end={y: 0.05 mN}", "5e-05 N on the end is too small to move the arm; check its unit (N, mN), or give 0.0059"),
    ],
)
def test_numbers_in_another_unit_are_named(setting: str, sentence: str) -> None:
    (note,) = of_units(load_config(CONFIGS / "pneunet_coarse.yaml", [setting]))
    assert sentence in note


@pytest.mark.parametrize(
    "setting",
    [
        *("material.density=30 kg/m^3", "material.density=2.5 g/cm^3", "material={law: svk, E: 1.2 MPa, nu: 0.495}"),
        *(LAYER % "thickness: 0.3 mm", LAYER % "E: 200 GPa"),
        *(
            "end.x=5 mm",
            "end.x=-0.1 m",
            "end.x=0 mm",
            "end.y=30 mm",
            "end.y=-60 mm",
            "end={x: 0.175 N, y: 0.07 N}",
            "end={x: 5 N}",
            "validation=off",
        ),
        *("validation={forces: [[0 N, 0.01 N]], end_y: [0.2 mm]}", STEEL % "kg/m^3"),
    ],
)
def test_numbers_that_arms_have_are_not_named(setting: str) -> None:
    assert of_units(load_config(CONFIGS / "pneunet_coarse.yaml", [setting])) == ()


@pytest.mark.parametrize(
    ("dhat", "sentence"),
    [
        (
            "0.4 mm",
            "dhat, 0.4 mm with a smallest gap of 2 mm and a thinnest wall of 1 mm, keeps walls in contact so far",
        ),
        (
            "0.04 um",
            "is smaller than any with which an arm was solved, and may need very many iterations; check its unit",
        ),
        *(("0.16 mm", ""), ("0.04 mm", ""), ("0.005 mm", "")),
    ],
)
def test_activation_distances_are_compared_with_gap_and_wall(dhat: str, sentence: str) -> None:
    settings = ["geometry.chambers=2", "mesh.size=6 mm", f"effects.self_contact={{dhat: {dhat}}}"]
    note = of_contact(Scene.meshed(load_config(CONFIGS / "pneunet_coarse.yaml", settings)))
    assert sentence in note
    assert bool(sentence) == bool(note)


def test_no_activation_distance_is_compared_where_none_is_given_or_nothing_meets() -> None:
    for config, settings in (("pneunet", []), ("semicircular", ["effects.self_contact={dhat: 4 mm}"])):
        short = ["geometry.chambers=2", "mesh.size=6 mm", *settings]
        assert of_contact(Scene.meshed(load_config(CONFIGS / f"{config}_coarse.yaml", short))) == ""


CHAMBERS = """
name: chambers
geometry:
  {family: own, file: chambers.step, curve: 1.5 mm, air: {near: [15 mm, 6 mm, 0 mm], far: [45 mm, 6 mm, 0 mm]}}
material: {law: neo_hooke, mu: 0.1 MPa, nu: 0.49}
pressures: [1 kPa, 2 kPa, 3 kPa]
mesh: {size: 6 mm}
law: five
"""


def test_cavities_that_are_longer_than_the_curvature_is_averaged_over_are_named(tmp_path: Path) -> None:
    save(tmp_path / "chambers.step", two_chambers)
    (tmp_path / "chambers.yaml").write_text(CHAMBERS, encoding="utf-8")

    def notes(*settings: str) -> str:
        return "; ".join(before_solving(load_config(tmp_path / "chambers.yaml", settings)))

    means = "curvatures are means over 6 mm, and the middles of the cavities are up to 28 mm apart: two lines would "
    assert notes().startswith(means)
    assert notes().endswith("so that a single line is taken; identification.d asks for two")
    assert notes("identification.d=10 mm") == ""
    assert notes("geometry.cell=28 mm").endswith("has 2.14 of 28 mm; give a smaller geometry.cell, or none")


def test_pressures_that_no_cavity_follows_are_named() -> None:
    constant = "effects.pressure={cavities: {cavity: 4 kPa}}"
    assert "the states at all pressures are the same" in (note := notes_before(PRESSURES, constant))
    assert note.endswith("effects.pressure: {cavities: {cavity: 1}}")
    assert notes_before(PRESSURES, "effects.pressure={cavities: {cavity: 0.5}}") == ""
    assert "follows" not in notes_before(PRESSURES, "effects.pressure=off")


def test_more_or_higher_pressures_are_not_suggested_where_they_change_nothing() -> None:
    constant = "effects.pressure={cavities: {cavity: 4 kPa}}"
    for setting, sentence in (("effects.pressure=off", "effects.pressure is off, so"), (constant, "no cavity follows")):
        notes = before_solving(load_config(CONFIGS / "pneunet_coarse.yaml", [setting, "pressures=[17 kPa, 37 kPa]"]))
        (note,) = notes
        assert sentence in note
        assert after_solving(solved(0.9, (0.95, 1.05), 1e-4, setting)) == ()
    one = load_config(CONFIGS / "pneunet_coarse.yaml", ["effects.pressure=off", "pressures=[5 kPa]"])
    assert before_solving(one) == ()


@pytest.mark.parametrize(
    ("settings", "spacing", "sentence"),
    [
        ((), 10.0, ""),
        (
            ("mesh.formulation=p1",),
            10.0,
            "are up to 10 mm apart, more than half of the 10 mm over which",
        ),
        (
            (),
            12.0,
            "more than half of the 10 mm over which curvatures are averaged; give a smaller mesh.size",
        ),
        (("law=cell",), 12.0, ""),
        (("geometry.chambers=2",), 12.0, ""),  # too short, which is said alone
    ],
)
def test_a_mesh_too_coarse_for_means_over_a_cell_is_named_before_solving(
    settings: tuple[str, ...], spacing: float, sentence: str
) -> None:
    """Nodes are at the vertices of the mesh and, of quadratic elements, in the middles between them."""
    config = load_config(CONFIGS / "pneunet_coarse.yaml", settings)
    points = np.zeros((9, 3))
    points[:, 0] = spacing * np.arange(9)
    body = SimpleNamespace(mesh=SimpleNamespace(points=points), curve_vertices=np.arange(9))
    said = too_coarse(config, body)  # type: ignore[arg-type]
    assert sentence in said
    assert bool(said) == bool(sentence)


def test_nothing_is_said_of_a_usual_design() -> None:
    assert notes_before(PRESSURES) == ""
    assert notes_before(PRESSURES, "geometry.chambers=6", "law=cell") == ""
    assert notes_before("pressures=[10 kPa, 20 kPa]", "added_pressures=1") == ""


def solved(
    min_J: float,
    stretches: tuple[float, float],
    kappa_0: float,
    *settings: str,
    alpha2: tuple[float, float] = (9, 11),
    contact_check: ContactCheck | None = None,
    evidence: float = 20.0,
    on_coarser: bool | None = None,
    one_rigidity: bool = False,
    curve_z_mm: float = 0.0,
    path_dependence: float = 0.0,
    r2: float = 0.9,
) -> Any:
    extremes = SimpleNamespace(
        min_J=min_J, min_J_at=(1.0, 2.0, 3.0), min_stretch=stretches[0], max_stretch=stretches[1]
    )
    summary = SimpleNamespace(
        experiment="II",
        pressure_kPa=20.0,
        extremes=extremes,
        contact_check=contact_check,
        curve_z_mm=curve_z_mm,
        path_dependence=path_dependence,
    )
    record = SimpleNamespace(summary=summary, centreline=SimpleNamespace(s=np.array([0.0, 100.0])))
    numbers = {"alpha1": Interval(10.0, 0.5, 9.0, 11.0), "alpha2": Interval(10.0, 0.5, *alpha2)}
    lines = SimpleNamespace(
        evidence=evidence,
        two_lines=evidence > 0.0,
        alpha2=Interval(13.61, 0.1, 13.4, 13.8),
        single_line=SimpleNamespace(alpha=Interval(10.94, 0.5, 10.0, 12.0), r2=r2),
    )
    parameters = SimpleNamespace(
        pressure_kPa=20.0,
        kappa_0_middle=kappa_0,
        kappa_0=SimpleNamespace(length=100.0),
        numbers=numbers,
        by_cells=lines,
        two_lines=lines.two_lines and not one_rigidity,
        evidence=evidence,
        choice_is_clear=one_rigidity or abs(evidence) >= CLEAR,
        two_lines_on_coarser=on_coarser,
        one_rigidity=one_rigidity,
    )
    config = load_config(CONFIGS / "pneunet_coarse.yaml", settings)
    return Solved(config, SimpleNamespace(records=(record,)), (parameters,))  # type: ignore[arg-type]


def test_an_arm_that_leaves_the_plane_of_the_rod_is_named() -> None:
    (note,) = after_solving(solved(0.9, (0.95, 1.05), 0.01, curve_z_mm=1.12))
    assert "leaves the plane z = 0 by up to 1.12 mm (II, 20 kPa), 1 % of its length; the rods are planar" in note
    assert after_solving(solved(0.9, (0.95, 1.05), 0.01, curve_z_mm=0.1)) == ()


@pytest.mark.parametrize(
    ("states", "settings", "sentence"),
    [
        ((0.6, (0.95, 1.05), 0.01), (), "loses up to 40 % of its volume at (1.0, 2.0, 3.0) mm (II, 20 kPa)"),
        (
            (0.48, (0.95, 1.05), 0.01),
            ("mesh.formulation=mixed", "material={law: svk, E: 1.2 MPa, nu: 0.49}"),
            "loses up to 52 % of its volume at (1.0, 2.0, 3.0) mm (II, 20 kPa), although a Poisson ratio of 0.49 keeps "
            "it nearly; compare with a smaller mesh.size, because the elements there are too large",
        ),
        ((0.9, (0.95, 1.3), 0.01), (), "from 0.95 (compressed) to 1.30 (at 20 kPa), and St. Venant-Kirchhoff"),
        ((0.9, (0.8, 1.05), 0.01), (), "from 0.80 (compressed) to 1.05"),
        (
            (0.9, (0.9, 1.65), 0.01),
            ("material={law: mooney_rivlin, c10: -0.05 MPa, c01: 0.1 MPa, nu: 0.49}",),
            "to 1.65 (at 20 kPa), and the law mooney_rivlin with these constants is not stable beyond 1.35",
        ),
        (
            (0.9, (0.9, 1.75), 0.01),
            ("material={law: mooney_rivlin, c10: -0.05 MPa, c01: 0.1 MPa, nu: 0.49}",),
            "describes rubber up to a stretch of about 1.7, and it is not stable beyond 1.35; fit another",
        ),
        ((0.9, (0.95, 1.05), 1e-4), (), "hardly bends: at 20 kPa its curvature adds up to 0.01 rad"),
    ],
)
def test_unusual_states_are_named(states: tuple[Any, ...], settings: tuple[str, ...], sentence: str) -> None:
    (note,) = after_solving(solved(*states, *settings))
    assert sentence in note


def test_curved_edges_of_a_mesh_file_that_are_taken_as_straight_are_named() -> None:
    design = object.__new__(MeshFile)
    for count, beginning in (
        (1, "one curved edge of the mesh file is taken"),
        (2, "2 curved edges of the mesh file are"),
    ):
        design.__dict__["_content"] = SimpleNamespace(straightened=np.tile([21.0, 11.5, 3.5], (count, 1)))
        assert (note := of_straightened(design)).startswith(beginning)
        assert "as straight, near (21.0, 11.5, 3.5) mm, because an element would fold" in note
    design.__dict__["_content"] = SimpleNamespace(straightened=np.empty((0, 3)))
    assert of_straightened(design) == ""


def test_the_law_of_a_region_is_compared_with_the_stretches_in_it() -> None:
    of_base = "materials={base: {law: svk, E: 0.3 MPa, nu: 0.49}}"
    run = solved(
        0.9, (0.5, 1.4), 0.01, "material={law: yeoh, c10: 0.15 MPa, c20: 0 MPa, c30: 0 MPa, nu: 0.49}", of_base
    )
    run.outcomes.records[0].fields = {
        "smallest_stretch": np.array([0.5, 0.95, 0.57]),
        "stretch": np.array([1.4, 1.05, 1.08]),
    }
    (note,) = after_solving(replace(run, regions={"base": np.array([1, 2])}))
    assert note.startswith(
        "stretches in the walls of the region base go from 0.57 (compressed) to 1.08 (at 20 kPa), and"
    )
    assert "it is not stable below 0.58 (compressed)" in note
    assert after_solving(replace(run, regions={"base": np.array([1])})) == ()


def test_a_law_holds_between_the_stretches_of_its_test() -> None:
    law = "material={law: yeoh, c10: 0.15 MPa, c20: 0 MPa, c30: 0 MPa, nu: 0.49%s}"
    assert after_solving(solved(0.9, (0.7, 1.9), 0.01, law % "")) == ()
    (note,) = after_solving(solved(0.9, (0.7, 1.9), 0.01, law % ", holds_between: [0.75, 1.8]"))
    assert note.startswith(
        "stretches in the walls go from 0.70 (compressed) to 1.90 (at 20 kPa), and the law yeoh holds from 0.75 to 1.8 "
        "(holds_between in the configuration); fit another law"
    )
    assert after_solving(solved(0.9, (0.7, 1.9), 0.01, law % ", holds_between: [0.6, 2]")) == ()


def test_an_arm_that_is_too_short_for_five_parameters_can_hardly_bend() -> None:
    run = replace(solved(0.9, (0.95, 1.05), 0.01), parameters=())
    (record,) = run.outcomes.records
    record.experiment, record.pressure_kPa, record.kappa_middle = "II", 30.0, lambda pitch: -1e-5 * pitch
    (note,) = after_solving(run)
    assert (
        f"at 30 kPa its curvature adds up to {1e-5 * run.config.design.pitch * run.config.design.length:.2g} rad"
        in note
    )
    record.kappa_middle = lambda pitch: None
    assert after_solving(run) == ()


def test_few_pressures_that_are_left_of_several_are_named() -> None:
    run = solved(0.9, (0.95, 1.05), 0.01, "pressures=[20 kPa, 60 kPa, 75 kPa]")
    run.outcomes.lowest_end_kPa = lambda: 64.71
    (note,) = after_solving(run)
    assert note == (
        "five parameters are known at one pressure alone, of 3 that were given, which cannot tell how they change in "
        "the pressure; give more pressures below 64.7 kPa"
    )
    two = after_solving(replace(run, parameters=2 * run.parameters))
    assert "at two pressures alone, of 3 that were given, which cannot tell whether they are linear" in two[0]
    assert after_solving(replace(run, parameters=3 * run.parameters)) == ()
    for settings in (("pressures=[20 kPa]",), ("pressures=[20 kPa, 30 kPa]", "added_pressures=1")):
        assert after_solving(replace(run, config=solved(0.9, (0.95, 1.05), 0.01, *settings).config)) == ()


@pytest.mark.parametrize(
    ("check", "sentence"),
    [
        (
            ContactCheck(0.25, 0.01),
            "with exact distances between them the end is displaced by at most 0.25 mm (II at 20 kPa); the force on "
            "the end differs by at most 0.01 N (II at 20 kPa)",
        ),
        (
            ContactCheck(0.0, 0.01),
            "with exact distances between them the force on the end differs by at most 0.01 N (II at 20 kPa)",
        ),
        (
            ContactCheck(None, None, "no equilibrium"),
            "by how much is not known in II at 20 kPa, where the comparison failed",
        ),
    ],
)
def test_contact_that_is_approximate_is_named(check: ContactCheck, sentence: str) -> None:
    (note,) = after_solving(solved(0.9, (0.95, 1.05), 0.01, contact_check=check))
    assert note == f"walls of a cavity have moved along each other, so that their contact is approximate: {sentence}"


def test_nothing_is_said_of_contact_that_exact_distances_do_not_change() -> None:
    assert after_solving(solved(0.9, (0.95, 1.05), 0.01, contact_check=ContactCheck(0.0, 0.0))) == ()


def test_contact_that_depends_on_the_increments_is_named() -> None:
    (note,) = after_solving(solved(0.9, (0.95, 1.05), 0.01, path_dependence=0.081))
    assert note == (
        "folded walls of a cavity may touch in more than one way, and in which of them they do may depend on the load "
        "increments: in II at 20 kPa the equilibrium with contact searched anew differs by 8.1 % in displacement or "
        "strain; the states of the increments are reported"
    )
    (note,) = after_solving(solved(0.9, (0.95, 1.05), 0.01, path_dependence=inf))
    assert "increments: in II at 20 kPa contact searched anew led to no equilibrium to compare with; the states" in note
    assert path_dependence(0.12, 0.07).endswith("anew differs by at most 12 % in displacement or strain")


@pytest.mark.parametrize(("low", "high"), [(9.0, 37.0), (0.0, 11.0), (-40.0, 60.0)])
def test_a_rigidity_that_is_not_determined_is_named(low: float, high: float) -> None:
    (note,) = after_solving(solved(0.9, (0.95, 1.05), 0.01, alpha2=(low, high)))
    assert f"95 % interval of α₂ at 20 kPa from {low:.3g} to {high:.3g} N mm²; give higher pressures" in note


@pytest.mark.parametrize(("r2", "evidence", "named"), [(0.28, -20.0, True), (0.51, -20.0, False), (0.28, 20.0, False)])
def test_a_single_line_that_describes_little_is_named(r2: float, evidence: float, named: bool) -> None:
    notes = after_solving(solved(0.9, (0.95, 1.05), 0.01, r2=r2, evidence=evidence))
    assert len(notes) == named
    if named:
        assert "at 20 kPa the line of the rod with five parameters describes only 28 % of the variance" in notes[0]


def test_a_single_line_that_is_not_determined_is_named_once() -> None:
    run = solved(0.9, (0.95, 1.05), 0.01, alpha2=(1.0, 20.0))
    run.parameters[0].numbers["alpha1"] = run.parameters[0].numbers["alpha2"]
    (note,) = after_solving(run)
    assert "95 % interval of α₁ = α₂ at 20 kPa from 1 to 20 N mm²; give" in note


@pytest.mark.parametrize(
    ("evidence", "on_coarser", "sentence"),
    [
        (
            -0.77,
            False,
            "10.9 N mm² with a single line, as reported, and 13.6 N mm² with two lines (difference of the Bayesian "
            "information criterion 0.77)",
        ),
        (
            10.7,
            False,
            "13.6 N mm² with two lines, as reported, and 10.9 N mm² with a single line (difference of the Bayesian "
            "information criterion 11; on the coarser mesh a single line would be taken)",
        ),
        (
            -7.6,
            True,
            "10.9 N mm² with a single line, as reported, and 13.6 N mm² with two lines (difference of the Bayesian "
            "information criterion 7.6; on the coarser mesh two lines would be taken)",
        ),
    ],
)
def test_a_number_of_lines_that_the_data_do_not_decide_is_named(
    evidence: float, on_coarser: bool, sentence: str
) -> None:
    (note,) = after_solving(solved(0.9, (0.95, 1.05), 0.01, evidence=evidence, on_coarser=on_coarser))
    assert note.startswith("the data of the five parameters do not decide clearly between a single line and two, ")
    assert note.endswith(f": at 20 kPa {sentence}")


@pytest.mark.parametrize(("evidence", "on_coarser"), [(6.1, True), (-6.1, False), (-9.0, None)])
def test_a_number_of_lines_that_the_data_decide_is_not_named(evidence: float, on_coarser: bool | None) -> None:
    assert after_solving(solved(0.9, (0.95, 1.05), 0.01, evidence=evidence, on_coarser=on_coarser)) == ()


def test_nothing_is_open_where_one_rigidity_holds_along_the_arm() -> None:
    assert after_solving(solved(0.9, (0.95, 1.05), 0.01, evidence=1.0, one_rigidity=True)) == ()


def test_usual_states_are_not_named() -> None:
    assert after_solving(solved(0.9, (0.95, 1.05), 0.01)) == ()
    assert after_solving(solved(0.75, (0.95, 1.05), 0.01, "mesh.formulation=mixed")) == ()
    compressible = "material={law: svk, E: 1.2 MPa, nu: 0.45}"
    assert after_solving(solved(0.6, (0.95, 1.05), 0.01, "mesh.formulation=mixed", compressible)) == ()
    rubber = "material={law: neo_hooke, mu: 0.4 MPa, kappa: 20 MPa, density: 1130 kg/m^3}"
    assert after_solving(solved(0.9, (0.7, 1.5), 0.01, rubber)) == ()


@pytest.fixture
def arm(monkeypatch: pytest.MonkeyPatch) -> Scene:
    """A scene of the right length whose identification refuses the lowest pressure."""
    config = load_config(CONFIGS / "pneunet_coarse.yaml", [PRESSURES])
    mesh = SimpleNamespace(points=np.linspace([0.0] * 3, [112.0, 0.0, 0.0], 57))
    body: Any = SimpleNamespace(length=112.0, pitch=10.0, mesh=mesh, curve_vertices=np.arange(57))
    return Scene(config, body)


CONTEXT = RunContext.alone(None, Silent())  # type: ignore[arg-type]
NONE = Outcomes({})


@pytest.mark.parametrize(
    ("identified", "other_rod", "fails"), [(("parameters",), False, False), ((), True, False), ((), False, True)]
)
def test_a_pressure_without_parameters_fails_a_run_only_where_it_leaves_no_rod(
    monkeypatch: pytest.MonkeyPatch, arm: Scene, identified: tuple[str, ...], other_rod: bool, fails: bool
) -> None:
    reason = "no five parameters at 10 kPa: the rod carries no moment"
    monkeypatch.setattr(
        added_pressures,
        "identify_all",
        lambda *given, **keys: (identified, (reason,)),
    )
    identification = identify_run(arm, CONTEXT, NONE)
    assert (identification.failures(other_rod), identification.remarks(other_rod)) == (
        ((reason,), ()) if fails else ((), (reason,))
    )
    assert identification.parameters == identified


def test_an_arm_that_is_too_short_has_the_same_reason_before_and_after(arm: Scene, tmp_path: Path) -> None:
    config = load_config(CONFIGS / "pneunet_coarse.yaml", [PRESSURES, "geometry.chambers=6"])
    (reason,) = identify_run(replace(arm, config=config), CONTEXT, NONE).failures(other_rod=False)
    assert reason == (
        "no five parameters: five parameters need a length of at least 6.5 pitches; this arm of 62 mm has 6.2 of 10 mm;"
        " give more geometry.chambers, or law: cell for the arm's own law alone"
    )
    assert notes_before(PRESSURES, "geometry.chambers=6") == reason
    assert notes_before("pressures=[5 kPa, 10 kPa]", "geometry.chambers=6") == reason  # nothing on linearity
    (tmp_path / "run.json").write_text(f'{{"remarks": ["{reason}"]}}', encoding="utf-8")
    page = render_report(tmp_path)
    assert "They were not identified: five parameters need a length of at least 6.5 pitches; this arm of 62 mm" in page
    assert f"Note: {reason.partition(' for the arm')[0]} for the arm" in page


def test_an_arm_without_chambers_is_asked_to_be_longer(tmp_path: Path) -> None:
    """Its cells are equal parts of the cavity, whose number grows with the length."""
    (tmp_path / "half_disc.yaml").write_text(
        "name: half_disc\nlaw: five\npressures: [5 kPa, 10 kPa, 15 kPa]\n"
        "geometry: {family: bisected_circle, radius: 7.5 mm, end_wall: 2 mm, length: 60 mm}\n"
        "material: {law: neo_hooke, mu: 0.3 MPa, nu: 0.3}\n",
        encoding="utf-8",
    )

    def reason(length: str) -> str:
        return why_too_short(load_config(tmp_path / "half_disc.yaml", [f"geometry.length={length}"]))

    assert reason("60 mm").endswith("; give a longer geometry.length")
    assert reason("69.1 mm") == ""


def test_a_short_arm_without_a_law_of_its_own_is_not_sent_to_it() -> None:
    weight = "effects.gravity=on"
    sentence = notes_before(PRESSURES, "geometry.chambers=6", weight)
    assert sentence.endswith("this arm of 62 mm has 6.2 of 10 mm; give more geometry.chambers")
    assert notes_before(PRESSURES, "geometry.chambers=1").endswith("; give more geometry.chambers")


def test_a_flat_element_is_named_before_solving() -> None:
    design = PneuNet(chambers=2)
    mesh = design.body(5).mesh
    assert of_mesh(mesh, design) == ()
    points = np.array(mesh.points)
    inner = np.setdiff1d(np.arange(len(points)), mesh.boundary)[0]
    tet = next(tet for tet in mesh.tets if inner in tet)
    opposite = points[[v for v in tet if v != inner]]
    for part in (0.5, 0.8, 0.9, 0.95, 0.98):  # the vertex comes near the opposite face of one of its elements
        points[inner] = (1 - part) * mesh.points[inner] + part * opposite.mean(axis=0)
        flat = Mesh(points, mesh.tets, {})
        if flat.quality.minimum < FLAT_ELEMENT:
            break
    (sentence,) = of_mesh(flat, design)
    assert f"radius ratio of {flat.quality.minimum:.2g}" in sentence
    assert f"near {position_text(flat.quality.position)}, where" in sentence
    assert sentence.endswith("look for a small edge or a thin gap of the body there, or mesh it with another size")


@pytest.mark.parametrize(("height", "free"), [(8.0, 0), (6.0, 32)], ids=["all of the end", "a part of it"])
def test_a_clamp_that_is_a_part_of_its_end_is_named(height: float, free: int) -> None:
    """Of the end face of 8 mm times 16 mm the uppermost 2 mm have no name."""
    filled = np.ones((3, 3, 3), dtype=bool)
    filled[1, 1, 1] = False
    mesh = bricks(filled, [np.array([0.0, 2, 18, 20]), np.array([0.0, 2, 6, 8]), np.array([0.0, 2, 14, 16])])
    clamp = on_plane(mesh, 0, 0.0) & (mesh.points[mesh.boundary, 1] <= height).all(axis=1)
    rest = {"tip": on_plane(mesh, 0, 20.0), "sym": on_plane(mesh, 2, 0.0), "cavity": on_plane(mesh, 0, 18.0)}
    sentence = of_clamp(Body(named(mesh, clamp=clamp, **rest), "bar", 20.0, 2.0, 0.0))
    assert (f"leaves out {free} of 128 mm2 in its plane" in sentence) if free else sentence == ""


@pytest.mark.parametrize("layer", [0, 1])
def test_a_cavity_that_is_mirrored_is_named(layer: int) -> None:
    """In a half of 0 <= z <= 8 mm the cavity reaches from the plane of symmetry to 2 mm, or from 2 to 6 mm."""
    filled = np.ones((3, 3, 3), dtype=bool)
    filled[1, 1, layer] = False
    mesh = bricks(filled, [np.array([0.0, 2, 18, 20]), np.array([0.0, 2, 6, 8]), np.array([0.0, 2, 6, 8])])
    ends = {"clamp": on_plane(mesh, 0, 0.0), "tip": on_plane(mesh, 0, 20.0), "sym": on_plane(mesh, 2, 0.0)}
    outer = np.logical_or.reduce([*(on_plane(mesh, axis, value) for axis, value in ((1, 0.0), (1, 8.0), (2, 8.0)))])
    cavity = ~np.logical_or.reduce([*ends.values(), outer])
    body = Body(named(mesh, **ends, cavity=cavity, outer=outer), "bar", 20.0, 2.0, 0.0)
    assert bool(of_half(body)) is (layer == 1)
    if layer:
        assert of_half(body).startswith("of the half z >= 0 of the body, cavity does not reach the plane z = 0")


def test_a_body_that_is_not_longest_along_x_is_named(tmp_path: Path) -> None:
    def upright(occ: Any) -> Any:
        solids = bar(occ)
        occ.rotate(solids, 0, 0, 0, 0, 0, 1, np.pi / 2)  # x becomes y
        return solids

    path = str(save(tmp_path / "upright.step", upright))
    note = of_directions(CadFile(path, 1.5))
    assert note.startswith("the body is 12 mm long along x, ")
    assert "and 60 mm along y; if that is its length, turn it with geometry.axes: [y, x, -z]; all positions" in note
    assert of_directions(CadFile(path, 1.5, axes=("y", "-x", "z"))) == ""
    middle = str(save(tmp_path / "middle.step", lambda occ: occ.translate(upright(occ), 0, -30, 0)))
    sideways = of_directions(CadFile(middle, -6.0, axes=("x", "z", "-y"), symmetric=False))
    assert "60 mm along z; if that is its length, turn it with geometry.axes; all" in sideways
    assert of_directions(PneuNet(chambers=1, chamber_height=50.0)) == ""


def test_long_calls_are_told_of() -> None:
    def listener(remarks: list[str]) -> Any:
        return SimpleNamespace(remark=remarks.append)

    quick: list[str] = []
    slow: list[str] = []
    with remarks_while_waiting(listener(quick), "meshing the body", every=10.0):
        pass
    with remarks_while_waiting(listener(slow), "meshing the body", every=0.02):
        sleep(0.3)
    assert quick == []
    assert len(slow) > 1
    assert slow[0].startswith("meshing the body for 0.")
    count = len(slow)
    sleep(0.1)
    assert len(slow) == count, "nothing is told after the end"


@pytest.mark.parametrize(("size", "differs"), [("4 mm", True), ("2.8 mm", False)])
def test_a_mesh_that_does_not_follow_round_walls_is_named(size: str, differs: bool) -> None:
    """The suggested size is enough: curved edges tangle no element there."""
    config = load_config(CONFIGS / "bisected_circle.yaml", ["geometry.wall=0.3 mm", f"mesh.size={size}"])
    note = of_volume(Scene.meshed(config).body, config)
    assert bool(note) is differs
    if differs:
        assert note == (
            "the mesh has 4.7 % more material than the drawing, because elements of 4 mm cannot follow its round walls;"
            " give a smaller mesh.size, for example 2.8 mm, or leave it out"
        )


@pytest.mark.parametrize(
    ("law", "stretches", "sentence"),
    [
        ("{law: hencky, E: 1.2 MPa, nu: 0.495}", (0.75, 1.2), ""),
        ("{law: hencky, E: 1.2 MPa, nu: 0.495}", (0.65, 1.2), "Hencky's law describes rubber between stretches"),
        ("{law: hencky, E: 1.2 MPa, nu: 0.495}", (0.95, 1.35), "Hencky's law describes rubber between stretches"),
        (
            "{law: neo_hooke, mu: 0.4 MPa, nu: 0.495}",
            (0.6, 1.6),
            "the law of neo-Hooke describes rubber up to a stretch",
        ),
        ("{law: neo_hooke, mu: 0.4 MPa, nu: 0.495}", (0.5, 1.45), ""),
        ("{law: mooney_rivlin, c10: 0.2 MPa, c01: 0.02 MPa, nu: 0.495}", (0.7, 1.8), "of Mooney and Rivlin describes"),
        ("{law: yeoh, c10: 0.2 MPa, c20: 0.01 MPa, c30: 0 MPa, nu: 0.495}", (0.5, 2.0), ""),
    ],
)
def test_strains_beyond_those_for_which_a_law_describes_rubber(
    law: str, stretches: tuple[float, float], sentence: str
) -> None:
    notes = after_solving(solved(0.9, stretches, 0.01, f"material={law}"))
    assert len(notes) == bool(sentence)
    assert all(sentence in note for note in notes)


@pytest.mark.parametrize("command", ["mesh", "effects", "accuracy", "cell"])
def test_every_command_that_solves_tells_of_pressures_in_another_unit(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Begun(Exception):
        """The notes come before anything is solved."""

    def begins(*given: Any) -> None:
        raise Begun

    for name in ("effects_study.compare_effects", "accuracy.run.run_study", "cell.study.measure_law"):
        monkeypatch.setattr(f"pipeline.{name}", begins)
    result = CliRunner().invoke(
        app, [command, str(CONFIGS / "pneunet_coarse.yaml"), "--set", "pressures=[0.37 MPa]", "--out", str(tmp_path)]
    )
    assert isinstance(result.exception, Begun) is (command != "mesh")
    text = " ".join(result.output.split())
    assert "370 kPa on walls with a Young's modulus of 1.2 MPa" in text
    assert "check the units (kPa, MPa), or stay well below" in text
