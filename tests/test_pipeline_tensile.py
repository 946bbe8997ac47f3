"""Tensile tests are read with their units, and invalid files are refused in one sentence with the position."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.errors import InputError
from pipeline.material.tensile import read_tensile, up_to

STRAINS = [0.0, 0.1, 0.2, 0.3, 0.4]
STRESSES = [0.0, 0.06, 0.11, 0.15, 0.19]


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


GOOD = [f"{100 * e:g},{s:g}" for e, s in zip(STRAINS, STRESSES, strict=True)]
HEADER = "strain (%),stress (MPa)"


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
    with pytest.raises(InputError, match=r"sheet.csv: is not a text in UTF-8"):
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
    said = ""
    try:
        tests = read_tensile([path])
    except InputError as refused:
        said, tests = str(refused), ()
    assert bool(tests) != said.startswith(f"{path}: ")
    assert len(said.splitlines()) <= 1
    assert all(np.isfinite(test.stress).all() and (test.stretch > 0).all() for test in tests)
