"""The axes of a sweep, and the file that they stand in: products, pairs, ranges, Latin hypercubes, refusals."""

from pathlib import Path

import pytest

from pipeline.study.sweep.points import Point, PointResult
from pipeline.study.sweep.spec import points_of, read_sweep
from pipeline.values.errors import InputError

BASE = """
name: short
geometry: {family: pneunet, chambers: 4}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [5 kPa]
mesh: {size: 8 mm, formulation: p2p0, grading: off}
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    (tmp_path / "base.yaml").write_text(BASE, encoding="utf-8")
    return tmp_path / "sweep.yaml"


def sweep_of(file: Path, text: str):
    file.write_text(f"name: some\nbase: base.yaml\n{text}", encoding="utf-8")
    return read_sweep(file)


def test_axes_are_multiplied_the_last_one_fastest(file: Path) -> None:
    sweep = sweep_of(file, "axes: [geometry.wall: [1 mm, 2 mm], geometry.chambers: {from: 7, to: 9, number: 3}]")
    pairs = [tuple(setting.values()) for setting in sweep.settings]
    assert pairs == [("1 mm", 7), ("1 mm", 8), ("1 mm", 9), ("2 mm", 7), ("2 mm", 8), ("2 mm", 9)]
    assert sweep.run == ("whole",)


def test_keys_of_one_entry_change_together(file: Path) -> None:
    sweep = sweep_of(file, "axes: [{geometry.wall: [1 mm, 2 mm], mesh.size: [8 mm, 9 mm]}]")
    assert sweep.settings == (
        {"geometry.wall": "1 mm", "mesh.size": "8 mm"},
        {"geometry.wall": "2 mm", "mesh.size": "9 mm"},
    )


def test_a_range_is_in_the_unit_of_its_first_end(file: Path) -> None:
    sweep = sweep_of(file, "axes: [geometry.chamber_height: {from: 8 mm, to: 1.2 cm, number: 3}]")
    assert [setting["geometry.chamber_height"] for setting in sweep.settings] == ["8 mm", "10 mm", "12 mm"]


def test_a_latin_hypercube_has_one_value_in_every_part_and_follows_its_seed(file: Path) -> None:
    text = "latin_hypercube: {points: 20, seed: %d, axes: {geometry.wall: {from: 1 mm, to: 3 mm}, "
    text += "geometry.chambers: {from: 3, to: 7}}}"
    first, again, other = (sweep_of(file, text % seed).settings for seed in (1, 1, 2))
    assert first == again
    assert first != other
    walls = sorted(float(setting["geometry.wall"].removesuffix(" mm")) for setting in first)
    assert [int((wall - 1.0) / 2.0 * 20) for wall in walls] == list(range(20))
    chambers = [setting["geometry.chambers"] for setting in first]
    assert {type(number) for number in chambers} == {int}
    assert sorted(chambers) == [number for number in range(3, 8) for _ in range(4)]


def test_a_folder_depends_on_the_design_and_not_on_the_other_points(file: Path) -> None:
    few = points_of(sweep_of(file, "axes: [geometry.wall: [1 mm, 1.5 mm]]"), file.parent)
    many = points_of(sweep_of(file, "axes: [geometry.wall: [0.8 mm, 1 mm, 1.5 mm]]"), file.parent)
    assert [point.name for point in few] == [point.name for point in many[1:]]
    assert few[0].name.startswith("wall=1mm_")


def test_points_that_cannot_be_built_are_kept_with_their_reason(file: Path) -> None:
    axes = "axes: [geometry.wall: [1 mm, 4.5 mm], geometry.chamber_length: [8 mm, 12 mm]]"
    points = points_of(sweep_of(file, axes), file.parent)
    assert [type(point) for point in points] == [Point, Point, PointResult, Point]
    assert "wall" in points[2].reason


def test_a_point_whose_only_experiment_is_not_simulated_is_refused(file: Path) -> None:
    points = points_of(sweep_of(file, "run: I\naxes: [effects.gravity: [on, off]]"), file.parent)
    assert [type(point) for point in points] == [PointResult, Point]
    assert "nothing holds the weight" in points[0].reason


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("axes: [geometry.wal: [1 mm]]", "sweep.yaml: geometry.wal: unknown key"),
        ("axes: [geometry.wall: [1 kPa, 2 kPa]]", "sweep.yaml: geometry.wall: '1 kPa'"),
        ("axes: [geometry.wall: [1, 2]]", "geometry.wall: 1 has no unit"),
        ("axes: [geometry.wall: []]", "geometry.wall: is an empty list"),
        ("axes: []", "sweep.yaml: axes: holds no points"),
        ("run: cell", "sweep.yaml: axes: holds no points"),
        ("axes: [{}]", "axes[1]: holds no key"),
        ("axes: [geometry.wall: 1 mm]", "'1 mm' is neither a list"),
        ("axes: [geometry.wall: {from: 1 mm, to: 2 kPa, number: 2}]", "'2 kPa' is not a value"),
        ("axes: [geometry.wall: {from: 1 mm, to: 2 mm, number: 1}]", "number: 1 is not allowed"),
        ("axes: [{geometry.wall: [1 mm], mesh.size: [8 mm, 9 mm]}]", "geometry.wall has 1, mesh.size has 2"),
        ("axes: [geometry.wall: [1 mm], {geometry.wall: [2 mm]}]", "geometry.wall is on two axes"),
        ("set: {geometry.wall: 1 mm}\naxes: [geometry.wall: [1 mm]]", "set.geometry.wall: is on"),
        ("axes: [geometry.wall: {from: 1 mm, to: 2 mm, number: 100001}]", "from 2 to 100000"),
        ("run: IV\naxes: [geometry.wall: [1 mm]]", "allowed: whole, cell"),
        ("latin_hypercube: {points: 2, axes: {mesh.size: {from: 8 mm, to: 9 mm}}}", "'seed: 1'"),
        ("axes: {mesh.size: [8 mm]}", "for example [geometry.wall"),
        ("latin_hypercube: {points: 0, seed: 1, axes: {mesh.size: {from: 8 mm, to: 9 mm}}}", "allowed: above 0"),
        ("latin_hypercube: {points: 2, seed: 1, axes: {mesh.size: [8 mm]}}", "is not a range"),
        ("axis: [geometry.wall: [1 mm]]", "unknown key; did you mean 'axes'?"),
        ("base: nowhere.yaml\naxes: [geometry.wall: [1 mm]]", "key 'base' given twice"),
        ("axes: [geometry.wall: [4.5 mm]]", "every point of"),
        ("run: {a: b}\naxes: [geometry.wall: [1 mm]]", "run: {'a': 'b'}"),
        ("run: [[II]]\naxes: [geometry.wall: [1 mm]]", "run: [['II']] is not allowed"),
        ("axes: [{3: [1 mm]}]", "axes[1]: 3 is not a"),
        ("axes: [geometry.wall: [2020-01-01]]", "geometry.wall: '2020-01-01' is no"),
        ("axes: [geometry.wall: [1 mm, .nan]]", "geometry.wall: nan is not"),
        ("axes: [geometry.wall: {from: .nan, to: 2.0, number: 3}]", "geometry.wall: nan is not"),
        ("set: {mesh.size: [.inf]}\naxes: [geometry.wall: [1 mm]]", "set.mesh.size: inf is not"),
    ],
)
def test_a_wrong_sweep_is_refused_in_one_sentence(file: Path, text: str, sentence: str) -> None:
    with pytest.raises(InputError) as refused:
        points_of(sweep_of(file, text), file.parent)
    assert sentence in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_base_that_does_not_exist_is_named_with_its_key(file: Path) -> None:
    file.write_text("name: some\nbase: nowhere.yaml\naxes: [geometry.wall: [1 mm]]", encoding="utf-8")
    with pytest.raises(InputError, match=r"sweep.yaml: base: .*nowhere.yaml: no such file"):
        read_sweep(file)


def test_a_product_that_is_too_large_is_refused(file: Path) -> None:
    axis = "{from: 1 mm, to: 2 mm, number: 1000}"
    with pytest.raises(InputError, match="has 1000000 points"):
        sweep_of(file, f"axes: [geometry.wall: {axis}, geometry.roof: {axis}]")
