"""Recipes: what is kept belongs to the present code, their pages and notebooks are complete, and they run."""

import re
import sys
from pathlib import Path

import nbformat
import pytest

import pneurod

HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE / "docs" / "hooks"))
try:
    import recipes
finally:
    sys.path.pop(0)

NAMES = recipes.recipes()
#: without finite elements of an arm
QUICK = ["own_material", "own_mesh", "rod_alone", "tensile_file"]
#: they need no more than the rod of an arm, here that of a stored run
WITH_STORED_ARM = ["hanging_arm", "gripper"]
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to run in, with what recipes read from the clone."""
    for name in ("configs", "examples"):
        (tmp_path / name).symlink_to(HERE / name)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.setenv("PYTHONPATH", str(HERE))
    return tmp_path


def words_and_numbers(lines: list[str]) -> tuple[str, list[float]]:
    """Printed lines without measured times: the words, and the numbers between them."""
    text = "\n".join(line.rstrip() for line in lines if "ms per shape" not in line)
    return re.sub(r"\s+", " ", NUMBER.sub("#", text)).strip(), [float(number) for number in NUMBER.findall(text)]


def prints_what_is_kept(name: str) -> None:
    """Run a recipe in the present folder and compare."""
    printed = [line for text in recipes.run(name) for line in text.splitlines()]
    words, numbers = words_and_numbers(printed)
    kept_words, kept_numbers = words_and_numbers([line for lines in recipes.kept(name)["printed"] for line in lines])
    assert words == kept_words
    assert numbers == pytest.approx(kept_numbers, rel=0.02, abs=0.05)
    assert (recipes.RESULTS / f"{name}.png").stat().st_size > 5_000


@pytest.mark.parametrize("name", NAMES)
def test_what_is_kept_belongs_to_the_present_code(name: str) -> None:
    assert recipes.kept(name)["code"] == recipes.code_hash(recipes.read(name)), f"run docs/hooks/recipes.py {name}"


@pytest.mark.parametrize("name", NAMES)
def test_every_recipe_is_a_notebook_with_text_and_a_small_picture(name: str) -> None:
    notebook = recipes.notebook_of(name)
    nbformat.validate(notebook)
    first, last = notebook.cells[0].source, notebook.cells[-1].source
    assert first.startswith("# ")
    assert last.startswith("## What to change\n")
    outputs = [output for cell in recipes.code_cells(notebook) for output in cell.outputs]
    assert [output.output_type for output in outputs].count("display_data") == 1
    assert any(output.output_type == "stream" and output.text.strip() for output in outputs)
    for ending in ("json", "png"):
        assert 100 < (recipes.KEPT / f"{name}.{ending}").stat().st_size < 60_000
    page = recipes.page_of(name)
    assert f"]({name}.png)" in page
    assert f"]({name}.ipynb)" in page


@pytest.mark.parametrize("name", QUICK)
def test_quick_recipes_print_what_is_kept(name: str, clone: Path) -> None:
    prints_what_is_kept(name)


@pytest.mark.filterwarnings("ignore::pneurod.RodWarning")
@pytest.mark.parametrize("name", WITH_STORED_ARM)
def test_recipes_run_with_a_stored_arm(name: str, clone: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stored = pneurod.read_results(HERE / "tests" / "data" / "results_coarse")
    monkeypatch.setattr(pneurod, "characterize", lambda *design, **more: stored)
    recipes.RESULTS.mkdir(parents=True)
    printed = "".join(recipes.run(name))
    words, _ = words_and_numbers(printed.splitlines())
    assert words == words_and_numbers([line for lines in recipes.kept(name)["printed"] for line in lines])[0]
    assert (recipes.RESULTS / f"{name}.png").is_file()


@pytest.mark.slow  # whole runs of arms; those above call what they call
@pytest.mark.parametrize("name", [name for name in NAMES if name not in QUICK])
def test_recipes_print_what_is_kept(name: str, clone: Path) -> None:
    prints_what_is_kept(name)


def test_nothing_is_kept_of_recipes_that_are_gone() -> None:
    assert sorted(path.name for path in recipes.KEPT.iterdir()) == sorted(
        f"{name}.{ending}" for name in NAMES for ending in ("json", "png")
    )
    assert len(NAMES) >= 10


@pytest.mark.parametrize("name", NAMES)
def test_a_recipe_is_a_screen_of_code_in_short_sentences(name: str) -> None:
    notebook = recipes.read(name)
    lines = [line for cell in recipes.code_cells(notebook) for line in cell.source.splitlines()]
    assert sum(bool(line.strip()) and not line.lstrip().startswith("#") for line in lines) <= 60
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            for sentence in re.split(r"[.?!:]\s|\n\n|\n- ", cell.source):
                assert len(sentence.split()) <= 25, sentence
