"""A sentence now and then while one long call does not return."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

from pipeline.config.config import Config
from pipeline.progress import Progress
from pipeline.simulation.scene import Scene

#: seconds between two sentences
EVERY = 20.0


@contextmanager
def remarks_while_waiting(progress: Progress, what: str, every: float = EVERY) -> Iterator[None]:
    """Remark every `every` seconds for how long `what` has lasted, until the block ends."""
    ended, start = threading.Event(), perf_counter()

    def tell() -> None:
        while not ended.wait(every):
            progress.remark(f"{what} for {perf_counter() - start:.3g} s so far")

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield
    finally:
        ended.set()
        teller.join()


def meshed_with_progress(config: Config, progress: Progress) -> Scene:
    """The scene of a configuration, with remarks while it is meshed. Raises InputError as `Scene.meshed`."""
    with remarks_while_waiting(progress, "meshing the body"):
        return Scene.meshed(config)
