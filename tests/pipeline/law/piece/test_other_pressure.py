"""A cell and a clamped end with two cavities under pressure: symmetry, and slopes by the pressure of one of them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.config.document import read_document
from pipeline.config.load import load_config
from pipeline.law.piece import measure_clamp
from pipeline.law.piece.measure import CellPoint, cell_without_moment, straight_curve
from pipeline.law.piece.measure_clamp import clamp_without_moment
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.rows import read_pairs
from tests.quotients import quotient
from tests.step_bodies import box, save

DESIGN = """
name: two
geometry: {family: bisected_circle, length: 40 mm, radius: 7 mm, divider: 2 mm}
material: {law: neo_hooke, mu: 0.2 MPa, nu: 0.495}
pressures: [10 kPa]
mesh: {size: 6 mm}
"""
PRESSURE = 0.01  #: MPa


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("two") / "two.yaml"
    path.write_text(DESIGN, encoding="utf-8")
    return path


def pieces(file: Path, first: float, second: float, by_cavity: bool = True) -> ArmPieces:
    fractions = f"effects.pressure.cavities={{cavity: {first:.17g}, cavity_lower: {second:.17g}}}"
    return ArmPieces(load_config(file, [fractions, f"law_by_cavity={str(by_cavity).lower()}"]), None)


def free(file: Path, first: float, second: float) -> CellPoint:
    return cell_without_moment(pieces(file, first, second).cell, PRESSURE)


def test_which_cavity_has_the_other_pressure(file: Path) -> None:
    others = [pieces(file, *fractions).other for fractions in ((1.0, 0.0), (1.0, 1.0), (0.3, 1.0))]
    assert others == ["cavity_lower", "cavity_lower", "cavity"]
    assert pieces(file, 1.0, 0.5, by_cavity=False).other == ""


def test_equal_pressures_leave_the_arm_straight_and_swapped_ones_bend_it_the_other_way(file: Path) -> None:
    alone, both, mixed, swapped = (free(file, *f) for f in ((1.0, 0.0), (1.0, 1.0), (1.0, 0.4), (0.4, 1.0)))
    assert alone.state.angle < 0.0
    # the mesh is no mirror image of itself
    assert abs(both.state.angle) < 0.02 * abs(alone.state.angle)
    assert swapped.state.angle == pytest.approx(-mixed.state.angle, rel=0.02)
    assert swapped.axis.stretch == pytest.approx(mixed.axis.stretch, abs=1e-5)


@pytest.mark.usefixtures("solved_tightly")
def test_slopes_by_one_pressure_are_those_of_cells_with_more_of_it(file: Path) -> None:
    part, step = 0.4, 0.01
    here = free(file, 1.0, part)
    cells = [pieces(file, 1.0, part + sign * step).cell for sign in (1.0, -1.0)]
    near = [cell_without_moment(cell, PRESSURE).state for cell in cells]
    at = [
        CellPoint.of(cell, cell.solve(PRESSURE, here.state.angle, state))
        for cell, state in zip(cells, near, strict=True)
    ]
    width = 2.0 * step * PRESSURE
    angles = [here.state.angle + sign * 1e-4 for sign in (1.0, -1.0)]
    cell = pieces(file, 1.0, part).cell
    bent = [CellPoint.of(cell, cell.solve(PRESSURE, angle, free(file, 1.0, part).state)) for angle in angles]
    more, less = (point.volumes for point in bent)
    of_first, of_second = (less - more) / 2e-4
    assert of_second == pytest.approx(here.slopes.moment_by_other, rel=1e-3)
    assert of_first + part * of_second == pytest.approx(here.slopes.moment_by_pressure, rel=1e-3)
    by_moment, by_stretch = (
        quotient(more, less, width)
        for more, less in ((at[0].moment, at[1].moment), (at[0].axis.stretch, at[1].axis.stretch))
    )
    assert here.slopes.moment_by_other == by_moment.within(rel=1e-4)
    assert here.axis.stretch_by_other == by_stretch.within(rel=1e-4)


def test_the_slope_of_the_clamped_end_by_one_pressure(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measure_clamp, "NEARLY_STRAIGHT", 1e-8)
    part, step = 0.4, 0.01
    rotations, slopes = [], []
    for fraction in (part - step, part, part + step):
        own = pieces(file, 1.0, fraction)
        end = clamp_without_moment(own.end(1, "clamp"), straight_curve(own.cell, 1000.0 * PRESSURE, 0.01))
        rotations.append(float(end.rotation[0]))
        slopes.append(float(end.rotation_by_other[0]))
    by_difference = (rotations[2] - rotations[0]) / (2.0 * step * 1000.0 * PRESSURE)
    assert slopes[1] == pytest.approx(by_difference, rel=0.01)


def test_derivatives_by_one_pressure_change_nothing_else(file: Path) -> None:
    curves = [straight_curve(pieces(file, 1.0, 0.0, by_cavity=on).cell, 10.0, 0.01) for on in (True, False)]
    assert len(curves[0].moment_by_other) == 2
    assert not curves[1].moment_by_other.size
    for name in ("moment", "kappa", "rigidity", "moment_by_pressure", "stretch", "axial_rigidity", "ripple"):
        assert np.array_equal(getattr(curves[0], name), getattr(curves[1], name))


def test_a_body_from_a_step_file_takes_pairs(tmp_path: Path) -> None:
    """A bar with a cavity above and one below a wall in its middle."""

    def bar(occ: Any) -> None:
        air = [box(occ, (3, low, -4), (57, low + 4, 4)) for low in (1, -5)]
        occ.cut([box(occ, (0, -6, -5), (60, 6, 5))], air)

    save(tmp_path / "bar.step", bar)
    geometry = "{family: own, file: bar.step, clamp: 0 mm, tip: 60 mm, curve: 0 mm, cell: {from: 30 mm, to: 35 mm},"
    air = "air: {upper: [30 mm, 3 mm, 0 mm], lower: [30 mm, -3 mm, 0 mm]}}"
    text = f"name: bar\ngeometry: {geometry} {air}\nmaterial: {{law: neo_hooke, mu: 0.2 MPa, nu: 0.495}}\n"
    path = tmp_path / "bar.yaml"
    path.write_text(f"{text}pressures: [[10 kPa, 4 kPa], [4 kPa, 10 kPa]]\nmesh: {{size: 6 mm}}\n", encoding="utf-8")
    spec = read_pairs(read_document(path))
    assert spec.cavities == ("upper", "lower")
    one, other = (
        cell_without_moment(ArmPieces(spec.config(direction, pressures), None).cell, PRESSURE)
        for direction, pressures in spec.rays.items()
    )
    assert one.state.angle < 0.0
    assert other.state.angle == pytest.approx(-one.state.angle, rel=0.02)
