"""The results of the coarse arm as a run left them, its curves and its law thinned out."""

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from pipeline.results.files import read_results
from pipeline.values.law import LawMeshError
from pipeline.values.run import Run

COARSE = Path(__file__).resolve().parent / "data" / "results_coarse"


def coarse_run(mesh_error: float | None = None) -> Run:
    """The run; with a mesh error the standard deviations of its law are this fraction of their values."""
    run = read_results(COARSE)
    if mesh_error is None:
        return run
    assert run.law.mesh_error is not None
    known = run.law.mesh_error
    columns: dict[str, Any] = {
        f"{name}_std": tuple(mesh_error * abs(value or 0.0) for value in getattr(known, name))
        for name in ("kappa_0_per_mm", "rigidity_N_mm2", "moment_N_mm")
    }
    error: LawMeshError = replace(known, **columns)
    return replace(run, law=replace(run.law, mesh_error=error))


def with_text(folder: Path, name: str, text: str) -> Path:
    """A copy of the results in `folder` whose file `name` has another text."""
    shutil.copytree(COARSE, folder, dirs_exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")
    return folder


def copy_with(folder: Path, name: str, change: Callable[[Any], Any]) -> Path:
    """A copy of the results in `folder` whose file `name` has the content `change(content)`."""
    shutil.copytree(COARSE, folder, dirs_exist_ok=True)
    content = json.loads((folder / name).read_text(encoding="utf-8"))
    changed = change(content)
    (folder / name).write_text(json.dumps(content if changed is None else changed), encoding="utf-8")
    return folder
