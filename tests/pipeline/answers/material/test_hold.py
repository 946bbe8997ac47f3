"""Branches of relaxation from a specimen that is held, with noise."""

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from geometry.arrays import Array
from pipeline.answers.material.hold import Hold, read_hold
from pipeline.cli import app
from pipeline.values.errors import InputError

G: Array = np.array([0.10, 0.06])
TAU: Array = np.array([0.3, 20.0])
TIMES = 0.01 * np.arange(-5.0, 30001.0)  # s, at 100 Hz


def modulus(t: Array, g: Array = G, tau: Array = TAU) -> Array:
    return np.asarray(1.0 + np.exp(-np.maximum(t, 0.0)[:, None] / tau) @ g)


def compliance(t: Array) -> Array:
    """Strain under a load by small steps of the integral equation J * dG = 1."""
    steps = np.concatenate([[0.0], np.geomspace(1e-4, t[-1], 1500)])
    strain = np.zeros(len(steps))
    strain[0] = 1.0 / modulus(np.zeros(1))[0]
    for n in range(1, len(steps)):
        middle = 0.5 * (steps[:n] + steps[1 : n + 1])
        g = modulus(steps[n] - middle)
        known = strain[0] * modulus(steps[n : n + 1])[0] + g[:-1] @ np.diff(strain[:n])
        strain[n] = strain[n - 1] + (1.0 - known) / g[-1]
    return np.asarray(np.interp(np.maximum(t, 0.0), steps, strain))


def file(folder: Path, titles: str, values: Array, times: Array = TIMES) -> Path:
    rows = "\n".join(f"{t:.6g},{v:.8g}" for t, v in zip(times, values, strict=True))
    (folder / "hold.csv").write_text(f"{titles}\n{rows}\n")
    return folder / "hold.csv"


def noisy(values: Array, part: float = 0.003) -> Array:
    return np.asarray(values * (1.0 + part * np.random.default_rng(3).standard_normal(len(values))))


def off(found: Hold) -> float:
    """Largest difference of the relaxation from the true one, from 30 ms to 200 s."""
    t = np.geomspace(0.03, 200.0, 60)
    return float(np.abs(modulus(t, np.array(found.g), np.array(found.tau_s)) - modulus(t)).max())


def test_the_branches_of_a_held_stretch(tmp_path: Path) -> None:
    found = read_hold(file(tmp_path, "time (s),stress (kPa)", noisy(57.0 * modulus(TIMES))))
    assert off(found) < 0.01
    assert 0.0028 < found.misfit < 0.0042  # noise is 0.3 % of stresses that begin 16 % above the level
    assert sum(found.g) == pytest.approx(0.16, abs=0.02)
    assert found.words == [
        f"A stretch that is held loses {100.0 - 100.0 / (1.0 + sum(found.g)):.3g} % of its stress from 0.01 to 300 s; "
        f"branches describe it within {100.0 * found.misfit:.2g} %. The law is taken as that at long times."
    ]


def test_the_branches_of_a_strain_under_a_load(tmp_path: Path) -> None:
    found = read_hold(file(tmp_path, "t [min],strain [%]", noisy(12.0 * compliance(TIMES)), TIMES / 60.0))
    assert off(found) < 0.012


def test_a_press_in_compression_has_the_same_branches(tmp_path: Path) -> None:
    pulled = read_hold(file(tmp_path, "Zeit (s),Kraft (N)", 3.0 * modulus(TIMES)))
    assert read_hold(file(tmp_path, "Zeit (s),Kraft (N)", -3.0 * modulus(TIMES))) == pulled


def test_noise_makes_no_branches(tmp_path: Path) -> None:
    found = read_hold(file(tmp_path, "time (s),stress (kPa)", noisy(np.full(len(TIMES), 57.0))))
    assert sum(found.g) < 0.01


def test_a_loss_factor_that_no_rubber_has_is_named(tmp_path: Path) -> None:
    slips = modulus(TIMES, np.array([3.0]), np.array([1.0]))
    _, doubt = read_hold(file(tmp_path, "time (s),stress (kPa)", slips)).words
    assert doubt.startswith("The loss factor is 0.")
    assert "rubbers have less than 0.5" in doubt


@pytest.mark.parametrize(
    ("titles", "times", "complaint"),
    [
        ("time,stress (kPa)", TIMES, "column 'time' has no unit; write it as 'time \\(s\\)'"),
        ("time (s),temperature", TIMES, "no line names columns of a time and of a stress"),
        ("time (s),stress (kPa)", -TIMES, "times do not rise at 0.04 s"),
        ("time (s),stress (kPa)", TIMES - 300.0, "has 0 points after the time 0"),
    ],
)
def test_wrong_files_are_refused(tmp_path: Path, titles: str, times: Array, complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        read_hold(file(tmp_path, titles, np.ones(len(times)), times))


def test_the_command_writes_them_beside_the_law(configs: Path, tmp_path: Path) -> None:
    hold = file(tmp_path, "time (s),stress (kPa)", 57.0 * modulus(TIMES))
    tests = str(configs / "elastosil_m4601_yeoh.csv")
    result = CliRunner().invoke(app, ["material", tests, "--hold", str(hold), "--out", str(tmp_path / "m")])
    assert result.exit_code == 0, result.output
    assert "relaxation: [{g: " in result.output
    assert (tmp_path / "m" / "material.json").is_file()
