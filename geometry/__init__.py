"""Geometry of the arms: dimensions, solids, meshes and the material curve."""

from geometry.body import Body
from geometry.centreline import Centreline
from geometry.design import Design, DesignError
from geometry.families import FAMILIES, BisectedCircle, PneuNet, Rectangular, Semicircular, SemicircularSingle
from geometry.families.cad_file import CadFile
from geometry.families.from_file import FileDesign, Plug
from geometry.families.mesh_file import MeshFile
from geometry.families.surface_file import SurfaceFile
from geometry.foreign.file import SUFFIXES as MESH_SUFFIXES
from geometry.foreign.frame import Axes
from geometry.foreign.surface import SUFFIXES as SURFACE_SUFFIXES
from geometry.grading import GRADINGS, Grading
from geometry.mesh import Mesh, Quality
from geometry.mesh_error import MeshError, position_text
from geometry.meshing.cells import CellPlanes
from geometry.reason import Reason

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
    "FileDesign",
    "Grading",
    "Mesh",
    "MeshError",
    "MeshFile",
    "Plug",
    "PneuNet",
    "Quality",
    "Reason",
    "Rectangular",
    "Semicircular",
    "SemicircularSingle",
    "SurfaceFile",
    "position_text",
]
