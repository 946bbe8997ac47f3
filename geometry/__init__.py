"""What the body is: designs, solids, meshes and the material curve."""

from geometry.centreline import Centreline
from geometry.design import Body, Design, DesignError
from geometry.families.bisected_circle import BisectedCircle
from geometry.families.cad_file import OwnSolid
from geometry.families.mesh_file import OwnMesh
from geometry.families.pneunet import PneuNet
from geometry.families.semicircular import Semicircular
from geometry.families.semicircular_single import SemicircularSingle
from geometry.grading import GRADINGS, Grading
from geometry.mesh import Mesh, MeshError, Quality

#: The designs by the name that a config gives them.
FAMILIES: dict[str, type[Design]] = {
    design.family: design for design in (PneuNet, Semicircular, SemicircularSingle, BisectedCircle)
}

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
