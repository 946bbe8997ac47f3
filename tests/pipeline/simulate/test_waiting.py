"""What is said while a body is meshed, and before."""

import re
import subprocess
import sys
from pathlib import Path
from time import sleep
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pipeline.config.load import load_config
from pipeline.simulate.design_notes import check_load
from pipeline.simulate.scene import Scene, mesh_with_progress
from pipeline.values.reasons import render
from tests.step_bodies import save

HERE = Path(__file__).resolve().parent.parent.parent.parent


def small_fillets(occ: Any, radius: float = 0.5) -> Any:
    """A bar of 60 x 12 x 15 mm with rounded upper edges and one cavity."""
    block = occ.addBox(0, 0, -7.5, 60, 12, 15)
    occ.synchronize()
    reach = {tag: occ.getBoundingBox(1, tag) for _, tag in occ.getEntities(1)}
    upper = [tag for tag, box in reach.items() if box[3] - box[0] > 59 and box[1] > 11]
    return occ.cut(occ.fillet([block], upper, [radius]), [(3, occ.addBox(5, 4, -4, 50, 5, 8))])[0]


FILLETS = """
name: fillets
geometry: {family: own, file: fillets.step, curve: 2 mm}
material: {law: neo_hooke, mu: 0.4 MPa, nu: 0.49}
pressures: [20 kPa]
mesh: {size: 5 mm, grading: off}
"""


def test_small_edges_are_named_before_meshing(tmp_path: Path) -> None:
    """In a process of its own, where what is printed while Gmsh meshes could be lost."""
    save(tmp_path / "fillets.step", small_fillets)
    path = tmp_path / "fillets.yaml"
    path.write_text(FILLETS, encoding="utf-8")
    command = [sys.executable, "-m", "pipeline", "mesh", str(path), "--out", str(tmp_path / "out")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=HERE) as meshing:
        assert meshing.stdout is not None
        small, stage = (meshing.stdout.readline().rstrip("\n") for _ in range(2))
        meshing.kill()
    assert stage == "stage: mesh"
    (reason,) = check_load(load_config(path))
    assert small == f"note: {render(reason)}"
    assert (reason.code, reason.values["count"]) == ("short_edges", 4)
    assert reason.values["shortest_mm"] == pytest.approx(np.pi / 4, rel=1e-3)
    assert re.fullmatch(r"\((0|60), 11\.\d, -?7\.\d+\) mm", reason.values["near"])
    assert check_load(load_config(path, ["mesh.size=2 mm"])) == ()


def test_long_calls_are_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    def told(seconds: float, every: float) -> list[str]:
        remarks: list[str] = []
        listener: Any = SimpleNamespace(remark=remarks.append)
        monkeypatch.setattr("pipeline.simulate.scene.EVERY", every)
        monkeypatch.setattr(Scene, "meshed", lambda config: sleep(seconds))
        config: Any = None
        mesh_with_progress(config, listener)
        return remarks

    quick, slow = told(0.0, 10.0), told(0.3, 0.02)
    assert quick == []
    assert len(slow) > 1
    count = len(slow)
    sleep(0.1)
    assert len(slow) == count, "nothing is told after the end"
