"""Gradings: where in a body the elements are smaller than elsewhere, and by how much (values only).

`geometry.meshing.size_field` gives them to Gmsh.
"""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Grading:
    """Element size near re-entrant edges (singular stresses) or near the thinnest walls (largest bending).

    At the distance r (mm) from there elements have the size min(size, fraction * size + growth * r).
    """

    at: Literal["nowhere", "edges", "walls"] = "nowhere"  #: re-entrant edges, or the thinnest walls
    fraction: float = 1.0  #: size there over the size of the mesh
    growth: float = 1.0  #: increase of the size per distance


#: No grading: elements of one size.
OFF = Grading()

#: The gradings by the name that a config gives them.
GRADINGS: dict[str, Grading] = {
    "off": OFF,
    "edges": Grading("edges", fraction=0.5, growth=0.5),
    "walls": Grading("walls", fraction=0.6),
}
