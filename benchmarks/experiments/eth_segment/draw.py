"""Draw the half z >= 0 of the segment of ETH as segment.brep: a tube with four chambers about a square hole.

    python -m benchmarks.experiments.eth_segment.draw

Dimensions in mm from srl-ethz/diffPD_sim2real 825e7b7 (MIT), python/1segment_arm: radius, outer and inner walls, half
the diagonal of the hole and the closed end are in Environments/soft1_arm_env.py; length and partitions in STL_files.
"""

from math import sqrt
from pathlib import Path

import gmsh

RADIUS, OUTER_WALL, INNER_WALL, DIAGONAL, PARTITION = 22.22, 2.03, 2.27, 10.11, 4.4
#: mm, of all, of the closed end, and of a plate at the clamp that closes the chambers there
LENGTH, END, PLATE = 100.0, 6.93, 2.0
HERE = Path(__file__).parent


def draw(path: Path, partition: float = PARTITION, outer_wall: float = OUTER_WALL) -> None:
    """Write the drawing; thicknesses of the walls between two chambers, and of those outside, in mm."""
    hole, long = DIAGONAL / sqrt(2.0), LENGTH - END - PLATE
    low, aside = hole + INNER_WALL, partition / sqrt(2.0)
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Verbosity", 1)
        occ = gmsh.model.occ
        solid = [(3, occ.addCylinder(0, 0, 0, LENGTH, 0, 0, RADIUS))]
        solid, _ = occ.cut(solid, [(3, occ.addBox(-1, -hole, -hole, LENGTH + 2, 2 * hole, 2 * hole))])
        for quarter in range(4):
            corners = ((low, aside - low), (low, low - aside), (RADIUS, RADIUS - aside), (RADIUS, aside - RADIUS))
            points = [occ.addPoint(PLATE, y, z) for y, z in corners]
            lines = [occ.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
            wedge = occ.extrude([(2, occ.addPlaneSurface([occ.addCurveLoop(lines)]))], long, 0, 0)
            within = [(3, occ.addCylinder(PLATE, 0, 0, long, 0, 0, RADIUS - outer_wall))]
            chamber, _ = occ.intersect([part for part in wedge if part[0] == 3], within)
            occ.rotate(chamber, 0, 0, 0, 1, 0, 0, quarter * 1.5707963267948966)
            solid, _ = occ.cut(solid, chamber)
        box = [(3, occ.addBox(-1, -2 * RADIUS, 0, LENGTH + 2, 4 * RADIUS, 2 * RADIUS))]
        solid, _ = occ.intersect(solid, box)
        occ.synchronize()
        loose = [part for part in occ.getEntities(2) if not gmsh.model.getAdjacencies(*part)[0].size]
        occ.remove(loose, recursive=True)
        occ.synchronize()
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


if __name__ == "__main__":
    draw(HERE / "segment.brep")
