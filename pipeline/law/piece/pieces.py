"""The pieces of an arm whose own law is measured, as its configuration sets them up."""

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

from fem import ContactError, Discretisation, Effect, SelfContact
from fem.cell.any_plane import turned
from fem.cell.boundary import Boundary
from fem.cell.inflation import inflated
from fem.cell.mirror_contact import MirrorContact
from fem.cell.piece import BendingPiece, PieceState
from geometry import GRADINGS, Body, Design, DesignError, MeshError
from geometry.meshing.mirror import Repetition
from geometry.meshing.moving import Movement, moved
from pipeline.config.config import Config, MeshSettings
from pipeline.law.piece.rates import changes_of
from pipeline.simulate.mass import mass_along, weight_per_length
from pipeline.simulate.scene import GAP, Scene, make_layers, material_of
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw


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
    derivatives: bool = False  #: whether the curves have derivatives by the design
    by: tuple[str, ...] = ()  #: the parameters of these derivatives, such as geometry.wall; empty: all
    mesh_of: Config | None = None  #: the design whose mesh is moved to these dimensions; None: a mesh of its own
    after_snap: float = 0.0  #: MPa, at which the cells have snapped; 0: they have their form from rest
    _pieces: dict[tuple[int, Boundary], BendingPiece] = field(default_factory=dict, init=False, repr=False)
    _turned: dict[Hashable, BendingPiece] = field(default_factory=dict, init=False, repr=False)
    _straight: dict[Hashable, PieceState] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        if reason := self.config.effects.why_no_arm_law(self.config.design):
            raise NoArmLaw(reason)

    def __reduce__(self) -> tuple[Any, ...]:
        own = self.config, self.dhat, self.outer, self.derivatives, self.by, self.mesh_of, self.after_snap
        return ArmPieces, own  # a worker meshes its own

    @staticmethod
    def of(scene: Scene) -> "ArmPieces":
        """The pieces of a meshed arm. Raises `NoArmLaw`."""
        return ArmPieces(scene.config, scene.activation_distance, scene.outer_walls)

    def with_derivatives(self) -> "ArmPieces":
        """These pieces, whose curves have derivatives by the design (`pipeline.law.piece.rates`)."""
        return replace(self, derivatives=True, by=(), mesh_of=None)

    def with_mesh(self, mesh: MeshSettings) -> "ArmPieces":
        """These pieces on another mesh, with the same contact and without derivatives."""
        return replace(self, config=replace(self.config, mesh=mesh), derivatives=False, by=(), mesh_of=None)

    def with_mesh_size(self, size_mm: float) -> "ArmPieces":
        """These pieces on a mesh of another size."""
        return self.with_mesh(replace(self.config.mesh, size_mm=size_mm))

    @property
    def mesh_name(self) -> str:
        """What the folder of their curves is called: mixed_walls_2.7mm."""
        mesh = self.config.mesh
        return f"{mesh.formulation}_{mesh.grading}_{mesh.size_mm:.12g}mm" + "_after_snap" * bool(self.after_snap)

    @property
    def key(self) -> Hashable:
        """Equal for equal pieces."""
        moved = None if self.mesh_of is None else self.mesh_of.hash
        return self.config.hash, self.dhat, self.outer, self.derivatives, self.by, moved, self.after_snap

    @property
    def walls(self) -> str:
        """The name of the outer faces that may meet."""
        return self.outer or next(iter(self.config.effects.self_contact.faces or (GAP,)))

    @property
    def other(self) -> str:
        """The cavity with the smaller fraction of the pressure, the last one of equal ones; empty where the law has no
        derivatives by its own pressure."""
        cavities = self.config.effects.pressure.cavities
        return min(reversed(cavities), key=lambda name: cavities[name].fraction) if self.config.law_by_cavity else ""

    @property
    def design(self) -> Design:
        """The arm."""
        return self.config.design

    @cached_property
    def repetition(self) -> Repetition:
        """Where the cells of the arm are. Raises InputError."""
        mesh, design = self.config.mesh, self.design
        try:
            design.check_size(mesh.size_mm)
            if self.mesh_of is not None:
                return _moved(self.mesh_of.design, design, mesh.size_mm, mesh.grading)
            return design.repetition(mesh.size_mm, GRADINGS[mesh.grading])
        except (DesignError, MeshError) as failure:
            raise self.config.unmeshable(failure) from None

    @cached_property
    def movements(self) -> Mapping[str, Movement | DesignError]:
        """How the meshed pieces move with the dimensions of the design."""
        return self.design.movements(self.repetition)

    def law(self, cells: Sequence[CellCurve], clamps: Sequence[ClampCurve], tips: Sequence[TipCurve]) -> ArmLaw:
        """The law of the arm from the curves of its pieces at rising pressures, with its mass and its weight."""
        lengths = 2.0 * self.repetition.half_pitch, self.repetition.middle, self.design.length
        mass = mass_along(self.design.of_pieces(self.repetition), self.config)
        weight = weight_per_length(mass, self.config)
        return ArmLaw(*lengths, tuple(cells), tuple(clamps), tuple(tips), mass, weight)

    @property
    def cell(self) -> BendingPiece:
        """Half a cell between two planes of mirror symmetry. Raises `NoArmLaw` and InputError."""
        return self.end(0, "mirror")

    def end(self, half_cells: int, start: Boundary) -> BendingPiece:
        """One end of the arm with that many half cells. Raises `NoArmLaw` and InputError."""
        key = half_cells, start
        if key not in self._pieces:
            self._pieces[key] = self._piece(half_cells, start)
        return self._pieces[key]

    def turned(self, start: Boundary, half_cells: int, fractions: Sequence[float], angle: float) -> BendingPiece:
        """A piece of the body turned about its material curve (`fem.cell.any_plane`); the last one is kept.

        fractions: of the pressure, by cavity. Raises `NoArmLaw` and InputError.
        """
        key = start, round(angle, 12), tuple(fractions)
        if key not in self._turned:
            self._turned.clear()  # each keeps a factorization
            by_cavity = dict(zip(self.design.cavities, fractions, strict=True))
            self._turned[key] = self._made(start, half_cells, by_cavity, angle)
        return self._turned[key]

    def straight(
        self, start: Boundary, half_cells: int, fractions: Sequence[float], pressure: float, from_half: bool = False
    ) -> PieceState:
        """A piece that is not turned under a pressure in MPa, with its plane upright; each is solved once.

        fractions: as in `turned`; from_half: whether it is inflated from the state at half of the pressure. Raises
        `PieceFailed`, `NoArmLaw` and InputError.
        """
        key = start, tuple(fractions), pressure
        if key not in self._straight:
            begin = self.straight(start, half_cells, fractions, 0.5 * pressure) if from_half else None
            piece = self.turned(start, half_cells, fractions, 0.0)
            self._straight[key] = inflated(piece, pressure, 0.0, begin=begin)
        return self._straight[key]

    def _piece(self, half_cells: int, start: Boundary) -> BendingPiece:
        fractions = {name: cavity.fraction for name, cavity in self.config.effects.pressure.cavities.items()}
        piece = self._made(start, half_cells, fractions)
        piece.other = self.other
        if self.derivatives and start != "free":
            piece.changes = changes_of(piece, self.config, self.repetition, self.movements, self.by)
        return piece

    def _made(
        self, start: Boundary, half_cells: int, fractions: Mapping[str, float], angle: float = 0.0
    ) -> BendingPiece:
        config = self.config
        dhat = self.dhat if self.walls == GAP else None
        try:
            if start == "mirror":
                body = self.design.half_cell(self.repetition)
            else:
                make = self.design.end_piece if start == "clamp" else self.design.tip_piece
                body = make(half_cells, self.repetition)
            body = turned(body, angle) if angle else body
            effects = [*make_layers(body, config), *self._contacts(body)]
            material, formulation = material_of(config), config.mesh.formulation
            piece = BendingPiece(body, material, start, formulation, fractions, dhat, effects=effects)
            piece.after_snap = self.after_snap
            return piece
        except (DesignError, MeshError) as failure:
            raise config.unmeshable(failure) from None
        except ContactError as failure:
            raise NoArmLaw(f"{failure} between two cells; leave effects.self_contact.faces out") from None

    def _contacts(self, body: Body) -> list[Effect]:
        """Besides that of the gap: of other outer faces with each other and with their images beyond the plane between
        two cells, and of the walls of each cavity, as in the whole arm."""
        if self.config.effects.self_contact.off:
            return []
        in_cavities = (SelfContact(name, starts_inactive=True, overlap=0.0) for name in body.cavities)
        return [*self._outer_contacts(body), *in_cavities]

    def _outer_contacts(self, body: Body) -> list[Effect]:
        if self.walls == GAP or self.dhat is None:
            return []
        mirrored = MirrorContact(self.walls, "tip", self.dhat)
        among_themselves = SelfContact(self.walls, self.dhat, starts_inactive=True, near=math.inf)
        if self.config.effects.self_contact.faces is not None:
            return [mirrored, among_themselves]  # refused where these walls do not face their images
        space = Discretisation.of(body.mesh, self.config.mesh.formulation)
        return [mirrored, among_themselves] if mirrored.has_walls(space) else [among_themselves]


def _moved(known: Design, design: Design, size: float, grading: str) -> Repetition:
    """The mesh of a design moved to the dimensions of another one. Raises `DesignError`."""
    repetition, velocities = _movable(known, known.regions, size, grading)
    values = design.dimensions
    changes = {name: values[name] - value for name, value in known.dimensions.items() if values[name] != value}
    return moved(repetition, velocities, changes)


@lru_cache(maxsize=2)  # a worker meshes a design once, whose mesh it moves many times
def _movable(
    design: Design, regions: tuple[str, ...], size: float, grading: str
) -> tuple[Repetition, Mapping[str, Movement | DesignError]]:
    """regions: of the design, by which equal dimensions may differ."""
    repetition = design.repetition(size, GRADINGS[grading])
    return repetition, design.movements(repetition)
