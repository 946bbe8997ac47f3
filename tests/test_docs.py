"""The documentation: links and paths exist, the glossary is used, and the words are those of the field."""

import ast
import re
import tomllib
from dataclasses import fields
from pathlib import Path

import pytest
import yaml

from fem.elements import ELEMENTS
from fem.materials import LAWS
from pipeline.cli import app
from pipeline.study.effects.rows import EffectRow
from pipeline.values.parameters import RodParameters
from pipeline.values.run import RodError, State
from tests.reading import read_sources

HERE = Path(__file__).resolve().parent.parent
PAGES = [HERE / "README.md", HERE / "CONTRIBUTING.md", HERE / "CHANGELOG.md", *sorted((HERE / "docs").rglob("*.md"))]
FOLDERS = (
    "geometry",
    "fem",
    "rod",
    "pipeline",
    "pneurod",
    "tests",
    "benchmarks",
    "configs",
    "docs",
    "examples",
    "studies",
)

#: Former names that a reader from outside would not understand, as regular expressions.
DIALECT = (
    r"wiggle",
    r"foretold|foretells",
    r"\bawake\b|\basleep\b|\bwoken\b|\bwakes?\b",
    r"\bforgiving\b|\bstricter\b",
    r"sixth number",
    r"one line suffices",
    r"\bthe closing\b|\bone rung\b|\bthe ladders?\b",
    r"\b(arm|design) \([a-d]\)|\([b-d]\) (to|and) \([b-d]\)",
    r"design notes?\b",
    r"held against",
    r"\bbelieved\b",
    r"older contact",
)


def text_of(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def prose_of(page: Path) -> str:
    """The text of a page without code blocks and code spans."""
    without_blocks = re.sub(r"^```.*?^```", "", text_of(page), flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^ {4}.*$", "", without_blocks, flags=re.MULTILINE))


def links_of(page: Path) -> list[str]:
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text_of(page))
    generated = ("reference/", "../reference/", "../recipes/", "recipes/")  # checked when the site is built
    return [link for link in links if not link.startswith(("http://", "https://", *generated))]


def anchors_of(page: Path) -> set[str]:
    """What links may name in a page: its headings, as the site and GitHub write them in addresses."""
    text = re.sub(r"^```.*?^```", "", text_of(page), flags=re.DOTALL | re.MULTILINE)
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"\s+", "-", re.sub(r"[^\w\s-]", "", heading).strip().lower()) for heading in headings}


def paths_of(page: Path) -> list[str]:
    """The code spans that name a file or folder of the repository."""
    spans = re.findall(r"`([\w./*-]+)`", text_of(page))
    return [span for span in spans if span.split("/")[0] in FOLDERS and "/" in span]


def test_links_between_pages_resolve() -> None:
    links = [(page, link) for page in PAGES for link in links_of(page)]
    assert len(links) > 30
    assert [f"{page.name}: {link}" for page, link in links if not (page.parent / link).exists()] == []


def test_anchors_of_links_are_headings_of_their_pages() -> None:
    """Those within a page too. The changelog names sections as they were; some pages are written with the site."""
    pages = [page for page in PAGES if page.name != "CHANGELOG.md"]
    links = [(page, *link) for page in pages for link in re.findall(r"\]\(([^)#\s:]*)#([^)\s]+)\)", text_of(page))]
    found = [(page, page.parent / name if name else page, anchor) for page, name, anchor in links]
    known = [(page, target, anchor) for page, target, anchor in found if target.suffix == ".md" and target.exists()]
    assert len(known) > 60
    assert [f"{page.name}: {to.name}#{anchor}" for page, to, anchor in known if anchor not in anchors_of(to)] == []


def test_every_page_is_linked_from_the_readme_or_the_overview() -> None:
    links = {HERE / link for link in links_of(HERE / "README.md")}
    links |= {HERE / "docs" / link for link in links_of(HERE / "docs" / "index.md")}
    assert [page.name for page in PAGES if HERE / "docs" in page.parents and page not in links] == []


def test_named_files_and_folders_exist() -> None:
    """The changelog names files as they were."""
    pages = [page for page in PAGES if page.name != "CHANGELOG.md"]
    paths = [(page, path) for page in pages for path in paths_of(page)]
    assert len(paths) > 60
    assert [f"{page.name}: {path}" for page, path in paths if not list(HERE.glob(path.rstrip("/")))] == []


def test_named_test_modules_exist() -> None:
    names = {name for page in PAGES for name in re.findall(r"`(?:[\w/]+/)?(test_\w+\.py)`", text_of(page))}
    assert len(names) > 10
    assert [name for name in sorted(names) if not list((HERE / "tests").rglob(name))] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_use_the_terms_of_the_field(page: Path) -> None:
    prose = prose_of(page)
    assert [match.group() for words in DIALECT for match in re.finditer(words, prose, re.IGNORECASE)] == []


@pytest.mark.parametrize(
    ("file", "row"),
    [
        *(("experiments.json", State), ("validation.json", RodError), ("parameters.json", RodParameters)),
        ("effects_table.json", EffectRow),
    ],
)
def test_every_key_of_a_result_file_is_documented(file: str, row: type) -> None:
    """Keys that end in _std or _95 are those of the number before."""
    section = text_of(HERE / "docs" / "results.md").partition(f"## {file}")[2].partition("\n## ")[0]
    keys = [field.name for field in fields(row) if not field.name.endswith(("_std", "_95"))]
    assert len(keys) > 10
    assert [key for key in keys if f"`{key}`" not in section] == []


def terms() -> list[str]:
    rows = re.findall(r"^\| ([^|]+) \|", text_of(HERE / "docs" / "glossary.md"), re.MULTILINE)
    return [term.strip(" `") for row in rows if row != "term" for term in row.split(", ")]


def test_every_term_of_the_glossary_is_used() -> None:
    sources = [path for folder in ("geometry", "fem", "rod", "pipeline") for path in (HERE / folder).rglob("*.py")]
    pages = [page for page in PAGES if page.name != "glossary.md"]
    words = " ".join(" ".join(text_of(path).lower().split()) for path in (*pages, *sources))
    assert len(terms()) > 50
    assert [term for term in terms() if term.lower() not in words] == []


def test_the_citation_has_the_version_of_the_package() -> None:
    citation = yaml.safe_load(text_of(HERE / "CITATION.cff"))
    project = tomllib.loads(text_of(HERE / "pyproject.toml"))["project"]
    assert citation["version"] == project["version"]
    assert citation["license"] == project["license"]
    assert citation["references"][0]["title"].startswith("On the development of rod-based models")


def test_docstrings_stand_alone() -> None:
    """They begin with what a thing is or does, and do not go on from its name."""
    begins = re.compile(r"(Of|That|Those|The same|As|By|In)\b")
    found = [
        f"{file.path}: {node.name}: {text.partition(chr(10))[0]}"
        for file in read_sources()
        for node in file.nodes
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
        if begins.match(text := ast.get_docstring(node) or "")
    ]
    assert found == []


def test_every_key_of_effects_table_json_is_documented() -> None:
    section = text_of(HERE / "docs" / "results.md").partition("### effects_table.json")[2].partition("\n## ")[0]
    keys = [field.name for field in fields(EffectRow)]
    assert len(keys) > 20
    assert [key for key in keys if f"`{key}`" not in section] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_lines_outside_tables_are_short(page: Path) -> None:
    """120 characters, and some more where a path became longer."""
    lines = text_of(page).splitlines()
    long = [line for line in lines if len(line) > 130 and not line.startswith(("|", "- ", "    ", "!["))]
    assert long == []


@pytest.mark.parametrize("name", LAWS)
def test_the_page_on_materials_names_every_law(name: str) -> None:
    assert re.search(rf"\b{name}\b", text_of(HERE / "docs" / "materials.md"))


def test_the_documentation_stays_short() -> None:
    """At most 60 000 words; what was measured in detail is in studies/."""
    words = sum(len(text_of(page).split()) for page in (HERE / "docs").rglob("*.md"))
    assert 20_000 < words < 60_000


@pytest.mark.parametrize("name", ELEMENTS)
def test_the_pages_on_theory_and_accuracy_name_every_element(name: str) -> None:
    for page in ("theory.md", "accuracy.md"):
        assert f"`{name}`" in text_of(HERE / "docs" / page), page


def test_one_subtitle_stands_everywhere() -> None:
    project = tomllib.loads(text_of(HERE / "pyproject.toml"))["project"]
    subtitle = project["description"]
    texts = {name: text_of(HERE / name) for name in ("README.md", "mkdocs.yml", "CITATION.cff")}
    assert subtitle.lower() in texts["CITATION.cff"].lower()
    assert f"site_description: {subtitle}" in texts["mkdocs.yml"]
    assert f"\n\n{subtitle}.\n" in texts["README.md"]
    assert app.info.help == f"{subtitle}."
    assert all(f"  - {word}" in texts["CITATION.cff"] for word in project["keywords"])


#: of former sentences, whose plain forms are in their place
FORMER = (
    "Most would help",
    "tolerances move its tip",
    "It is known within",
    "law in space has no weight",
    "EI/l^2 / 50",
    "however small, the offsets",
    "It holds from",
    "for which law",
    "agrees with it in two directions",
    "without one at equal pressures",
    "use the arm's own law",
    "because the mesh makes an error",
)


def test_former_sentences_are_gone() -> None:
    for path in (*(HERE / "rod").rglob("*.py"), *(HERE / "pipeline").rglob("*.py")):
        joined = re.sub(r'"\s*\n\s*f?"', "", text_of(path))
        assert [former for former in FORMER if former in joined] == [], path
