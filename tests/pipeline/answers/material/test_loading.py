"""Tensile tests are read as machines write them; the first loading, the break and the slack are found."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fem
from geometry.arrays import Array
from pipeline.answers.material.loading import POWERS, Selection, TensileTest, first_loading, read_tensile, scatter
from pipeline.answers.material.table import Series, Specimen, read_table
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


STRAINS = [0.0, 0.1, 0.2, 0.3, 0.4]
STRESSES = [0.0, 0.06, 0.11, 0.15, 0.19]
LENGTH, AREA = 33.0, 16.0
GOOD = [f"{100 * e:g},{s:g}" for e, s in zip(STRAINS, STRESSES, strict=True)]
HEADER = "strain (%),stress (MPa)"


def written(folder: Path, text: str, name: str = "pull.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def table(header: str, rows: list[str]) -> str:
    return "\n".join([header, *rows]) + "\n"


def points(form: str) -> list[str]:
    return [
        form.format(
            strain=e, percent=100 * e, stretch=1 + e, MPa=s, kPa=1e3 * s, Pa=1e6 * s, mm=LENGTH * e, N=AREA * s,
            kN=AREA * s / 1e3, true=np.log1p(e), cauchy=s * (1 + e),
        )
        for e, s in zip(STRAINS, STRESSES, strict=True)
    ]  # fmt: skip


def read_file(path: Path) -> list[Series]:
    return read_table(path, Specimen(LENGTH, AREA))


@pytest.mark.parametrize(
    ("header", "form"),
    [
        ("strain (%),stress (MPa)", "{percent:g},{MPa:g}"),
        ("Strain [%] , Nominal Stress [kPa]", "{percent:g}, {kPa:g}"),
        ("strain / 1;stress / N/mm^2", "{strain:g};{MPa:g}"),
        ("stretch (-)\tengineering stress (Pa)", "{stretch:g}\t{Pa:.12g}"),
        ("stretch,stress (MPa)", "{stretch:g},{MPa:g}"),
        ("time (s),stress (MPa),strain (mm/mm),force (N)", "1,{MPa:g},{strain:g},3"),
        ("time (s),Tensile strain (%),Tensile stress (MPa)", "1,{percent:g},{MPa:g}"),
        ("time,strain,stress\n(s),(%),(MPa)", "1,{percent:g},{MPa:g}"),
        ("Time,Tensile strain (Extension),Tensile stress\n(s),(%),(MPa)", "1,{percent:g},{MPa:g}"),
        ("Tensile;Tensile\nstrain;stress\n%;MPa", "{percent:g};{MPa:g}"),
        ('Specimen 1\nDate,2024-01-01\n\n"Time","Tensile strain","Tensile stress"\n"(s)","(%)","(MPa)"',
         '"1","{percent:g}","{MPa:g}"'),
        ("Width (mm);6;;;\nSpeed (mm/min);500;;;\n;;;;\n"
         "Time (s);True Strain;True Stress (MPa);Engineering Strain;Engineering Stress (MPa)",
         "0.1;{true:.6f};{cauchy:.6f};{strain:g};{MPa:g}"),
        ("Prüfzeit;Dehnung;Spannung\ns;%;N/mm²", "1;{percent:g};{MPa:g}"),
        ("Dehnung [%];Zugspannung [MPa];wahre Dehnung [-]", "{percent:g};{MPa:g};{true:.6f}"),
        ("Traversenweg in mm;Standardkraft in N", "{mm:.6f};{N:.6f}"),
        ("Déformation (%);Contrainte (MPa)", "{percent:g};{MPa:g}"),
        ("Temps (s);Allongement (mm);Force (N)", "1;{mm:.6f};{N:.6f}"),
        ("Extension (mm),Load (kN)", "{mm:.6f},{kN:.9f}"),
        ("Strain_% Stress_MPa", "{percent:g} {MPa:g}"),
        ('"Prüfzeit";"Standardkraft";"Verformung"\n"s";"N";"%"', '"1";"{N:.6f}";"{percent:g}"'),
        ("Name,Parameter1\n1 _ 1\nTime,Force,Stroke\nsec,N,mm", "1,{N:.6f},{mm:.6f}"),
        ("Crosshead (mm)\tLoad (N)\tTime (s)", "{mm:.6f}\t{N:.6f}\t1"),
        ("dL [mm];F [kN]", "{mm:.6f};{kN:.9f}"),
        ("MTS793|MPT|ENU|1|2|.\n\nTime:\t0.1\tSec\nAxial Displacement\tAxial Force\tTime\nmm\tN\tSec",
         "{mm:.6f}\t{N:.6f}\t1"),
        ("Sample,1\nPosition,Load,Time\nmm,kN,s", "{mm:.6f},{kN:.9f},1"),
        ("ε (%)\tσ (kPa)", "{percent:g}\t{kPa:g}"),
        ("eng. strain, eng. stress (MPa)", "{strain:g},{MPa:g}"),
        ("strain (1),stress (Pa),eng. strain (%),eng. stress (MPa)", "{true:.6f},{cauchy:g},{percent:g},{MPa:g}"),
    ],
)  # fmt: skip
def test_titles_units_and_separators(header: str, form: str, tmp_path: Path) -> None:
    [test] = read_file(written(tmp_path, "# measured on Monday\n\n" + table(header, points(form))))
    np.testing.assert_allclose(test.strain, STRAINS, atol=1e-6)
    np.testing.assert_allclose(test.stress, STRESSES, atol=1e-6)
    assert all("has no unit" in note for note in test.notes)
    assert len(test.notes) == (header.startswith("eng.") or "Engineering Strain;" in header)


@pytest.mark.parametrize(
    "title", ["Compressive strain (%),Compressive stress (MPa)", "Stauchung (%),Druckspannung (MPa)"]
)
def test_compression_that_is_positive(title: str, tmp_path: Path) -> None:
    for sign in ("", "-"):
        [test] = read_file(written(tmp_path, table(title, points(f"{sign}{{percent:g}},{sign}{{MPa:g}}"))))
        np.testing.assert_allclose(test.strain, -np.array(STRAINS), atol=1e-12)
        np.testing.assert_allclose(test.stress, -np.array(STRESSES))


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be", "utf-16-le", "latin-1", "cp1252", "utf-8-sig"])
def test_encodings_and_decimal_commas(encoding: str, tmp_path: Path) -> None:
    rows = [row.replace(".", ",") for row in points("{percent:g};{MPa:g};80")]
    mark = "\ufeff" if encoding == "utf-16-be" else ""
    (tmp_path / "pull.csv").write_bytes((mark + table("Dehnung (%);Spannung (MPa);Härte", rows)).encode(encoding))
    [test] = read_file(tmp_path / "pull.csv")
    np.testing.assert_allclose(test.stress, STRESSES)


def test_numbers_with_signs_between_thousands(tmp_path: Path) -> None:
    rows = [f"{e},{1e4 + 1e4 * s:,.1f}".replace(",", "_", 1) for e, s in zip(STRAINS, STRESSES, strict=True)]
    [english] = read_file(written(tmp_path, table("strain (1);stress (Pa)", [row.replace("_", ";") for row in rows])))
    german = [row.translate({ord("."): ",", ord(","): "."}).replace("_", ";") for row in rows]
    [other] = read_file(written(tmp_path, table("Dehnung (1);Spannung (Pa)", german)))
    np.testing.assert_allclose(english.stress, 1e-2 * (1 + np.array(STRESSES)))
    np.testing.assert_allclose(other.stress, english.stress)
    np.testing.assert_allclose(other.strain, STRAINS)


@pytest.mark.parametrize(("largest", "unit"), [(3.0, "1"), (300.0, "%")])
def test_a_strain_without_a_unit_is_read_and_named(largest: float, unit: str, tmp_path: Path) -> None:
    rows = [f"{e},{e}" for e in np.linspace(0, largest, 6)]
    [test] = read_file(written(tmp_path, table("strain,stress (MPa)", rows)))
    assert test.strain[-1] == pytest.approx(3.0)
    assert test.notes == (
        f"{tmp_path / 'pull.csv'}: column 'strain' has no unit and reaches {largest:g}; it is read in {unit}",
    )


def test_several_tests(tmp_path: Path) -> None:
    """In a column of tests, in pairs of columns, and in several files."""
    rows = [f"{name},{e},{k * s}" for e, s in zip(STRAINS, STRESSES, strict=True) for name, k in (("A", 1), ("B", 2))]
    both = written(tmp_path, table("specimen,strain (1),stress (MPa)", rows), "both.csv")
    first, second = read_file(both)
    assert (first.name, second.name) == ("A", "B")
    np.testing.assert_allclose(second.stress, 2 * first.stress)
    beside = points("{percent:g},{MPa:g},{strain:g},{kPa:g}")
    header = "strain 1 (%),stress 1 (MPa),strain 2 (1),stress 2 (kPa)"
    one, two = read_file(written(tmp_path, table(header, beside), "pairs.csv"))
    np.testing.assert_allclose([two.strain, two.stress], [one.strain, one.stress])
    alone = written(tmp_path, table(HEADER, GOOD), "alone.csv")
    named = read_tensile([both, alone], Specimen(), Selection())
    assert [test.name for test in named] == ["both A", "both B", "alone"]
    with pytest.raises(InputError, match=r"both\.csv: test 'both A' was read already; give every test once"):
        read_tensile([both, both], Specimen(), Selection())


def test_rows_without_numbers_and_columns_that_repeat_are_left_out_and_named(tmp_path: Path) -> None:
    rows = [*GOOD[:3], "break,", *GOOD[3:], "end of test,"]
    [test] = read_file(written(tmp_path, table(HEADER, rows)))
    assert len(test.strain) == len(GOOD)
    assert test.notes == (f"{tmp_path / 'pull.csv'}: 1 rows between points have no numbers and are left out",)
    [test] = read_file(
        written(tmp_path, table("strain (%),stretch,stress (MPa)", points("{percent:g},{stretch:g},{MPa:g}")))
    )
    assert test.notes[0].endswith(
        "the columns 'strain (%)' and 'stress (MPa)' are taken, other columns of strain and stress are not"
    )


@pytest.mark.parametrize(
    ("header", "form", "states"),
    [
        ("test,strain (1),stress (MPa)", "pure shear,{strain},9\npull 1,{strain},{MPa}", "planar uniaxial"),
        (
            "biaxial strain (1),biaxial stress (MPa),strain (1),stress (MPa)",
            "{strain},9,{strain},{MPa}",
            "equibiaxial uniaxial",
        ),
        ("strain (1),planar stress (MPa),uniaxial stress (MPa)", "{strain},9,{MPa}", "planar uniaxial"),
        (
            "Scherdehnung (1);Schubspannung (MPa);Dehnung (1);Zugspannung (MPa)",
            "{strain};9;{strain};{MPa}",
            "uniaxial",
        ),
        ("file,loading_branch,strain (1),stress_MPa_raw", "a,first,{strain},{MPa}\na,last,{strain},9", "uniaxial"),
    ],
)
def test_kinds_of_tests(header: str, form: str, states: str, tmp_path: Path) -> None:
    """By column and by title; tests of another kind and later loadings are left out and named."""
    found = read_file(written(tmp_path, table(header, points(form))))
    assert " ".join(series.state for series in found) == states
    np.testing.assert_allclose(found[-1].stress, STRESSES)
    assert [" is left out" in note for series in found for note in series.notes] == [True] * (states == "uniaxial")
    planar = read_table(written(tmp_path, table(HEADER, GOOD)), Specimen(), "planar")
    assert [series.state for series in planar] == ["planar"]


def test_a_column_of_tests_names_compression(tmp_path: Path) -> None:
    rows = points("compression,{percent:g},{MPa:g}\n3D-Druck 1,{percent:g},{MPa:g}")
    pressed, printed = read_file(written(tmp_path, table(f"test,{HEADER}", rows)))
    np.testing.assert_allclose(pressed.stress, -printed.stress)
    np.testing.assert_allclose(pressed.strain, -np.array(STRAINS), atol=1e-12)


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "sheet.csv").write_bytes(b"PK\x03\x04\xff\xfe")
    with pytest.raises(InputError, match=r"sheet.csv: is not a text; save it as CSV"):
        read_file(tmp_path / "sheet.csv")


PARTS = st.sampled_from([*"0123456789.,;-\t\n\"'#%()[]/eE ", HEADER + "\n", "test,", "stretch (1)", "kPa", "nan"])


@pytest.mark.parametrize("number", [50, pytest.param(200, marks=pytest.mark.slow)])
def test_whatever_stands_in_a_file_it_is_read_or_refused(tmp_path: Path, number: int) -> None:
    @settings(max_examples=number, deadline=None)
    @given(st.lists(PARTS))
    def tried(parts: list[str]) -> None:
        path, message = written(tmp_path, "".join(parts)), ""
        try:
            tests = read_tensile([path], Specimen(), Selection())
        except InputError as refused:
            message, tests = str(refused), ()
        assert bool(tests) != message.startswith(f"{path}: ")
        assert len(message.splitlines()) <= 1
        assert all(np.isfinite(test.stress).all() and (test.stretch > 0).all() for test in tests)

    tried()
