"""Designs described in Python: bodies, materials, and the sentences for what is wrong with them."""

import inspect
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import pytest

import geometry
import pneurod
from fem.materials import LAWS
from geometry import FAMILIES, CadFile, MeshFile, SurfaceFile
from pipeline.api.described import Body, Material
from pipeline.config.body import geometry_section
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.config.material import material_section
from pneurod import designs

FROM_FILE = (CadFile, MeshFile, SurfaceFile)


def config_of(monkeypatch: pytest.MonkeyPatch, *arguments: Any, **keywords: Any) -> Config:
    """The configuration that would be run."""
    given: list[Config] = []

    class Stopped(Exception):
        pass

    def stop(config: Config, *_: Any) -> None:
        given.append(config)
        raise Stopped

    monkeypatch.setattr("pipeline.run.run", stop)
    with pytest.raises(Stopped):
        pneurod.characterize(*arguments, **keywords)
    return given[0]


def test_every_family_and_every_law_has_a_class() -> None:
    classes = [value for value in vars(designs).values() if isinstance(value, type) and "choice" in vars(value)]
    chosen = {kind: {c.choice[1] for c in classes if issubclass(c, kind)} for kind in (Body, Material)}
    assert chosen == {Body: {*geometry.FAMILIES, "own"}, Material: set(LAWS)}
    assert {kind.__name__ for kind in classes} <= set(pneurod.__all__)


def test_every_class_has_the_keys_of_its_section() -> None:
    classes = [value for value in vars(designs).values() if isinstance(value, type) and "choice" in vars(value)]
    for kind in classes:
        key, name = kind.choice
        if key == "law":
            sections = [material_section(LAWS[name])]
        else:
            sections = [geometry_section(design) for design in ([FAMILIES[name]] if name in FAMILIES else FROM_FILE)]
        keys = {field: given for section in sections for field, given in section.key_fields().items() if field != key}
        own = {field.name: field for field in fields(kind)}
        assert set(own) == set(keys) | ({"form"} if name == "ogden" else set()), kind
        required = {field for field, given in own.items() if given.default is MISSING}
        assert required == {field for field, given in keys.items() if given.is_required()}, kind


@pytest.mark.parametrize("name", sorted(pneurod.__all__))
def test_every_public_function_and_constructor_names_its_arguments(name: str) -> None:
    public = getattr(pneurod, name)
    if callable(public) and not (isinstance(public, type) and issubclass(public, Exception)):
        kinds = {parameter.kind for parameter in inspect.signature(public).parameters.values()}
        assert not kinds & {inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL}


def test_a_design_in_python_is_the_one_of_a_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = tmp_path / "finger.yaml"
    path.write_text(
        "name: finger\ngeometry: {family: pneunet, chambers: 6, wall: 1.2 mm}\n"
        "material: {law: neo_hooke, mu: 0.1 MPa, kappa: 5 MPa}\npressures: [2 kPa, 4 kPa]\nmesh: {size: 6 mm}\n"
    )
    body = pneurod.PneuNet(chambers=6, wall="1.2 mm")
    rubber = pneurod.NeoHooke(mu="0.1 MPa", kappa="5 MPa")
    pressures, mesh = ["2 kPa", "4 kPa"], {"mesh.size": "6 mm"}
    given = config_of(monkeypatch, body, name="finger", material=rubber, pressures=pressures, settings=mesh)
    assert given.record() == load_config(path).record()
    changed = config_of(monkeypatch, path, material=pneurod.Hencky(E="1 MPa", nu=0.49), pressures=["3 kPa"])
    assert (changed.material.law, changed.pressures_kPa) == ("hencky", (3.0,))
    assert changed.design == given.design
    assert body == pneurod.PneuNet(wall="1.2 mm", chambers=6)
    assert body != pneurod.Semicircular(wall="1.2 mm", chambers=6)
    assert repr(body) == "PneuNet(chambers=6, wall='1.2 mm')"


def test_a_family_names_the_design_and_its_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    assert (
        config_of(
            monkeypatch, pneurod.BisectedCircle(), material=pneurod.Yeoh(c10="0.1 MPa", c20="0 MPa", c30="0 MPa")
        ).name
        == "bisected_circle"
    )


def test_every_error_for_callers_has_one_base() -> None:
    for error in (
        pneurod.InputError,
        pneurod.RunFailed,
        pneurod.RodError,
        pneurod.fem.NotConverged,
        geometry.MeshError,
    ):
        assert issubclass(error, pneurod.PneurodError)
