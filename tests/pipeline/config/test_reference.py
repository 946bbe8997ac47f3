"""The reference of the keys is that of the schema, and the file of `pneurod init` is a configuration."""

import re
import runpy
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import pytest
import yaml

from fem.materials import LAWS, NeoHooke
from fem.materials.material import PositiveStress
from geometry import FAMILIES, CadFile, MeshFile, SurfaceFile
from pipeline.config.body import BODIES, OWN
from pipeline.config.example import RUBBER, example
from pipeline.config.load import load_config
from pipeline.config.reference import REQUIRED, effect_keys, general_keys, geometry_keys, material_keys
from pipeline.simulate.scene import Scene
from pipeline.simulate.too_short import too_short
from tests.commands import done, refused

PAGE = Path(__file__).resolve().parent.parent.parent.parent / "docs" / "configuration.md"
#: what writes the tables of the page
TABLES = runpy.run_path(str(PAGE.parent / "hooks" / "key_tables.py"))


def test_the_page_has_the_tables_of_the_schema() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert page.count("<!-- keys: ") == 11
    assert TABLES["with_tables"](page) == page


def test_the_examples_of_the_page_are_arms_with_five_parameters(tmp_path: Path, configs: Path) -> None:
    base = yaml.safe_load((configs / "pneunet_coarse.yaml").read_text(encoding="utf-8"))
    blocks = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert len(blocks) == 3
    for block in blocks:
        keys = yaml.safe_load(block)
        file = tmp_path / "arm.yaml"
        file.write_text(yaml.safe_dump(keys if "name" in keys else {**base, **keys}), encoding="utf-8")
        assert too_short(load_config(file)) is None, block


@pytest.mark.parametrize(("kind", "meaning"), [(PositiveStress, "above zero"), (Annotated[PositiveStress, "J"], "J")])
def test_a_constant_of_a_new_law_is_in_the_reference(
    kind: object, meaning: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    law = dataclass(frozen=True)(type("Gent", (NeoHooke.__base__,), {"__annotations__": {"Jm": kind}}))
    monkeypatch.setitem(LAWS, "gent", law)
    entry = next(entry for entry in material_keys("gent") if entry.key == "Jm")
    assert (entry.unit, entry.default) == ("MPa", REQUIRED)
    assert meaning in entry.meaning
    assert any("`Jm`" in line and "`gent`" in line for line in TABLES["tables"]()["material"].splitlines())


@pytest.mark.parametrize("family", BODIES)
def test_init_writes_a_configuration_that_is_meshed(family: str, tmp_path: Path, configs: Path) -> None:
    (tmp_path / "finger.step").write_bytes((configs / "finger.step").read_bytes())
    file = tmp_path / "arm.yaml"
    done("init", family, "--out", str(file))
    config = load_config(file, ["mesh.size=6 mm"])
    assert config.name == f"my_{family}"
    assert config.material.name == RUBBER
    keys = list(yaml.safe_load(file.read_text(encoding="utf-8")))
    assert keys == ["name", "geometry", "material", "pressures", *(["mesh"] if family != OWN else [])]
    assert Scene.meshed(config).body.mesh.volume > 0.0
    if family in FAMILIES:
        assert config.design == FAMILIES[family]()


@pytest.mark.parametrize("family", BODIES)
def test_every_key_of_the_written_file_can_be_used(family: str, tmp_path: Path, configs: Path) -> None:
    (tmp_path / "finger.step").write_bytes((configs / "finger.step").read_bytes())
    text = re.sub(r"^# (?=\s*\w+:(\s|$))", "", example(family, every=True), flags=re.MULTILINE)
    text = re.sub(r"^  kappa: .*$", "", text, flags=re.MULTILINE)  # nu is given instead
    text = re.sub(r"^    threads: .*$", "", text, flags=re.MULTILINE)  # thickness and E are given instead
    if family == "pneunet":  # the lists are given instead of these
        text = re.sub(r"^  (chamber_length|chamber_height|gap): .*$", "", text, flags=re.MULTILINE)
    if family == OWN:  # the file of this test is a single solid
        text = re.sub(r"^(  parts|materials): .*$", "", text, flags=re.MULTILINE)
    content = yaml.safe_load(text)
    assert {"newton", "validation", "effects", "accuracy", "law", "end"} <= set(content)
    assert ("materials" in content) == (family not in (OWN, "bisected_circle"))
    file = tmp_path / "arm.yaml"
    file.write_text(text, encoding="utf-8")
    config = load_config(file)
    assert config.newton.tolerance == 1e-6


def test_of_a_body_from_a_file_only_required_keys_are_no_comments() -> None:
    text = example(OWN, every=True)
    content = yaml.safe_load(text)
    assert set(content) == {"name", "geometry", "material", "pressures"}
    assert set(content["geometry"]) == {"family", "file", "curve"}
    assert {"  parts:", "  cell:", "  air:", "  tip:"} <= set(re.findall(r"^# (  \w+:)", text, re.M))
    assert "# materials: {base: " in text


def test_init_replaces_no_file(tmp_path: Path) -> None:
    file = tmp_path / "arm.yaml"
    file.write_text("mine")
    assert "--force" in refused("init", "--out", str(file))
    assert file.read_text() == "mine"
    done("init", "--out", str(file), "--force")


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
def test_a_line_with_a_value_that_is_no_default_says_so(family: str) -> None:
    lines = example(family, every=True).splitlines()
    for entry in general_keys():
        key = entry.key.rpartition(".")[2]
        shown = [line for line in lines if re.match(rf"# +{key}: ", line) and entry.plain_meaning in line]
        if "." in entry.key and entry.default == "none":
            assert shown, entry
            assert all(line.endswith("; an example") for line in shown)
