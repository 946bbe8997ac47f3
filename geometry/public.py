"""The names that users and the other rooms write as `geometry.NAME`."""

from geometry.body import Body
from geometry.centreline import Centreline
from geometry.errors import DesignError, MeshError, PneurodError, Reason, Values, position_text
from geometry.families import FAMILIES, BisectedCircle, PneuNet, Rectangular, Semicircular, SemicircularSingle
from geometry.families.design import Design
from geometry.files.cad.cad_file import CadFile
from geometry.files.frame import Axes, CellPlanes, Directions
from geometry.files.from_file import FileDesign, Plug
from geometry.files.mesh.mesh_file import MeshFile
from geometry.files.mesh.reader import SUFFIXES as MESH_SUFFIXES
from geometry.files.surface.surface_file import SurfaceFile
from geometry.files.surface.triangles import SUFFIXES as SURFACE_SUFFIXES
from geometry.grading import GRADINGS, Grading
from geometry.mesh import Mesh, Quality

__all__ = [
    "FAMILIES",
    "GRADINGS",
    "MESH_SUFFIXES",
    "SURFACE_SUFFIXES",
    "Axes",
    "BisectedCircle",
    "Body",
    "CadFile",
    "CellPlanes",
    "Centreline",
    "Design",
    "DesignError",
    "Directions",
    "FileDesign",
    "Grading",
    "Mesh",
    "MeshError",
    "MeshFile",
    "Plug",
    "PneuNet",
    "PneurodError",
    "Quality",
    "Reason",
    "Rectangular",
    "Semicircular",
    "SemicircularSingle",
    "SurfaceFile",
    "Values",
    "position_text",
]
