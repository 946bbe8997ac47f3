"""The names that users and the other rooms write as `geometry.NAME`."""

from geometry.body import Body as Body
from geometry.centreline import Centreline as Centreline
from geometry.errors import DesignError as DesignError
from geometry.errors import MeshError as MeshError
from geometry.errors import PneurodError as PneurodError
from geometry.errors import Reason as Reason
from geometry.errors import Values as Values
from geometry.errors import position_text as position_text
from geometry.families import FAMILIES as FAMILIES
from geometry.families import BisectedCircle as BisectedCircle
from geometry.families import PneuNet as PneuNet
from geometry.families import Rectangular as Rectangular
from geometry.families import Semicircular as Semicircular
from geometry.families import SemicircularSingle as SemicircularSingle
from geometry.families.design import Design as Design
from geometry.files.cad.cad_file import CadFile as CadFile
from geometry.files.frame import Axes as Axes
from geometry.files.frame import CellPlanes as CellPlanes
from geometry.files.frame import Directions as Directions
from geometry.files.from_file import Plug as Plug
from geometry.files.mesh.mesh_file import MeshFile as MeshFile
from geometry.files.mesh.reader import SUFFIXES as MESH_SUFFIXES  # noqa: F401  another name
from geometry.files.surface.surface_file import SurfaceFile as SurfaceFile
from geometry.files.surface.triangles import SUFFIXES as SURFACE_SUFFIXES  # noqa: F401  the same
from geometry.grading import GRADINGS as GRADINGS
from geometry.mesh import Mesh as Mesh
from geometry.mesh import Quality as Quality
