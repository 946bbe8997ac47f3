"""The reference of the keys is that of the schema, and the file of `pneurod init` is a configuration."""

import re
from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

from fem.materials import LAWS
from geometry import FAMILIES, CadFile, MeshFile, SurfaceFile
from pipeline.cli import app
from pipeline.config.config import AUTO
from pipeline.config.example import BODIES, example
from pipeline.config.load import load_config
from pipeline.config.reference import effect_keys, general_keys, geometry_keys, material_keys, with_tables
from pipeline.simulation.scene import Scene

PAGE = Path(__file__).resolve().parent.parent / "docs" / "configuration.md"


def test_the_page_has_the_tables_of_the_schema() -> None:
    """`python -m pipeline.config.reference docs/configuration.md` writes them."""
    page = PAGE.read_text(encoding="utf-8")
    assert page.count("<!-- keys: ") == 11
    assert with_tables(page) == page


def test_every_key_is_on_the_page() -> None:
    page = PAGE.read_text(encoding="utf-8")
    keys = [entry.key for entry in general_keys()] + [f"effects.{entry.key}" for entry in effect_keys()]
    for design in (*FAMILIES.values(), CadFile, MeshFile, SurfaceFile):
        keys += [entry.key for entry in geometry_keys(design)]
    for law in LAWS:
        keys += [entry.key for entry in material_keys(law)]
    assert len(keys) > 70
    assert [key for key in keys if f"| `{key}` |" not in page] == []


def test_every_key_says_what_it_means() -> None:
    entries = [*general_keys(), *effect_keys(), *(e for law in LAWS for e in material_keys(law))]
    for entry in [
        *entries,
        *(e for design in (*FAMILIES.values(), CadFile, MeshFile, SurfaceFile) for e in geometry_keys(design)),
    ]:
        assert len(entry.meaning) > 4, entry
        assert entry.allowed, entry
        assert entry.example, entry


@pytest.mark.parametrize("family", BODIES)
def test_init_writes_a_configuration_that_is_meshed(family: str, tmp_path: Path, configs: Path) -> None:
    (tmp_path / "finger.step").write_bytes((configs / "finger.step").read_bytes())
    file = tmp_path / "arm.yaml"
    result = CliRunner().invoke(app, ["init", family, "--out", str(file)])
    assert result.exit_code == 0, result.stderr
    config = load_config(file, ["mesh.size=6 mm"])
    assert config.name == f"my_{family}"
    assert Scene.meshed(config).body.mesh.volume > 0.0
    if family in FAMILIES:
        assert config.design == FAMILIES[family]()


@pytest.mark.parametrize("family", BODIES)
def test_every_key_of_the_written_file_can_be_used(family: str, tmp_path: Path, configs: Path) -> None:
    (tmp_path / "finger.step").write_bytes((configs / "finger.step").read_bytes())
    text = re.sub(r"^# (?=\s*\w+:(\s|$))", "", example(family), flags=re.MULTILINE)
    content = yaml.safe_load(text)
    assert {"newton", "validation", "effects", "accuracy", "law", "end"} <= set(content)
    file = tmp_path / "arm.yaml"
    file.write_text(text, encoding="utf-8")
    config = load_config(file)
    assert config.mesh.size_mm is AUTO  # with an accuracy, which decides it
    assert config.newton.tolerance == 1e-6


def test_init_replaces_no_file_and_knows_the_families(tmp_path: Path) -> None:
    file = tmp_path / "arm.yaml"
    file.write_text("mine")
    refused = CliRunner().invoke(app, ["init", "--out", str(file)])
    assert (refused.exit_code, file.read_text()) == (2, "mine")
    assert "--force" in refused.stderr
    assert CliRunner().invoke(app, ["init", "--out", str(file), "--force"]).exit_code == 0
    wrong = CliRunner().invoke(app, ["init", "pneunett", "--out", str(tmp_path / "other.yaml")])
    assert wrong.exit_code == 2
    assert "did you mean 'pneunet'?" in wrong.stderr
