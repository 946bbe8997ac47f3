"""The documentation site: it is built without a warning, its reference is complete, and its commands and blocks run."""

import html
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from playwright.sync_api import sync_playwright

from fem.materials import LAWS
from pipeline.cli import app
from pipeline.config.load import load_config

HERE = Path(__file__).resolve().parent.parent
DOCS = HERE / "docs"
GUIDES = [DOCS / "index.md", DOCS / "tutorial.md", *sorted((DOCS / "how_to").glob("*.md"))]
COARSE = ("--set", "mesh.size=8 mm")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the site, built as `make docs` builds it: every warning ends the build."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = {**os.environ, "PYTHONPATH": str(HERE), "NO_MKDOCS_2_WARNING": "1"}
    ended = subprocess.run(command, capture_output=True, text=True, check=False, cwd=HERE, env=environment)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return folder


def text_of(page: Path) -> str:
    """The words of a page of the site, without tags."""
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page.read_text(encoding="utf-8")))


def commands_of(page: Path) -> list[list[str]]:
    """The commands `pneurod ...` of the indented blocks of a page, a continued line joined with the next one."""
    text = page.read_text(encoding="utf-8").replace("\\\n", " ")
    return [shlex.split(line) for line in re.findall(r"^ +\.venv/bin/pneurod (.*)$", text, re.MULTILINE)]


def registered() -> dict[str, object]:
    return {command.name or command.callback.__name__: command for command in app.registered_commands}


def test_the_reference_has_every_command_law_and_recipe(site: Path) -> None:
    commands = text_of(site / "reference" / "commands.html")
    assert [name for name in registered() if f"pneurod {name}" not in commands] == []
    laws = text_of(site / "reference" / "laws.html")
    assert [name for name in LAWS if f"law : {name}" not in laws and f"law: {name}" not in laws] == []
    recipes = [path.stem for path in (HERE / "examples").glob("*.py")]
    kinds = ("html", "ipynb", "png")
    assert [name for name in recipes for kind in kinds if not (site / "recipes" / f"{name}.{kind}").is_file()] == []


def test_the_messages_are_those_of_the_sources(site: Path) -> None:
    messages = text_of(site / "reference" / "messages.html")
    assert messages.count("InputError") > 30
    assert "the body <name> has no face named <missing>; it has <faces>" in html.unescape(messages)
    assert messages.count("RodError") > 30
    # a sentence that is made in parts is one sentence
    assert "has a triangle that near <centre> is no boundary face of a tetrahedron" in html.unescape(messages)
    assert "is not among the programs of export" in messages


def test_no_page_loads_anything_from_elsewhere(site: Path) -> None:
    loaded = [
        f"{page.name}: {address}"
        for page in site.rglob("*.html")
        for address in re.findall(r'<(?:script|link|img|iframe)[^>]+(?:src|href)="(http[^"]+)"', page.read_text())
    ]
    assert loaded == []


def test_the_search_works_in_a_folder_and_wide_tables_show_that_they_scroll(site: Path) -> None:
    if (program := shutil.which("chromium")) is None:
        pytest.skip("no Chromium on this machine (Debian package chromium)")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto((site / "how_to" / "robots.html").as_uri())
        page.click(".md-search__input")
        page.keyboard.type("tolerances")
        found = page.wait_for_selector(".md-search-result__link")
        assert str(found.get_attribute("href")).endswith("how_to/budget.html")
        page.goto((site / "peers.html").as_uri())
        wide = "document.querySelector('.md-typeset__scrollwrap')"
        assert page.evaluate(f"{wide}.scrollWidth > {wide}.clientWidth")
        assert "linear-gradient" in page.evaluate(f"getComputedStyle({wide}).backgroundImage")
        assert [address for address in asked if not address.startswith("file:")] == []
        browser.close()


def test_every_example_line_of_a_law_is_accepted(tmp_path: Path) -> None:
    sys.path.insert(0, str(DOCS / "hooks"))
    try:
        from material_laws import LINES
    finally:
        sys.path.pop(0)
    assert set(LINES) == set(LAWS)
    for name, line in LINES.items():
        config = tmp_path / f"{name}.yaml"
        config.write_text(f"name: a\ngeometry: {{family: pneunet}}\nmaterial: {line}\nmesh: {{size: 4 mm}}\n")
        assert load_config(config).material is not None


@pytest.mark.parametrize("page", GUIDES, ids=lambda page: page.stem)
def test_commands_of_the_guides_exist_with_their_options(page: Path) -> None:
    import typer

    known = typer.main.get_command(app).commands
    for words in commands_of(page):
        options = {option for parameter in known[words[0]].params for option in parameter.opts}
        assert [word for word in words if word.startswith("--") and word not in options] == []


@pytest.mark.parametrize("page", GUIDES, ids=lambda page: page.stem)
def test_yaml_blocks_of_the_guides_are_accepted(page: Path, tmp_path: Path) -> None:
    shutil.copytree(HERE / "configs", tmp_path / "configs")
    blocks = re.findall(r"```yaml\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for block in blocks:
        keys = yaml.safe_load(block)
        base = yaml.safe_load((HERE / "configs" / "semicircular_coarse.yaml").read_text(encoding="utf-8"))
        path = tmp_path / "configs" / "block.yaml"
        path.write_text(yaml.safe_dump(keys if "name" in keys else {**base, **keys}), encoding="utf-8")
        assert load_config(path).name


#: the runs of the tutorial take a minute; tests/test_recipes.py makes such runs too
ON_RESULTS_OF_THE_TUTORIAL = pytest.mark.slow


@pytest.fixture(scope="module")
def followed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder in which the tutorial was followed, with a coarser mesh and without loads that nothing is fitted to;
    the second run is without the own law."""
    folder = tmp_path_factory.mktemp("tutorial")
    shutil.copytree(HERE / "configs", folder / "configs")
    [block] = re.findall(r"```yaml\n(.*?)```", (DOCS / "tutorial.md").read_text(encoding="utf-8"), flags=re.DOTALL)
    (folder / "my_arm.yaml").write_text(block, encoding="utf-8")
    for words in commands_of(DOCS / "tutorial.md"):
        if "--set" in words:  # the same arm with another modulus
            continue
        coarse = COARSE if words[0] in ("run", "mesh") else ()
        quick = ("--set", "validation=off") if words[0] == "run" else ()
        five = ("--set", "law=five") if words[:2] == ["run", "my_arm.yaml"] else ()
        ended = run_in(folder, "-m", "pipeline", *words, *coarse, *quick, *five)
        assert ended.returncode == 0, ended.stderr
    return folder


def run_in(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(HERE)}
    command = [sys.executable, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder, env=environment)


@ON_RESULTS_OF_THE_TUTORIAL
def test_the_tutorial_can_be_followed(followed: Path) -> None:
    assert (followed / "results" / "first" / "report.html").is_file()
    assert (followed / "results" / "first" / "law.json").is_file()
    assert (followed / "results" / "my_body" / "mesh.vtu").is_file()
    assert (followed / "results" / "my_arm" / "parameters.json").is_file()


@ON_RESULTS_OF_THE_TUTORIAL
def test_the_python_guide_runs_on_the_results_of_the_tutorial(followed: Path) -> None:
    text = (DOCS / "how_to" / "python.md").read_text(encoding="utf-8")
    block, _ = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    (followed / "block.py").write_text(block, encoding="utf-8")
    ended = run_in(followed, "-W", "error", "block.py")
    assert (ended.returncode, ended.stderr) == (0, "")
    last = [float(word) for word in ended.stdout.splitlines()[-1].split()]
    assert 0.0 < last[0] < 112.0


@ON_RESULTS_OF_THE_TUTORIAL
def test_the_formats_of_the_guide_on_robots_are_those_of_the_program(followed: Path) -> None:
    from rod.export.formats import EXPORTS

    text = (DOCS / "how_to" / "robots.md").read_text(encoding="utf-8")
    assert [name for name in EXPORTS if f"`{name}`" not in text] == []
    for words in commands_of(DOCS / "how_to" / "robots.md"):
        ended = run_in(followed, "-m", "pipeline", *words)
        assert ended.returncode == 0, ended.stderr


def test_the_python_page_shows_signatures(site: Path) -> None:
    page = text_of(site / "python.html")
    assert "characterize" in page
    assert "progress" in page
    assert "read_results" in page
