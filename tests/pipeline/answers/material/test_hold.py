"""Branches of relaxation from a specimen that is held, with noise."""

from pathlib import Path

import numpy as np
import pytest

from geometry.arrays import Array
from pipeline.answers.material.hold import Hold, read_hold
from pipeline.values.errors import InputError
from rod.in_time.relaxation import Relaxation
from tests.commands import done, refused

G: Array = np.array([0.10, 0.06])
TAU: Array = np.array([0.3, 20.0])
TIMES = np.concatenate([0.01 * np.arange(-5.0, 500.0), np.linspace(5.0, 300.0, 2951)])  # s, at 100 and at 10 Hz


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
        f"A stretch that is held loses {100.0 - 100.0 / (1.0 + sum(found.g)):#.3g} % of its stress from 0.01 to 300 s; "
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


DATA = Path(__file__).parents[3] / "data"


def ramped(t: Array, ramp: float, start: float) -> Array:
    """A stress at times in s whose part at long times rises evenly from a start: g 0.10 at 1 s, 0.05 at 30 s."""
    since = np.maximum(t - start, 0.0)[:, None]
    rising = np.minimum(since, ramp)
    tau, g = np.array([1.0, 30.0]), np.array([0.10, 0.05])
    carried = tau / ramp * (np.exp(-(since - rising) / tau) - np.exp(-since / tau))
    return np.asarray(rising[:, 0] / ramp + carried @ g)


def lost(found: Hold) -> float:
    return 1.0 - 1.0 / (1.0 + sum(found.g))


def test_a_hold_with_its_ramp() -> None:
    found = read_hold(DATA / "relax_ramp.csv")
    assert lost(found) == pytest.approx(0.1304, abs=0.003)
    near = {tau: g for g, tau in zip(found.g, found.tau_s, strict=True) if g > 0.01}
    assert list(near) == pytest.approx([1.0, 30.0], rel=0.06)
    assert list(near.values()) == pytest.approx([0.10, 0.05], abs=0.003)
    assert found.misfit < 1e-3


@pytest.mark.parametrize("ramp", [0.1, 0.5, 2.0, 5.0])
@pytest.mark.parametrize("start", [0.0, 4.0], ids=["at once", "after a rest"])
def test_ramps_of_many_lengths(ramp: float, start: float, tmp_path: Path) -> None:
    """With a strain beside and without, of a stress and of a force: 13 % is lost, within what noise of 0.1 % allows."""
    t = np.unique(np.concatenate([np.arange(0.0, 20.0, 0.02), np.arange(20.0, 400.0, 0.5)]))
    stress, strain = noisy(ramped(t, ramp, start), 0.001), 50.0 * np.clip((t - start) / ramp, 0.0, 1.0)
    for titles, values in (("time (s),stress (MPa)", stress), ("Prüfzeit (s),Kraft (N)", 16.0 * stress)):
        assert lost(read_hold(file(tmp_path, titles, values, t))) == pytest.approx(0.1304, abs=0.012), titles
    rows = "\n".join(f"{a:.6g},{b:.8g},{c:.8g}" for a, b, c in zip(t, strain, stress, strict=True))
    (tmp_path / "hold.csv").write_text(f"time (s),strain (%),stress (MPa)\n{rows}\n")
    assert lost(read_hold(tmp_path / "hold.csv")) == pytest.approx(0.1304, abs=0.012)


def test_a_stretch_before_the_ramp_has_relaxed_before(tmp_path: Path) -> None:
    """A load of a tenth for a minute, then a ramp of 2 s."""
    t = np.unique(np.concatenate([np.arange(0.0, 80.0, 0.02), np.arange(80.0, 400.0, 0.5)]))
    found = read_hold(file(tmp_path, "time (s),force (N)", 0.1 + noisy(ramped(t, 2.0, 60.0), 0.001), t))
    assert lost(found) == pytest.approx(0.1304, abs=0.012)
    assert found.between_s[0] == pytest.approx(0.4 / 3.0, rel=0.05)  # what a ramp of 2 s shows


def test_a_slow_logger_tells_what_is_lost_after_its_first_second(tmp_path: Path) -> None:
    t = np.arange(0.0, 300.0, 1.0)
    found = read_hold(file(tmp_path, "time (s),stress (MPa)", ramped(t, 0.5, 0.2), t))
    stress = ramped(np.array([1.0, 300.0]), 0.5, 0.2)
    left = 1.0 + np.array([np.exp(-0.5 / np.array(found.tau_s)) @ found.g, 0.0])
    assert left[0] == pytest.approx(stress[0], abs=0.02)
    assert found.between_s == (1.0, 298.0)


def test_a_load_with_its_ramp_and_a_strain_beside_is_creep(tmp_path: Path) -> None:
    t = np.arange(0.0, 300.0, 0.1)
    load = np.clip(t / 2.0, 0.0, 1.0)
    steps = np.arange(0.0, 2.0, 0.02) + 0.01
    grid = np.arange(0.0, 300.0, 0.02)
    known = compliance(grid)
    strain = np.mean([np.interp(t - step, grid, known, left=0.0) for step in steps], axis=0)
    rows = "\n".join(f"{a:.6g},{b:.8g},{c:.8g}" for a, b, c in zip(t, 7.0 * load, strain, strict=True))
    (tmp_path / "hold.csv").write_text(f"time (s),stress (MPa),strain (1)\n{rows}\n")
    g, tau = (np.array(of) for of in (read_hold(tmp_path / "hold.csv").g, read_hold(tmp_path / "hold.csv").tau_s))
    late = np.geomspace(0.5, 200.0, 40)
    np.testing.assert_allclose(modulus(late, g, tau), modulus(late), atol=0.01)


def test_the_export_of_a_german_machine() -> None:
    """Few points, units in the second line."""
    found = read_hold(DATA / "hold_zwick.csv")
    assert lost(found) == pytest.approx(1.0 - 0.69 / 0.80, abs=0.01)
    assert found.between_s == (1.0, 120.0)


def test_moduli_over_frequency(tmp_path: Path) -> None:
    found = read_hold(DATA / "dma.csv")
    assert found.words[1] == "The loss factor is 0.042 to 0.062 from 0.1 to 10 Hz."
    rows = np.loadtxt(DATA / "dma.csv", delimiter=",", skiprows=2)
    rubber = Relaxation(found.g, found.tau_s)
    np.testing.assert_allclose(rubber.loss_factor(rows[:, 0]), rows[:, 2] / rows[:, 1], atol=1.5e-3)
    over = rubber.dynamic(2j * np.pi * rows[:, 0]).real / rows[:, 1]
    assert np.ptp(over) < 0.01 * over.mean()  # one over the modulus at long times
    turned = "\n".join(f"{2 * np.pi * f},{s},{v}" for f, s, v in rows)
    for title in ("angular frequency (rad/s)", "Kreisfrequenz (1/s)", "ω (s⁻¹)"):
        (tmp_path / "turned.csv").write_text(f"{title},storage modulus (MPa),loss modulus (MPa)\n{turned}", "utf-8")
        assert read_hold(tmp_path / "turned.csv").tau_s == pytest.approx(found.tau_s, rel=1e-6), title
    sweep = "\n".join(f"1,{20 + k},{s},{v}" for k, (_, s, v) in enumerate(rows))
    titles = "frequency (Hz),temperature (°C),storage modulus (MPa),loss modulus (MPa)"
    (tmp_path / "sweep.csv").write_text(f"{titles}\n{sweep}", "utf-8")
    with pytest.raises(InputError, match="too few frequencies, 1; give 5 or more, at one temperature"):
        read_hold(tmp_path / "sweep.csv")
    sentence = refused("material", str(DATA / "dma.csv"), "--out", str(tmp_path / "m"))
    assert "storage and loss modulus over frequency, are given with --hold" in sentence


def test_what_branches_do_not_describe_is_refused(tmp_path: Path) -> None:
    """A hold that is followed by unloading."""
    values = np.where(TIMES > 200.0, 0.0, 57.0 * modulus(TIMES))
    with pytest.raises(
        InputError, match=r"branches describe it within \d+ % only, and 5 % are allowed; leave out what"
    ):
        read_hold(file(tmp_path, "time (s),stress (kPa)", values))
    for strain, complaint in ((0.0, "is zero in most rows"), (TIMES + 9.0, "neither stress nor strain is held")):
        rows = "\n".join(f"{t},{e},{t + 9.0}" for t, e in zip(TIMES, strain + 0.0 * TIMES, strict=True))
        (tmp_path / "both.csv").write_text(f"time (s),strain (%),stress (MPa)\n{rows}\n")
        with pytest.raises(InputError, match=complaint):
            read_hold(tmp_path / "both.csv")


def test_the_command_writes_them_beside_the_law(configs: Path, tmp_path: Path) -> None:
    hold = file(tmp_path, "time (s),stress (kPa)", 57.0 * modulus(TIMES))
    tests = str(configs / "elastosil_m4601_yeoh.csv")
    printed = done("material", tests, "--hold", str(hold), "--out", str(tmp_path / "m"))
    assert "relaxation: [{g: " in printed
    assert (tmp_path / "m" / "material.json").is_file()
