"""The kernels of the solver, loaded in every worker before it solves, and compiled by one of them if need be."""

from fem import compile_kernels
from pipeline.config.config import Config
from pipeline.context import RunContext
from pipeline.parallel import Pending, TaskContext
from pipeline.simulation.scene import material_of


def begin_loading(context: RunContext, config: Config) -> list[Pending[None]]:
    """Load them in every worker. The results are there when nothing has to be compiled any more."""
    others = [context.submit(_import_solver) for _ in range(context.workers.jobs - 1)]
    return [context.submit(load_kernels, config), *others]


def load_kernels(context: TaskContext, config: Config) -> None:
    """Load those of a configuration in this process, once, so that no experiment is charged with it. Raises InputError
    as `material_of`."""
    layer = config.effects.strain_limiting_layer.on
    key = ("kernels", config.mesh.formulation, repr((config.material, config.materials)), layer)
    context.kept(key, lambda: compile_kernels(config.mesh.formulation, material_of(config), layer))


def _import_solver(context: TaskContext) -> None:
    """Nothing but the imports of this module."""
