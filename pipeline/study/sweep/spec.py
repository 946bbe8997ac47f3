"""The file of a sweep: a base configuration, what is run on every point, and the axes."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from json import dumps
from pathlib import Path
from typing import Annotated, Any

from pipeline.config.document import Document, read_document
from pipeline.config.kinds import Count, CountFromZero, Name, Text, list_of
from pipeline.config.section import Field, Kind, Section, read, section
from pipeline.study.sweep.axes import Axis, Setting, axis_of, check_value, combined, latin_hypercube
from pipeline.values.errors import InputError, quoted
from pipeline.values.json_values import JsonObject

#: what may be run on a point: the whole run, the arm's own law, or some of the experiments
WHOLE, CELL = "whole", "cell"
EXPERIMENTS = ("I", "II", "III")
#: one of the two words, or names of experiments
Run = tuple[str, ...]


def _run(value: Any) -> Run:
    names = tuple(value) if isinstance(value, list) and value else (value,)
    is_known = all(isinstance(name, str) for name in names)
    if is_known and (
        names in ((WHOLE,), (CELL,)) or (set(names) <= set(EXPERIMENTS) and len(set(names)) == len(names))
    ):
        return names
    raise ValueError(f"{quoted(value)} is not allowed; allowed: whole, cell, I, II, III, or a list such as [II, III]")


@section(frozen=True)
class _Hypercube(Section):
    points: Count = Field(examples=["60"])
    seed: CountFromZero = Field(examples=["1"])
    axes: dict[str, Any] = Field(examples=["{geometry.wall: {from: 0.8 mm, to: 1.6 mm}}"])


@section(frozen=True)
class _File(Section):
    name: Name
    base: Text = Field(examples=["pneunet_coarse.yaml"])
    run: Annotated[Run, Kind("", WHOLE, read=_run)] = (WHOLE,)
    set: dict[str, Any] = Field(default_factory=dict)
    axes: Annotated[tuple[dict[str, Any], ...], list_of("", "[geometry.wall: [1 mm, 1.5 mm]]")] = ()
    latin_hypercube: _Hypercube | None = None


@dataclass(frozen=True)
class Sweep:
    """What a file of a sweep says."""

    source: Path  #: the file
    name: str
    base: Path  #: the configuration that every point begins with
    base_document: Document  #: what it says
    run: Run
    common: Setting  #: values that replace those of the base at every point
    axes: tuple[Axis, ...]
    settings: tuple[Setting, ...]  #: the values of the axes at every point

    @property
    def identity(self) -> JsonObject:
        """What its results belong to, the axes apart. Equal keys and values of the base have equal hashes."""
        base = dumps(self.base_document.content, sort_keys=True, default=str)
        base_hash = hashlib.sha256(base.encode()).hexdigest()
        return {"name": self.name, "base": str(self.base), "base_hash": base_hash, "run": self.run, "set": self.common}

    @property
    def keys(self) -> tuple[str, ...]:
        """The dotted keys of the axes."""
        return tuple(key for axis in self.axes for key in axis.keys)


def read_sweep(path: Path) -> Sweep:
    """The sweep in a YAML file.

    Raises InputError with one sentence that names the file, the key and what is allowed.
    """
    document = read_document(path)
    content = read(_File, document)
    axes = tuple(_axes(document, content))
    if not axes:
        raise document.wrong(("axes",), "holds no points; for example 'axes: [geometry.wall: [1 mm, 1.5 mm]]'")
    common = dict(content.set)
    for key, value in common.items():
        try:
            check_value(value)
        except ValueError as refused:
            raise document.wrong(("set", key), str(refused)) from None
    doubled = sorted(set(common) & {key for axis in axes for key in axis.keys})
    if doubled:
        raise document.wrong(("set", doubled[0]), "is on an axis too; leave it out of one of them")
    _refuse_nested(document, [*common, *(key for axis in axes for key in axis.keys)])
    try:
        settings = combined(axes)
    except ValueError as refused:
        raise document.wrong(("axes",), str(refused)) from None
    base = path.parent / content.base
    return Sweep(path, content.name, base, _base(document, base), content.run, common, axes, tuple(settings))


def _base(document: Document, path: Path) -> Document:
    """The base configuration. Raises InputError, which names the key `base`."""
    try:
        return read_document(path)
    except InputError as failure:
        raise document.wrong(("base",), str(failure)) from None


def _refuse_nested(document: Document, keys: Sequence[str]) -> None:
    """Raise InputError where a key holds another one, which it would replace."""
    for outer in keys:
        for inner in keys:
            if inner.startswith(f"{outer}."):
                sentence = f"{outer} and {inner} are both given, and the first replaces the second"
                raise document.wrong(("axes",), f"{sentence}; give one of them")


def _axes(document: Document, content: _File) -> list[Axis]:
    axes: list[Axis] = []
    for number, entry in enumerate(content.axes):
        try:
            axes.append(axis_of(entry))
        except ValueError as refused:
            raise document.wrong(("axes", number), str(refused)) from None
    if cube := content.latin_hypercube:
        if cube.points < 1 or not cube.axes:
            raise document.wrong(("latin_hypercube",), "holds no points; give some, and at least one key in its axes")
        try:
            axes.append(latin_hypercube(cube.points, cube.seed, cube.axes))
        except ValueError as refused:
            raise document.wrong(("latin_hypercube", "axes"), str(refused)) from None
    return axes


def document_of(sweep: Sweep, setting: Setting) -> Document:
    """The base configuration with the values of one point put in. Raises InputError where a key cannot be put in."""
    values = [(key, dumps(value)) for key, value in {**sweep.common, **setting}.items()]
    return sweep.base_document.with_values(values, lambda key: f"{sweep.source}: {key}")
