"""What workers do while the run meshes its body: one loads the kernels, compiled if need be, all import the solver."""

from fem import Solid, compile_kernels
from pipeline.context import RunContext
from pipeline.parallel.worker import TaskContext
from pipeline.parallel.workers import Pending


def loaded(context: RunContext, formulation: str, material: Solid) -> list[Pending[None]]:
    """A task for each worker. Their results are there when nothing has to be compiled any more."""
    others = [context.submit(_import_solver) for _ in range(context.workers.jobs - 1)]
    return [context.submit(_load_kernels, formulation, material), *others]


def _load_kernels(context: TaskContext, formulation: str, material: Solid) -> None:
    compile_kernels(formulation, material)


def _import_solver(context: TaskContext) -> None:
    """Nothing but the imports of this module."""
