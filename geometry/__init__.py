"""What the body is: designs, solids, meshes and the material curve."""

from geometry.centreline import Centreline
from geometry.design import Body, Design, DesignError
from geometry.mesh import Mesh, MeshError, Quality
from geometry.pneunet import PneuNet

FAMILIES: dict[str, type[Design]] = {design.family: design for design in (PneuNet,)}
"""The designs by the name that a config gives them."""

__all__ = ["FAMILIES", "Body", "Centreline", "Design", "DesignError", "Mesh", "MeshError", "PneuNet", "Quality"]
