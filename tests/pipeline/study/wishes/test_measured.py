"""The file of a wish, the wanted numbers of designs, and their derivatives by what is free."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.store.store import open_store
from pipeline.study.wishes.measured import MovedMesh, NotBorne, store_of
from pipeline.study.wishes.spec import read_wishes
from pipeline.study.wishes.step import check_feasible
from pipeline.study.wishes.wish import WishFile, exact_limits, rounded
from tests.solved import alone

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent.parent / "configs"
SMALL = f"""
name: small
base: {CONFIGS}/semicircular_coarse.yaml
set: {{mesh.size: 6 mm, accuracy: off}}
free:
  geometry.wall: {{from: 0.7 mm, to: 1.6 mm}}
  geometry.base: {{from: 1.2 mm, to: 3 mm}}
  pressure.grip: {{from: 15 kPa, to: 30 kPa}}
wishes:
  - {{kappa_0: -0.6 1/m, at: 20 kPa, within: 2 %}}
  - {{tip: [40 mm, -2 mm], at: grip, within: 1 mm}}
  - {{angle: 4 deg, at: grip, within: 0.1 deg}}
  - {{stiffness: 10 N/m, at: grip, within: 2 %}}
  - {{force: 0.02 N, at: 20 kPa, at_height: 0 mm, within: 2 %}}
limits: {{largest_stretch: 1.3, mass: 30 g, smallest_wall: 0.5 mm}}
"""


def small(folder: Path, text: str = SMALL) -> WishFile:
    path = folder / "wish.yaml"
    path.write_text(text, encoding="utf-8")
    return read_wishes(path)


def test_derivatives_are_those_of_designs_that_were_measured(tmp_path: Path) -> None:
    """Central differences over 2 % of each dimension and pressure, on meshes that were moved."""
    file = small(tmp_path)
    point = file.wishes.start
    with alone(tmp_path / "out", file) as context:
        mesh = MovedMesh.of(file, point, context, is_fine=False)
        known = mesh.numbers(point)
        differences, stretches = [], []
        for k in range(len(point)):
            ends = [mesh.numbers(point * (1.0 + sign * 0.01 * np.eye(len(point))[k])) for sign in (-1.0, 1.0)]
            differences.append((ends[1].values - ends[0].values) / (0.02 * point[k]))
            stretches.append((ends[1].stretch - ends[0].stretch) / (0.02 * point[k]))
    expected = np.array(differences).T
    errors, sizes = np.abs(known.rates - expected * point), np.abs(expected * point)
    # derivatives of a law are exact but for the tip beside the axis and the rigidities against stretching and shear
    assert errors[0].max() < 1e-3 * sizes[0].max()
    for own, size in zip(*(file.wishes.parts(part) for part in (errors, sizes)), strict=True):
        assert own.max() < 0.1 * size.max()
    assert known.stretch_rates[:2] == pytest.approx(np.array(stretches[:2]) * point[:2], rel=0.05)


def test_stiffer_moduli_are_derivatives_by_the_material(tmp_path: Path) -> None:
    """Central differences over 4 % of the modulus, on the same mesh."""
    text = SMALL.replace("starts", "").replace("accuracy: off}", "accuracy: off, material.E: E MPa}")
    text = text.replace("0.1 deg}", "0.1 deg, under: {force: [0 N, -0.01 N]}}")
    ends = []
    for number, modulus in enumerate((1.2 * 0.98, 1.2, 1.2 * 1.02)):
        (tmp_path / str(number)).mkdir()
        file = small(tmp_path / str(number), text.replace("E MPa", f"{modulus} MPa"))
        with alone(tmp_path / str(number) / "out", file) as context:
            mesh = MovedMesh.of(file, file.wishes.start, context, is_fine=False)
            ends.append(mesh.numbers(file.wishes.start))
    expected = (ends[2].values - ends[0].values) / 0.04
    assert ends[1].by_stiffness == pytest.approx(expected, rel=0.02, abs=0.02 * np.abs(expected).max())


def test_a_margin_that_the_cell_does_not_bear_is_named(tmp_path: Path) -> None:
    file = small(tmp_path, SMALL.replace("limits: {", "limits: {bears: 40, "))
    with alone(tmp_path / "out", file) as context:
        mesh = MovedMesh.of(file, file.wishes.start, context, is_fine=False)
        with pytest.raises(NotBorne, match="kPa"):
            mesh.numbers(file.wishes.start)


def test_curves_of_a_design_are_kept_by_its_values_and_mesh(tmp_path: Path) -> None:
    file = small(tmp_path)
    point = file.wishes.start
    configs = [file.config(point * factor) for factor in (1.0, 1.1)]
    with open_store(tmp_path / "out", file) as store:
        stores = [store_of(store, configs[0]), store_of(store, configs[1]), store_of(store, configs[1], configs[0])]
        assert len({one.directory for one in stores}) == 3
        with open_store(tmp_path / "run", configs[0]) as of_run:
            assert of_run.numbers_key == stores[0].numbers_key  # a run takes its curves
    limits = exact_limits(file.wishes, configs[0])
    assert limits["smallest_wall"] == pytest.approx((0.5 / configs[0].design.thinnest_wall, 1.0))


def test_a_file_is_complete_values(tmp_path: Path) -> None:
    file = small(tmp_path)
    wishes = file.wishes
    assert wishes.dimensions == ("geometry.wall", "geometry.base")
    assert wishes.start.tolist() == [1.0, 2.0, 22.5]  # of the base, and the middle of a pressure
    assert wishes.pressures_kPa(wishes.start) == (20.0, 22.5)
    assert [len(part) for part in wishes.parts(np.arange(6.0))] == [1, 2, 1, 1, 1]
    kappa_0, tip = wishes.wishes[:2]
    assert (kappa_0.target, kappa_0.within) == ((-6e-4,), pytest.approx(1.2e-5))
    found = np.concatenate([wishes.targets[:1], [40.0, -4.0], wishes.targets[3:]])
    assert wishes.misses(found) == pytest.approx([0.0, 2.0, 0.0, 0.0, 0.0])
    assert tip.text(tip.target) == "(40, -2) mm"
    config = file.config(rounded(np.array([1.23456789, 2.0, 25.0])))
    assert config.design.dimensions["wall"] == 1.23457
    assert config.pressures_kPa == (20.0, 25.0)
    assert config.end.y_mm == 0.0
    assert config.name == "small"
    loaded = small(tmp_path, SMALL.replace("0.1 deg}", "0.1 deg, under: {force: [0 N, -0.1 N]}}")).wishes.wishes[2]
    assert loaded.under.force == (0.0, -0.1)
    assert loaded.name == "angle at grip under force [0 N, -0.1 N]"


def test_a_wish_within_the_tolerance_of_another_one_and_wide_limits_are_feasible(tmp_path: Path) -> None:
    check_feasible(small(tmp_path))
    check_feasible(
        small(tmp_path, SMALL.replace("limits:", "  - {kappa_0: -0.62 1/m, at: 20 kPa, within: 2 %}\nlimits:"))
    )
