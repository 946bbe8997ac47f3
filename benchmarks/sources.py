"""Which version of the program a published number is from, and the key of results that are kept until it changes."""

import subprocess
from pathlib import Path

from pipeline.store.state_key import NUMBER_SOURCES, result_key

#: the folder of the rooms
ROOMS = Path(__file__).resolve().parent.parent


def key_of(words: str, *files: str) -> str:
    """sha256 of what was measured, of the program, of the packages it uses, and of other files that decide the result.

    files: relative to the folder of the rooms.
    """
    return result_key(words, (*NUMBER_SOURCES, *files))


def commit_of_sources(rooms: Path = ROOMS) -> str:
    """The last commit that changed the program, with "+" where its files differ from it; others do not count."""
    commit = _git(rooms, "log", "-1", "--format=%h", "--", *NUMBER_SOURCES)
    changed = _git(rooms, "status", "--porcelain", "--", *NUMBER_SOURCES)
    return f"{commit}+" if commit and changed else commit or "unknown"


def _git(rooms: Path, *arguments: str) -> str:
    """What git says; nothing outside a clone or without git."""
    try:
        done = subprocess.run(["git", *arguments], capture_output=True, text=True, check=False, cwd=rooms)
    except OSError:
        return ""
    return done.stdout.strip()
