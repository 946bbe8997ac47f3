"""A configuration read from a YAML file with units, checked.

Every refusal is one sentence: `FILE: key: what is wrong; what is allowed`.
"""

from collections.abc import Sequence
from dataclasses import fields
from itertools import pairwise
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

import fem.materials
from fem.elements import ELEMENTS, automatic_element
from fem.materials import LAWS
from geometry import FAMILIES, CadFile, Design, DesignError, MeshFile
from geometry.design import check_size
from pipeline.config.config import (
    AUTO,
    Auto,
    CavityPressure,
    Config,
    Effects,
    End,
    Material,
    MeshSettings,
    Newton,
    PressureEffect,
    Validation,
)
from pipeline.config.document import Document, read_document
from pipeline.config.schema import OWN, checked
from pipeline.errors import InputError

#: size over the smallest side of the body with which the number of elements is checked where the size is AUTO
COARSE = 0.4
#: units at the end of the names of values; the keys of the YAML have none
UNITS = ("_mm_s2", "_tonne_mm3", "_mm", "_kPa", "_MPa", "_N")

Section = TypeVar("Section")


def load_config(path: Path | str, overrides: Sequence[str] = ()) -> Config:
    """The configuration in the YAML file `path` with `overrides` ("mesh.size=4 mm") applied.

    Raises InputError with one sentence that names the file (or the override), the key and what is allowed.
    """
    document = read_document(Path(path), overrides)
    content, family, law = checked(document)
    design, size = _design(document, content, family)
    constants = {name: getattr(content.material, name) for name in LAWS[law].constants()}
    material = Material(law, constants, content.material.density)
    _check_together(document, content)
    state = content.effects.incompressibility.state
    return Config(
        name=content.name,
        family=family,
        design=design,
        material=material,
        pressures_kPa=content.pressures,
        end=_section(End, content.end),
        added_pressures=content.added_pressures,
        validation=_validation(document, content, design.length),
        law=content.law,
        mesh=_mesh(content, size, state, _poisson_ratio(document, material)),
        newton=_section(Newton, content.newton),
        accuracy=content.accuracy,
        effects=_effects(document, design, content.effects),
        source=str(document.path),
    )


def _section(kind: type[Section], content: Any) -> Section:
    """A section of the configuration from that of the document: fields have the names of the keys and a unit."""
    return kind(**{field.name: getattr(content, _without_unit(field.name)) for field in fields(kind)})  # type: ignore[arg-type]


def _without_unit(name: str) -> str:
    return next((name.removesuffix(unit) for unit in UNITS if name.endswith(unit)), name)


def _effects(document: Document, design: Design, content: Any) -> Effects:
    pressure = PressureEffect(content.pressure.state, _cavities(document, design, content.pressure))
    others = {name: kind for name, kind in get_type_hints(Effects).items() if name != "pressure"}
    return Effects(pressure, **{name: _section(kind, getattr(content, name)) for name, kind in others.items()})


def _design(document: Document, content: Any, family: str) -> tuple[Design, float | Auto]:
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
            return design, design.fixed_body.mesh.quality.longest_edge
        if content.mesh.size is None and content.accuracy is None:
            raise document.wrong(
                ("mesh", "size"), "is auto, but no accuracy is requested; give --accuracy 2%, or a size such as 4 mm"
            )
        size = COARSE * min(design.extent) if content.mesh.size is None else content.mesh.size
        check_size(size, design.extent, design.solid_volume / 2)
        return design, AUTO if content.mesh.size is None else size
    except DesignError as refused:
        parts = [tuple(key.split(".")) for key in refused.keys]
        keys = tuple(("geometry", *key) if key[0] in values else key for key in parts)
        raise document.wrong_together(keys, refused.sentence) from None


#: how far the end of the load that is part of every run lies from that of experiment III, over the length
ELSEWHERE = 0.1


def _default_validation(content: Any, length: float) -> Validation:
    """One load that nothing is fitted to: in the middle of the widest interval of pressures, the end elsewhere."""
    intervals = list(pairwise(content.pressures))
    low, high = max(intervals, key=lambda interval: interval[1] - interval[0], default=content.pressures * 2)
    pressure, end = (float(f"{value:.12g}") for value in (0.5 * (low + high), content.end.y + ELSEWHERE * length))
    return Validation((pressure,), (end,), (), with_experiments=False)


def _validation(document: Document, content: Any, length: float) -> Validation:
    """The loads not used for the fit; where there are some and no pressures, all pressures of the run.

    Where none are given and the validation is not switched off, the default one; length: of the arm, mm.
    """
    loads, of_run = content.validation, content.pressures
    if not (loads.pressures or loads.end_y or loads.forces):
        return Validation((), (), ()) if loads.state == "off" else _default_validation(content, length)
    if content.end.y in loads.end_y:
        raise document.wrong(
            ("validation", "end_y"), f"{content.end.y:g} mm is what the numbers are identified with; give others"
        )
    for pressure in loads.pressures or ():
        if not of_run[0] <= pressure <= of_run[-1]:
            limits = f"{of_run[0]:g} to {of_run[-1]:g} kPa"
            raise document.wrong(
                ("validation", "pressures"),
                f"{pressure:g} kPa lies outside the pressures of the run; allowed: {limits}",
            )
    other_loads = bool(loads.end_y or loads.forces)
    if loads.pressures and not other_loads and set(loads.pressures) <= set(of_run):
        raise document.wrong(
            ("validation", "pressures"), "are all pressures of the run; give one between them, or end_y, or forces"
        )
    return Validation(loads.pressures or (of_run if other_loads else ()), loads.end_y, loads.forces)


def _cavities(document: Document, design: Design, pressure: Any) -> dict[str, CavityPressure]:
    """The pressure of every cavity; where none is named, the first one follows the pressure of the run."""
    for name in pressure.cavities:
        if name not in design.cavities:
            raise document.wrong(
                ("effects", "pressure", "cavities", name), f"is no cavity; this body has {', '.join(design.cavities)}"
            )
    given = pressure.cavities or {design.cavities[0]: CavityPressure(1.0, 0.0)}
    return {name: given.get(name, CavityPressure(0.0, 0.0)) for name in design.cavities}


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


def _mesh(content: Any, size: float | Auto, state: str, nu: float) -> MeshSettings:
    """The mesh with its element; a ready mesh has fewer keys, the others keep their defaults."""
    keys = {field.name: _without_unit(field.name) for field in fields(MeshSettings)}
    given = {name: getattr(content.mesh, key) for name, key in keys.items() if hasattr(content.mesh, key)}
    formulation = _formulation(content.mesh.formulation, state, nu)
    return MeshSettings(**{**given, "size_mm": size, "formulation": formulation})


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
