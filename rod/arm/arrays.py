"""The arrays of a chain of beam elements: what it is, what acts on it, its state and its tangent.

The first node is where the clamp puts it (`rod.arm.end_kernels`): it is eliminated with the first element. The unknowns
are the motions of all others, in the plane x, y and angle, in space place and turn.
"""

from typing import NamedTuple

from geometry.arrays import Array, Index
from rod.arm.end_kernels import EndArrays
from rod.arm.section_kernels import SectionArrays

#: numbers that are kept of an element
KEPT, FORCES, FORCES_IN_SPACE = 42, 4, 6
#: the angle in the plane among what may be held
TURN = 5


class LoadArrays(NamedTuple):
    """What acts on the nodes, and what holds them."""

    force: Array  #: (3,) N, on the end
    couple: Array  #: (3,) N mm, on the end
    nodes: Array  #: (N, 3) N, on the axis at the nodes
    couples: Array  #: (N, 3) N mm
    #: (N, 2, 3) N mm: forces times how far along the first and the second direction of the section they act
    beside: Array
    #: (k, 2) nodes, and what is held there: the place along x, y or z (0 to 2), or the angle in the plane (5)
    held: Index
    target: Array  #: (k,) mm or rad, of the point that is held
    lever: Array  #: (k, 2) mm, of this point beside the axis; for the end the tip has it


class StateArrays(NamedTuple):
    """A chain in a state; Newton's method changes it in place."""

    place: Array  #: (N, 3) mm
    angle: Array  #: (N,) rad, in the plane
    frames: Array  #: (N, 3, 3), in space
    inner: Array  #: (n, 3) N, axial and shear forces of the elements in the tangent
    reaction: Array  #: (k,) N or N mm, of what is held


class Chain(NamedTuple):
    """The elements."""

    in_space: bool
    is_loaded: bool  #: False: the tangent is that of the same shape without forces and moments
    h: Array  #: (n,) mm, rest lengths
    decides: int  #: node whose bending moment decides on the clamp
    beyond: float  #: mm, how far beyond this node the moment decides in fact
    free: int  #: first node beyond the clamped end, from which on unstable directions are counted
    length: float  #: mm


class ArmArrays(NamedTuple):
    """An arm in a state of pressure: what it consists of."""

    section: SectionArrays
    ends: EndArrays
    chain: Chain


class Tangent(NamedTuple):
    """The tangent of a chain, with what holds it; overwritten by each iteration."""

    band: Array  #: (m (N - 1), 4 m - 1), as in `rod.arm.bands`; m unknowns of a node
    by_reaction: Array  #: (k, 6): the residual of the held node by the reaction
    by_motion: Array  #: (k, 6): the held place or angle by the motion of the node
    missed: Array  #: (k,) mm or rad
    direct: Array  #: (k, k) held places by reactions, of a tip that gives way
    residual: Array  #: (m (N - 1),) of the nodes beyond the clamp
    start: Array  #: (m, 1 + m) motion of the first node, and what it adds by that of the second
    #: (n, KEPT), of the elements for `predict`; forces from FORCES on, in space from FORCES_IN_SPACE on
    kept: Array
