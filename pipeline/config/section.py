"""Sections of a configuration: frozen values that are read from a document, and the words in which it is refused.

A field is a key of the section, without the unit at the end of its name: `size_mm` is written as `size: 4 mm`. A value
that Python code gives is one inside, in mm, N, MPa and kPa; only what stands in a document is converted and checked.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Annotated, Any, ClassVar, Self, TypeVar, get_args

from pydantic import (
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    model_validator,
)
from pydantic.dataclasses import dataclass as section
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, PydanticCustomError, core_schema, to_jsonable_python
from pydantic_core import InitErrorDetails as Error

from pipeline.config.document import Document, Key
from pipeline.config.not_there import NOT_THERE
from pipeline.values.errors import ConflictError, InputError, quoted

__all__ = ["Error", "Field", "FieldInfo", "TypeAdapter", "section", "to_jsonable_python"]

#: units at the end of the names of fields; keys have none
UNITS = ("_mm_s2", "_tonne_mm3", "_mm", "_kPa", "_MPa", "_N", "_Hz", "_s", "_deg")
#: pydantic's names for a key that a section does not have
UNKNOWN = ("unexpected_keyword_argument", "invalid_key")

S = TypeVar("S")
K = TypeVar("K", bound=str | int)
V = TypeVar("V")
T = TypeVar("T")


def key_of(field: str) -> str:
    """The key with which a field is written."""
    return next((field.removesuffix(unit) for unit in UNITS if field.endswith(unit)), field)


CONFIG = ConfigDict(
    extra="forbid",
    arbitrary_types_allowed=True,
    alias_generator=key_of,
    validate_by_name=True,
    validate_by_alias=True,
)


@dataclass(frozen=True)
class ReadContext:
    """What stands beside a value: the fields of its section that were read before it, and the whole document."""

    fields: Mapping[str, Any]  #: without refused ones
    document: Document

    def known(self, *names: str) -> list[Any]:
        """The values of these fields; where one of them is refused, an error without words is raised."""
        if not set(names) <= self.fields.keys():
            raise_all([wrong("")])
        return [self.fields[name] for name in names]

    def read(self, keys: type[S], value: Any) -> S:
        """The section that is written in `value`, as `read_keys` reads it."""
        return read_keys(keys, value, self.document)


@dataclass(frozen=True)
class Kind:
    """How a kind of value is written, for sentences and the reference, and how the value inside is made from it."""

    allowed: str  #: Markdown
    example: str
    unit: str = ""
    read: Callable[[Any], Any] = lambda value: value  #: of what is written; raises ValueError with the complaint
    test: Callable[[Any], bool] | None = None  #: whether a value is allowed; may raise ValueError with the complaint
    #: instead of `read`, of what is written and what stands beside it, for what follows from several values
    complete: Callable[[Any, ReadContext], Any] | None = None
    keys: "type[Section] | None" = None  #: as which it is written; None for a value, or keys that depend on one of them

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        checked = core_schema.with_info_after_validator_function(self._check, handler(source))
        return core_schema.with_info_before_validator_function(self._read, checked)

    def _read(self, value: Any, info: ValidationInfo) -> Any:
        if info.context is None:
            return value
        written = value if self.keys is None else read_keys(self.keys, value, info.context)
        return self.complete(written, ReadContext(info.data, info.context)) if self.complete else self.read(written)

    def _check(self, value: Any, info: ValidationInfo) -> Any:
        if info.context is None or self.test is None or self.test(value):
            return value
        allowed = self.allowed.replace("`", "")
        number = f"{value:g}" if isinstance(value, float) else quoted(value)
        raise ValueError(f"{number} is not allowed; allowed: {allowed}; for example {self.example}")


def wrong(complaint: str, loc: Key = (), keys: Iterable[Key] = ()) -> Error:
    """What is wrong with the value at `loc`, seen from where it is raised; without words if it is known elsewhere."""
    context = {"complaint": complaint, "keys": tuple(keys)}
    return Error(type=PydanticCustomError("wrong", "{complaint}", context), loc=loc, input=None)


def conflict(complaint: str, *keys: Key) -> Error:
    """Why values at these keys of the configuration do not go together, though each one is allowed."""
    return wrong(complaint, keys=keys)


def raise_all(errors: Iterable[Error]) -> None:
    """Raise all these errors at once, if there are any."""
    if listed := list(errors):
        raise ValidationError.from_exception_data("configuration", listed)


@section(frozen=True, config=CONFIG)
class Section:
    """Keys of a configuration that belong together."""

    others: ClassVar[Mapping[str, Iterable[str]]] = {}  #: the keys of similar sections by their names
    hints: ClassVar[Mapping[str, str]] = {}  #: what to write instead of keys of other programs, in small letters

    @classmethod
    def key_fields(cls) -> dict[str, FieldInfo]:
        """The fields by their keys; those that are not written have no key."""
        fields: Mapping[str, FieldInfo] = cls.__pydantic_fields__  # type: ignore[attr-defined]
        return {str(field.alias): field for field in fields.values() if field.alias}

    @classmethod
    def mapping(cls, value: Any) -> Any:
        """What is written, as keys. Raises ValueError."""
        if not isinstance(value, Mapping):
            raise ValueError(f"must hold keys; allowed here: {', '.join(cls.key_fields())}")
        return value

    @model_validator(mode="wrap")
    @classmethod
    def _in_words(cls, value: Any, handler: Callable[[Any], Self], info: ValidationInfo) -> Self:
        if info.context is None or isinstance(value, cls):
            return handler(value)
        try:
            return handler(cls.mapping(value))
        except ValidationError as refused:
            raise ValidationError.from_exception_data("configuration", list(_worded(cls, refused))) from None


def section_of(name: str, fields: Mapping[str, tuple[Any, Any]], **hints: Any) -> Any:
    """A section with these fields, each of a type and with its default and description (`pydantic.Field`).

    hints: `others` and `hints` of the section.
    """
    namespace = {"__annotations__": {key: kind for key, (kind, _) in fields.items()}, "__module__": __name__}
    defaults = {key: default for key, (_, default) in fields.items()}
    made = type(name, (Section,), {**namespace, **defaults, **hints})
    return section(made, frozen=True, kw_only=True)


def chosen(value: Any, key: str, allowed: Sequence[str]) -> str:
    """The name at the key of a section that decides about its other keys. Raises the error of a wrong one."""
    if not isinstance(value, Mapping):
        raise ValueError(f"must hold keys, for example {{{key}: {allowed[0]}, ...}}")
    if key not in value:
        raise_all([wrong(f"is missing; allowed: {', '.join(allowed)}", (key,))])
    if value[key] not in allowed:
        raise_all([wrong(not_known(value[key], allowed), (key,))])
    return str(value[key])


def read_keys(keys: type[S], value: Any, document: Document) -> S:
    """The section that is written in `value`. Raises pydantic's ValidationError with a complaint for each mistake."""
    return TypeAdapter(keys).validate_python(value, context=document, by_alias=True, by_name=False)


def read_each(entries: Mapping[K, V], read_one: Callable[[K, V], T], place: Key = ()) -> dict[K, T]:
    """Each entry as it is read. All that are refused are raised at once, at their keys within `place`."""
    made, errors = {}, []
    for key, entry in entries.items():
        try:
            made[key] = read_one(key, entry)
        except ValidationError as refused:
            for error in refused.errors():
                context = error["ctx"]
                errors.append(wrong(context["complaint"], (*place, key, *error["loc"]), context["keys"]))
        except ValueError as refused:
            errors.append(wrong(str(refused).rstrip("."), (*place, key)))
    raise_all(errors)
    return made


@contextmanager
def in_sentences(document: Document) -> Iterator[None]:
    """Errors of what a document holds, as sentences.

    Raises InputError with a sentence for each thing that is wrong; ConflictError where each value is allowed.
    """
    try:
        yield
    except ValidationError as refused:
        errors = [error for error in refused.errors() if error["ctx"]["complaint"]]
    else:
        return
    named = [(error["ctx"]["keys"] or [error["loc"]], error["ctx"]["complaint"]) for error in errors]
    sentences = [document.sentence(document.first_given(places), complaint) for places, complaint in named]
    raise (ConflictError if all(error["ctx"]["keys"] for error in errors) else InputError)(*sentences)


def read(keys: type[S], document: Document) -> S:
    """The section that a whole document holds. Raises InputError as `in_sentences`."""
    with in_sentences(document):
        return read_keys(keys, document.content, document)


def _worded(keys: type[Section], refused: ValidationError) -> Iterator[Error]:
    """Pydantic's errors in the words of a user, unknown keys first; a key that is missing because it is misspelt is
    named once."""
    errors = refused.errors()
    unknown = [error for error in errors if error["type"] in UNKNOWN]
    meant = {closest(error["loc"][-1], keys.key_fields()) for error in unknown}
    for error in [*unknown, *(error for error in errors if error["type"] not in UNKNOWN)]:
        kind, loc, context = error["type"], error["loc"], error.get("ctx", {})
        if kind == "wrong":
            yield wrong(context["complaint"], loc, context["keys"])
        elif kind != "missing" or loc[-1] not in meant:
            # the place of a name that is no text ends with "[key]"
            yield wrong(_complaint(keys, error), loc[:-2] if loc[-1:] == ("[key]",) else loc)


def _complaint(keys: type[Section], error: Any) -> str:
    kind, loc = error["type"], error["loc"]
    if kind == "value_error":
        return str(error["ctx"]["error"])
    if kind in UNKNOWN:
        if sought := {**NOT_THERE, **keys.hints}.get(str(loc[-1]).lower()):
            return f"unknown key; {sought}"
        near = closest(loc[-1], keys.key_fields())
        having = ", ".join(name for name, others in keys.others.items() if loc[-1] in others)
        instead = f"it is a key of {having}; " if having else ""
        hint = f"did you mean '{near}'? " if near else ""
        return f"unknown key; {instead}{hint}allowed here: {', '.join(keys.key_fields())}"
    if loc[-1:] == ("[key]",):
        return f"{quoted(error['input'])} is not a name; write it in quotes"
    example = example_of(keys.key_fields()[str(loc[0])])
    if kind == "missing":
        return f"is missing; for example '{loc[0]}: {example}'"
    return f"{quoted(error['input'])} is not allowed; for example {example}"


def closest(text: Any, allowed: Iterable[str]) -> str:
    """The allowed text that another one resembles most; empty where none does."""
    return next(iter(get_close_matches(str(text).lower(), list(allowed), n=1)), "")


def not_known(value: Any, allowed: Sequence[str]) -> str:
    """The complaint about a name that is not among those allowed."""
    near = closest(value, allowed)
    hint = f"did you mean '{near}'? " if near else ""
    return f"{quoted(value)} is not known; {hint}allowed: {', '.join(allowed)}"


def kind_of(field: FieldInfo) -> Kind | None:
    """What may be written for a field: its unit, examples and test; None for a field without such a kind."""
    return _last_kind(Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation)


def _last_kind(annotation: Any) -> Kind | None:
    own = [part for part in getattr(annotation, "__metadata__", ()) if isinstance(part, Kind)]
    inside = (_last_kind(part) for part in get_args(annotation))
    return own[-1] if own else next(filter(None, inside), None)


def example_of(field: FieldInfo) -> str:
    """A value as it may be written."""
    kind = kind_of(field)
    return str(field.examples[0]) if field.examples else kind.example if kind else "{}"
