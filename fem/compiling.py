"""The kernels compiled before they are needed, so that the first run does not compile them in every process."""

import numpy as np

from fem.effects import Pressure
from fem.loadpath import follow
from fem.material import StVenantKirchhoff
from fem.model import Model
from fem.recovery import stress_error
from fem.supports import Fixed
from geometry import Mesh


def compile_kernels() -> None:
    """Solve one element; some twenty seconds once, then a second: the compiled kernels stay on disk."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    faces = {"clamp": np.array([[0, 1, 2]]), "cavity": np.array([[1, 2, 3]])}
    mesh = Mesh(points, np.array([[0, 1, 2, 3]]), faces)
    law = StVenantKirchhoff(1.0, 0.3)
    solution = follow(Model(mesh, law, [Fixed("clamp")], [Pressure("cavity", 1e-3)]), [1.0])
    stress_error(solution.steps[0], law)
