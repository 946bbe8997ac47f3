"""The law of an arm whose rubber departs from that of a law in the second order of the strain.

Rubbers of equal moduli have equal stresses up to terms with the square of the strain. Under a pressure p the strains of
an arm are of the order

    e = p h^2 / EA,    h^2 = 12 EI / EA,

with EI and EA without moment; h is the height of a solid bar with these rigidities. So the curvature without moment may
differ by a multiple of e^2 / h, and the stretch by a multiple of e^2. Arms without gaps bend by the small difference of
what their two sides stretch, of which the first order nearly vanishes in an incompressible round wall. The second order
then decides how far they bend.
"""

import math
from dataclasses import replace

import numpy as np

from rod.arm_law.curves import CellCurve
from rod.arm_law.law import ArmLaw
from rod.checked import finite

#: MPa
KPA = 1e-3


def with_second_order(law: ArmLaw, bend: float, stretch: float) -> ArmLaw:
    """The law whose curvature without moment differs by bend e^2 / h, and whose stretch differs by stretch e^2.

    bend, stretch: of the order of 1 for another law of the rubber. Ends, rigidities and derivatives stay. Raises
    `RodError` for what is no number.
    """
    bend, stretch = finite(bend, "The bend of second order"), finite(stretch, "The stretch of second order")
    if bend == stretch == 0.0:
        return law
    return replace(law, cells=tuple(_changed(cell, bend, stretch) for cell in law.cells))


def _changed(cell: CellCurve, bend: float, stretch: float) -> CellCurve:
    strain, height = order_of_strain(cell)
    curved, longer = bend * strain**2 / height, stretch * strain**2
    by_pressure = 2.0 / cell.pressure if cell.pressure else 0.0  # both grow with the square of the pressure
    faster = by_pressure * (longer - curved * cell.stretch_by_kappa)
    return replace(
        cell,
        kappa=cell.kappa + curved,
        moment_by_pressure=cell.moment_by_pressure - by_pressure * curved * cell.rigidity,
        stretch=cell.stretch + longer,
        stretch_by_pressure=cell.stretch_by_pressure + faster,
    )


def order_of_strain(cell: CellCurve) -> tuple[float, float]:
    """The strain e, and the height h in mm."""
    bending, axial = (float(np.interp(0.0, cell.moment, values)) for values in (cell.rigidity, cell.axial_rigidity))
    height = math.sqrt(12.0 * bending / axial)
    return KPA * cell.pressure * height**2 / axial, height
