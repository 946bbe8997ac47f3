"""Tests of several kinds: laws fitted to all and to each, their ratio, and what is said where no law has it."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import fem
from geometry.arrays import Array
from pipeline.answers.material.kinds import contradictions
from pipeline.answers.material.laws import STATES
from pipeline.answers.material.study import FitOptions, Material, fit_tests
from tests.commands import done, refused

MOSELEY = Path(__file__).parents[3] / "data" / "moseley"
TRUTH = fem.Yeoh(0.06, 0.004, 0.0, 100.0)
STRAIN = np.linspace(0.0, 1.5, 40)
#: the final law of the authors of the tests
AUTHORS = """name: authors
geometry: {family: pneunet, chambers: 3}
material:
  law: ogden
  form: abaqus
  mu: [0.0243610418119 MPa, 6.67031796838e-05 MPa, 0.000453810089515 MPa]
  alpha: [1.71377656933, 7.0678724376, -3.36588070882]
  nu: 0.48
pressures: [5 kPa]
"""


def file(folder: Path, state: str, factor: float = 1.0, title: str = "strain (1),stress (MPa)") -> Path:
    stress = factor * TRUTH.incompressible(1 + STRAIN, STATES[state](1 + STRAIN))
    rows = "\n".join(f"{e},{s}" for e, s in zip(STRAIN, stress, strict=True))
    (folder / f"{state}.csv").write_text(f"{title}\n{rows}\n")
    return folder / f"{state}.csv"


def together(folder: Path, *states: str, **factors: float) -> Material:
    files = [file(folder, state, factors.get(state, 1.0)) for state in states]
    return fit_tests(files, FitOptions(kinds=states))


@pytest.mark.parametrize("states", [("uniaxial", "planar"), ("uniaxial", "equibiaxial"), ("planar", "equibiaxial")])
def test_a_law_comes_back_from_tests_of_two_kinds(states: tuple[str, str], tmp_path: Path) -> None:
    found = together(tmp_path, *states)
    assert found.kinds.words == ()
    assert found.judged is found.kinds.together
    best = next(fit for fit in found.judged.usable if fit.name == "yeoh")
    # as exact as the bar of the solver, whose volume grows, is that of the incompressible body
    assert best.constants == pytest.approx([0.06, 0.004, 0.0], rel=2e-2, abs=1e-4)
    measured = "equibiaxial" in states
    assert any("does not pull in two directions" in sentence for sentence in found.words) is not measured
    first = float(TRUTH.incompressible(np.array([2.0]), STATES[states[0]](np.array([2.0])))[0])
    assert any(f"stress at 100 % strain {first:.3g} MPa" in sentence for sentence in found.words)
    assert len(found.kinds.table.rows) > 10
    assert not fit_tests([file(tmp_path, states[1])], FitOptions(kinds=states[1:])).kinds.table


def test_a_planar_test_that_no_law_has_beside_the_uniaxial_one(tmp_path: Path) -> None:
    """1.3 times as stiff it contradicts, 1.1 times it does not; no mean is taken, and each kind has its line."""
    apart = together(tmp_path, "uniaxial", "planar", planar=1.3)
    (sentence,) = apart.kinds.words
    assert re.match(r"The planar test is 1\.3 times what any law says that describes the uniaxial one;", sentence)
    assert next(line for line in apart.lines if line.startswith("#")) == "# uniaxial test alone"
    assert "# planar test alone" in apart.lines
    first = [judged.laws[0].law.shear_modulus for judged in apart.kinds.alone.values()]
    assert first[1] / first[0] == pytest.approx(1.3, rel=0.03)
    assert together(tmp_path, "uniaxial", "planar", planar=1.1).kinds.words == ()
    assert list(contradictions(apart.tests, {})) == []


def test_the_silicone_of_moseley(tmp_path: Path) -> None:
    """One command has the table of the authors' law beside both tests."""
    (tmp_path / "authors.yaml").write_text(AUTHORS)
    files = [str(MOSELEY / "uniaxial.csv"), str(MOSELEY / "planar.csv")]
    out = tmp_path / "out"
    printed = done("material", *files, "--for", str(tmp_path / "authors.yaml"), "--out", str(out))
    assert "The planar test is 1.5 times what any law says that describes the uniaxial one; one of them is" in printed
    assert "0.0067 MPa are taken away from every stress" in printed
    assert "loading 'last' is left out" in printed
    rows = {line.split()[0]: line for line in printed.splitlines() if line.strip()}
    given = numbers(rows["as"])
    assert given[:6] == pytest.approx([0.76, 0.78, 0.83, 1.10, 1.16, 1.25], abs=0.011)
    assert numbers(rows["tests"])[7] == pytest.approx(1.73, abs=0.011)
    assert given[7] == pytest.approx(1.17, abs=0.005)
    record = json.loads((out / "material.json").read_text(encoding="utf-8"))
    assert (record["recommended"], record["yaml"]) == (None, None)
    assert set(record["laws_of_one_kind"]) == {"uniaxial", "planar"}
    assert [line for line in record["lines"] if line.startswith("#")] == [
        "# uniaxial test alone",
        "# beside it, where walls stretch beyond 2.42",
        "# planar test alone",
        "# beside it, where walls stretch beyond 1.94",
    ]


def numbers(line: str) -> Array:
    return np.array([float(text) for text in re.findall(r"\d+\.?\d*(?=,|\s|$)", line)])


def test_laws_beyond_the_tests(tmp_path: Path) -> None:
    """How far a test decides, and that a law with stiffening differs in the limit pressure from one without."""
    found = fit_tests([MOSELEY / "uniaxial.csv"], FitOptions())
    assert found.judged.laws[0].name == "neo_hooke"
    assert "Where walls stretch further take yeoh, which can be used up to 3.45." in found.words
    said = next(sentence for sentence in found.words if sentence.startswith("The tests decide up to a stretch of 3.45"))
    assert said.endswith(
        "Beyond it yeoh stiffens and neo_hooke does not, which decides whether an arm has a limit pressure: run both."
    )


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--kind", "shear"), "--kind shear: is not known; allowed: uniaxial, planar, equibiaxial"),
        (("--kind", "planar", "--kind", "planar", "--kind", "planar"), "--kind: 3 are given for 2 files"),
    ],
)
def test_wrong_kinds(options: tuple[str, ...], complaint: str, tmp_path: Path) -> None:
    files = [str(file(tmp_path, state)) for state in ("uniaxial", "planar")]
    assert complaint in refused("material", *files, *options, "--out", str(tmp_path / "out"))
