"""The rod with a law of two curvatures against arcs, beams and itself turned about its axis."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
import pytest

import pneurod
from geometry.arrays import Array
from pipeline.results import laws
from pipeline.results.laws import law_of_record, law_record
from rod import Rod, RodError, Support
from rod.arm_law import kinds, space_rod
from rod.arm_law.kinds import along
from rod.arm_law.polynomial import Basis, Polynomial, exponents_up_to
from rod.arm_law.space_law import SpaceLaw
from rod.frames import rotation
from rod.load import Load
from rod.same_pressure import Pressures, pressures_of
from rod.weight import Mass
from tests.quotients import SOLVED, quotient

LENGTH, EA, GJ, GA = 80.0, 40.0, 120.0, 5.0
RIGIDITY = np.array([[300.0, 20.0], [20.0, 200.0]])
#: 1/mm per kPa of each of three cavities
BENDS = np.array([[0.0, -5e-4], [4e-4, 2e-4], [-4e-4, 3e-4]])


def polynomial(columns: dict[tuple[int, ...], float], count: int, scale: Array) -> Polynomial:
    """One column, from coefficients by the powers of unscaled variables."""
    powers = exponents_up_to(max(sum(key) for key in columns), count)
    values = [columns.get(tuple(row), 0.0) * np.prod(scale**row) for row in powers.tolist()]
    return Basis(powers, scale).times(np.array(values)[:, None])


def constant(values: list[float], count: int) -> Polynomial:
    return Basis(np.zeros((1, count), np.intp), np.ones(count)).times(np.array([values]))


def law(stretch_slope: float = 0.0, cubic: float = 0.0, turn: float = 0.0) -> SpaceLaw:
    """w = (kappa - p BENDS) B (kappa - p BENDS) / 2 + cubic kappa_z^3, in sections that are turned about x."""
    scale = np.array([0.01, 0.01, 10.0, 10.0, 10.0])
    onto = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    B = onto.T @ RIGIDITY @ onto
    coupled = BENDS @ onto @ B  # moments at kappa = 0 by each pressure
    w = {(2, 0, 0, 0, 0): B[0, 0] / 2, (1, 1, 0, 0, 0): B[0, 1], (0, 2, 0, 0, 0): B[1, 1] / 2, (0, 3, 0, 0, 0): cubic}
    for k in range(3):
        unit = [int(i == k) for i in range(3)]
        w[1, 0, unit[0], unit[1], unit[2]], w[0, 1, unit[0], unit[1], unit[2]] = -coupled[k]
    stretch = {(0, 0, 0, 0, 0): 1.0, (0, 1, 0, 0, 0): stretch_slope, (0, 0, 1, 0, 0): 1e-3}
    return SpaceLaw(
        cavities=("a", "b", "c"),
        pressures=10.0 * np.eye(3),
        onto=np.eye(3),
        pitch=10.0,
        length=LENGTH,
        clamp_length=15.0,
        reach=0.03,
        error=1e-3,
        potential=polynomial(w, 5, scale),
        stretch=polynomial(stretch, 5, scale),
        axial_rigidity=constant([EA], 5),
        compliance=constant([1 / GJ, 0.0, 0.0, 1 / GA, 0.0, 1 / GA], 3),
        volume=constant([30.0] * 3, 5),
        clamp=constant([0.0] * 9, 5),
        tip=constant([0.0] * 6, 3),
    )


def test_without_load_it_is_an_arc_about_the_direction_of_its_curvature() -> None:
    pressures = (4.0, 3.0, 1.0)
    rod = law().at(pressures)
    kappa = np.array(pressures) @ BENDS
    assert rod.kappa_0 == pytest.approx(kappa, abs=1e-12)
    size, stretch = float(np.linalg.norm(kappa)), 1.0 + 1e-3 * pressures[0]
    across = np.array([kappa[1], -kappa[0]]) / size  # (0, k_y, k_z) x e_x
    angle = size * LENGTH
    expected = stretch / size * np.array([np.sin(angle), *((1 - np.cos(angle)) * across)])
    found = rod.solve_in_space(Load())
    assert np.array(found.end) == pytest.approx(expected, abs=1e-6)
    assert found.bending_deg == pytest.approx(np.degrees(angle), abs=1e-5)
    assert found.stability.lowest == pytest.approx(1.0, abs=1e-6)


def test_a_small_force_bends_it_as_a_beam_of_timoshenko() -> None:
    rod, force = law().at((0.0, 0.0, 0.0)), 1e-5
    soft = np.linalg.inv(RIGIDITY)
    for fy, fz in ((force, 0.0), (0.0, force)):
        _, y, z = rod.solve_in_space(Load((0.0, fy, fz))).end
        # M_z = F_y (l - s) bends towards y, M_y = -F_z (l - s) towards -z
        about_y, about_z = soft @ [-fz, fy]
        expected = LENGTH**3 / 3 * np.array([about_z, -about_y]) + LENGTH / GA * np.array([fy, fz])
        assert np.array([y, z]) == pytest.approx(expected, rel=1e-5, abs=1e-6 * force)


def test_a_turned_law_gives_the_turned_shape() -> None:
    load, turn, pressures = np.array([-0.01, 0.02, 0.03]), 0.8, (5.0, 2.0, 0.0)
    onto = rotation(np.array([turn, 0.0, 0.0]))
    own = law().at(pressures).solve_in_space(Load(tuple(load))).end
    turned = law(turn=turn).at(pressures).solve_in_space(Load(tuple(onto @ load))).end
    assert turned == pytest.approx(onto @ own, abs=1e-6)


def test_forces_have_a_potential_where_the_stretch_follows_the_curvature() -> None:
    rod = law(stretch_slope=3.0, cubic=2000.0).at((5.0, 2.0, 0.0))
    base, step = np.array([0.02, 0.01, -0.02]), 1e-4

    more, less = ([rod.solve_in_space(Load(tuple(base + s * step * one))).end for one in np.eye(3)] for s in (1, -1))
    compliance = quotient(more, less, 2 * step, SOLVED)
    largest = float(np.abs(compliance.value).max())
    assert compliance.within(abs=1e-4 * largest) == compliance.value.T
    assert np.abs(compliance.value[0, 1:]).max() > 0.01 * largest


def test_the_limit_of_the_elements_converges_with_the_fourth_power(monkeypatch: pytest.MonkeyPatch) -> None:
    ends = []
    monkeypatch.setattr(space_rod, "LONGEST", 1.0)
    for element in (0.8, 0.4, 0.2, 0.1):
        monkeypatch.setattr(space_rod, "ELEMENT", element)
        ends.append(law(0.3, 2e3, 0.4).at((4.0, 3.0, 1.0)).solve_in_space(Load((0.0, 0.02, 0.02))).end)
    differences = np.abs(np.diff(np.array(ends), axis=0)).max(axis=1)
    assert np.log2(differences[:-1] / differences[1:]) == pytest.approx(4.0, abs=0.3)


def test_the_air_is_minus_the_derivative_of_the_potential_by_the_pressures() -> None:
    """That of cells along the arm, in mm2 with pressures in MPa, and what its ends have besides."""
    made = law(cubic=2000.0)
    basis = made.potential
    by_pressure = np.hstack([made.potential.by(2 + k, basis) for k in range(3)])
    clamp, tip = constant([0.0] * 6 + [1.0, 2.0, 3.0], 5), constant([0.0] * 3 + [10.0, 20.0, 30.0], 3)
    volume = basis.times(-1e3 * by_pressure)
    rod = replace(made, volume=volume, clamp=clamp, tip=tip).at((5.0, 2.0, 0.0))
    state = rod.solve_in_space(Load((0.0, 0.02, 0.03)))
    along = np.trapezoid(1e3 * state.curvature[:, 1:] @ RIGIDITY @ BENDS.T, state.s, axis=0)
    assert rod.volumes(state) == pytest.approx(along + np.array([11.0, 22.0, 33.0]), rel=1e-9)


def test_an_end_that_is_held_gives_the_force_that_brings_it_there() -> None:
    rod, force = law().at((5.0, 2.0, 0.0)), (0.01, 0.02, -0.01)
    end = rod.solve_in_space(Load(force)).end
    held = Load(supports=(Support(rod.length, *end),))
    assert rod.solve_in_space(held).force == pytest.approx(force, rel=1e-5)


def test_the_file_gives_the_same_rod() -> None:
    made = law(stretch_slope=2.0)
    again = law_of_record(law_record(made))
    load = Load((0.01, 0.02, 0.03))
    assert again.at((5, 2, 0)).solve_in_space(load).end == made.at((5, 2, 0)).solve_in_space(load).end
    record = law_record(made)
    with pytest.raises(ValueError, match="must have the air of each cavity"):
        law_of_record({**record, "volume": record["stretch"]})
    del record["tip"]
    with pytest.raises(ValueError, match="tip"):
        law_of_record(record)


@dataclass(frozen=True)
class Alone:
    """A kind of law that is added: the same arm over the pressure of its first cavity."""

    kind: ClassVar[str] = "alone"
    has_plane: ClassVar[bool] = False
    plane: ClassVar[None] = None
    cavities: ClassVar[tuple[str, ...]] = ("the arm",)
    fractions: ClassVar[dict[str, float]] = {"the arm": 1.0}
    ratios: ClassVar[tuple[Pressures, ...]] = ()
    notes: ClassVar[tuple[str, ...]] = ()
    length: Annotated[float, "length_mm"]
    highest: Annotated[float, "highest_kPa"]
    mass: Annotated[Mass | None, "mass"] = None

    @property
    def rows(self) -> tuple[Pressures, ...]:
        return (0.0,), (self.highest,)

    def at(self, pressures: float | Sequence[float]) -> space_rod.SpaceRod:
        return law().at((*pressures_of(pressures, self.cavities), 0.0, 0.0))


def test_a_kind_of_law_that_is_added_is_read_and_bends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(laws, "Saved", kinds.Saved | Alone)
    record = law_record(Alone(LENGTH, 5.0))  # type: ignore[arg-type]
    (tmp_path / "law.json").write_text(json.dumps(record), encoding="utf-8")
    found = pneurod.shape(tmp_path / "law.json", "4 kPa").shape
    assert found.end == law().at((4.0, 0.0, 0.0)).solve_in_space(Load()).end
    tip = [f"{value} mm" for value in found.end]
    (pressure,) = pneurod.solve(tmp_path / "law.json", tip=f"[{', '.join(tip)}]").solutions
    assert pressure.pressure_kPa == pytest.approx(4.0, rel=1e-6)
    (bent,) = pneurod.solve(tmp_path / "law.json", angle=f"{found.bending_deg} deg").solutions
    assert (bent.pressure_kPa, bent.angle_deg) == pytest.approx((4.0, found.bending_deg), rel=1e-5)
    with pytest.raises(pneurod.InputError, match="this arm bends in space; give the place of its tip as x, y and z"):
        pneurod.solve(tmp_path / "law.json", tip="[70 mm, 0 mm]")


def test_its_weight_bends_it_as_an_even_load() -> None:
    """A cantilever of 2 g lies along x; the file keeps its mass."""
    made = law_of_record(law_record(replace(law(), mass=Mass.even(LENGTH, 2.0))))
    rod = Rod(LENGTH, law=made.at((0.0, 0.0, 0.0)))
    end = rod.solve(direction=(0.0, 0.0, -1.0)).end
    force = -2e-3 * 9.81 / 100  # N, of a hundredth of the weight; it is linear there
    light = Rod(LENGTH, law=replace(made, mass=Mass.even(LENGTH, 0.02)).at((0.0, 0.0, 0.0)))
    about_y, about_z = np.linalg.inv(RIGIDITY) @ [-force, 0.0]
    expected = LENGTH**3 / 8 * np.array([about_z, -about_y]) + LENGTH / 2 / GA * np.array([0.0, force])
    assert np.array(light.solve(direction=(0.0, 0.0, -1.0)).end)[1:] == pytest.approx(expected, rel=1e-3)
    assert 90 * expected[1] > end[2] > 110 * expected[1]


def test_as_a_rod() -> None:
    assert law().at((3.0, 3.0, 4.0)).pressures == (3.0, 3.0, 4.0)
    rod = Rod(LENGTH, law=law().at((5.0, 2.0, 0.0)))
    assert rod.solve(force=(0.0, 0.01)).end == rod.solve(force=(0.0, 0.01, 0.0)).end


def test_along_a_ratio_it_goes_as_far_as_its_rows() -> None:
    made = law()
    whole = along(made, made.rows[0])
    assert whole.rows == ((0.0,), (max(made.rows[0]),))
    assert (whole.fractions, whole.ratios) == (dict(zip(made.cavities, made.ratios[0], strict=True)), made.ratios)
    mixed = along(made, (1.0, 1.0, 0.0))
    ((highest,),) = mixed.rows[-1:]
    assert mixed.at(highest).pressures == (highest, highest, 0.0)
    with pytest.raises(RodError, match="are not between rows of the law"):
        mixed.at(1.01 * highest)
