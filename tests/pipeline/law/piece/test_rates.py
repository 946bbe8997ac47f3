"""Derivatives of an arm's own law by its design."""

import json
from dataclasses import fields, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from geometry import PneuNet
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.law.cells import cell_at
from pipeline.law.ends import CLAMP, TIP, end_at
from pipeline.law.mesh_limit import Corrections, across_on, corrected
from pipeline.law.piece import in_space, measure
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.rates import law_rates, material_steps
from pipeline.law.piece.tasks import PieceCurves
from pipeline.results.laws import law_of_record, law_record
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from rod import ArmLaw, RodError
from rod.arm_law.curves import ACROSS

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent.parent / "configs"
#: kPa, at which the walls of the cell touch when it is straightened, and its curvature there, 1/mm
PRESSURE, BEND = 20.0, -0.012
#: mm
CHANGE = 0.01
#: error of the curves of laws whose difference is a small one
FINE = 3e-4
#: its mesh
COARSER = "mesh.size=5 mm"


def config(*settings: str) -> Config:
    known = ["geometry.chambers=4", "mesh.size=4 mm", "law_in_space=true"]
    return load_config(CONFIGS / "pneunet_coarse.yaml", [*known, *settings])


@cache
def pieces(*settings: str) -> ArmPieces:
    return ArmPieces(config(*settings), 0.04).with_derivatives()


def law_at_one_pressure(arm: ArmPieces, pressure: float = PRESSURE, error: float = measure.TOLERANCE) -> ArmLaw:
    with (
        TemporaryDirectory() as folder,
        open_store(folder, arm.config) as store,
        pytest.MonkeyPatch.context() as patch,
    ):
        patch.setattr(measure, "TOLERANCE", error)
        patch.setattr(in_space, "STATES", 99)  # rigidities of all states, none between others
        curves = PieceCurves(arm, store, Silent())
        cell = cell_at(curves, pressure, BEND)
        clamp, tip = (end_at(curves, end, cell.curve, 1) for end in (CLAMP, TIP))
    made = arm.repetition
    law = ArmLaw(2.0 * made.half_pitch, made.middle, arm.design.length, (cell.curve,), (clamp.curve,), (tip.curve,))
    return replace(law, rates=law_rates(arm.config, made, arm.movements, [cell], [clamp]))


@cache
def law() -> ArmLaw:
    return law_at_one_pressure(pieces())


@cache
def fine_law() -> ArmLaw:
    """Whose states lie so near to each other that small differences of laws are those of the arms."""
    return law_at_one_pressure(pieces(COARSER), error=FINE)


def test_by_the_modulus_as_moments_and_pressures_scale() -> None:
    """All moduli times c at p times c: the moments times c, and the same stretches and rotations."""
    cell, clamp, rate = law().cells[0], law().clamps[0], law().rates["material.E"]
    assert cell.contact.any()
    assert not cell.contact.all()
    expected = (cell.moment - PRESSURE * cell.moment_by_pressure) / rate.value
    assert rate.cells[0].moment == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())
    expected = -PRESSURE * cell.stretch_by_pressure / rate.value
    assert rate.cells[0].stretch == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())
    turned = clamp.moment * clamp.rotation_by_moment + PRESSURE * clamp.rotation_by_pressure
    # interpolated between the states of the cell
    assert rate.clamps[0].rotation == pytest.approx(-turned / rate.value, abs=0.03 * np.abs(turned).max())
    assert (rate.value, rate.unit, rate.length) == (1.2, "MPa", 0.0)


def test_moduli_times_a_factor_need_no_finite_elements() -> None:
    """A law of half the modulus, solved at half the pressure, is the law of the arm scaled by one half."""
    softer = ArmPieces(config("material.E=0.6 MPa"), 0.04).with_derivatives()
    solved, scaled = law_at_one_pressure(softer, 0.5 * PRESSURE), law().scaled(0.5)
    curves = [(law.cells[0], law.clamps[0], law.tips[0]) for law in (solved, scaled, law())]
    for own, by_factor, known in zip(*curves, strict=True):
        for field in fields(own):
            expected, old = getattr(own, field.name), getattr(known, field.name)
            assert getattr(by_factor, field.name) == pytest.approx(
                expected, rel=1e-9, abs=1e-9 * np.abs(old).max(initial=0.0)
            )
    for name, rate in solved.rates.items():
        other = scaled.rates[name]
        assert other.value == pytest.approx(rate.value)
        for own, by_factor in ((rate.cells[0], other.cells[0]), (rate.clamps[0], other.clamps[0])):
            for field in fields(own):
                expected = getattr(own, field.name)
                close = pytest.approx(expected, rel=1e-5, abs=1e-6 * np.abs(expected).max())
                assert getattr(by_factor, field.name) == close


@pytest.mark.parametrize("name", ["wall", "chamber_length"])
def test_by_a_dimension_as_laws_of_moved_meshes_differ(name: str) -> None:
    here, known = fine_law(), pieces(COARSER)

    def moved(change: float) -> ArmLaw:
        design, movement = known.design, known.movements[name]
        changed = design.with_dimension(name, design.dimensions[name] + change)
        mesh = movement.moved(known.repetition, change)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(PneuNet, "repetition", lambda *_: mesh)  # instead of a mesh of its own
            return law_at_one_pressure(ArmPieces(replace(known.config, design=changed), 0.04), error=FINE)

    less, more = moved(-CHANGE), moved(CHANGE)
    key = f"geometry.{name}"
    ours = [here.with_changes({key: sign * CHANGE}) for sign in (-1.0, 1.0)]
    for number in (
        lambda one: one.at(PRESSURE).section.kappa_0,
        lambda one: float(one.cells[0].at(0.0)[1]),
        lambda one: float(one.at(PRESSURE).solve().theta[-1]),
        lambda one: float(one.at(PRESSURE).solve().y[-1]),
    ):
        expected = number(more) - number(less)
        assert number(ours[1]) - number(ours[0]) == pytest.approx(expected, rel=0.01)
    own, low, high, *changed = (np.array(list(across_on(one.cells[0]).values())) for one in (here, less, more, *ours))
    # the wall hardly changes B_2; curves between two states leave 3e-4 of it per mm
    assert (changed[1] - changed[0]) / own == pytest.approx((high - low) / own, rel=0.01, abs=4e-4 * 2.0 * CHANGE)
    rate = here.rates[key]
    assert rate.length == pytest.approx((more.length - less.length) / (2.0 * CHANGE), abs=1e-9)
    assert rate.pitch == pytest.approx((more.pitch - less.pitch) / (2.0 * CHANGE), abs=1e-9)


def test_in_the_limit_of_the_mesh_rigidities_out_of_the_plane_change_by_the_same_part() -> None:
    across = np.array([PRESSURE]), np.array([[0.9, 1.2]])
    moved = corrected(law(), Corrections(np.array([0.0]), np.zeros(1), np.full(1, 1.05), across))
    for key, rate in moved.rates.items():
        for name, factor in zip(ACROSS, (0.9, 1.2), strict=True):
            assert getattr(rate.cells[0], name) == pytest.approx(factor * getattr(law().rates[key].cells[0], name))
            assert getattr(moved.cells[0], name) == pytest.approx(factor * getattr(law().cells[0], name))


def test_the_file_holds_them() -> None:
    again = law_of_record(json.loads(json.dumps(law_record(law()))))
    assert list(again.rates) == list(law().rates)
    ours, theirs = (one.derivative("geometry.wall") for one in (law(), again))
    assert np.array_equal(ours["kappa_0"], theirs["kappa_0"])
    assert np.array_equal(ours["torsional_rigidity"], theirs["torsional_rigidity"])
    assert 0.0 < ours["torsional_rigidity"][0] < law().cells[0].torsional_rigidity.max()
    assert (law().rate("geometry.wall").value, law().rate("geometry.wall").unit) == (1.0, "mm")
    assert ours["end_angle"][0] > 0.0  # a thicker wall bends less, and the angle is negative


def test_a_parameter_without_derivatives_is_named() -> None:
    with pytest.raises(RodError, match=r"geometry\.walls.*geometry\.wall"):
        law().derivative("geometry.walls")
    with pytest.raises(RodError, match="finite"):
        law().with_changes({"geometry.wall": float("nan")})


def test_constants_of_all_materials_are_parameters() -> None:
    material = "material={law: ogden, mu: [0.3 MPa, -0.1 MPa], alpha: [2, -2], kappa: 20 MPa}"
    region = "materials={base: {law: svk, E: 5 MPa, nu: 0.49}}"
    steps = material_steps(config(material, region))
    terms = {f"material.{name}.{k}" for name in ("mu", "alpha") for k in (1, 2)}
    assert set(steps) == terms | {"material.kappa", "materials.base.E", "materials.base.nu"}
    step = steps["materials.base.E"]
    assert (step.value, step.unit) == (5.0, "MPa")


def test_by_the_scale_of_a_body_from_a_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of all three axes by s: moments s^3 M(s kappa), and lengths of the clamped end s times as large."""
    arm = config()
    monkeypatch.setattr(PneuNet, "is_from_file", True)
    monkeypatch.setattr(PneuNet, "file", "arm.step", raising=False)
    scaled = law_at_one_pressure(ArmPieces(arm, None).with_derivatives())
    cell, clamp = scaled.cells[0], scaled.clamps[0]
    rates = [scaled.rates[f"geometry.scale_{axis}"] for axis in "xyz"]
    assert [rate.unit for rate in rates] == ["1"] * 3

    def total(part: str, name: str) -> np.ndarray:  # type: ignore[type-arg]
        return np.sum([getattr(getattr(rate, part)[0], name) for rate in rates], axis=0)

    expected = 3.0 * cell.moment + cell.kappa * cell.rigidity
    assert total("cells", "moment") == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())
    assert total("cells", "stretch") == pytest.approx(cell.kappa * cell.stretch_by_kappa, abs=1e-6)
    assert total("cells", "ripple")[:, 1] == pytest.approx(
        cell.ripple[:, -1] + cell.kappa[:, None] * np.gradient(cell.ripple[:, -1], cell.kappa, axis=0), abs=1e-2
    )
    # interpolated between the states of the cell
    assert total("clamps", "rotation") == pytest.approx(-3.0 * clamp.moment * clamp.rotation_by_moment, abs=2e-3)
    expected = clamp.offset - 3.0 * clamp.moment[:, None] * clamp.offset_by_moment
    assert total("clamps", "offset") == pytest.approx(expected, abs=2e-2)
    assert sum(rate.length for rate in rates) == pytest.approx(scaled.length)
