"""Measured curves in the result folder: each is kept as soon as it is there, and not measured again."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from time import perf_counter
from typing import Generic, TypeVar

from pipeline.store.json_values import JsonObject
from pipeline.store.store import Store
from rod.arm_law.record import curve_row, curve_values

Curve = TypeVar("Curve")


@dataclass(frozen=True)
class Measured(Generic[Curve]):
    """A curve and what it cost."""

    curve: Curve
    limits: tuple[str, ...] = ()  #: sentences: why it was not followed further
    #: of the cubics between its states: of a cell over the largest curvature, of a clamped end in rad
    error: float = 0.0
    factorizations: int = 0
    seconds: float = 0.0
    is_stored: bool = field(default=False, compare=False)  #: by an earlier run


@dataclass(frozen=True)
class KeptCurves(Generic[Curve]):
    """Curves of one kind in the folder `law`, valid for the configuration and the sources of a store."""

    store: Store
    kind: type[Curve]
    keys: Mapping[str, str]  #: of the file, as in `rod.arm_law.record`

    def get(self, name: str, measure: Callable[[], Measured[Curve]]) -> Measured[Curve]:
        """The curve of this name from an earlier run, or measured now and kept."""
        kept = self.read(name)
        if kept is not None:
            return kept
        begin = perf_counter()
        measured = measure()
        measured = Measured(
            measured.curve, measured.limits, measured.error, measured.factorizations, perf_counter() - begin
        )
        self.store.save_json(_file(name), {"key": self.store.numbers_key, **self._row(measured)})
        return measured

    def read(self, name: str) -> Measured[Curve] | None:
        """The curve of an earlier run, None where there is none from these sources."""
        kept = self.store.read_json(_file(name))
        if kept is None or kept["key"] != self.store.numbers_key:
            return None
        return Measured(
            self.kind(**curve_values(kept["curve"], self.keys)),
            tuple(kept["limits"]),
            kept["error"],
            kept["factorizations"],
            kept["seconds"],
            is_stored=True,
        )

    def _row(self, measured: Measured[Curve]) -> JsonObject:
        return {
            "curve": curve_row(measured.curve, self.keys),
            "limits": list(measured.limits),
            "error": measured.error,
            "factorizations": measured.factorizations,
            "seconds": measured.seconds,
        }


def _file(name: str) -> str:
    return f"law/{name}.json"
