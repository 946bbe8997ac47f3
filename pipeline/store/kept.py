"""Values that are kept for the next call of a command: used again only by the sources that computed them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from pydantic import TypeAdapter

from pipeline.store.result_folder import ResultFolder
from pipeline.store.store import Store

Value = TypeVar("Value")


@dataclass(frozen=True)
class KeptFile(Generic[Value]):
    """A file that keeps a value with the key of everything that decides it. It may be sent to worker processes."""

    folder: ResultFolder
    name: str
    kind: Any  #: the type of the value
    key: str

    def read(self) -> Value | None:
        """The value of an earlier call with the same key; None where there is none, or one that cannot be read."""
        try:
            content = self.folder.read_json(self.name)
            if not isinstance(content, Mapping) or content.get("key") != self.key:
                return None
            value: Value = TypeAdapter(self.kind).validate_python(content.get("value"))
        except (OSError, ValueError):
            return None
        return value

    def save(self, value: Value) -> None:
        """Keep a value. Raises OSError."""
        content = TypeAdapter(self.kind).dump_python(value, mode="json", fallback=lambda number: number.tolist())
        self.folder.save_json(self.name, {"key": self.key, "value": content})

    def read_or_make(self, make: Callable[[], Value]) -> Value:
        """The value of an earlier call, or what is made and kept now."""
        value = self.read()
        if value is None:
            value = make()
            self.save(value)
        return value


def read_kept(store: Store, name: str, kind: Any, key: str = "") -> Any:
    """The value of this type in a file of an earlier run with the same key; None where there is none.

    key: that of the numbers of the store unless it is given.
    """
    return KeptFile[Any](store, name, kind, key or store.numbers_key).read()


def save_kept(store: Store, name: str, kind: Any, value: Any, key: str = "") -> None:
    """Keep a value of this type in a file."""
    KeptFile[Any](store, name, kind, key or store.numbers_key).save(value)


def kept(store: Store, name: str, kind: Any, make: Callable[[], Value], key: str = "") -> Value:
    """The value of an earlier run, or what is made and kept now."""
    return KeptFile[Value](store, name, kind, key or store.numbers_key).read_or_make(make)
