"""Values that are printed in a few lines."""

from collections.abc import Iterable, Mapping, Sequence


class Printable:
    """A value that `print` shows as lines: names and what is told of them, and its notes."""

    @property
    def lines(self) -> Sequence[object]:
        """Lines that `print` shows: a name and its value in each, then the notes."""
        return [*aligned(self.told), *getattr(self, "notes", ())]  # type: ignore[attr-defined]

    def __str__(self) -> str:
        return "\n".join(map(str, self.lines))


def aligned(told: Mapping[str, str]) -> list[str]:
    """Lines of names and what is told of them, which begins in one column."""
    width = max(map(len, told))
    return [f"{name:<{width}}  {value}" for name, value in told.items()]


def listed(values: Iterable[float], unit: str = "") -> str:
    """Components in brackets, with five digits."""
    return f"[{', '.join(f'{float(value) + 0.0:.5g}' for value in values)}] {unit}".rstrip()


def placed(end: Iterable[float]) -> str:
    """A place (mm) to a thousandth of a millimetre; what is rounded to zero has no sign."""
    return ", ".join(f"{axis} = {round(float(value), 3) + 0.0:.3f} mm" for axis, value in zip("xyz", end, strict=False))
