"""The law of the drawing of an arm, measured once for all arms that are built from it."""

import json
from pathlib import Path

from benchmarks.virtual_arms.designs import VirtualArm
from pipeline.config.load import load_config
from pipeline.law.build import build_law
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.study import save_law
from pipeline.simulate.scene import Scene
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store

FILE = "drawing.json"


def folder_of_law(arm: VirtualArm, folder: Path) -> Path:
    """The folder with law.json of the drawing, below a folder; it is measured unless it is there.

    On the coarse mesh of the drawing, with derivatives, at no other pressures than those of the drawing: as
    `pneurod cell --accuracy off` does it at half the cost.
    """
    out = folder / arm.law_name
    content = json.dumps(arm.drawing, indent=1) + "\n"
    out.mkdir(parents=True, exist_ok=True)
    file = out / FILE
    if file.exists() and file.read_text(encoding="utf-8") == content:
        return out
    path = folder / f"{arm.law_name}.yaml"
    path.write_text(content, encoding="utf-8")  # JSON is YAML
    config = load_config(path)
    with open_store(out, config) as store:
        pieces = ArmPieces.of(Scene.meshed(config)).with_derivatives()
        law = build_law(pieces, config.pressures_kPa, RunContext.alone(store, Silent()), between=False)
        save_law(store, law, config.pressures_kPa)
    file.write_text(content, encoding="utf-8")  # after the law: an interrupted one is measured again
    return out
