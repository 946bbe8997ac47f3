"""The cases as values, read from cases.yaml."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

HERE = Path(__file__).resolve().parent
CONFIGS = HERE.parent.parent / "configs"

#: what two states are compared by: position of the end over the length, force on the end, volume of the air,
#: the length of the material curve, the force of the clamp, or the air of a tube over that at rest
QUANTITIES = ("end", "force", "volume", "stretch", "clamp", "air")


@dataclass(frozen=True)
class Scene:
    """What is solved: a configuration with some values replaced, one experiment, and the pressures in their order."""

    config: str  #: name of a file in configs/
    settings: tuple[str, ...]  #: as after `--set`
    experiment: str  #: I, II, III or dead
    pressures: tuple[float, ...]  #: kPa
    force: tuple[float, float]  #: N, in dead
    as_own_mesh: bool  #: written to a .msh and read back as a body of one's own

    def changed(self, values: Mapping[str, Any]) -> "Scene":
        """The scene with the keys of a case replaced; `set` is added to what is set already."""
        return Scene(
            config=values.get("config", self.config),
            settings=(*(self.settings if values.get("config") is None else ()), *values.get("set", ())),
            experiment=values.get("experiment", self.experiment),
            pressures=tuple(map(float, values.get("pressures", self.pressures))),
            force=tuple(values.get("force", self.force)),
            as_own_mesh=values.get("as_own_mesh", self.as_own_mesh),
        )


@dataclass(frozen=True)
class Check:
    """A number that a solved case must come near to: of a second scene, or a value given here."""

    against: str  #: in words
    of: str  #: one of QUANTITIES
    twin: Scene | None
    times: float  #: what the twin's number is multiplied by
    value: float | Sequence[float] | None
    within: float  #: largest difference, relative but for `end`


@dataclass(frozen=True)
class HardCase:
    """One line of the table."""

    name: str
    scene: Scene
    limit: str  #: what the reason must say; empty where the case is solved
    check: Check | None  #: of a solved case
    aspect: float  #: the mesh has an element at least as slender
    #: name of a rod of `rods.py` and its part of the load, or of a tube of `tubes.py` and MPa, in place of the scene
    rod: tuple[str, float] | None = None

    def __post_init__(self) -> None:
        assert bool(self.limit) != (self.check is not None), f"{self.name}: either a limit or a check"


#: keys of a scene in cases.yaml
SCENE = ("set", "experiment", "pressures", "force", "as_own_mesh")
PLAIN = Scene("pneunet_coarse", (), "II", (), (0.0, 0.0), False)


def read_cases(path: Path = HERE / "cases.yaml") -> tuple[HardCase, ...]:
    """All cases, in the order of the file."""
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    bases = {name: PLAIN.changed(values) for name, values in document["bases"].items()}
    return tuple(_case(values, bases) for values in document["cases"])


def _case(values: Mapping[str, Any], bases: Mapping[str, Scene]) -> HardCase:
    _only(values, ("name", "base", "rod", "limit", "check", "aspect", *SCENE))
    scene = bases[values["base"]].changed(values) if "base" in values else PLAIN
    check, rod = values.get("check"), values.get("rod")
    checked = check and _check(check, scene, bases)
    limit, aspect = values.get("limit", ""), values.get("aspect", 0.0)
    return HardCase(values["name"], scene, limit, checked, aspect, rod and tuple(rod))


def _check(values: Mapping[str, Any], scene: Scene, bases: Mapping[str, Scene]) -> Check:
    _only(values, ("against", "of", "twin", "times", "value", "within"))
    assert values["of"] in QUANTITIES, values["of"]
    twin = values.get("twin")
    if twin is not None:
        _only(twin, ("base", *SCENE))
        begin = bases[twin["base"]] if "base" in twin else scene
        pressures = twin.get("pressures", scene.pressures)
        twin = replace(begin.changed(twin), pressures=tuple(map(float, pressures)))
    assert (twin is None) == ("value" in values), "a check is against a twin or against a value"
    return Check(
        values["against"], values["of"], twin, values.get("times", 1.0), values.get("value"), float(values["within"])
    )


def _only(values: Mapping[str, Any], keys: Sequence[str]) -> None:
    unknown = set(values) - set(keys)
    assert not unknown, f"unknown keys {unknown}"
