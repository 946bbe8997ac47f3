"""Compilation of the kernels ahead of a run, so that its processes load them from disk."""

import gc

import numpy as np

from fem.effects.effect import Effect
from fem.effects.loads import Pressure
from fem.effects.membrane import StrainLimitingLayer
from fem.materials import StVenantKirchhoff
from fem.materials.regions import Solid, laws_of
from fem.memory import paused
from fem.model import Model
from fem.path.loadpath import follow
from fem.post.recovery import stress_error
from fem.supports import Fixed, Prescribed, Support
from geometry import Mesh


def compile_kernels(formulation: str = "p2p0", material: Solid | None = None, layer: bool = False) -> None:
    """Solve a model of one element, which compiles every kernel: half a minute once, half a second from disk.

    The kernels serve all formulations. "mixed" has one more, which is compiled with that formulation. Laws that are not
    linear in the strain have kernels of their own, compiled if `material` is such a law, or has one in a region, and so
    have a layer and hoops, compiled with `layer`. Raises ValueError for a formulation that does not exist.
    """
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    faces = {"clamp": np.array([[0, 1, 2]]), "cavity": np.array([[1, 2, 3]])}
    mesh = Mesh(points, np.array([[0, 1, 2, 3]]), faces)
    law = StVenantKirchhoff(1.0, 0.3)
    supports: list[Support] = [Fixed("clamp", "xy"), Prescribed("clamp", "z", 1e-3)]
    effects: list[Effect] = [Pressure("cavity", 1e-3)]
    if layer:
        effects.append(StrainLimitingLayer(faces["clamp"], 1.0, 1.0, 0.3))
    with paused():
        solution = follow(Model(mesh, law, supports, effects, formulation), [1.0])
        stress_error(solution.steps[0], law)
        for law_of_region in laws_of(material or law).values():
            for evaluate in (law_of_region.shear, law_of_region.dilatation):
                evaluate(np.zeros((1, 6)))
    gc.freeze()  # collections pass over all that is loaded, the last one at the end of the process too
