"""What every stage of a run is given beside its input: where results are kept, how many processes, who listens."""

from dataclasses import dataclass

from pipeline.progress import Progress
from pipeline.store.store import Store


@dataclass(frozen=True)
class RunContext:
    """The surroundings of a run; they decide no result."""

    store: Store  #: the result directory, with the states of earlier runs
    jobs: int  #: experiments solved at the same time
    progress: Progress  #: receives stages, pressures and Newton iterations
