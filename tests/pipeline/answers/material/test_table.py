"""Tensile tests are read as machines and spreadsheets write them, and other files are refused in one sentence."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.answers.material.loading import Selection, read_tensile
from pipeline.answers.material.table import Series, Specimen, read_table
from pipeline.values.errors import InputError

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


def read(path: Path) -> list[Series]:
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
    [test] = read(written(tmp_path, "# measured on Monday\n\n" + table(header, points(form))))
    np.testing.assert_allclose(test.strain, STRAINS, atol=1e-6)
    np.testing.assert_allclose(test.stress, STRESSES, atol=1e-6)
    assert all("has no unit" in note for note in test.notes)
    assert len(test.notes) == (header.startswith("eng.") or "Engineering Strain;" in header)


@pytest.mark.parametrize(
    "title", ["Compressive strain (%),Compressive stress (MPa)", "Stauchung (%),Druckspannung (MPa)"]
)
def test_compression_that_is_positive(title: str, tmp_path: Path) -> None:
    for sign in ("", "-"):
        [test] = read(written(tmp_path, table(title, points(f"{sign}{{percent:g}},{sign}{{MPa:g}}"))))
        np.testing.assert_allclose(test.strain, -np.array(STRAINS), atol=1e-12)
        np.testing.assert_allclose(test.stress, -np.array(STRESSES))


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be", "utf-16-le", "latin-1", "cp1252", "utf-8-sig"])
def test_encodings_and_decimal_commas(encoding: str, tmp_path: Path) -> None:
    rows = [row.replace(".", ",") for row in points("{percent:g};{MPa:g};80")]
    mark = "\ufeff" if encoding == "utf-16-be" else ""
    (tmp_path / "pull.csv").write_bytes((mark + table("Dehnung (%);Spannung (MPa);Härte", rows)).encode(encoding))
    [test] = read(tmp_path / "pull.csv")
    np.testing.assert_allclose(test.stress, STRESSES)


def test_numbers_with_signs_between_thousands(tmp_path: Path) -> None:
    rows = [f"{e},{1e4 + 1e4 * s:,.1f}".replace(",", "_", 1) for e, s in zip(STRAINS, STRESSES, strict=True)]
    [english] = read(written(tmp_path, table("strain (1);stress (Pa)", [row.replace("_", ";") for row in rows])))
    german = [row.translate({ord("."): ",", ord(","): "."}).replace("_", ";") for row in rows]
    [other] = read(written(tmp_path, table("Dehnung (1);Spannung (Pa)", german)))
    np.testing.assert_allclose(english.stress, 1e-2 * (1 + np.array(STRESSES)))
    np.testing.assert_allclose(other.stress, english.stress)
    np.testing.assert_allclose(other.strain, STRAINS)


@pytest.mark.parametrize(("largest", "unit"), [(3.0, "1"), (300.0, "%")])
def test_a_strain_without_a_unit_is_read_and_named(largest: float, unit: str, tmp_path: Path) -> None:
    rows = [f"{e},{e}" for e in np.linspace(0, largest, 6)]
    [test] = read(written(tmp_path, table("strain,stress (MPa)", rows)))
    assert test.strain[-1] == pytest.approx(3.0)
    assert test.notes == (
        f"{tmp_path / 'pull.csv'}: column 'strain' has no unit and reaches {largest:g}; it is read in {unit}",
    )


def test_several_tests(tmp_path: Path) -> None:
    """In a column of tests, in pairs of columns, and in several files."""
    rows = [f"{name},{e},{k * s}" for e, s in zip(STRAINS, STRESSES, strict=True) for name, k in (("A", 1), ("B", 2))]
    both = written(tmp_path, table("specimen,strain (1),stress (MPa)", rows), "both.csv")
    first, second = read(both)
    assert (first.name, second.name) == ("A", "B")
    np.testing.assert_allclose(second.stress, 2 * first.stress)
    beside = points("{percent:g},{MPa:g},{strain:g},{kPa:g}")
    header = "strain 1 (%),stress 1 (MPa),strain 2 (1),stress 2 (kPa)"
    one, two = read(written(tmp_path, table(header, beside), "pairs.csv"))
    np.testing.assert_allclose([two.strain, two.stress], [one.strain, one.stress])
    alone = written(tmp_path, table(HEADER, GOOD), "alone.csv")
    named = read_tensile([both, alone], Specimen(), Selection())
    assert [test.name for test in named] == ["both A", "both B", "alone"]
    with pytest.raises(InputError, match=r"both\.csv: test 'both A' was read already; give every test once"):
        read_tensile([both, both], Specimen(), Selection())


def test_rows_without_numbers_and_columns_that_repeat_are_left_out_and_named(tmp_path: Path) -> None:
    rows = [*GOOD[:3], "break,", *GOOD[3:], "end of test,"]
    [test] = read(written(tmp_path, table(HEADER, rows)))
    assert len(test.strain) == len(GOOD)
    assert test.notes == (f"{tmp_path / 'pull.csv'}: 1 rows between points have no numbers and are left out",)
    [test] = read(
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
    found = read(written(tmp_path, table(header, points(form))))
    assert " ".join(series.state for series in found) == states
    np.testing.assert_allclose(found[-1].stress, STRESSES)
    assert [" is left out" in note for series in found for note in series.notes] == [True] * (states == "uniaxial")
    planar = read_table(written(tmp_path, table(HEADER, GOOD)), Specimen(), "planar")
    assert [series.state for series in planar] == ["planar"]


def test_a_column_of_tests_names_compression(tmp_path: Path) -> None:
    rows = points("compression,{percent:g},{MPa:g}\n3D-Druck 1,{percent:g},{MPa:g}")
    pressed, printed = read(written(tmp_path, table(f"test,{HEADER}", rows)))
    np.testing.assert_allclose(pressed.stress, -printed.stress)
    np.testing.assert_allclose(pressed.strain, -np.array(STRAINS), atol=1e-12)


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "sheet.csv").write_bytes(b"PK\x03\x04\xff\xfe")
    with pytest.raises(InputError, match=r"sheet.csv: is not a text; save it as CSV"):
        read(tmp_path / "sheet.csv")


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
