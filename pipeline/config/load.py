"""A configuration read from a YAML file with units, checked.

A refusal is one sentence for each thing that is wrong: `FILE: key: what is wrong; what is allowed`.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

from fem.elements import ELEMENTS
from geometry import FAMILIES, Design, DesignError
from pipeline.config.arm_law import why_no_arm_law
from pipeline.config.automatic_mesh import COARSER, COARSEST, GivenMesh, chosen_mesh
from pipeline.config.config import (
    AUTO,
    Config,
    End,
    IdentificationSettings,
    Material,
    MeshSettings,
    Newton,
    Validation,
    middle_of_widest,
)
from pipeline.config.document import Document, read_document
from pipeline.config.effects import CavityPressure, Effects, PressureEffect
from pipeline.config.schema import OWN, checked, own_design
from pipeline.config.solid import check_stiffness, solids
from pipeline.errors import InputError
from rod.same_pressure import as_known

#: units at the end of the names of values; the keys of the YAML have none
UNITS = ("_mm_s2", "_tonne_mm3", "_mm", "_kPa", "_MPa", "_N")

Section = TypeVar("Section")
Result = TypeVar("Result")


def load_config(path: Path | str, overrides: Sequence[str] = ()) -> Config:
    """The configuration in the YAML file `path` with `overrides` ("mesh.size=4 mm") applied.

    Raises InputError with a sentence for each thing that is wrong, which names the file (or the override), the key and
    what is allowed.
    """
    return config_of(read_document(Path(path), overrides))


def config_of(document: Document) -> Config:
    """The configuration that a document describes. Raises InputError as `load_config`."""
    return config_of_checked(document, checked(document))


def config_of_checked(document: Document, parts: tuple[Any, str, dict[str, str]]) -> Config:
    """The same from what `checked` returns of the document."""
    content, family, laws = parts
    refusals: list[str] = []
    materials = _attempt(refusals, solids, document, content, laws)
    if materials is not None:
        _attempt(refusals, check_stiffness, document, materials[""], content.pressures)
    _attempt(refusals, _check_together, document, content)
    design = _attempt(refusals, _design, document, content, family, [name for name in laws if name])
    if design is None or materials is None:
        raise InputError(*refusals)
    mesh = _attempt(refusals, _mesh, document, content, design, materials)
    effects = _attempt(refusals, _effects, document, design, content.effects)
    validation = _attempt(refusals, _validation, document, content, design.length)
    if effects is not None:
        _attempt(refusals, _check_law, document, content.law, design, effects)
    _attempt(refusals, _check_identification, document, content.identification, design.length)
    if mesh is None or effects is None or validation is None or refusals:
        raise InputError(*refusals)
    return Config(
        name=content.name,
        family=family,
        design=design,
        material=materials.pop(""),
        materials=materials,
        pressures_kPa=content.pressures,
        experiments=content.experiments,
        end=_end(content.end),
        identification=_identification(content.identification),
        added_pressures=content.added_pressures,
        validation=validation,
        law=content.law,
        mesh=mesh,
        newton=_section(Newton, content.newton),
        accuracy=content.accuracy,
        effects=effects,
        source=str(document.path),
    )


def _check_law(document: Document, law: str, design: Design, effects: Effects) -> None:
    """Refuse the arm's own law alone for an arm that has none."""
    if law == "cell" and (reason := why_no_arm_law(design, effects)):
        raise document.wrong(("law",), f"cell is not possible: {reason}")


def _attempt(refusals: list[str], check: Callable[..., Result], *values: Any) -> Result | None:
    """What a check returns; where it refuses, None and its sentences at the end of `refusals`."""
    try:
        return check(*values)
    except InputError as failure:
        refusals += failure.sentences
        return None


def _section(kind: type[Section], content: Any) -> Section:
    """A section of the configuration from that of the document: fields have the names of the keys and a unit."""
    return kind(**{field.name: getattr(content, _without_unit(field.name)) for field in fields(kind)})  # type: ignore[arg-type]


def _without_unit(name: str) -> str:
    return next((name.removesuffix(unit) for unit in UNITS if name.endswith(unit)), name)


def _end(content: Any) -> End:
    """What the end has in III along both axes."""
    return End(content.x.displacement_mm, content.y.displacement_mm, (content.x.force_N, content.y.force_N))


def _identification(content: Any) -> IdentificationSettings:
    return IdentificationSettings(content.d, content.weight, content.weight_of or "")


def _effects(document: Document, design: Design, content: Any) -> Effects:
    pressure = PressureEffect(content.pressure.state, _cavities(document, design, content.pressure))
    others = {name: kind for name, kind in get_type_hints(Effects).items() if name != "pressure"}
    return Effects(pressure, **{name: _section(kind, getattr(content, name)) for name, kind in others.items()})


def _design(document: Document, content: Any, family: str, regions: Sequence[str]) -> Design:
    values = {key: value for key, value in content.geometry if key != "family"}
    try:
        if family == OWN:
            values["file"] = str(document.path.parent / values["file"])
            design: Design = own_design(values["file"])(**values)
        else:
            _check_lists(document, FAMILIES[family].lists)
            design = FAMILIES[family](**values)
        design = design.with_regions(regions)
    except DesignError as refused:
        raise _refused(document, refused, values) from None
    if not design.is_resizable and content.accuracy is not None:
        raise document.wrong(("accuracy",), "a ready mesh cannot be made finer; leave it out, or give a drawing")
    return design


def _check_lists(document: Document, lists: Mapping[str, str]) -> None:
    """Refuse a dimension beside the list that is given instead of it; an override with the list replaces it."""
    for several, usual in lists.items():
        keys = (("geometry", usual), ("geometry", several))
        if {several, usual} <= document.content["geometry"].keys() and (
            keys[0] in document.overridden or keys[1] not in document.overridden
        ):
            raise document.wrong_together(keys, f"{usual} and {several} exclude each other; give one of them")


def _refused(document: Document, refused: DesignError, dimensions: Iterable[str] = ()) -> InputError:
    """A sentence for each thing that is wrong about a design."""
    sentences: list[str] = []
    for error in (refused, *refused.others):
        parts = [tuple(key.split(".")) for key in error.keys]
        keys = tuple(("geometry", *key) if key[0] in dimensions else key for key in parts)
        sentences += document.wrong_together(keys, error.sentence).sentences
    return InputError(*sentences)


#: how far the end of the load that is part of every run lies from that of experiment III, over the length
ELSEWHERE = 0.1


def _check_identification(document: Document, content: Any, length: float) -> None:
    """Refuse a break off the arm, and the name of a weight that is not there."""
    if content.d is not None and content.d >= length:
        raise document.wrong(
            ("identification", "d"), f"{content.d:g} mm is not on the arm; allowed: below its length, {length:g} mm"
        )
    if content.weight_of is not None and content.weight is None:
        raise document.wrong(("identification", "weight_of"), "names a weight that is missing; give weight as well")


def _default_validation(content: Any, length: float) -> Validation:
    """One load that nothing is fitted to: in the middle of the widest interval of pressures, the end elsewhere.

    Of an arm whose end III holds down it is on the other side (`Validation.beyond`).
    """
    at_rest = content.end.y.displacement_mm or 0.0
    end = float(f"{at_rest + ELSEWHERE * length:.12g}")
    return Validation((middle_of_widest(content.pressures),), (end,), (), with_experiments=False)


def _validation(document: Document, content: Any, length: float) -> Validation:
    """The loads not used for the fit; where there are some and no pressures, all pressures of the run.

    None where the validation is switched off; where none are given the default one. length: of the arm, mm.
    """
    loads, of_run = content.validation, content.pressures
    if loads.state == "off":
        return Validation((), (), ())
    if not (loads.pressures or loads.end_y or loads.forces):
        return _default_validation(content, length)
    end = _end(content.end)
    if end == End(y_mm=end.y_mm) and end.y_mm in loads.end_y:
        raise document.wrong(
            ("validation", "end_y"), f"{end.y_mm:g} mm is what the numbers are identified with; give others"
        )
    if end.force_N in loads.forces and end == End(None, None, end.force_N):
        x, y = end.force_N
        raise document.wrong(
            ("validation", "forces"), f"[{x:g} N, {y:g} N] is what the numbers are identified with; give others"
        )
    if (0.0, 0.0) in loads.forces:
        raise document.wrong(
            ("validation", "forces"), "[0 N, 0 N] is experiment II, with which the numbers are identified; give others"
        )
    pressures = tuple(as_known(of_run, pressure) for pressure in loads.pressures or ())
    for pressure in pressures:
        if not of_run[0] <= pressure <= of_run[-1]:
            limits = f"{of_run[0]:g} to {of_run[-1]:g} kPa"
            raise document.wrong(
                ("validation", "pressures"),
                f"{pressure:g} kPa lies outside the pressures of the run; allowed: {limits}",
            )
    other_loads = bool(loads.end_y or loads.forces)
    if pressures and not other_loads and set(pressures) <= set(of_run):
        raise document.wrong(
            ("validation", "pressures"), "are all pressures of the run; give one between them, or end_y, or forces"
        )
    return Validation(pressures or (of_run if other_loads else ()), loads.end_y, loads.forces)


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


def _mesh(document: Document, content: Any, design: Design, materials: Mapping[str, Material]) -> MeshSettings:
    """The mesh as given, and as the program chooses it where it is not; AUTO where an accuracy decides the size."""
    keys, accuracy = content.mesh, content.accuracy is not None
    if not design.is_resizable:
        given = GivenMesh(design.given_element_size, keys.formulation, None)
        accuracy, coarser = False, "off"
    else:
        given, coarser = GivenMesh(keys.size, keys.formulation, getattr(keys, "grading", None)), keys.coarser
    state = content.effects.incompressibility.state
    nu = max(material.built().poisson_ratio for material in materials.values())
    try:
        chosen = chosen_mesh(design, materials[""].law, nu, None if state == "auto" else state == "on", given)
        planned = accuracy and given.size_mm is None
        size = COARSEST * min(design.extent) if planned else chosen.size_mm
        if design.is_resizable:
            design.check_size(size)
    except DesignError as refused:
        raise _refused(document, refused) from None
    usual = COARSER if coarser == "auto" and not accuracy else None
    reasons = {key: why for key, why in chosen.reasons.items() if key != "size" or not planned}
    if coarser == "auto" and accuracy:
        reasons["coarser"] = "a requested accuracy has estimates of its own"
    return MeshSettings(
        size_mm=AUTO if planned else size,
        formulation=chosen.formulation,
        coarser=usual if isinstance(coarser, str) else coarser,
        grading=chosen.grading,
        chosen=reasons,
    )
