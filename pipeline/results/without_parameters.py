"""Why a run has no five parameters, and the sentence where a rod is requested of such a run."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pipeline.values.errors import InputError
from pipeline.values.reasons import NO_PARAMETERS


def why_no_parameters(run: Mapping[str, Any]) -> str:
    """The reason by the content of run.json, a clause; the general one where that has none."""
    reasons = (*(run.get("failures") or ()), *(run.get("remarks") or ()))
    named = dict.fromkeys(reason["text"] for reason in reasons if reason["code"] in NO_PARAMETERS)
    return (
        "; ".join(text[:1].lower() + text[1:].rstrip(".") for text in named)
        or "the identification needs II and III at the same pressure"
    )


def refuse_without_parameters(path: Path, content: Mapping[str, Any]) -> None:
    """Raise InputError, with the reason that the run gives, for a parameters.json without a pressure."""
    if content["pressures_kPa"] != []:
        return
    other = "; the arm's own law is in law.json" if (path.parent / "law.json").is_file() else ""
    raise InputError(f"{path}: holds no parameters of a rod: {why_no_parameters(_run_of(path))}{other}")


def _run_of(path: Path) -> Mapping[str, Any]:
    """The content of the run.json beside a file; empty where there is none that can be read."""
    try:
        run = json.loads((path.parent / "run.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return run if isinstance(run, dict) else {}
