"""Whose folder it is: a command may be repeated; what another one or a hand has made or changed is refused."""

import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.values.errors import InputError, argument
from pipeline.values.formats import BODY, PAIRS_PAGE
from pipeline.values.json_values import JsonObject


@dataclass(frozen=True)
class Owner:
    """What fills a folder with results."""

    name: str
    mark: str  #: the file by which it is known
    files: tuple[str, ...]  #: the others at the top of the folder
    folders: tuple[str, ...] = ()

    def has(self, folder: Path) -> bool:
        """Whether the results in a folder are of this kind."""
        return (folder / self.mark).is_file()

    def clear(self, folder: Path) -> None:
        """Remove such results, and nothing else."""
        if self.has(folder):
            for name in (self.mark, *self.files):
                (folder / name).unlink(missing_ok=True)
            for name in self.folders:
                shutil.rmtree(folder / name, ignore_errors=True)

    def unlike(self, folder: Path, identity: JsonObject) -> list[str]:
        """The keys by which results in a folder are of something else; none where nothing but a body was made yet."""
        made = [folder / name for name in self.files if name != BODY]
        made += [path for name in self.folders for path in (folder / name).rglob("*")]
        if not any(path.is_file() and path != folder / self.mark for path in made):
            return []
        try:
            kept = json.loads((folder / self.mark).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            kept = None
        known = kept if isinstance(kept, Mapping) else {}
        own = json.loads(json.dumps(identity))
        return [
            key.removesuffix("_hash").replace("config", "configuration") for key in own if known.get(key) != own[key]
        ]


RUN = Owner(
    "a run",
    "states/configuration.json",
    (
        *("parameters.json", "experiments.json", "validation.json", "effects.json", "run.json", "accuracy.json"),
        *("law.json", "law_on_mesh_of_arm.json", "curves.csv", "validation_curves.csv", BODY, "I.pvd", "II.pvd"),
        *("III.pvd", "report.html", "accuracy.html", "design.yaml", "design.json", "history.csv", "design.html"),
    ),
    ("states", "pictures", "fields", "rungs", "law", "law_in_space"),
)
PAIRS = Owner("runs at pairs of pressures", PAIRS_PAGE, ("law.json", "run.json"))
SWEEP = Owner("a sweep", "sweep.json", ("sweep.csv", "sweep.html", "effects_table.json"), ("points",))
CALIBRATION = Owner(
    "a calibration", "calibration.json", ("law.json", "run.json", "predictions.csv", "calibration.html", BODY)
)
MATERIAL = Owner("a fit of a material", "material.json", ("material_curves.csv", "material.html"))
#: a folder has one of them; the motion of an arm stands beside its law
OWNERS = RUN, PAIRS, SWEEP, CALIBRATION, MATERIAL
MOTION = Owner("a motion", "motion.html", ("motion.csv",))


def claim(
    out: Path | str, owner: Owner, identity: JsonObject | None = None, *, fresh: bool | None = None
) -> ResultFolder:
    """The folder for results, made if it is missing.

    identity: what they belong to, by keys of the mark; None where earlier ones of any are replaced. fresh: whether
    earlier results are removed; None where the command does not offer it. Raises InputError for a folder that cannot be
    written, that another command has filled, or that has results of something else or a file of these names that a hand
    has made or changed.
    """
    folder = open_folder(out)
    given, remedy = argument("out", folder.directory), f"give another {argument('out')}"
    for other in OWNERS if owner in OWNERS else ():
        if other is not owner and other.has(folder.directory):
            raise InputError(f"{given}: holds the results of {other.name}; {remedy}")
    there = [name for name in (owner.mark, *owner.files) if (folder.directory / name).exists()]
    made = {name: folder.was_made(name) for name in there}
    if by_hand := next((name for name, one in made.items() if one is False or not (one or owner.mark in made)), None):
        raise InputError(
            f"{given}: {by_hand} in it was not made by this command, or changed since; rename it, or {remedy}"
        )
    if fresh:
        owner.clear(folder.directory)
    if identity is not None and (unlike := owner.unlike(folder.directory, identity)):
        held = f"{given}: holds the results of {owner.name} with another {' and '.join(unlike)}; {remedy}"
        raise InputError(held if fresh is None else f"{held}, or {argument('fresh', True)} to replace them")
    return folder
