"""The moments for which a rod is known: with the arm's own law, which is not extrapolated, and with five parameters."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pipeline.report.formatting import number, percent
from pipeline.report.results import Results
from pipeline.store.formats import of_extensible
from pipeline.validation.rods import EXTENSIBLE, FIVE
from rod.identification.moment_range import ALLOWED_FRACTION

#: largest difference between a pressure of the law and one of the experiments that it stands for, over the latter
NEAR = 0.01
#: pressures that the sentence names; with more it names the first and the last
MOST_NAMED = 4


@dataclass(frozen=True)
class MomentsOfLaw:
    """The moments that the law has at one pressure, N mm."""

    pressure_kPa: float
    cell: tuple[float, float]
    clamp: tuple[float, float] | None  #: of the clamped end; None in files without it

    @property
    def both(self) -> tuple[float, float]:
        """The moments that both have."""
        low, high = zip(self.cell, self.clamp or self.cell, strict=True)
        return max(low), min(high)


def moments_of_law(results: Results) -> list[MomentsOfLaw]:
    """By pressure of the experiments, those between which the law is interpolated left out."""
    clamps = {_pressure(curve): curve for curve in (results.arm_law.get("clamp") or {}).get("curves", ())}
    return [
        MomentsOfLaw(_pressure(curve), _ends(curve), _ends(clamp) if (clamp := clamps.get(_pressure(curve))) else None)
        for curve in curves_of_experiments(results)
    ]


def curves_of_experiments(results: Results) -> list[Mapping[str, Any]]:
    """The curves of a cell at the pressures of the experiments, or within NEAR of them; those between left out.

    The pressures of the law are parts of its highest one, which pressures that the program has chosen are close to.
    """
    requested = results.pressures
    curves = results.arm_law.get("curves", ())
    return [c for c in curves if any(abs(_pressure(c) - p) <= NEAR * abs(p) for p in requested)]


def moments_sentence(results: Results) -> str:
    """The moments for which the law is known, for the verdict; empty without a law."""
    rows = moments_of_law(results)
    parts = _named([(row.pressure_kPa, row.both) for row in rows])
    more = "" if len(parts) == len(rows) else "; the report has those at the other pressures"
    return f"The arm's own law is known for moments {', '.join(parts)}, and not extrapolated{more}." if parts else ""


def moments_of_identification(results: Results, rod: str) -> str:
    """The moments of experiment III from which a rod with five parameters was identified; empty without that."""
    columns = {FIVE: results.parameters, EXTENSIBLE: of_extensible(results.parameters)}.get(rod, {})
    ranges = columns.get("moment_range_N_mm") or ()
    rows = [(p, ends) for p, ends in zip(results.identified_pressures, ranges, strict=False) if ends]
    if not (parts := _named(rows)):
        return ""
    more = "" if len(parts) == len(rows) else " (parameters.json has the moments at the other pressures)"
    return (
        f"The rod to take was identified under moments {', '.join(parts)}{more}. Beyond them it is extrapolated, and "
        f"pneurod rod warns where this is so on more than {percent(ALLOWED_FRACTION)} of its length."
    )


def moments_table(results: Results) -> list[list[str]]:
    """Rows of the table of the report: p, moments of a cell and of the clamped end."""
    return [
        [f"{row.pressure_kPa:g}", _to(row.cell), _to(row.clamp) if row.clamp else "-"]
        for row in moments_of_law(results)
    ]


def _named(rows: Sequence[tuple[float, tuple[float, float]]]) -> list[str]:
    """The moments by pressure in words, of many pressures those at the first and the last."""
    named = rows if len(rows) <= MOST_NAMED else (rows[0], rows[-1])
    return [f"from {_to(ends)} N mm at {pressure:g} kPa" for pressure, ends in named]


def _pressure(curve: Mapping[str, Any]) -> float:
    return float(curve["pressure_kPa"])


def _ends(curve: Mapping[str, Any]) -> tuple[float, float]:
    moments: Sequence[float] = curve["moment_N_mm"]
    return moments[0], moments[-1]


def _to(ends: tuple[float, float]) -> str:
    low, high = (number(float(f"{end:.3g}")) for end in ends)
    return f"{low} to {high}"
