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

    @classmethod
    def of_run(cls, store: Store, name: str, kind: Any) -> "KeptFile[Value]":
        """The key of numbers computed from the states of a run."""
        return cls(store, name, kind, store.numbers_key)

    def read(self) -> Value | None:
        """The value of an earlier call with the same key; None where there is none, or one that cannot be read."""
        try:
            content = self.folder.read_json(self.name)
            if not isinstance(content, Mapping) or content.get("key") != self.key:
                return None
            return TypeAdapter(self.kind).validate_python(content.get("value"))
        except (OSError, ValueError):
            return None

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
