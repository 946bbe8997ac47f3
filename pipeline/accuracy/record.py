"""The content of accuracy.json: what each rung cost, and how far its numbers are from those of the finest solution."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from pipeline.accuracy.ladder import CONTACT, POINTS, TOLERANCE, Rung, mesh_choice
from pipeline.accuracy.reference import HEADLINE, NUMBERS, errors, headline, limit, pareto_front, shifted
from pipeline.config.config import Config
from pipeline.config.schema import FORMULATIONS
from pipeline.errors import RunFailed
from pipeline.store.provenance import provenance

AXES = ("x", "y")

#: the numbers whose meaning hangs on whether the law has one slope or two
OF_THE_LAW = ("alpha1_N_mm2", "alpha2_N_mm2", "d_mm")

Found = Mapping[str, Any]  #: what `rung_measured.measure` found
Numbers = Mapping[str, Any]  #: of that, what belongs to one pressure

#: the elements whose limit is the reference
SUREST = next(name for name in ("mixed", "p2p0") if name in FORMULATIONS)


def accuracy_record(config: Config, rungs: Sequence[tuple[Rung, Found]], touching_mm: float | None) -> dict[str, Any]:
    """The content of accuracy.json. Raises RunFailed where there is nothing to hold the rungs against."""
    references = {pressure: _references(config, rungs, pressure, touching_mm) for pressure in config.pressures_kPa}
    lacking = [f"{pressure:g} kPa" for pressure, found in references.items() if found["force_N"] is None]
    if lacking:
        raise RunFailed(f"too few rungs reached {', '.join(lacking)} to extrapolate from; choose lower pressures")
    rows = [row for rung, found in rungs for row in _rows(config, rung, found, references)]
    ranked = [row for row in rows if row["headline"] is not None]
    front = pareto_front([(row["cpu_seconds"], row["headline"]) for row in ranked])
    for row in rows:
        row["on_front"] = any(row is ranked[index] for index in front)
    return {
        "config": config.record(),
        "config_hash": config.hash,
        **provenance(),
        "pressures_kPa": list(config.pressures_kPa),
        "as_configured": {"choice": mesh_choice(config), "size_mm": config.mesh.size_mm, "contact_mm": touching_mm},
        "reference": [{"pressure_kPa": pressure, **_written(found)} for pressure, found in references.items()],
        "reference_error": max(one[key].relative for one in references.values() for key in HEADLINE if one[key]),
        "rungs": rows,
    }


def _references(
    config: Config, rungs: Sequence[tuple[Rung, Found]], pressure: float, touching_mm: float | None
) -> dict[str, Any]:
    """What each number is held against at one pressure: a Reference, two of them for the end, or None."""
    lines: dict[str, list[tuple[float, Numbers]]] = {}
    distances: list[tuple[float, Numbers]] = []
    for rung, found in rungs:
        numbers = next((one for one in found["numbers"] if (one["pressure_kPa"], one["stride"]) == (pressure, 1)), None)
        if numbers is None:
            continue
        if rung.is_mesh and rung.config.mesh.formulation == SUREST:
            lines.setdefault(rung.choice, []).append((found["degrees_of_freedom"], numbers))
        if touching_mm is not None and rung.config.mesh == config.mesh and rung.choice != TOLERANCE:
            distances.append((rung.value if rung.choice == CONTACT else touching_mm, numbers))
    return {key: _reference(key, list(lines.values()), distances, touching_mm) for key in NUMBERS}


def _reference(
    key: str,
    lines: Sequence[Sequence[tuple[float, Numbers]]],
    distances: Sequence[tuple[float, Numbers]],
    touching_mm: float | None,
) -> Any:
    if key == "end_mm":
        ends = [
            _reference(axis, _of_end(lines, i), _of_end([distances], i)[0], touching_mm) for i, axis in enumerate(AXES)
        ]
        return None if None in ends else ends
    if key in OF_THE_LAW:
        slopes = _slopes(lines)
        lines = [[rung for rung in line if _two_slopes(rung) == slopes] for line in lines]
        distances = [rung for rung in distances if _two_slopes(rung) == slopes]
    known = [[(n, numbers[key]) for n, numbers in line if numbers[key] is not None] for line in lines]
    found = limit(known)
    steps = [(mm, numbers[key]) for mm, numbers in distances if numbers[key] is not None]
    if found is None or touching_mm is None or len(steps) < 2 or touching_mm not in dict(steps):
        return found
    return shifted(found, steps, touching_mm)


def _two_slopes(rung: tuple[float, Numbers]) -> bool:
    return rung[1]["d_mm"] is not None


def _slopes(lines: Sequence[Sequence[tuple[float, Numbers]]]) -> bool:
    """Whether most rungs of the lines found two slopes; the finest decides where as many found one. The rigidity of one
    line and that of two are different numbers, so only the others of its kind say something about one."""
    rungs = sorted((rung for line in lines for rung in line), key=lambda rung: rung[0])
    votes = sum(1 if _two_slopes(rung) else -1 for rung in rungs)
    return votes > 0 or (votes == 0 and bool(rungs) and _two_slopes(rungs[-1]))


def _rows(
    config: Config, rung: Rung, found: Found, references: Mapping[float, Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """One row of a rung, and one more for every way of thinning its curve."""
    rows = []
    measured = {key: value for key, value in found.items() if key not in ("numbers", "key")}
    for stride in rung.strides:
        numbers = [one for one in found["numbers"] if one["stride"] == stride]
        against = [
            {
                "pressure_kPa": one["pressure_kPa"],
                **errors(one, references[one["pressure_kPa"]], config.design.length),
            }
            for one in numbers
        ]
        thinned = {"choice": POINTS, "value": min((one["points"] for one in numbers), default=None)}
        rows.append(
            {
                "choice": rung.choice,
                "value": rung.value,
                **(thinned if stride > 1 else {}),
                **measured,
                "headline": headline(against) if len(numbers) == len(config.pressures_kPa) else None,
                "errors": against,
                "numbers": numbers,
            }
        )
    return rows


def _of_end(lines: Any, axis: int) -> Any:
    """The lines with one coordinate of the end as their number."""
    return [[(n, {AXES[axis]: numbers["end_mm"][axis]}) for n, numbers in line] for line in lines]


def _written(found: Mapping[str, Any]) -> dict[str, Any]:
    written: dict[str, Any] = {}
    for key, one in found.items():
        if key == "end_mm":
            written[key] = one and [asdict(axis) for axis in one]
        else:
            written[key] = one and asdict(one)
    return written
