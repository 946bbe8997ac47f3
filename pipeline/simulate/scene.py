"""From a configuration to its scene: the part of the body that is meshed, its material, and the effects on it."""

import threading
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, radians
from time import perf_counter
from typing import Any

import numpy as np

import fem
from fem.elements import ELEMENTS, Volumetric
from geometry import GRADINGS, Body, DesignError, MeshError, position_text
from geometry.arrays import Index
from pipeline.config.config import Config, Material
from pipeline.config.effects import HOOPS, LAYER
from pipeline.simulate.mass import GRAMS, element_masses
from pipeline.store.progress import Progress
from pipeline.values.errors import InputError
from pipeline.values.pressure import in_MPa
from pipeline.values.record import MeshRecord
from rod import Load

#: The name of outer faces that can meet, where the user names no others, and that of all outer faces of a body from a
#: file, of which it is not known which ones they are.
GAP, OUTER = "gap", "outer"
#: the walls of all cavities, and the lowest plane of the body, as the faces of a layer
INNER, BOTTOM = "inner", "bottom"
#: seconds between two remarks while the body is meshed
EVERY = 20.0
#: faces that cannot touch others, and why
_NEVER_MEET = {"clamp": "is held and meets nothing", "sym": "is the plane of symmetry, which meets nothing"}


@dataclass(frozen=True)
class Scene:
    """A configuration with its meshed body: everything that the finite elements need but the experiment."""

    config: Config
    body: Body  #: half of it where body, pressure and loads are mirror images about z = 0

    @staticmethod
    def meshed(config: Config) -> "Scene":
        """Mesh the body of a configuration.

        Raises InputError for a body that cannot be meshed or lacks what an effect needs, and for constants that the
        law cannot have together.
        """
        material_of(config)
        try:
            body = config.design.body(config.mesh.size_mm, GRADINGS[config.mesh.grading])
        except (DesignError, MeshError) as failure:
            raise config.unmeshable(failure) from None
        _check_boundary(config, body)
        _check_faces(config, body)
        whole = config.effects.symmetry.off or config.effects.gravity.breaks_symmetry
        scene = Scene(config, body.full() if whole else body)
        scene._check_contact()
        return scene

    @property
    def mesh_record(self) -> MeshRecord:
        """The mesh as run.json has it: what was chosen and why, how long its edges are, and its volume."""
        mesh, settings, design = self.body.mesh, self.config.mesh, self.config.design
        averaging = {"averaging": reason} if (reason := design.reason_for_pitch) else {}
        return MeshRecord(
            size_mm=settings.size_mm,
            from_file=not design.is_resizable,
            formulation=settings.formulation,
            grading=settings.grading,
            averaging_mm=self.body.pitch,
            curve_height_mm=self.body.curve_y,
            chosen=dict(settings.chosen) | averaging,
            elements=len(mesh.tets),
            mean_edge_mm=mesh.quality.mean_edge,
            longest_edge_mm=mesh.quality.longest_edge,
            smallest_radius_ratio=mesh.quality.minimum,
            volume_over_drawing=self.body.volume / design.solid_volume,
        )

    @property
    def material(self) -> fem.Solid:
        """The law of the solid, or those of its regions. Raises InputError as `material_of`."""
        return material_of(self.config)

    @property
    def contact_faces(self) -> tuple[str, ...]:
        """The faces each of which may meet itself: those the user names, gap or outer walls that face each other, and
        the walls of the cavities.

        Empty where contact is switched off.
        """
        if self.config.effects.self_contact.off:
            return ()
        names = (*(self.config.effects.self_contact.faces or ()), *self._facing_outside, *self.body.cavities)
        return tuple(dict.fromkeys(name for name in names if name in self.body.mesh.faces))

    @property
    def activation_distance(self) -> float | None:
        """The activation distance of contact (mm) as configured, or the default; None where no faces can meet."""
        space = self._space
        return min((contact.activation_distance(space) for contact in self._intended_contacts), default=None)

    def __getstate__(self) -> dict[str, Any]:
        """Without its elements, which a process that gets a scene makes itself where it needs them."""
        return {name: value for name, value in vars(self).items() if name != "_space"}

    @cached_property
    def _space(self) -> fem.Discretisation:
        return fem.Discretisation.of(self.body.mesh, self.config.mesh.formulation)

    @property
    def _intended_contacts(self) -> list[fem.SelfContact]:
        dhat = self.config.effects.self_contact.dhat_mm
        return [fem.SelfContact(faces, dhat) for faces in self.contact_faces if faces in self._intended_faces]

    @property
    def _intended_faces(self) -> tuple[str, ...]:
        """The faces that are expected to meet: those the user names, else those outside that face each other."""
        return self.config.effects.self_contact.faces or self._facing_outside

    @property
    def outer_walls(self) -> str:
        """The name of the outer faces that are expected to meet; empty where none do."""
        return next((name for name in self._intended_faces if name not in self.body.cavities), "")

    @cached_property
    def _facing_outside(self) -> tuple[str, ...]:
        """The faces outside that the program expects to meet."""
        faces = self.body.mesh.faces
        if GAP in faces or OUTER not in faces:
            return (GAP,)
        return (OUTER,) if fem.SelfContact(OUTER, starts_inactive=True).smallest_gap(self._space) < inf else ()

    def _check_contact(self) -> None:
        """Refuse a given activation distance that walls are within at rest. Raises InputError."""
        if self.config.effects.self_contact.dhat_mm is None:
            return
        space = self._space
        try:
            for contact in self._intended_contacts:
                replace(contact, starts_inactive=True).activation_distance(space)  # faces that never meet do no harm
        except fem.ContactError as failure:
            raise InputError(f"{self.config.source}: effects.self_contact.dhat: {failure}") from None

    def effects(self, largest_MPa: float) -> list[fem.Effect]:
        """The effects on the body, with `largest_MPa` as the pressure of the run at load factor 1."""
        gravity = self.config.effects.gravity
        effects = [*self._pressures(largest_MPa), *self._contacts()]
        if gravity.on:
            density = self.config.material.density_tonne_mm3
            assert density is not None  # the configuration refuses gravity without it
            regions = {name: material.density_tonne_mm3 or 0.0 for name, material in self.config.materials.items()}
            effects.append(fem.Gravity(density, gravity.acceleration_mm_s2, ramp=False, regions=regions))
        return [*effects, *make_layers(self.body, self.config)]

    @cached_property
    def weight(self) -> Load:
        """The weight of the arm in its plane, spread evenly along it at the height of its centre of mass; none without
        gravity."""
        gravity, mesh = self.config.effects.gravity, self.body.mesh
        masses = element_masses(self.body, self.config) if gravity.on else None
        if masses is None:
            return Load()
        height = mesh.points[mesh.tets, 1].mean(axis=1) @ masses / masses.sum() - self.body.curve_y
        per_length = masses.sum() / GRAMS / self.body.length
        x, y, _ = (per_length * component for component in gravity.acceleration_mm_s2)
        return Load(weight=(x, y), weight_height=float(height))

    def _pressures(self, largest_MPa: float) -> list[fem.Effect]:
        effects: list[fem.Effect] = []
        pressure = self.config.effects.pressure
        if pressure.off:
            return effects
        for name, cavity in pressure.cavities.items():
            if cavity.fraction:
                effects.append(fem.Pressure(name, cavity.fraction * largest_MPa))
            if cavity.constant_kPa:
                effects.append(fem.Pressure(name, in_MPa(cavity.constant_kPa), ramp=False))
        return effects

    def _contacts(self) -> list[fem.Effect]:
        effects: list[fem.Effect] = []
        contact = self.config.effects.self_contact
        for faces in self.contact_faces:
            intended = faces in self._intended_faces
            # faces that nobody named start inactive even where contact is switched on: no cost until they meet
            inactive = contact.state == "auto" or not intended
            # the walls of a cavity collapse under a vacuum, and press on spots
            overlap = 0.0 if faces in self.body.cavities else fem.OVERLAP
            distance = contact.dhat_mm if intended else None
            effects.append(fem.SelfContact(faces, distance, inactive, overlap))
        return effects


def _check_boundary(config: Config, body: Body) -> None:
    """Refuse a mesh or surface file whose boundary passes through itself."""
    if not config.design.has_drawing and (crossing := fem.crossing_at_rest(body.mesh)):
        raise InputError(
            f"{config.source}: geometry.file: the boundary of the mesh passes through itself near "
            f"{position_text(crossing)}; move the vertex there back, or mesh the body again"
        )


def make_layers(body: Body, config: Config) -> list[fem.Membrane]:
    """The strain-limiting layer and the hoops of a body or a piece of it, those that are switched on and lie on it."""
    layer, hoops = config.effects.strain_limiting_layer, config.effects.hoops
    layers: list[fem.Membrane] = []
    if layer.on and len(on := faces_of(body, config, LAYER)):
        layers.append(fem.StrainLimitingLayer(on, layer.thickness_mm, layer.E_MPa, layer.nu))
    if hoops.on and len(on := faces_of(body, config, HOOPS)):
        layers.append(fem.Hoops(on, hoops.thickness_mm, hoops.modulus_MPa, radians(hoops.angle_deg)))
    return layers


def faces_of(body: Body, config: Config, effect: str) -> Index:
    """Triangles (f, 3) of the strain-limiting layer or of the hoops; none where the body has none for them."""
    name, height = getattr(config.effects, effect).faces, body.mesh.points[:, 1].min()
    if effect == LAYER and name in (None, BOTTOM):
        return body.mesh.plane(1, height if name else body.curve_y)
    faces = _possible_faces(body)
    parts = [faces[part] for part in (body.cavities if name == INNER else (name,)) if part in faces]
    triangles = np.concatenate([np.empty((0, 3), np.int64), *parts])
    return fem.faces_along(body.mesh.points, triangles) if effect == HOOPS else triangles


def _possible_faces(body: Body) -> dict[str, Index]:
    """The faces on which a layer may lie, by their names."""
    ends = (*_NEVER_MEET, "tip")
    return {name: triangles for name, triangles in body.mesh.faces.items() if name not in ends}


def _check_faces(config: Config, body: Body) -> None:
    """Refuse a body that lacks what an effect needs."""
    if config.effects.symmetry.on and not body.half:
        raise InputError(f"{config.source}: effects.symmetry: on, but this body is no half; write auto or off")
    for effect in (LAYER, HOOPS):
        if config.effects.requested[effect].on and not len(faces_of(body, config, effect)):
            raise _without_faces(config, body, effect)
    allowed = [name for name in body.mesh.faces if name not in _NEVER_MEET]
    for faces in config.effects.self_contact.faces or ():
        if faces not in allowed:
            reason = _NEVER_MEET[faces] if faces in body.mesh.faces else "does not exist"
            raise InputError(
                f"{config.source}: effects.self_contact.faces: '{faces}' {reason}; this body has {', '.join(allowed)}"
            )


def _without_faces(config: Config, body: Body, effect: str) -> InputError:
    """The refusal of a layer or of hoops for which a body has no faces."""
    name = getattr(config.effects, effect).faces
    possible = [INNER, *[BOTTOM] * (effect == LAYER), *_possible_faces(body)]
    if name is None:
        return InputError(
            f"{config.source}: effects.{effect}: the mesh has no faces in the plane "
            f"y = {body.curve_y:g} mm of the material curve; cut the body there before meshing it"
        )
    why = "does not run along the arm" if name in possible else f"is not possible; this body has {', '.join(possible)}"
    return InputError(f"{config.source}: effects.{effect}.faces: '{name}' {why}")


def material_of(config: Config) -> fem.Solid:
    """The law of the solid, or those of its regions. Raises InputError for constants that a law cannot have
    together."""
    laws = {"": config.material} | dict(config.materials)
    built = {name: _built(config, f"materials.{name}" if name else "material", law) for name, law in laws.items()}
    body = built.pop("")
    return fem.ByRegion(body, built) if built else body


def _built(config: Config, key: str, material: Material) -> fem.Material:
    try:
        law = material.built()
    except fem.MaterialError as failure:
        raise InputError(f"{config.source}: {key}: {failure}") from None
    formulation = config.mesh.formulation
    if ELEMENTS[formulation].volumetric is Volumetric.PRESSURE and law.volumetric_modulus <= 0:
        where = "" if key == "material" else f" in {key}"
        raise InputError(
            f"{config.source}: mesh.formulation: {formulation} needs a law that resists a change of volume by more "
            f"than shear does; its volumetric modulus here is {law.volumetric_modulus:g} MPa{where}; write p2 or p2p0"
        )
    return law


def mesh_with_progress(config: Config, progress: Progress) -> Scene:
    """The scene of a configuration, with remarks every EVERY seconds. Raises InputError as `Scene.meshed`."""
    ended, start = threading.Event(), perf_counter()

    def tell() -> None:
        while not ended.wait(EVERY):
            progress.remark(f"meshing the body for {perf_counter() - start:.3g} s so far")

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        return Scene.meshed(config)
    finally:
        ended.set()
        teller.join()
