"""The first loading, the break and the slack are found, and what is left out is named."""

import numpy as np
import pytest

import fem
from geometry.arrays import Array
from pipeline.answers.material.loading import POWERS, Selection, TensileTest, first_loading, scatter
from pipeline.answers.material.table import Series
from pipeline.values.errors import InputError

UP = np.linspace(0.0, 1.5, 61)
FIRST = Selection()


def stress_of(strain: Array) -> Array:
    return np.asarray(0.3 * ((1 + strain) - (1 + strain) ** -2))


def read(strain: Array, stress: Array, selection: Selection = FIRST) -> TensileTest:
    series = Series("", strain, stress, np.arange(2, len(strain) + 2), ())
    return first_loading("pull.csv", "pull", series, selection)


def cycles(*tops: float) -> tuple[Array, Array]:
    """Loadings to these strains, each followed by unloading; every stress beyond the first loading is softer."""
    ways = [np.concatenate([top * UP / 1.5, top * UP[::-1] / 1.5]) for top in tops]
    strain, largest, stress = np.concatenate(ways), 0.0, []
    for value, way in zip(strain, np.concatenate([np.diff(strain), [-1.0]]), strict=True):
        first = way > 0 and value >= largest
        largest = max(largest, value)
        stress.append(float(stress_of(np.array(value))) * (1.0 if first else 0.7))
    return strain, np.array(stress)


@pytest.mark.parametrize("tops", [(1.5,), (1.5, 1.5, 1.5), (0.5, 1.0, 1.5)], ids=["one", "equal", "growing"])
def test_the_first_loading_is_used(tops: tuple[float, ...]) -> None:
    """Of growing cycles each adds what lies beyond those before; no stress is a mean over branches."""
    test = read(*cycles(*tops))
    assert test.stretch[-1] >= 2.47
    off = np.abs(test.stress - stress_of(test.strain)) > 1e-12
    assert off.sum() <= len(tops)  # the point at which a specimen turns
    assert "the strain goes back after line 62: the first loading is used (--cycle)" in test.notes[0]


def test_another_loading_is_used_where_it_is_asked_for() -> None:
    strain, stress = cycles(1.5, 1.5)
    second = read(strain, stress, Selection(cycle=2))
    np.testing.assert_allclose(second.stress[:-1], 0.7 * stress_of(second.strain[:-1]), atol=1e-12)
    assert "loading 2 is used" in second.notes[0]
    with pytest.raises(InputError, match="cycle=3: the test has 2"):
        read(strain, stress, Selection(cycle=3))


@pytest.mark.parametrize(
    "strain",
    [UP[::-1], np.concatenate([UP, -UP[1:20] / 3]), UP + 0.01 * np.sin(40 * UP)],
    ids=["falling", "tension, then compression", "scatter of the extensometer"],
)
def test_one_loading_in_another_order_is_used_as_a_whole(strain: Array) -> None:
    test = read(strain, stress_of(strain))
    assert test.notes == ()
    np.testing.assert_allclose(test.strain, np.sort(strain))


def test_rows_in_any_order_are_no_cycles() -> None:
    random = np.random.default_rng(0)
    for count in (6, 8, 12, 61):
        strain = random.permutation(np.linspace(0.0, 1.5, count))
        assert len(read(strain, stress_of(strain)).stretch) == count


def test_points_after_a_break_are_left_out() -> None:
    for after in ([0.01, 0.0, 0.0], [0.5, 0.1, 0.0], [0.0]):
        broken = np.concatenate([UP, 1.5 + 0.02 * np.arange(1, len(after) + 1)])
        test = read(broken, np.concatenate([stress_of(UP), after]))
        np.testing.assert_allclose(test.strain, UP, atol=1e-12)
        assert "the stress drops after a strain of 150 %, a break" in test.notes[0]
        assert len(test.left_out[0]) == len(after)
    noisy = stress_of(UP) + 0.3 * np.random.default_rng(1).standard_normal(61)
    assert not any("break" in note for note in read(UP, noisy).notes)


LAWS = {
    "neo_hooke": fem.NeoHooke(0.2, 100.0),
    "hardening": fem.Yeoh(0.11, 0.02, 0.0, 100.0),
    "softening": fem.MooneyRivlin(0.06, 0.06, 100.0),
    "ogden": fem.Ogden((0.3,), (1.2,), 100.0),
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_slack_is_taken_away(law: fem.Material) -> None:
    """2 % of it, cut off or rounded, within 0.3 % of strain, whatever the law; and none where there is none."""
    for top, count in ((3.0, 66), (1.5, 300)):
        strain = np.linspace(0.0, top, count)
        assert read(strain, law.incompressible(1 + strain)).slack == 0.0
        cut = read(strain, law.incompressible(1 + np.maximum(strain - 0.02, 0.0)))
        assert cut.slack == pytest.approx(0.02, abs=0.003)
        assert cut.strain[0] > -0.015
        assert "are taken away as slack: the tangent at the steepest part" in cut.notes[0]
        rounded = read(strain, law.incompressible(1 + 0.01 * np.log1p(np.exp((strain - 0.02) / 0.01))))
        assert rounded.slack == pytest.approx(0.02, abs=0.004)


def test_an_offset_of_the_load_cell_is_named_and_taken_away() -> None:
    test = read(UP, stress_of(UP) + 0.05)
    assert test.slack == 0.0
    np.testing.assert_allclose(test.stress, stress_of(UP), atol=1.5e-3)
    [note] = test.notes
    assert "MPa are taken away from every stress, the offset of the load cell at zero strain; if it was a pre" in note


def test_the_slack_of_a_planar_test_follows_from_the_curve_of_a_planar_test() -> None:
    strain, planar = UP[1:], POWERS["planar"]
    stretch = 1 + np.maximum(strain - 0.02, 0.0)
    series = Series("", strain, 0.3 * (stretch - stretch**-planar), np.arange(60), (), state="planar")
    assert first_loading("pull.csv", "pull", series, FIRST).slack == pytest.approx(0.02, abs=0.003)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_compression_in_positive_numbers_is_asked_about(law: fem.Material) -> None:
    """Sparse or dense, with a rounded start or without; tension to the same strains is not, nor what is called so."""
    for top, count in ((0.2, 25), (0.4, 200), (0.6, 7)):
        strain = np.linspace(0.0, top, count)
        rounded = 0.01 * np.log1p(np.exp((strain - 0.03) / 0.01))
        for shown in (strain, rounded) if count > 7 else (strain,):
            with pytest.raises(InputError, match="the stress rises faster than the strain from the start"):
                read(strain, -law.incompressible(1 - shown))
            read(strain, law.incompressible(1 + shown))
        pressed = -law.incompressible(1 - strain)
        series = Series("", strain, pressed, np.arange(2, count + 2), (), "tensile strain (1) tensile stress (mpa)")
        assert len(first_loading("pull.csv", "pull", series, FIRST).stress) > 4


def test_strains_are_left_out_where_it_is_asked_for() -> None:
    test = read(UP, stress_of(UP), Selection(start=0.2))
    assert test.strain[0] == pytest.approx(0.2, abs=0.01)
    with pytest.raises(InputError, match="4 points are left; 5 are needed"):
        read(UP, stress_of(UP), Selection(start=float(UP[-4])))


def test_scatter_is_that_of_noise_and_of_the_steps_of_a_load_cell() -> None:
    random = np.random.default_rng(3)
    strain = np.linspace(0.0, 1.5, 301)
    noisy = [scatter(strain, stress_of(strain) + 0.005 * random.standard_normal(301)) for _ in range(20)]
    assert np.mean(noisy) == pytest.approx(0.005, rel=0.1)
    assert scatter(strain, stress_of(strain)) < 1e-6
    step = 0.05 * 0.7
    stepped = scatter(strain, np.round(stress_of(strain) / step) * step)
    assert stepped > step / 12**0.5
