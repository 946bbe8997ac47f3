"""An arm with a plane of symmetry and its own law, as the rod in space sees it; stability of its planar states."""

from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from geometry.topology import cross
from rod.arm_law.cosserat import LawInSpace, Shapes, in_frame, rotation
from rod.arm_law.small_motions import OUT_OF_PLANE, Ends, loaded_rod, stability_of
from rod.arm_law.solver import EndConditions, Pieces, check_within_law, equilibrium
from rod.cubics import cubic, cubic_slope
from rod.load import Load
from rod.solution import RodSolution
from rod.spatial import Position, SpatialLoad, Stability

ACROSS = np.array([0.0, 0.0, 1.0])


class PlanarArm:
    """The pieces of an arm at one pressure; its end is held along the axes with a prescribed position."""

    def __init__(self, pieces: Pieces, position: Position) -> None:
        self.pieces, self.position = pieces, position
        self.law = LawInSpace.of(pieces.section)
        self.length, self.positions = pieces.length, pieces.positions
        slopes = pieces.section.kappa_slope
        self.rigidity = 1.0 / float(slopes[len(slopes) // 2])
        self._tip = EndConditions(Load(), position[:2]).tip_state(pieces.tip)
        self._of_turns = self._tip.over_turns(
            np.column_stack([self._tip.couple, self._tip.acts_at, self._tip.beside[:, -1]])
        )

    def weight(self, load: SpatialLoad) -> Array:
        """As `rod.arm_law.spatial_solver.SpatialArm` says, and so are the others."""
        return self.pieces.weight(load, self.positions)

    def inflated(self) -> tuple[Array, Array, Array]:
        """Where the height of the end is prescribed, and its x is not, the path begins in experiment III."""
        x, y, _ = self.position
        inflated = EndConditions(Load(), (None, y if x is None else None))
        planar, tip = equilibrium(self.pieces, inflated), inflated.tip_state(self.pieces.tip)
        turn = float(planar.theta[-1])
        frame = rotation(turn * ACROSS)
        beside = tip.beside_at(turn, float(planar.force @ frame[:2, 0]))[-1]
        place = np.array([planar.x[-1], planar.y[-1], 0.0]) + frame[:, :2] @ beside
        return frame, np.array([*planar.force, 0.0]), place

    def tip(self, frame: Array, force: Array) -> tuple[Array, Array, Array]:
        """The couple of its support, its lever, and the end of the curve."""
        turn, axial = np.arctan2(frame[:, 1, 0], frame[:, 0, 0]), in_frame(frame, force)[:, 0]
        values = cubic(self._tip.turns, *self._of_turns, turn)
        pull = axial[:, None] * self._tip.by_pull[-1]
        lever, to_end = (self._in_space(frame, values[:, k : k + 2] + pull) for k in (1, 3))
        return values[:, :1] * ACROSS, lever, to_end

    @staticmethod
    def _in_space(frame: Array, beside: Array) -> Array:
        """(c, 3) of lengths (c, 2) along a section's normal and its direction in the plane of symmetry."""
        return np.asarray(frame[:, :, 0] * beside[:, :1] + frame[:, :, 1] * beside[:, 1:])

    def clamped(self, shapes: Shapes, force: Array) -> tuple[Array, Array, float]:
        """Out of the plane the end turns about its start, by the moment there."""
        clamp, n = self.pieces.clamp, len(shapes.moment) - 1
        row = clamp.position / self.length * n
        i = min(int(row), n - 1)
        decides = shapes.moment[i] + (row - i) * (shapes.moment[i + 1] - shapes.moment[i])
        bending = decides[:, 2]
        inside = np.clip(bending, clamp.moment[0], clamp.moment[-1])
        by_moment = cubic_slope(clamp.moment, clamp.offset, clamp.offset_by_moment, inside)[:, 0]
        in_plane = clamp.rotation_at(bending) + force[:, 0] * by_moment
        across = shapes.moment[0, :, :2] @ clamp.lateral_compliance.T
        tilted = rotation(np.column_stack([across, np.zeros(len(bending))]))
        place = np.column_stack([clamp.offset_at(bending), np.zeros(len(bending))])
        return place, tilted @ rotation(in_plane[:, None] * ACROSS), float(np.abs(bending - inside).max())

    def check(self, outside: float, moment: Array, is_weighed: bool) -> None:
        """Of the moments about the normal of the plane."""
        check_within_law(self.pieces, outside, moment[:, 2], is_weighed)

    def ends(self, moment: Array, lever: Array, to_end: Array, held: Array) -> Ends:
        """The clamped end of the law."""
        return Ends.of(self.pieces.clamp, moment, lever, to_end, held)


def stability_across(pieces: Pieces, state: RodSolution) -> Stability:
    """Of a planar equilibrium against motions out of the plane; its end is free along z.

    The force on the end keeps its direction. It acts where it makes the moment of the end.
    """
    frames, moment = rotation(state.theta[:, None] * ACROSS), state.moment[:, None] * ACROSS
    x, y = (float(part) / pieces.length for part in state.weight)
    weight, force = pieces.weight(SpatialLoad(weight=(x, y, 0.0)), state.s), np.append(state.force, 0.0)
    rod, _ = loaded_rod(LawInSpace.of(pieces.section), state.s, frames, moment, force, weight)
    lever = frames[-1, :, :2] @ pieces.tip.edge
    if square := float(force @ force):
        lever = lever + cross(force, moment[-1] - cross(lever, force)) / square
    ends = Ends.of(pieces.clamp, moment, lever, lever, np.zeros(3, bool))
    return stability_of(rod, replace(ends, kept=OUT_OF_PLANE))
