"""What a result was made with: commit, package versions, machine."""

import os
import platform
import subprocess
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet


def required(extra: str = "solve") -> dict[str, SpecifierSet]:
    """The direct dependencies of pneurod on this machine, each with the versions it may have; with no extra, those of
    rods alone."""
    requirements = [Requirement(text) for text in metadata.requires("pneurod") or ()]
    return {
        needed.name: needed.specifier
        for needed in requirements
        if needed.marker is None or needed.marker.evaluate({"extra": extra})
    }


def provenance() -> dict[str, Any]:
    """The part of run.json that does not depend on the design."""
    return {
        "pneurod": metadata.version("pneurod"),
        "commit": _commit(),
        "python": platform.python_version(),
        "packages": {name: installed(name) for name in required()},
        "machine": {
            "system": platform.platform(),
            "processor": processor(),
            "cores": os.cpu_count(),
            "memory_GB": _memory_GB(),
        },
    }


@cache
def installed(name: str) -> str | None:
    """The version of a distribution on this machine, or None."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _commit() -> str | None:
    """The commit of the sources, with "+" where files differ from it; None outside a clone or without git."""
    here = Path(__file__).resolve().parents[2]
    if not (here / ".git").exists():
        return None
    try:
        commit = _git(here, "rev-parse", "HEAD")
        return commit + "+" if _git(here, "status", "--porcelain", "--untracked-files=no") else commit
    except (OSError, subprocess.SubprocessError):
        return None


def _git(here: Path, *arguments: str) -> str:
    command = ["git", "-C", str(here), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()


def processor() -> str:
    """The name of the machine's processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def _memory_GB() -> float | None:
    try:
        return round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1)
    except (OSError, ValueError):
        return None
