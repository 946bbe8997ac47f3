"""Measured bodies: the folder of a case, and the bar of one of them by finite elements and as a rod."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from benchmarks.experiments.bar import FACTORS, Bar, BendingRod, Elements, Response
from benchmarks.experiments.cases import CASE, MEASURED, cases_in, read_case
from benchmarks.experiments.fitted_bar import BarNumbers, fit_bar
from benchmarks.experiments.judged import lines_of
from benchmarks.experiments.segment import GIVEN, curve, read_measured, threads
from fem import NeoHooke
from pipeline.values.errors import InputError

SHIPPED = Path("benchmarks/experiments")
#: mm, the point of the end of the segment that is followed, from the middle
OFF_AXIS = 8.3
#: N on the edge -> mm, height of the middle of the free face by COMSOL with E = 263.8 kPa: the mean of the published
#: heights of two points on its sides (srl-ethz/diffPD_sim2real, python/realbeam_experiments, utils.py)
COMSOL = {0.0: -6.7215, -0.51012: -16.5615, -1.00062: -25.687}


def test_every_shipped_case_is_read() -> None:
    cases = {case.name: case for case in cases_in(SHIPPED)}
    assert set(cases) == {"eth_beam", "eth_segment", "seed_pneunet"}
    bar = cases["eth_beam"]
    assert isinstance(bar.body, Bar)
    assert bar.length == 100.0
    assert len(bar.measured.rows) == 6
    assert sorted({number for rows in bar.calibrate_on for number in rows}) == [1, 2, 3, 4, 5, 6]


def test_the_rows_of_the_segment_are_the_motion_of_its_end() -> None:
    case = read_case(SHIPPED / "eth_segment")
    lines = (SHIPPED / "eth_segment" / MEASURED).read_text(encoding="utf-8").splitlines()
    told = [values for line in lines if line.startswith("#   ") and (values := line[1:].split())[0] != "kPa"]
    assert len(told) == len(case.measured.rows) == len(read_measured()) == 15
    for row, (pressure, distance, turn, aside) in zip(case.measured.rows, np.array(told, float), strict=True):
        assert row.state.pressure_kPa == pressure
        x = row.values["tip_x"] - 100.0 + OFF_AXIS * np.sin(np.radians(turn))
        y = row.values["tip_y"] + OFF_AXIS * (1.0 - np.cos(np.radians(turn)))
        assert float(np.linalg.norm([x, y, aside])) == pytest.approx(distance, abs=0.015)  # two digits are kept


def test_a_wound_segment_bears_pressures_at_which_one_without_loops_balloons() -> None:
    wound, bare = curve(threads(GIVEN)), curve("effects.hoops=off")
    assert (wound.highest, bare.highest) == (46.0, 14.0)
    assert "16 kPa" in bare.why
    assert wound.distance(20.0) == pytest.approx(14.0, abs=0.05)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"bar": None}, "either a bar or an arm"),
        ({"calibrate_on": [[7]]}, "from 1 to 6"),
        ({"licence": None}, "licence"),
        (
            {"bar": {"length": "100 mm", "height": "30 mm", "width": "30 mm", "material": {"law": "svk"}}},
            "bar.material",
        ),
    ],
)
def test_a_wrong_case_is_refused(tmp_path: Path, change: dict[str, object], named: str) -> None:
    content = yaml.safe_load((SHIPPED / "eth_beam" / CASE).read_text(encoding="utf-8")) | change
    written = {key: value for key, value in content.items() if value is not None}
    (tmp_path / CASE).write_text(yaml.safe_dump(written), encoding="utf-8")
    (tmp_path / MEASURED).write_bytes((SHIPPED / "eth_beam" / MEASURED).read_bytes())
    with pytest.raises(InputError, match=named):
        read_case(tmp_path)


def test_a_bar_bends_as_in_another_program() -> None:
    bar = Bar(100.0, 30.0, 30.0, NeoHooke.from_uniaxial({"mu": 0.2638 / 3.0}, 0.499), 1.07e-9)
    for force, height in COMSOL.items():
        (tip,) = Elements(7.5).tips(bar, (0.0, force), [1.0])
        assert tip.y_mm == pytest.approx(height, rel=0.01)
        (rod,) = BendingRod().tips(bar, (0.0, force), [1.0])
        assert rod.y_mm == pytest.approx(height, rel=0.03)  # it neither shears nor stretches


def test_a_bar_of_other_moduli_is_one_under_other_loads() -> None:
    soft, stiff = (Bar(100.0, 30.0, 30.0, NeoHooke.from_uniaxial({"mu": mu}, 0.499), 1.07e-9) for mu in (0.05, 0.1))
    response = Response(BendingRod(), soft, (0.0, -0.5))
    (tip,) = BendingRod().tips(stiff, (0.0, -0.5), [1.0])
    assert response.at(2.0) == pytest.approx(tip, rel=1e-4)
    with pytest.raises(ValueError, match="outside"):
        response.at(1.1 / FACTORS[0])


def test_one_load_foretells_the_others() -> None:
    case = read_case(SHIPPED / "eth_beam")
    numbers = BarNumbers(case, case.body, BendingRod())
    fitted = fit_bar(numbers, (5, 6))
    assert 3e3 * fitted.modulus * case.body.law.shear_modulus == pytest.approx(265.0, abs=10.0)  # kPa
    assert fitted.before.deflection > 0.5
    assert fitted.after.deflection < 0.05
    assert fitted.inside > 0.8


def test_a_bar_under_pressure_is_refused(tmp_path: Path) -> None:
    (tmp_path / CASE).write_bytes((SHIPPED / "eth_beam" / CASE).read_bytes())
    text = (SHIPPED / "eth_beam" / MEASURED).read_text(encoding="utf-8").replace("\n0,0,0,lying", "\n1,0,0,lying", 1)
    (tmp_path / MEASURED).write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="a bar lies"):
        list(lines_of(read_case(tmp_path), tmp_path, 1))
