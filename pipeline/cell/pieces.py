"""The pieces of an arm whose own law is measured, as its configuration sets them up."""

import math
from collections.abc import Hashable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from fem import ContactError, Discretisation, Effect, SelfContact
from fem.cell.boundary import Boundary
from fem.cell.mirror_contact import MirrorContact
from fem.cell.piece import BendingPiece
from geometry import GRADINGS, Body, Design, DesignError, MeshError
from geometry.meshing.mirror import Repetition
from pipeline.config.config import Config
from pipeline.simulation.scene import GAP, Scene, layer_in, material_of


class NoArmLaw(Exception):
    """This arm, or its effects, have no law of their own; one sentence tells why."""


@dataclass(frozen=True, eq=False)  # caches inside
class ArmPieces:
    """Half cell and ends of the arm of a configuration, each meshed when it is first used.

    Raises `NoArmLaw` before anything is meshed.
    """

    config: Config
    dhat: float | None  #: mm, activation distance of contact of the walls outside; None without contact
    outer: str = ""  #: name of the outer faces that may meet; empty: the first one of the configuration, or the gap
    _pieces: dict[tuple[int, Boundary], BendingPiece] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        if reason := self.config.effects.why_no_arm_law(self.config.design):
            raise NoArmLaw(reason)

    def __reduce__(self) -> tuple[Any, ...]:
        return ArmPieces, (self.config, self.dhat, self.outer)  # a worker meshes its own

    @staticmethod
    def of(scene: Scene) -> "ArmPieces":
        """The pieces of a meshed arm. Raises `NoArmLaw`."""
        return ArmPieces(scene.config, scene.activation_distance, scene.outer_walls)

    def with_mesh_size(self, size_mm: float) -> "ArmPieces":
        """The same pieces on another mesh, with the same contact."""
        return ArmPieces(self.config.with_mesh_size(size_mm), self.dhat, self.outer)

    @property
    def key(self) -> Hashable:
        """Equal for equal pieces."""
        return self.config.hash, self.dhat, self.outer

    @property
    def walls(self) -> str:
        """The name of the outer faces that may meet."""
        return self.outer or next(iter(self.config.effects.self_contact.faces or (GAP,)))

    @property
    def design(self) -> Design:
        """The arm."""
        return self.config.design

    @property
    def fractions(self) -> dict[str, float]:
        """By the name of a cavity: its pressure over that of the law."""
        return {name: cavity.fraction for name, cavity in self.config.effects.pressure.cavities.items()}

    @cached_property
    def repetition(self) -> Repetition:
        """Where the cells of the arm are. Raises InputError."""
        mesh = self.config.mesh
        try:
            return self.design.repetition(mesh.element_size_mm, GRADINGS[mesh.grading])
        except (DesignError, MeshError) as failure:
            raise self.config.unmeshable(failure) from None

    @property
    def cell(self) -> BendingPiece:
        """Half a cell between two planes of mirror symmetry. Raises `NoArmLaw` and InputError."""
        return self._piece(0, "mirror")

    def end(self, half_cells: int, start: Boundary) -> BendingPiece:
        """One end of the arm with that many half cells. Raises `NoArmLaw` and InputError."""
        return self._piece(half_cells, start)

    def _piece(self, half_cells: int, start: Boundary) -> BendingPiece:
        key = (half_cells, start)
        if key not in self._pieces:
            config, body = self.config, self._body(half_cells, start)
            effects, dhat = [*layer_in(body, config), *self._contacts(body)], self.dhat if self.walls == GAP else None
            try:
                self._pieces[key] = BendingPiece(
                    *(body, material_of(config), start, config.mesh.formulation, self.fractions, dhat), effects=effects
                )
            except ContactError as failure:
                raise NoArmLaw(f"{failure} between two cells; leave effects.self_contact.faces out") from None
        return self._pieces[key]

    def _contacts(self, body: Body) -> list[Effect]:
        """Of outer faces that are no gap, with each other and with their images beyond the plane between two cells."""
        if self.walls == GAP or self.dhat is None:
            return []
        mirrored = MirrorContact(self.walls, "tip", self.dhat)
        among_themselves = SelfContact(self.walls, self.dhat, starts_inactive=True, near=math.inf)
        if self.config.effects.self_contact.faces is not None:
            return [mirrored, among_themselves]  # refused where these walls do not face their images
        space = Discretisation.of(body.mesh, self.config.mesh.formulation)
        return [mirrored, among_themselves] if mirrored.has_walls(space) else [among_themselves]

    def _body(self, half_cells: int, start: Boundary) -> Body:
        """The meshed piece. Raises `NoArmLaw` and InputError."""
        try:
            return self._meshed(half_cells, start)
        except (DesignError, MeshError) as failure:
            raise self.config.unmeshable(failure) from None

    def _meshed(self, half_cells: int, start: Boundary) -> Body:
        size, grading = self.config.mesh.element_size_mm, GRADINGS[self.config.mesh.grading]
        if start == "mirror":
            return self.design.half_cell(size, grading)
        is_clamp = start == "clamp"
        for (meshed, other), piece in self._pieces.items():
            if meshed == half_cells and other != "mirror" and (other == "clamp") == is_clamp:
                return piece.body
        return (self.design.end_piece if is_clamp else self.design.tip_piece)(half_cells, size, grading)
