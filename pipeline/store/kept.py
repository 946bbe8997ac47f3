"""Values that a run keeps for the next one: used again only by the sources that computed them."""

from collections.abc import Callable
from typing import Any, TypeVar

from pydantic import TypeAdapter

from pipeline.store.store import Store

Value = TypeVar("Value")


def read_kept(store: Store, name: str, kind: Any, key: str = "") -> Any:
    """The value of this type in a file of an earlier run with the same key; None where there is none.

    key: that of the numbers of the store unless it is given.
    """
    content = store.read_json(name)
    if content is None or content["key"] != (key or store.numbers_key):
        return None
    return TypeAdapter(kind).validate_python(content["value"])


def save_kept(store: Store, name: str, kind: Any, value: Any, key: str = "") -> None:
    """Keep a value of this type in a file."""
    content = TypeAdapter(kind).dump_python(value, mode="json")
    store.save_json(name, {"key": key or store.numbers_key, "value": content})


def kept(store: Store, name: str, kind: Any, make: Callable[[], Value], key: str = "") -> Value:
    """The value of an earlier run, or what is made and kept now."""
    value: Value | None = read_kept(store, name, kind, key)
    if value is None:
        value = make()
        save_kept(store, name, kind, value, key)
    return value
