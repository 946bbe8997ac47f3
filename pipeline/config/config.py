"""A design and what is to be computed for it, as checked values in mm, N, MPa and tonne/mm3, nested as in the YAML.

`Config` is the shape of the file too: its fields are the keys (`pipeline.config.section`). `pipeline.config.load` reads
one from a file.
"""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from fem.elements import automatic_element
from geometry import CellPlanes, Design, DesignError, MeshError
from pipeline.config import kinds
from pipeline.config.automatic_mesh import GivenMesh, MeshSettings, read_mesh
from pipeline.config.body import OWN, design_key, read_design
from pipeline.config.document import Key, dotted
from pipeline.config.effects import CavityPressure, Effects, State
from pipeline.config.material import Material, read_material, stiffness_conflicts
from pipeline.config.section import (
    Error,
    Field,
    Kind,
    ReadContext,
    Section,
    conflict,
    raise_all,
    section,
    to_jsonable_python,
)
from pipeline.config.tolerances import Tolerances, read_tolerances
from pipeline.config.validation import End, GivenEnd, GivenValidation, Validation, read_end, read_validation
from pipeline.values.errors import InputError, quoted
from pipeline.values.json_values import Json, JsonObject

__all__ = ["Config", "End", "Material", "MeshSettings", "Validation"]

#: the laws of the rod: five parameters and the law from one cell, or one of them
Laws = Literal["both", "five", "cell"]
LAW_CHOICES: tuple[Laws, ...] = get_args(Laws)
#: Newton's tolerance where none is given
USUAL_TOLERANCE = 1e-6
_MATERIAL = Kind("a section", "{law: svk, ...}", complete=read_material)
_REGIONS = Kind("a section for each region", "{base: {law: svk, E: 5 MPa, nu: 0.495, density: 1130 kg/m^3}}")


def _experiments(value: Any) -> tuple[str, ...]:
    names = tuple(value) if isinstance(value, list) else (value,)
    if sorted(map(str, names)) not in (["I", "II", "III"], ["II", "III"]):
        raise ValueError(f"{quoted(value)} is not allowed; allowed: [I, II, III] or [II, III]")
    return tuple(sorted(names))


@section(frozen=True)
class IdentificationSettings(Section):
    """How the five parameters are identified."""

    d_mm: kinds.PositiveLength | None = Field(
        default=None, description="break of the two lines, [given](identification.md#a-given-d) instead of sought"
    )


@section(frozen=True)
class Newton(Section):
    """When Newton's method stops."""

    tolerance: Annotated[
        kinds.Number, Kind("above 0, at most 0.01", "0.000001", "1", test=lambda value: 0.0 < value <= 1e-2)
    ] = Field(default=USUAL_TOLERANCE, description="largest relative residual of an equilibrium")


def _with_all_cavities(given: Effects, beside: ReadContext) -> Effects:
    """The effects with the pressure of every cavity; where none is named, the first one follows the pressure of the
    run."""
    design = beside.fields.get("design")
    if design is None:  # it is refused, and the effects can be compared with the other sections all the same
        return given
    cavities = given.pressure.cavities or {design.cavities[0]: CavityPressure(1.0, 0.0)}
    raise_all(
        conflict(f"is no cavity; this body has {', '.join(design.cavities)}", ("effects", "pressure", "cavities", name))
        for name in cavities
        if name not in design.cavities
    )
    every = {name: cavities.get(name, CavityPressure(0.0, 0.0)) for name in design.cavities}
    return replace(given, pressure=replace(given.pressure, cavities=every))


def _check_together(unknown: Any, beside: ReadContext) -> str:
    """The file of a document whose sections go together, as far as they are known."""
    if unknown:
        raise ValueError("unknown key; a key has a name")
    raise_all(_conflicts(beside))
    return str(beside.document.path)


def _conflicts(beside: ReadContext) -> Iterator[Error]:
    """Refuses sections that do not go together, of those that are not refused by themselves."""
    values = beside.fields
    if {"material", "pressures_kPa"} <= values.keys():
        yield from stiffness_conflicts(values["material"], values["pressures_kPa"])
    design, effects, identification = (values.get(name) for name in ("design", "effects", "identification"))
    if design and identification and (identification.d_mm or 0.0) >= design.length:
        place = f"{identification.d_mm:g} mm is not on the arm; allowed: below its length, {design.length:g} mm"
        yield conflict(place, ("identification", "d"))
    if values.get("draft") and values.get("law") == "five":
        yield conflict("five has no draft, which is of the arm's own law; leave one of them out", ("law",), ("draft",))
    if effects and design and values.get("draft") and (reason := effects.why_no_arm_law(design)):
        yield conflict(f"is not possible: {reason}", ("draft",))
    if effects and design and values.get("law") == "cell" and (reason := effects.why_no_arm_law(design)):
        yield conflict(f"cell is not possible: {reason}", ("law",))
    if effects and effects.symmetry.on and effects.gravity.breaks_symmetry:
        sentence = "gravity acts across the plane of symmetry; write symmetry: auto or give its z component 0 m/s^2"
        yield conflict(sentence, ("effects", "symmetry"), ("effects", "gravity"))
    if effects and effects.gravity.on:
        solids: dict[Key, Any] = {("material",): values.get("material")}
        solids |= {("materials", name): solid for name, solid in values.get("materials", {}).items()}
        for key in (key for key, solid in solids.items() if solid and solid.density_tonne_mm3 is None):
            yield conflict("is missing, and gravity needs it; for example 1130 kg/m^3", (*key, "density"))


@section(frozen=True)
class Config(Section):
    """A design and what is to be computed for it, checked. The order of the fields is that in which they are read."""

    name: kinds.Name = Field(description="name of the design")
    design: Annotated[Design, Kind("a section", "{family: pneunet, ...}", complete=read_design)] = Field(
        alias="geometry", description="`family` of the body and its [dimensions](#geometry)"
    )
    #: of the body, but for the regions below
    material: Annotated[Material, _MATERIAL] = Field(description="`law` of the material and its [constants](#material)")
    materials: Annotated[dict[str, Annotated[Material, _MATERIAL]], _REGIONS] = Field(
        default_factory=dict,
        description="[regions](#a-base-of-another-material) of another material than the rest of the body",
    )
    pressures_kPa: kinds.Pressures = Field(
        default=(5.0, 17.0, 31.0, 45.0),
        description="pressures of the run; of two cavities also [pairs](how_to/two_pressures.md), "
        "of three chambers [rows](how_to/three_chambers.md)",
    )
    #: II, III, and I where it is solved
    experiments: Annotated[tuple[str, ...], Kind("`[I, II, III]` or `[II, III]`", "[II, III]", read=_experiments)] = (
        Field(
            default=("I", "II", "III"), description="II and III give the parameters; I, the free body, may be left out"
        )
    )
    end: Annotated[End, Kind("", "{}", complete=read_end, keys=GivenEnd)] = End()
    identification: IdentificationSettings = IdentificationSettings()
    validation: Annotated[Validation, Kind("", "{}", complete=read_validation, keys=GivenValidation)] = Field(
        default_factory=dict, validate_default=True
    )
    law: Annotated[Laws, kinds.one_of(LAW_CHOICES)] = Field(
        default="both",
        description="of the rod, not of the material: five parameters, the [arm's own law](cell.md) or both",
        examples=["five"],
    )
    law_in_space: kinds.YesNo = Field(
        default=False,
        description="whether the arm's own law also has [rigidities out of the plane](cell.md#out-of-the-plane)",
    )
    law_by_cavity: kinds.YesNo = Field(
        default=False,
        description="whether the arm's own law has derivatives by the pressure of the cavity with the smaller "
        "fraction; set for [pairs](how_to/two_pressures.md) of pressures",
    )
    newton: Newton = Newton()
    #: relative error of kappa_0, rigidity and moment of the arm's own law; None: on the mesh of the arm alone
    accuracy: kinds.Percentage = Field(
        default=0.01,
        description="error that the mesh may make of the [arm's own law](cell.md#error-of-the-mesh), or `off`; "
        "also `--accuracy`",
    )
    draft: kinds.YesNo = Field(
        default=False,
        description="whether the arm's own law alone is made, on one mesh whose error is [not known]"
        "(performance.md#a-draft); also `--draft`",
    )
    effects: Annotated[Effects, Kind("", "{}", complete=_with_all_cavities, keys=Effects)] = Field(
        default_factory=dict, validate_default=True
    )
    mesh: Annotated[MeshSettings, Kind("", "{}", complete=read_mesh, keys=GivenMesh)] = Field(
        default_factory=dict, validate_default=True
    )
    tolerances: Annotated[
        Tolerances,
        Kind(
            "a section: a key of the configuration with a length, stress or part of it",
            "{pressure: 2 %}",
            complete=read_tolerances,
        ),
    ] = Field(
        default_factory=dict,
        validate_default=True,
        description="of dimensions, `material.stiffness` and `pressure`, for the [budget](how_to/budget.md); "
        "`process: cast` or `printed` for those that are not given",
    )
    #: the file it was read from, for messages; it has no key
    source: Annotated[str, Kind("", "", complete=_check_together)] = Field(default="", alias="", validate_default=True)

    def record(self) -> JsonObject:
        """Everything that decides the results, ready for JSON, with the keys of the YAML and their units."""
        values = to_jsonable_python(self, by_alias=False)
        del values["source"], values["mesh"]["chosen"]
        values["design"] = {"family": self.family, **_dimensions(self.design)}
        values["material"] = self.material.record()
        values["tolerances"] = None if self.tolerances == Tolerances() else values["tolerances"]
        values["materials"] = {name: material.record() for name, material in self.materials.items()}
        names = {"design": "geometry"}
        left_out = ("materials", "tolerances", "law_in_space", "law_by_cavity", "draft")
        return {names.get(name, name): value for name, value in values.items() if value or name not in left_out}

    @property
    def family(self) -> str:
        """The family of the body, as it is written."""
        return OWN if self.design.is_from_file else self.design.family

    def unmeshable(self, failure: DesignError | MeshError) -> InputError:
        """The refusal of a body that cannot be meshed, with the keys of the configuration."""
        if isinstance(failure, MeshError):
            return InputError(f"{self.source}: {failure}")
        dimensions, sentences = vars(self.design), []
        for error in (failure, *failure.others):
            keys = ", ".join(dotted(design_key(key, dimensions)) for key in error.keys)
            sentences.append(f"{self.source}: {keys}: {error.sentence}")
        return InputError(*sentences)

    @property
    def is_law_alone(self) -> bool:
        """Whether nothing but the arm's own law is made."""
        return self.draft or self.law == "cell"

    @property
    def hash(self) -> str:
        """sha256 of the record: equal for equal values, however they were written, and for a draft and its full run."""
        record = {key: value for key, value in self.record().items() if key != "draft"}
        canonical = json.dumps(record, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(canonical.encode()).hexdigest()

    @property
    def mass_tonne(self) -> float | None:
        """Mass of the solid; None without a density, also of one region."""
        volumes = {name: self.design.region_volumes[name] for name in self.materials}
        parts = [(self.material, self.design.solid_volume - sum(volumes.values()))]
        parts += [(self.materials[name], volume) for name, volume in volumes.items()]
        masses = [None if (d := solid.density_tonne_mm3) is None else d * volume for solid, volume in parts]
        known = [mass for mass in masses if mass is not None]
        return sum(known) if len(known) == len(masses) else None

    @property
    def poisson_ratio(self) -> float:
        """The largest one of all materials at small strain, which decides about locking."""
        return max(material.built().poisson_ratio for material in (self.material, *self.materials.values()))

    def with_effect(self, effect: str, state: State) -> "Config":
        """This configuration with one effect switched; the element follows incompressibility."""
        switched = replace(getattr(self.effects, effect), state=state)
        config = replace(self, effects=replace(self.effects, **{effect: switched}))
        if effect != "incompressibility":
            return config
        element = automatic_element(self.poisson_ratio, switched.decided)
        chosen = {key: why for key, why in self.mesh.chosen.items() if key != "formulation"}
        return replace(config, mesh=replace(self.mesh, formulation=element.name, chosen=chosen))

    def with_mesh_size(self, size_mm: float) -> "Config":
        """This configuration with another mesh size."""
        return replace(self, mesh=replace(self.mesh, size_mm=size_mm))


def _dimensions(design: Any) -> dict[str, Json]:
    """The keys of a design as in the YAML; a file stands there with the digest of what is in it."""
    values: dict[str, Json] = {
        name: value
        for name, value in to_jsonable_python(design).items()
        if value != [] and (name, value) != ("parts", {})
    }
    if isinstance(planes := getattr(design, "cell", None), CellPlanes):
        values["cell"] = {"from": planes.start, "to": planes.stop}
    return values | ({"file": Path(design.file).name, "sha256": design.digest} if design.is_from_file else {})
