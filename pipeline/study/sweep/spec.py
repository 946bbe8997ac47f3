"""The file of a sweep: a base configuration, what is run on every point, and the axes, which give the points."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from json import dumps
from pathlib import Path
from typing import Annotated, Any

from pipeline.config import kinds, load
from pipeline.config.document import Document, read_document
from pipeline.config.section import (
    Error,
    Field,
    Kind,
    Section,
    in_sentences,
    raise_all,
    read_each,
    read_keys,
    section,
    wrong,
)
from pipeline.simulate.simulate import why_not_free
from pipeline.study.sweep.axes import Axis, axis_of, check_value, combined, latin_hypercube
from pipeline.study.sweep.points import REFUSED, Point, PointResult, Setting
from pipeline.values.errors import ConflictError, InputError, quoted
from pipeline.values.json_values import JsonObject, Written
from pipeline.values.reasons import render

#: what may be run on a point: the whole run, the arm's own law, or some of the experiments
WHOLE, CELL = "whole", "cell"
#: II and III with the numbers that effects are compared by; it stands in no file
VARIANT = "effects"
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


@section(frozen=True, kw_only=True)
class _Hypercube(Section):
    points: Annotated[kinds.Count, Kind("above 0", "60", test=kinds.above_zero)]
    seed: kinds.CountFromZero = Field(examples=["1"])
    axes: Annotated[dict[str, Written], kinds.not_empty("{geometry.wall: {from: 0.8 mm, to: 1.6 mm}}")]


@section(frozen=True)
class _File(Section):
    name: kinds.Name
    base: kinds.Base
    run: Annotated[Run, Kind("", WHOLE, read=_run)] = (WHOLE,)
    set: dict[str, Written] = Field(default_factory=dict)
    axes: Annotated[tuple[dict[str, Written], ...], kinds.list_of("", "[geometry.wall: [1 mm, 1.5 mm]]")] = ()
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

    def as_draft(self) -> "Sweep":
        """This sweep with a draft of the arm's own law at every point."""
        return replace(self, run=(CELL,), common={**self.common, "draft": True})

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

    Raises InputError with a sentence that names the file, the key and what is allowed, for each mistake.
    """
    document = read_document(path)
    with in_sentences(document):
        content = read_keys(_File, document.content, document)
        axes = [*read_each(dict(enumerate(content.axes)), lambda _, entry: axis_of(entry), ("axes",)).values()]
        if (cube := content.latin_hypercube) is not None:
            drawn = {"latin_hypercube": cube}
            axes += read_each(drawn, lambda _, cube: latin_hypercube(cube.points, cube.seed, cube.axes)).values()
        read_each(content.set, lambda _, value: check_value(value), ("set",))
        raise_all(_conflicts(content.set, axes))
        settings = read_each({"axes": axes}, lambda _, axes: tuple(combined(axes)))
    base = content.base
    return Sweep(path, content.name, base.path, base, content.run, content.set, tuple(axes), settings["axes"])


def _conflicts(common: Setting, axes: Sequence[Axis]) -> Iterator[Error]:
    """Refuses a key that is given twice, or holds another one, which it would replace."""
    if not axes:
        yield wrong("holds no points; for example 'axes: [geometry.wall: [1 mm, 1.5 mm]]'", ("axes",))
    on_axes = [key for axis in axes for key in axis.keys]
    keys = [*common, *on_axes]
    for key in sorted(common.keys() & on_axes):
        yield wrong("is on an axis too; leave it out of one of them", ("set", key))
    for outer, inner in product(keys, keys):
        if inner.startswith(f"{outer}."):
            sentence = f"{outer} and {inner} are both given, and the first replaces the second; give one of them"
            yield wrong(sentence, ("axes",))


def document_of(sweep: Sweep, setting: Setting) -> Document:
    """The base configuration with the values of one point put in. Raises InputError where a key cannot be put in."""
    values = [(key, dumps(value)) for key, value in {**sweep.common, **setting}.items()]
    return sweep.base_document.with_values(values, lambda key: f"{sweep.source}: {key}")


def points_of(sweep: Sweep, out: Path) -> list[Point | PointResult]:
    """All points in the order of the axes, with the results of those whose configuration is refused; out: the folder.

    Raises InputError where a value of an axis is refused at every point that has it, as an unknown key or a wrong unit
    is, and where no point at all is left.
    """
    unchecked: dict[int, InputError] = {}
    points: list[Point | PointResult] = []
    for number, setting in enumerate(sweep.settings, start=1):
        try:
            document = document_of(sweep, setting)
            try:
                config, _ = load.for_command(CELL if sweep.run == (CELL,) else "run", document, load.checked)
            except InputError as failure:
                if not isinstance(failure, ConflictError):
                    unchecked[number] = failure
                raise
            if sweep.run == ("I",) and (reason := why_not_free(config)):
                raise InputError(f"{render(reason)}, and run names no other one")
            points.append(Point(number, setting, config, sweep.run, out.resolve()))
        except InputError as failure:
            points.append(PointResult(REFUSED, "; ".join(failure.sentences), number=number, values=setting))
    _refuse_axes(sweep, unchecked)
    refused = [point for point in points if isinstance(point, PointResult)]
    if len(refused) == len(points):
        raise InputError(f"every point of {sweep.source} is refused; the first one: {refused[0].reason}")
    return points


def _refuse_axes(sweep: Sweep, unchecked: dict[int, InputError]) -> None:
    """Raise the refusal of a value of an axis that no point can have."""
    for value in (value for axis in sweep.axes for value in axis.settings if unchecked):
        having = [
            number
            for number, setting in enumerate(sweep.settings, start=1)
            if all(setting[key] == entry for key, entry in value.items())
        ]
        if having and all(number in unchecked for number in having):
            raise unchecked[having[0]]
