"""Forces and stiffnesses of sections, as the elements read them.

A section has an energy w per rest length of its strains: twist, lateral curvature and curvature k; stretch, shear and
lateral shear v. Three kinds of sections share the arrays `SectionArrays`.

*Tabulated* (the arm's own law in its plane, and out of the plane to second order), with coefficients over kappa:

    w = w_0(kappa) + EA (stretch - s)^2 / 2 + GA shear^2 / 2
        + B_2 kappa_2^2 / 2 + GJ twist^2 / 2 + GA_3 (lateral shear + a twist)^2 / 2

*Two lines* (five parameters), with Delta = kappa - kappa_0 and next to rigid stretch and shear:

    w = alpha Delta^2 / 2 + m_0 Delta + EA (stretch - 1)^2 / 2 + GA shear^2 / 2

*Polynomial* (arms without a plane of symmetry), with both curvatures kappa:

    w = w_0(kappa) + EA (stretch - s(kappa))^2 / 2 + z C^-1 z / 2,    z = (twist, shear, lateral shear)
"""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array

#: kinds of sections
TABULATED, LINES, POLYNOMIAL = 0, 1, 2
#: columns of the table of a tabulated section
COLUMNS = (
    *("moment", "stretch", "axial_rigidity", "shear_rigidity", "lateral_rigidity", "torsional_rigidity"),
    *("lateral_shear_rigidity", "twist_axis"),
)
#: how far beyond its reach a polynomial is evaluated; from there on it goes on linearly
BEYOND = 1.3


class SectionArrays(NamedTuple):
    """A section of any kind."""

    kind: int
    #: tabulated: (4, n, c) coefficients of cubics over equal steps of kappa, by COLUMNS; polynomial: (i, j, 11)
    #: coefficients of kappa_y^i kappa_z^j of w_y, w_z, w_yy, w_yz, w_zz, s, s_y, s_z, s_yy, s_yz, s_zz
    table: Array
    #: tabulated: first kappa and step; two lines: EA, GA; polynomial: EA, the nine entries of C^-1, the curvatures
    #: without moment, and the reach about them
    numbers: Array
    #: (n, 3) by element. Tabulated: what is added to kappa; two lines: kappa_0, alpha, m_0
    local: Array
    #: of a rubber that relaxes, in a step of time: its forces are scale times the elastic ones, and memory
    scale: float = 1.0
    memory: Array = np.empty((0, 0))  #: (n, 3), in space (n, 6), N mm and N; empty: an elastic section


def elastic(section: SectionArrays) -> SectionArrays:
    """The section without memory."""
    return SectionArrays(section.kind, section.table, section.numbers, section.local, 1.0, section.memory[:0])


def add_memory(section: SectionArrays, e: int, force: Array, stiffness: Array) -> None:
    """Change elastic forces (k,) and stiffness (k, k) of element e to those of a rubber that relaxes."""
    for i in range(len(force)):
        force[i] = section.scale * force[i] + section.memory[e, i]
        for j in range(len(force)):
            stiffness[i, j] *= section.scale


def _columns(section: SectionArrays, kappa: float, out: Array) -> float:
    """Values, slopes and second derivatives (3, c) of the columns; by how much kappa leaves the table, 1/mm."""
    table = section.table
    step, last = section.numbers[1], table.shape[1] - 1
    position = (kappa - section.numbers[0]) / step
    if not math.isfinite(position):
        out[:] = math.nan
        return math.inf
    i = min(max(math.floor(position), 0), last)
    t = position - i
    inside = min(max(t, 0.0), 1.0)
    x, beyond = step * inside, step * (t - inside)
    for c in range(out.shape[1]):
        c1, c2, c3 = table[1, i, c], table[2, i, c], table[3, i, c]
        out[0, c] = table[0, i, c] + x * (c1 + x * (c2 + x * c3))
        out[1, c] = c1 + x * (2.0 * c2 + 3.0 * x * c3)
        out[2, c] = 2.0 * c2 + 6.0 * x * c3
        if beyond != 0.0:  # moment and stretch go on along their tangents, rigidities stay
            out[2, c] = 0.0
            if c < 2:
                out[0, c] += beyond * out[1, c]
            else:
                out[1, c] = 0.0
    return abs(beyond)


def plane_section(section: SectionArrays, e: int, strain: Array, force: Array, stiffness: Array, work: Array) -> float:
    """Moment, axial and shear force (3,) of element e at strains (3,) kappa, stretch, shear; stiffness (3, 3).

    work: (3, c), overwritten. Returns by how much a tabulated section leaves its table, 1/mm.
    """
    kappa, stretch, shear = strain[0], strain[1], strain[2]
    if section.kind == LINES:
        local, axial, across = section.local, section.numbers[0], section.numbers[1]
        force[0] = local[e, 1] * (kappa - local[e, 0]) + local[e, 2]
        force[1] = axial * (stretch - 1.0)
        force[2] = across * shear
        stiffness[:, :] = 0.0
        stiffness[0, 0] = local[e, 1]
        stiffness[1, 1] = axial
        stiffness[2, 2] = across
        return 0.0
    outside = _columns(section, kappa + section.local[e, 0], work)
    EA, EA1, EA2 = work[0, 2], work[1, 2], work[2, 2]
    GA, GA1, GA2 = work[0, 3], work[1, 3], work[2, 3]
    s1, longer = work[1, 1], stretch - work[0, 1]
    force[0] = work[0, 0] + longer * (0.5 * EA1 * longer - EA * s1) + 0.5 * GA1 * shear * shear
    force[1] = EA * longer
    force[2] = GA * shear
    stiffness[0, 0] = (
        work[1, 0]
        + 0.5 * EA2 * longer * longer
        - 2.0 * EA1 * longer * s1
        + EA * s1 * s1
        - EA * longer * work[2, 1]
        + 0.5 * GA2 * shear * shear
    )
    stiffness[0, 1] = stiffness[1, 0] = EA1 * longer - EA * s1
    stiffness[0, 2] = stiffness[2, 0] = GA1 * shear
    stiffness[1, 1] = EA
    stiffness[2, 2] = GA
    stiffness[1, 2] = stiffness[2, 1] = 0.0
    return outside


def space_section(section: SectionArrays, e: int, strain: Array, force: Array, stiffness: Array, work: Array) -> float:
    """Moments and forces (6,) of element e at strains (6,), and the stiffness (6, 6).

    work: (3, c), overwritten. Returns by how much the curvature leaves the law, 1/mm.
    """
    stiffness[:] = 0.0
    if section.kind == POLYNOMIAL:
        return _polynomial(section, strain, force, stiffness, work)
    twist, lateral, stretch, shear = strain[0], strain[1], strain[3], strain[4]
    outside = _columns(section, strain[2] + section.local[e, 0], work)
    EA, EA1, EA2 = work[0, 2], work[1, 2], work[2, 2]
    GA, GA1, GA2 = work[0, 3], work[1, 3], work[2, 3]
    B, B1, B2 = work[0, 4], work[1, 4], work[2, 4]
    GJ, GJ1, GJ2 = work[0, 5], work[1, 5], work[2, 5]
    G3, G31, G32 = work[0, 6], work[1, 6], work[2, 6]
    a, a1, a2 = work[0, 7], work[1, 7], work[2, 7]
    s1, longer = work[1, 1], stretch - work[0, 1]
    across = strain[5] + a * twist
    turned = a1 * twist
    force[0] = GJ * twist + G3 * across * a
    force[1] = B * lateral
    force[2] = (
        work[0, 0]
        + longer * (0.5 * EA1 * longer - EA * s1)
        + 0.5 * (GA1 * shear * shear + B1 * lateral * lateral + GJ1 * twist * twist + G31 * across * across)
        + G3 * across * turned
    )
    force[3] = EA * longer
    force[4] = GA * shear
    force[5] = G3 * across
    stiffness[0, 0] = GJ + G3 * a * a
    stiffness[0, 2] = stiffness[2, 0] = GJ1 * twist + G31 * across * a + G3 * (turned * a + across * a1)
    stiffness[0, 5] = stiffness[5, 0] = G3 * a
    stiffness[1, 1] = B
    stiffness[1, 2] = stiffness[2, 1] = B1 * lateral
    stiffness[2, 2] = (
        work[1, 0]
        + longer * (0.5 * EA2 * longer - 2.0 * EA1 * s1 - EA * work[2, 1])
        + EA * s1 * s1
        + 0.5 * (GA2 * shear * shear + B2 * lateral * lateral + GJ2 * twist * twist + G32 * across * across)
        + turned * (2.0 * G31 * across + G3 * turned)
        + G3 * across * a2 * twist
    )
    stiffness[2, 3] = stiffness[3, 2] = EA1 * longer - EA * s1
    stiffness[2, 4] = stiffness[4, 2] = GA1 * shear
    stiffness[2, 5] = stiffness[5, 2] = G31 * across + G3 * turned
    stiffness[3, 3] = EA
    stiffness[4, 4] = GA
    stiffness[5, 5] = G3
    return outside


def _polynomial(section: SectionArrays, strain: Array, force: Array, stiffness: Array, work: Array) -> float:
    numbers, table = section.numbers, section.table
    EA, y, z = numbers[0], strain[1] - numbers[10], strain[2] - numbers[11]
    away, reach = math.hypot(y, z), numbers[12]
    if not math.isfinite(away):
        force[:] = math.nan
        return math.inf
    part = min(1.0, BEYOND * reach / away) if away > 0.0 else 1.0
    ky, kz = numbers[10] + part * y, numbers[11] + part * z
    values = np.zeros(table.shape[2])
    power = 1.0
    for i in range(table.shape[0]):
        both = power
        for j in range(table.shape[1]):
            for c in range(len(values)):
                values[c] += both * table[i, j, c]
            both *= kz
        power *= ky
    left_y, left_z = (1.0 - part) * y, (1.0 - part) * z
    w_y = values[0] + values[2] * left_y + values[3] * left_z
    w_z = values[1] + values[3] * left_y + values[4] * left_z
    s = values[5] + values[6] * left_y + values[7] * left_z
    axial = EA * (strain[3] - s)
    force[1] = w_y - axial * values[6]
    force[2] = w_z - axial * values[7]
    force[3] = axial
    bent = 1.0 if part == 1.0 else 0.0
    stiffness[1, 1] = values[2] + EA * values[6] * values[6] - bent * axial * values[8]
    stiffness[1, 2] = stiffness[2, 1] = values[3] + EA * values[6] * values[7] - bent * axial * values[9]
    stiffness[2, 2] = values[4] + EA * values[7] * values[7] - bent * axial * values[10]
    stiffness[1, 3] = stiffness[3, 1] = -EA * values[6]
    stiffness[2, 3] = stiffness[3, 2] = -EA * values[7]
    stiffness[3, 3] = EA
    for i in range(3):
        row = 0 if i == 0 else 3 + i
        force[row] = 0.0
        for j in range(3):
            column = 0 if j == 0 else 3 + j
            entry = numbers[1 + 3 * i + j]
            stiffness[row, column] = entry
            force[row] += entry * strain[column]
    return max(away - reach, 0.0)


#: in the order in which they call each other, innermost first
CALLS = (_columns, _polynomial, plane_section, space_section, elastic, add_memory)
