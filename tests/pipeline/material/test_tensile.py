"""Tensile tests are read with their units, and invalid files are refused in one sentence with the position."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geometry.arrays import Array
from pipeline.errors import InputError
from pipeline.material.doubts import goes_back
from pipeline.material.tensile import read_tensile, up_to

STRAINS = [0.0, 0.1, 0.2, 0.3, 0.4]
STRESSES = [0.0, 0.06, 0.11, 0.15, 0.19]
GOOD = [f"{100 * e:g},{s:g}" for e, s in zip(STRAINS, STRESSES, strict=True)]
HEADER = "strain (%),stress (MPa)"


def written(folder: Path, text: str, name: str = "pull.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def table(header: str, rows: list[str]) -> str:
    return "\n".join([header, *rows]) + "\n"


@pytest.mark.parametrize(
    ("header", "form"),
    [
        ("strain (%),stress (MPa)", "{percent:g},{MPa:g}"),
        ("Strain [%] , Nominal Stress [kPa]", "{percent:g}, {kPa:g}"),
        ("strain / 1;stress / N/mm^2", "{strain:g};{MPa:g}"),
        ("stretch (-)\tengineering stress (Pa)", "{stretch:g}\t{Pa:.12g}"),
        ("time (s),stress (MPa),strain (mm/mm),force (N)", "1,{MPa:g},{strain:g},3"),
    ],
)
def test_units_and_separators(header: str, form: str, tmp_path: Path) -> None:
    rows = [
        form.format(strain=e, percent=100 * e, stretch=1 + e, MPa=s, kPa=1e3 * s, Pa=1e6 * s)
        for e, s in zip(STRAINS, STRESSES, strict=True)
    ]
    [test] = read_tensile([written(tmp_path, "# measured on Monday\n\n" + table(header, rows))])
    assert test.name == "pull"
    np.testing.assert_allclose(test.strain, STRAINS, atol=1e-14)
    np.testing.assert_allclose(test.stress, STRESSES, rtol=1e-12)


def test_decimal_commas(tmp_path: Path) -> None:
    rows = [f"{100 * e:g};{s:g}".replace(".", ",") for e, s in zip(STRAINS, STRESSES, strict=True)]
    [test] = read_tensile([written(tmp_path, "\ufeff" + table("strain (%);stress (MPa)", rows))])
    np.testing.assert_allclose(test.stress, STRESSES)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "latin-1", "cp1252", "utf-8-sig"])
def test_encodings_of_spreadsheets(encoding: str, tmp_path: Path) -> None:
    rows = [f"{100 * e:g};{s:g};80".replace(".", ",") for e, s in zip(STRAINS, STRESSES, strict=True)]
    text = table("strain (%);stress (MPa);Härte", rows)
    mark = "\ufeff" if encoding == "utf-16-le" else ""
    (tmp_path / "pull.csv").write_bytes((mark + text).encode(encoding))
    [test] = read_tensile([tmp_path / "pull.csv"])
    np.testing.assert_allclose(test.stress, STRESSES)


@pytest.mark.parametrize(
    "header",
    [
        "time (s),Tensile strain (%),Tensile stress (MPa)",
        "time,strain,stress\n(s),(%),(MPa)",
        "Time,Tensile strain (Extension),Tensile stress\n(s),(%),(MPa)",
        "time,strain,nominal stress\ns,%,MPa",
        'Specimen 1\nDate,2024-01-01\n\n"Time","Tensile strain","Tensile stress"\n"(s)","(%)","(MPa)"',
    ],
)
def test_titles_of_testing_machines(header: str, tmp_path: Path) -> None:
    [test] = read_tensile([written(tmp_path, table(header, [f"1,{row}" for row in GOOD]))])
    np.testing.assert_allclose(test.strain, STRAINS, atol=1e-14)
    np.testing.assert_allclose(test.stress, STRESSES)


def notes(folder: Path, strain: Array, stress: Array, header: str = "strain (1),stress (MPa)") -> tuple[str, ...]:
    """What is said about a file with these points."""
    rows = [f"{e},{s}" for e, s in zip(strain.tolist(), stress.tolist(), strict=True)]
    [test] = read_tensile([written(folder, table(header, rows))])
    return test.notes


UP = np.linspace(0.0, 1.5, 61)


@pytest.mark.parametrize(
    ("strain", "line"),
    [
        (np.concatenate([UP, UP[::-1]]), 62),  # unloading
        (np.concatenate([UP, UP]), 62),  # two specimens below each other
        (np.concatenate([part for top in (0.5, 1.0, 1.5) for part in (top * UP / 1.5, top * UP[::-1] / 1.5)]), 62),
        (UP[::-1], None),
        (np.concatenate([UP, -UP[1:20] / 3]), None),  # tension, then compression
        (np.concatenate([UP[30:], UP[:30]]), None),  # in parts
        (UP + 0.01 * np.sin(40 * UP), None),  # scatter of the extensometer
    ],
    ids=["unloading", "twice", "cycles", "falling", "compression", "parts", "scatter"],
)
def test_strains_that_go_back_are_named(strain: Array, line: int | None, tmp_path: Path) -> None:
    sentences = notes(tmp_path, strain, 0.3 * ((1 + strain) - (1 + strain) ** -2))
    if line is None:
        assert sentences == ()
    else:
        [note] = sentences
        assert note.startswith(
            f"{tmp_path / 'pull.csv'}: test 'pull': the strain goes back after line {line}: unloading"
        )


def test_rows_in_any_order_are_no_cycles() -> None:
    random = np.random.default_rng(0)
    for count in (5, 6, 8, 12, 61):
        assert [goes_back(random.permutation(np.linspace(0.0, 1.5, count))) for _ in range(50)] == [None] * 50


def test_points_after_a_break_are_left_out(tmp_path: Path) -> None:
    stress = 0.3 * ((1 + UP) - (1 + UP) ** -2)
    for after in ([0.01, 0.0, 0.0], [0.5, 0.1, 0.0], [0.0]):
        broken = np.concatenate([UP, 1.5 + 0.02 * np.arange(1, len(after) + 1)])
        rows = [f"{e},{s}" for e, s in zip(broken, [*stress, *after], strict=True)]
        [test] = read_tensile([written(tmp_path, table("strain (1),stress (MPa)", rows))])
        np.testing.assert_allclose(test.strain, UP, atol=1e-12)
        [note] = test.notes
        assert note.endswith(
            "drops after a strain of 150 %, where the specimen has broken: the points from 152 % on are left out"
        )
    softer = np.sin(2 * UP)  # falls slowly beyond its largest value
    assert notes(tmp_path, UP, softer) == ()
    noisy = stress + 0.3 * np.random.default_rng(1).standard_normal(61)
    assert notes(tmp_path, UP, noisy) == ()


def test_exchanged_columns_are_named(tmp_path: Path) -> None:
    stress = 0.3 * ((1 + UP) - (1 + UP) ** -2)
    [note] = notes(tmp_path, stress, 100 * UP, "strain (%),stress (MPa)")
    assert note.endswith(
        "strains reach 0.702 % and stresses 150 MPa: are the columns 'strain (%)' and 'stress (MPa)' swapped?"
    )
    assert notes(tmp_path, UP, stress, "strain (%),stress (MPa)") == ()  # another mistake


def test_stretches_in_a_column_of_strains_are_named(tmp_path: Path) -> None:
    stretch = np.linspace(1.0, 3.0, 21)
    stress = 0.2 * (stretch - stretch**-2)
    (note,) = notes(tmp_path, stretch, stress)
    assert "column 'strain (1)' begins at a strain of 100 % with a stress of 0 MPa" in note
    assert note.endswith("if these are stretches, call the column 'stretch (1)'")
    assert notes(tmp_path, stretch, stress, "stretch (1),stress (MPa)") == ()
    from_one = np.linspace(2.0, 7.0, 21)  # measured beyond a strain of 1 only
    assert notes(tmp_path, from_one - 1, 0.2 * (from_one - from_one**-2)) == ()


def test_several_tests_in_one_file_and_in_several(tmp_path: Path) -> None:
    rows = [
        f"{name},{e},{share * s}"
        for e, s in reversed(list(zip(STRAINS, STRESSES, strict=True)))
        for name, share in (("A", 1), ("B", 2))
    ]
    both = written(tmp_path, table("specimen,strain (1),stress (MPa)", rows), "both.csv")
    first, second = read_tensile([both])
    assert (first.name, second.name) == ("A", "B")
    np.testing.assert_allclose(first.strain, STRAINS, atol=1e-14)  # ascending, whatever the order in the file
    np.testing.assert_allclose(second.stress, 2 * first.stress)
    alone = written(tmp_path, table("strain (1),stress (MPa)", [row[2:] for row in rows[::2]]), "alone.csv")
    assert [test.name for test in read_tensile([both, alone])] == ["both A", "both B", "alone"]
    with pytest.raises(InputError, match=r"both\.csv: test 'both A' was read already; give every test once"):
        read_tensile([both, both])


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "holds no table; the first line names the columns with their units"),
        ("# only\n# words\n", "holds no table"),
        (table(HEADER, []), "has a header and no points under it; give at least 5"),
        (table("strain (%),load (N)", GOOD), "line 1: no column is named stress; the first line names"),
        (table("a,stress (MPa)", GOOD), "line 1: no column is named strain"),
        (table("0,0", GOOD), "line 1: no column is named strain"),
        (table("strain,stress (MPa)", GOOD), r"line 1: column 'strain' has no unit; write it as in 'strain \(%\)'"),
        (table("strain (mm),stress (MPa)", GOOD), r"line 1: column 'strain \(mm\)': 'mm' is not the unit of a strain"),
        (table("strain (%),stress (N)", GOOD), r"line 1: column 'stress \(N\)': 'N' is not the unit of a stress"),
        (table("strain (%),stress (furlong)", GOOD), "'furlong' is not the unit of a stress"),
        (table("strain,stress\n(%),(N)", GOOD), "column 'strain' has no unit"),
        (table("0,1\n" + HEADER, GOOD), "line 1: holds numbers above the titles of line 2; the first line names"),
        (table("axial strain (%),stress (MPa)", GOOD), r"'axial strain \(%\)' is not known to be nominal; give"),
        (table("true strain (%),stress (MPa)", GOOD), r"line 1: column 'true strain \(%\)' is not nominal; give"),
        (table("strain (%),cauchy stress (MPa)", GOOD), "'cauchy stress .MPa.' is not nominal"),
        (table("strain (%),stretch (1),stress (MPa)", GOOD), "'strain .%.' and 'stretch .1.' mean the same"),
        (table(HEADER, [*GOOD, "50,n/a"]), r"line 7, column 'stress \(MPa\)': 'n/a' is not a number; write a finite"),
        (table(HEADER, [*GOOD, "50,"]), r"line 7, column 'stress \(MPa\)': is empty"),
        (table(HEADER, [*GOOD, "nan,0.2"]), r"line 7, column 'strain \(%\)': 'nan' is not a number"),
        (table(HEADER, [*GOOD, "50"]), "line 7: has 1 cells under 2 columns"),
        (table(HEADER, [*GOOD, "50,0,2"]), "line 7: has 3 cells under 2 columns; a comma within numbers needs ';'"),
        (
            table(HEADER, ["-100,-9", *GOOD]),
            r"line 2, column 'strain \(%\)': -100 is no possible strain",
        ),
        (table("test," + HEADER, [f"A,{row}" for row in GOOD] + [",50,0.2"]), "line 7, column 'test': is empty; name"),
        (table(HEADER, GOOD[:4]), "test 'pull': has 4 points; 5 are needed"),
        (table(HEADER, [f"10,{k}" for k in range(5)]), "test 'pull': has one strain only"),
        (
            table(HEADER, [f"{10 * k},0" for k in range(5)]),
            "test 'pull': every stress is zero; give the measured force",
        ),
        (
            table(HEADER, [*GOOD[:4], "31,0", "32,0", "33,0"]),
            "test 'pull': before its break at 30 %: has 4 points; 5 are needed",
        ),
        (table(HEADER, [f"{10 * k},{-k}" for k in range(5)]), "test 'pull': stress falls as the strain grows"),
    ],
)
def test_bad_files(text: str, complaint: str, tmp_path: Path) -> None:
    path = written(tmp_path, text)
    with pytest.raises(InputError, match=complaint) as refused:
        read_tensile([path])
    assert str(refused.value).startswith(f"{path}: ")
    assert "\n" not in str(refused.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none.csv: no such file; give a CSV file of tensile tests"):
        read_tensile([tmp_path / "none.csv"])
    (tmp_path / "sheet.csv").write_bytes(b"PK\x03\x04\xff\xfe")
    with pytest.raises(InputError, match=r"sheet.csv: is not a text; give a CSV file in UTF-8, in UTF-16"):
        read_tensile([tmp_path / "sheet.csv"])
    with pytest.raises(InputError, match=r"cannot be read: Is a directory"):
        read_tensile([tmp_path])


def test_larger_strains_are_left_out(tmp_path: Path) -> None:
    rows = [f"{k},{0.006 * k}" for k in range(0, 45, 5)]
    tests = read_tensile([written(tmp_path, table(HEADER, rows))])
    [kept] = up_to(tests, 0.2)
    np.testing.assert_allclose(kept.strain, [0.0, 0.05, 0.1, 0.15, 0.2])
    with pytest.raises(InputError, match="--up-to 19 %: leaves 4 points of test 'pull'; 5 are needed"):
        up_to(tests, 0.19)


@settings(max_examples=200, deadline=None)
@given(
    st.lists(st.sampled_from([*"0123456789.,;-\t\n\"'#%()[]/eE ", HEADER + "\n", "test,", "stretch (1)", "kPa", "nan"]))
)
def test_whatever_stands_in_a_file_it_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, parts: list[str]
) -> None:
    path = written(tmp_path_factory.mktemp("fuzz"), "".join(parts))
    message = ""
    try:
        tests = read_tensile([path])
    except InputError as refused:
        message, tests = str(refused), ()
    assert bool(tests) != message.startswith(f"{path}: ")
    assert len(message.splitlines()) <= 1
    assert all(np.isfinite(test.stress).all() and (test.stretch > 0).all() for test in tests)
