"""What the body is: designs, solids, meshes and the material curve."""

from geometry.bisected_circle import BisectedCircle
from geometry.centreline import Centreline
from geometry.design import Body, Design, DesignError
from geometry.grading import GRADINGS, Grading
from geometry.mesh import Mesh, MeshError, Quality
from geometry.own_mesh import OwnMesh
from geometry.own_solid import OwnSolid
from geometry.pneunet import PneuNet
from geometry.semicircular import Semicircular
from geometry.semicircular_single import SemicircularSingle

FAMILIES: dict[str, type[Design]] = {
    design.family: design for design in (PneuNet, Semicircular, SemicircularSingle, BisectedCircle)
}
"""The designs by the name that a config gives them."""

__all__ = [
    "FAMILIES",
    "GRADINGS",
    "BisectedCircle",
    "Body",
    "Centreline",
    "Design",
    "DesignError",
    "Grading",
    "Mesh",
    "MeshError",
    "OwnMesh",
    "OwnSolid",
    "PneuNet",
    "Quality",
    "Semicircular",
    "SemicircularSingle",
]
