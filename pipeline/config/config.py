"""One design as a user writes it (YAML with units) and as the program reads it (mm, N, MPa, tonne/mm3).

Every refusal is one sentence: `FILE: key: what is wrong; what is allowed`.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import fem.materials
from fem.elements import ELEMENTS, automatic_element
from fem.materials import LAWS
from geometry import FAMILIES, CadFile, Design, DesignError, MeshFile
from geometry.design import check_size
from pipeline.config.document import Document, read_document
from pipeline.config.schema import EFFECTS, OWN, checked
from pipeline.errors import InputError

#: size of elements over the smallest side of the body, where a size is still to be looked for
NOMINAL = 0.4


@dataclass(frozen=True)
class Material:
    """The law of the solid and its constants."""

    law: str  #: as in the YAML: svk
    constants: Mapping[str, float]  #: stresses in MPa
    density_tonne_mm3: float

    def built(self) -> fem.materials.Material:
        """The law with its constants. Raises `fem.materials.MaterialError` where it cannot have them together."""
        return LAWS[self.law](**self.constants)


@dataclass(frozen=True)
class MeshChoice:
    """How fine and with which elements."""

    size_mm: float
    formulation: str  #: one of fem.elements.ELEMENTS
    coarser: float | None  #: the second mesh's size over size_mm, for the mesh error of the numbers; None for none
    grading: str  #: one of geometry.GRADINGS


@dataclass(frozen=True)
class Layer:
    """A sheet of paper or fabric in the plane of the material curve."""

    thickness_mm: float
    E_MPa: float
    nu: float


@dataclass(frozen=True)
class CavityPressure:
    """The pressure of one cavity: its share of the pressure of the run plus what it holds at all pressures."""

    share: float
    held_kPa: float


@dataclass(frozen=True)
class Validation:
    """Loads for which the rod is held against the finite elements without being fitted to them."""

    pressures_kPa: tuple[float, ...]  #: ascending; those of the run and others between them
    end_y_mm: tuple[float, ...]  #: displacements u_y of the end in III
    forces_N: tuple[tuple[float, float], ...]  #: dead forces on the end


@dataclass(frozen=True)
class Config:
    """A design and what is asked of it, checked. Lengths in mm, stresses in MPa."""

    name: str
    family: str
    design: Design
    material: Material
    pressures_kPa: tuple[float, ...]  #: ascending
    end_y_mm: float  #: the displacement u_y of the end in experiment III
    added_pressures: int  #: how many may be added where alpha(p) or kappa_0(p) is not straight
    validation: Validation
    mesh: MeshChoice
    newton_tolerance: float  #: residual over internal forces at which Newton stops
    accuracy: float | None  #: largest relative error of kappa_0(l/2), alpha2 and F that is asked for
    size_is_given: bool  #: the mesh size is the user's, and none is looked for
    effects: Mapping[str, str]  #: effect -> auto, on or off
    cavities: Mapping[str, CavityPressure]  #: cavity -> its pressure, in the order of the design
    gravity_mm_s2: tuple[float, float, float]
    layer: Layer
    contact_dhat_mm: float | None  #: activation distance of contact; None for a fiftieth of the smallest gap
    contact_faces: tuple[str, ...] | None  #: names of faces that can meet; None for those named gap
    source: str  #: the file it was read from, for messages

    def record(self) -> dict[str, Any]:
        """Everything that decides the results, ready for JSON; lengths in mm, constants of the law in MPa."""
        return {
            "name": self.name,
            "geometry": {"family": self.family, **_dimensions(self.design)},
            "material": {
                "law": self.material.law,
                **self.material.constants,
                "density_tonne_mm3": self.material.density_tonne_mm3,
            },
            "pressures_kPa": list(self.pressures_kPa),
            "end_y_mm": self.end_y_mm,
            "added_pressures": self.added_pressures,
            "validation": {
                "pressures_kPa": list(self.validation.pressures_kPa),
                "end_y_mm": list(self.validation.end_y_mm),
                "forces_N": [list(force) for force in self.validation.forces_N],
            },
            "mesh": asdict(self.mesh),
            "newton": {"tolerance": self.newton_tolerance},
            "accuracy": self.accuracy,
            "effects": {
                **self.effects,
                "cavity_pressures": {name: asdict(pressure) for name, pressure in self.cavities.items()},
                "gravity_mm_s2": list(self.gravity_mm_s2),
                "layer": asdict(self.layer),
                "contact_dhat_mm": self.contact_dhat_mm,
                "contact_faces": self.contact_faces and list(self.contact_faces),
            },
        }

    @property
    def hash(self) -> str:
        """sha256 of the record: equal for equal values, however they were written."""
        canonical = json.dumps(self.record(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(canonical.encode()).hexdigest()

    def with_effect(self, effect: str, state: str) -> "Config":
        """The same with one effect on or off."""
        effects = {**self.effects, effect: state}
        if effect != "incompressibility":
            return replace(self, effects=effects)
        formulation = _formulation(None, state, self.material.built().poisson_ratio)
        return replace(self, effects=effects, mesh=replace(self.mesh, formulation=formulation))


def load_config(path: Path | str, overrides: Sequence[str] = ()) -> Config:
    """The configuration in the YAML file `path` with `overrides` ("mesh.size=4 mm") applied.

    Raises InputError with one sentence that names the file (or the override), the key and what is allowed.
    """
    document = read_document(Path(path), overrides)
    content, family, law = checked(document)
    design, size = _design(document, content, family)
    constants = {name: getattr(content.material, name) for name in LAWS[law].constants()}
    material = Material(law, constants, content.material.density)
    effects = content.effects
    states = {name: getattr(effects, name).state for name in EFFECTS}
    layer = effects.strain_limiting_layer
    _check_together(document, content)
    return Config(
        name=content.name,
        family=family,
        design=design,
        material=material,
        pressures_kPa=content.pressures,
        end_y_mm=content.end.y,
        added_pressures=content.added_pressures,
        validation=_validation(document, content),
        mesh=_mesh(content, size, states["incompressibility"], _poisson_ratio(document, material)),
        newton_tolerance=content.newton.tolerance,
        accuracy=content.accuracy,
        size_is_given=getattr(content.mesh, "size", None) is not None,
        effects=states,
        cavities=_cavities(document, design, effects.pressure),
        gravity_mm_s2=effects.gravity.acceleration,
        layer=Layer(layer.thickness, layer.E, layer.nu),
        contact_dhat_mm=effects.self_contact.dhat,
        contact_faces=effects.self_contact.faces,
        source=str(document.path),
    )


def _design(document: Document, content: Any, family: str) -> tuple[Design, float]:
    """The design and the size of its elements, mm."""
    values = content.geometry.model_dump(exclude={"family"})
    try:
        if family == OWN:
            values["file"] = str(document.path.parent / values["file"])
            own = CadFile if "air" in values else MeshFile
            design: Design = own(**values)
        else:
            design = FAMILIES[family](**values)
        if isinstance(design, MeshFile):
            if content.accuracy is not None:
                raise document.wrong(
                    ("accuracy",), "a ready mesh cannot be made finer; leave it out, or give a drawing"
                )
            return design, design.ready.mesh.quality.longest_edge
        size = _nominal(document, design, content) if content.mesh.size is None else content.mesh.size
        check_size(size, design.extent, design.solid_volume / 2)
        return design, size
    except DesignError as refused:
        parts = [tuple(key.split(".")) for key in refused.keys]
        keys = tuple(("geometry", *key) if key[0] in values else key for key in parts)
        raise document.wrong_together(keys, refused.sentence) from None


def _nominal(document: Document, design: Design, content: Any) -> float:
    """The mesh size (mm) where one is still to be looked for."""
    if content.accuracy is None:
        raise document.wrong(
            ("mesh", "size"), "is auto, but no accuracy is asked for; give --accuracy 2%, or a size such as 4 mm"
        )
    return NOMINAL * min(design.extent)


def _validation(document: Document, content: Any) -> Validation:
    """The loads not used for the fit; where there are some and no pressures, all pressures of the run."""
    asked, known = content.validation, content.pressures
    if content.end.y in asked.end_y:
        raise document.wrong(
            ("validation", "end_y"), f"{content.end.y:g} mm is what the numbers are identified with; give others"
        )
    for pressure in asked.pressures or ():
        if not known[0] <= pressure <= known[-1]:
            raise document.wrong(
                ("validation", "pressures"),
                f"{pressure:g} kPa lies outside the pressures of the run; allowed: {known[0]:g} to {known[-1]:g} kPa",
            )
    loads = bool(asked.end_y or asked.forces)
    if asked.pressures and not loads and set(asked.pressures) <= set(known):
        raise document.wrong(
            ("validation", "pressures"), "are all pressures of the run; give one between them, or end_y, or forces"
        )
    return Validation(asked.pressures or (known if loads else ()), asked.end_y, asked.forces)


def _cavities(document: Document, design: Design, pressure: Any) -> dict[str, CavityPressure]:
    """The pressure of every cavity; where none is named, the first one follows the pressure of the run."""
    for name in pressure.cavities:
        if name not in design.cavities:
            raise document.wrong(
                ("effects", "pressure", "cavities", name), f"is no cavity; this body has {', '.join(design.cavities)}"
            )
    found = pressure.cavities or {design.cavities[0]: ("share", 1.0)}
    cavities = {}
    for name in design.cavities:
        kind, value = found.get(name, ("share", 0.0))
        cavities[name] = CavityPressure(value if kind == "share" else 0.0, value if kind == "held" else 0.0)
    return cavities


def _check_together(document: Document, content: Any) -> None:
    """Refuse effects that contradict each other or the mesh."""
    effects, formulation = content.effects, content.mesh.formulation
    state = effects.incompressibility.state
    if formulation is not None and state != "auto" and (state == "off") != ELEMENTS[formulation].fully_integrated:
        raise document.wrong_together(
            (("effects", "incompressibility"), ("mesh", "formulation")),
            f"incompressibility {state} and formulation {formulation} contradict each other; leave one of them out",
        )
    if effects.symmetry.state == "on" and effects.gravity.state == "on" and effects.gravity.acceleration[2] != 0.0:
        raise document.wrong_together(
            (("effects", "symmetry"), ("effects", "gravity")),
            "gravity acts across the plane of symmetry; write symmetry: auto or give its z component 0 m/s^2",
        )


def _mesh(content: Any, size: float, state: str, nu: float) -> MeshChoice:
    """The elements; a ready mesh has no second one and is not graded."""
    return MeshChoice(
        size,
        _formulation(content.mesh.formulation, state, nu),
        getattr(content.mesh, "coarser", None),
        getattr(content.mesh, "grading", "off"),
    )


def _formulation(given: str | None, state: str, nu: float) -> str:
    """The elements: as given, else by the state of the effect and Poisson's ratio."""
    if given is not None:
        return given
    return automatic_element(nu, None if state == "auto" else state == "on").name


def _poisson_ratio(document: Document, material: Material) -> float:
    """Poisson's ratio of the law at small strain. Raises InputError for constants that it cannot have together."""
    try:
        return material.built().poisson_ratio
    except fem.materials.MaterialError as failure:
        raise InputError(f"{document.path}: material: {failure}") from None


def _dimensions(design: Any) -> dict[str, Any]:
    """The keys of a design as in the YAML; a file stands there with the digest of what is in it."""
    values = {field.name: getattr(design, field.name) for field in fields(design)}
    if isinstance(design, CadFile | MeshFile):
        values |= {"file": Path(design.file).name, "sha256": design.digest}
    if "air" in values:
        values["air"] = {name: list(point) for name, point in values["air"].items()}
    return values
