"""What a test solves by itself: in one process and without a word."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pipeline.config.config import Config
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store


@contextmanager
def alone(folder: Path, config: Config, *, fresh: bool = False) -> Iterator[RunContext]:
    """What stages need to solve a configuration in a folder."""
    with open_store(folder, config, fresh=fresh) as store:
        yield RunContext.alone(store, Silent())
