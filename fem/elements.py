"""The finite elements: tetrahedra, quadratic ones with curved edges on round walls, and where in them the
parts of the law are evaluated.

Importing this needs nothing else. A further element is an entry of `ELEMENTS`; one with another treatment of the
volumetric part of the law needs a class in `fem.equations.formulation` as well.
"""

from dataclasses import dataclass
from enum import Enum


class Volumetric(Enum):
    """Where the volumetric part of the law is evaluated."""

    FULL = "at all points of the quadrature rule"
    CENTROID = "at the centroid alone"
    PRESSURE = "through a pressure field, linear in each element and continuous"


@dataclass(frozen=True)
class ShapeFunctions:
    """Lagrange polynomials on a tetrahedron: nodes at its vertices, and at the middles of its edges if quadratic."""

    degree: int
    points: int  #: of the quadrature rule that is exact up to this degree
    nodal_weights: tuple[float, ...]  #: integral of each shape function over a tetrahedron, over its volume
    edge_weights: tuple[float, ...]  #: integral of each shape function over an edge, over its length; nodes in order


LINEAR = ShapeFunctions(1, 1, (0.25,) * 4, (1 / 2, 1 / 2))
QUADRATIC = ShapeFunctions(2, 4, (-0.05,) * 4 + (0.2,) * 6, (1 / 6, 4 / 6, 1 / 6))


@dataclass(frozen=True)
class Element:
    """Displacement and quadrature of a tetrahedron. The shear part of the law is evaluated at all quadrature points."""

    name: str  #: the formulation, as in a configuration
    shape: ShapeFunctions  #: of the displacement
    volumetric: Volumetric
    summary: str  #: how the law is evaluated, a clause

    @property
    def quadratic(self) -> bool:
        """Whether edges have a node in their middle."""
        return self.shape is QUADRATIC

    @property
    def fully_integrated(self) -> bool:
        """Whether nothing is done against locking near incompressibility."""
        return self.volumetric is Volumetric.FULL


#: the elements by name
ELEMENTS: dict[str, Element] = {
    element.name: element
    for element in (
        Element(
            "p2p0",
            QUADRATIC,
            Volumetric.CENTROID,
            "the volumetric part of the law is taken at one point per element",
        ),
        Element("p2", QUADRATIC, Volumetric.FULL, "the whole law is taken at four points per element"),
        Element(
            "mixed",
            QUADRATIC,
            Volumetric.PRESSURE,
            "the pressure is an unknown of its own, linear in each element and continuous",
        ),
        Element("p1", LINEAR, Volumetric.FULL, "the whole law is taken at the one point of a linear element"),
    )
}
#: the element whose error falls fastest with the degrees of freedom near incompressibility (studies/accuracy.md)
MOST_ACCURATE = "mixed"
#: Poisson's ratio from which an element that is fully integrated locks
NEARLY_INCOMPRESSIBLE = 0.4
#: Poisson's ratio from which the pressure is an unknown of its own
PRACTICALLY_INCOMPRESSIBLE = 0.499


def element_of(name: str) -> Element:
    """The element of that name; raises ValueError naming those that exist."""
    if name not in ELEMENTS:
        raise ValueError(f"formulation {name!r}: allowed are {', '.join(ELEMENTS)}")
    return ELEMENTS[name]


def automatic_element(nu: float, against_locking: bool | None = None) -> Element:
    """The element for a solid with Poisson's ratio nu at small strain.

    against_locking: whether to take one that is not fully integrated; None decides by nu.
    """
    if not (nu >= NEARLY_INCOMPRESSIBLE if against_locking is None else against_locking):
        return ELEMENTS["p2"]
    return ELEMENTS["mixed" if nu >= PRACTICALLY_INCOMPRESSIBLE else "p2p0"]
