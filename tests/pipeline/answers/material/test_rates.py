"""Branches of relaxation from loadings at several rates, with noise."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.answers.material.rates import read_rates
from pipeline.answers.material.sentences import doubts_of_given
from pipeline.values.errors import InputError


def loaded(file: Path, duration: float, branches: list[tuple[float, float]], noise: float = 0.002) -> Path:
    """A neo-Hookean strip that is pulled to twice its length within some s; fine steps of the integral of G ds_e."""
    t = np.linspace(0.0, duration, 4001)
    stretch = 1.0 + t / duration
    elastic = 0.05 * (stretch - stretch**-2)
    stress = elastic.copy()
    for g, tau in branches:
        rate = np.gradient(elastic, t)
        weight = np.exp(np.clip(t / tau, None, 500.0))
        stress += g / weight * np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (rate * weight)[:-1]
                                                                + 0.5 * np.diff(t) * (rate * weight)[1:])])  # fmt: skip
    kept = slice(None, None, 20)
    stress = stress[kept] + noise * stress.max() * np.random.default_rng(5).standard_normal(len(t[kept]))
    rows = zip(t[kept], 100.0 * (stretch[kept] - 1.0), 1e3 * stress, strict=True)
    file.write_text("time (s),strain (%),stress (kPa)\n" + "\n".join(f"{a:.6g},{b:.6g},{c:.6g}" for a, b, c in rows))
    return file


@pytest.mark.parametrize(
    ("durations", "branches"), [((0.5, 60.0), [(0.12, 4.0)]), ((0.3, 5.0, 80.0), [(0.15, 1.0), (0.08, 18.0)])]
)
def test_known_branches_are_found_within_what_is_stated(
    tmp_path: Path, durations: tuple[float, ...], branches: list[tuple[float, float]]
) -> None:
    found = read_rates([loaded(tmp_path / f"{k}.csv", d, branches) for k, d in enumerate(durations)])
    assert 0.5e-3 < found.misfit < 3e-3
    for (g, tau), own, slow, (of_g, of_tau) in zip(branches, found.g, found.tau_s, found.std, strict=True):
        assert abs(np.log(own / g)) < 2.0 * of_g
        assert abs(np.log(slow / tau)) < 2.0 * of_tau
        assert max(of_g, of_tau) < 0.5
    assert "Branches: " in found.words[1]


def test_one_rate_tells_no_branches(tmp_path: Path) -> None:
    files = [loaded(tmp_path / f"{k}.csv", 5.0, [(0.1, 1.0)]) for k in (0, 1)]
    with pytest.raises(InputError, match="two rates or more"):
        read_rates(files)
    files[0].write_text("time (s),stress (kPa)\n0,0\n1,5\n")
    with pytest.raises(InputError, match="has no strain and stress over time"):
        read_rates(files)


def test_what_no_rubber_has_is_named() -> None:
    assert list(doubts_of_given(0.495, "1070 kg/m^3", 0.1)) == []
    of_nu, of_density, of_batch = doubts_of_given(0.3, "2000 kg/m^3", 0.3)
    assert of_nu == "a Poisson ratio of 0.3 is given, and rubbers have 0.45 to 0.5"
    assert of_density == "a density of 2000 kg/m^3 is given, and rubbers have 800 to 1400 kg/m^3"
    assert of_batch == "the specimens differ by 30 %; those of one batch by less than 20 %"
