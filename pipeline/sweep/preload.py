"""Loaded by every local worker of Dask as it starts: interrupts are left to the main process."""

from pipeline.processes import ignore_interrupts


def dask_setup(worker: object) -> None:
    """Called by Dask in the main thread of the worker."""
    ignore_interrupts()
