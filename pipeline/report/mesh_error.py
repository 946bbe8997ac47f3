"""What the report says about the error of the mesh, in the five parameters and in the arm's own law."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

from pipeline.cell.refinement import SMALLEST_TURN
from pipeline.report.formatting import decimals_of, fixed, listed, percent
from pipeline.report.mesh import from_file
from pipeline.report.numbers import NUMBERS
from pipeline.report.results import Results
from pipeline.validation.rods import ARM_LAW

#: how the sentence on `mesh_error` in parameters.json begins
_OF_FIVE = "Mesh error of the five parameters"
#: of `mesh_error` in law.json
_LAW_QUANTITIES = {
    "kappa_0_per_mm": "κ₀",
    "rigidity_N_mm2": "the bending rigidity of a cell",
    "moment_N_mm": "its moment at half of κ₀",
}
#: the same where κ₀ is so small that an error relative to it says nothing
_OF_SMALLEST_TURN = {
    "kappa_0_per_mm": f"the curvature that turns the arm by {SMALLEST_TURN:g} rad, which is above κ₀",
    "moment_N_mm": f"the moment of a cell at half of the curvature that turns the arm by {SMALLEST_TURN:g} rad",
}


def mesh_error(results: Results) -> str:
    """Whether the standard deviations of the five parameters contain the error of the mesh, and how large that is."""
    if not results.identified_pressures:
        return ""
    error = results.parameters.get("mesh_error")
    if not error and results.run.get("accuracy"):
        return f"{_OF_FIVE}: that of the requested accuracy, which the standard deviations do not contain."
    if not error:
        coarser = (results.run.get("config", {}).get("mesh") or {}).get("coarser")
        why = results.parameters.get("mesh_error_reason") or (
            f"a mesh {coarser:g} times as coarse gave no parameters"
            if coarser
            else "this needs another mesh, and this one is from a file"
            if from_file(results)
            else "mesh.coarser in the configuration adds it"
        )
        return f"{_OF_FIVE}: not estimated. Their standard deviations do not contain the error of the mesh: {why}."
    sizes = listed([f"{size:g}" for size in error["sizes_mm"]])
    mixed_at = error.get("mixed_at_kPa")
    mixed = "" if mixed_at is None else f" and from mixed elements at {mixed_at:g} kPa"
    parts = []
    for key, symbol, unit in NUMBERS:
        stds = [std for std in error[f"{key}_std"] if std]
        if stds:
            parts.append(f"{fixed(max(stds), decimals_of([], [max(stds)]))} {unit} of {symbol}")
    relative = f"{_relative(error)} at the worst pressure, " if _relative(error) else ""
    return (
        f"{_OF_FIVE}: {relative}estimated from mesh sizes of {sizes} mm{mixed}. It is included in the standard "
        f"deviations, with up to {listed(parts)}."
    )


def what_spread_is(results: Results) -> str:
    """What the standard deviations of the five parameters are, and whether the error of the mesh is in them."""
    included = "" if results.parameters.get("mesh_error") else ", without the error of the mesh"
    return f"one standard deviation{included}"


def largest_mesh_error(results: Results, rod: str) -> float:
    """The largest relative error due to the mesh, of all numbers and pressures; 0 where none is known.

    rod: whose numbers, those of the arm's own law or the five parameters (κ₀(l/2), α₂ and F).
    """
    if rod == ARM_LAW:
        return max((error.relative for error in _errors_of_law(results)), default=0.0)
    return max(_largest(results.parameters.get("mesh_error") or {}).values(), default=0.0)


def _largest(error: Mapping[str, Any]) -> dict[str, float]:
    """The largest relative errors over the pressures that are known, by symbol."""
    symbols = {"kappa_0": "κ₀(l/2)", "alpha2": "α₂", "force": "F"}
    known = {s: [e for e in error.get(f"{name}_relative") or () if e is not None] for name, s in symbols.items()}
    return {symbol: max(errors) for symbol, errors in known.items() if errors}


def _relative(error: Mapping[str, Any]) -> str:
    """The largest relative errors over the pressures; empty where they are not known."""
    parts = [f"{100 * largest:.1f} % in {symbol}" for symbol, largest in _largest(error).items()]
    return f"about {listed(parts)}" if parts else ""


def law_mesh_error(results: Results) -> str:
    """The error of the mesh in the arm's own law; empty where there is no law, a sentence where it is not known."""
    if not results.arm_law:
        return ""
    largest = _relative_of_law(results)
    if not largest:
        return "Mesh error of the arm's own law: not estimated."
    reason = (results.arm_law.get("mesh_error") or {}).get("reason")
    why = f"; {reason}" if reason else ""
    return f"Mesh error of the arm's own law: {largest}, one standard deviation{why}."


@dataclass(frozen=True)
class _ErrorOfLaw:
    """The largest error of a quantity of the arm's own law due to its mesh."""

    relative: float  #: one standard deviation
    pressure_kPa: float | None  #: where it is largest; None in files without their pressures
    quantity: str

    def __str__(self) -> str:
        at = "" if self.pressure_kPa is None else f" (at {self.pressure_kPa:g} kPa)"
        return f"{percent(self.relative)} of {self.quantity}{at}"


def _errors_of_law(results: Results) -> list[_ErrorOfLaw]:
    """The largest error of every quantity whose error is known."""
    known = results.arm_law.get("mesh_error") or {}
    smallest = _smallest_of_law(results.arm_law, known)
    largest = []
    for key, quantity in _LAW_QUANTITIES.items():
        columns = (known.get(name) or () for name in (key, f"{key}_std", "pressures_kPa"))
        errors = []
        for value, std, pressure, least in zip_longest(*columns, smallest.get(key, ())):
            if value is None or std is None or not (value or least):
                continue
            is_small = abs(value) < (least or 0.0)
            over, named = (least, _OF_SMALLEST_TURN[key]) if is_small else (abs(value), quantity)
            errors.append(_ErrorOfLaw(std / over, pressure, named))
        if errors:
            largest.append(max(errors, key=lambda error: error.relative))
    return largest


def _smallest_of_law(law: Mapping[str, Any], known: Mapping[str, Any]) -> dict[str, list[float]]:
    """By key and pressure: what errors are relative to at least. It is the curvature that turns the arm by
    SMALLEST_TURN, as for the mesh of a requested accuracy, and the moment that half of it takes."""
    if "length_mm" not in law:
        return {}
    kappa, rigidities = SMALLEST_TURN / law["length_mm"], known.get("rigidity_N_mm2") or ()
    moments = [0.5 * kappa * abs(rigidity or 0.0) for rigidity in rigidities]
    return {"kappa_0_per_mm": [kappa] * len(known.get("kappa_0_per_mm") or ()), "moment_N_mm": moments}


def _relative_of_law(results: Results) -> str:
    """The largest relative errors of the law due to its mesh; empty where they are not known."""
    parts = [str(error) for error in _errors_of_law(results)]
    return f"about {listed(parts)}" if parts else ""


def _indicator(results: Results) -> str:
    """The only measure of the error of a mesh from a file; empty for other meshes, whose size can be changed."""
    indicator = results.run.get("indicator")
    if not indicator or not from_file(results):
        return ""
    return (
        ", because the mesh is from a file; the stress of its elements differs from a smooth one recovered from it by "
        f"up to {percent(indicator['stress_error'])} in energy, which is a measure of the mesh and not an error of the "
        "rod"
    )


def mesh_besides(results: Results, rod: str) -> str:
    """The sentence on the error of the mesh beside that of the rods, which are compared on the same mesh.

    rod: the one to take, whose error is named first; of another one where only that is known.
    """
    of_five = _relative(results.parameters.get("mesh_error") or {}) if results.parameters else ""
    of_five = f"{of_five} at the worst pressure" if of_five else ""
    of_law = _relative_of_law(results)
    if of_law:
        of_law += "; that of the clamped end and the tip is not known"
        of_law += f", and in the whole arm it is {of_five}" if of_five else ""
    largest = (of_law or of_five) if rod == ARM_LAW else (of_five or of_law)
    if not largest and results.run.get("accuracy"):
        known = "It was estimated for the requested accuracy."
    elif not largest:
        known = f"It was not estimated{_indicator(results)}."
    else:
        known = f"One standard deviation: {largest}."
    return (
        "The error of the mesh comes on top of that, because the rod was compared with finite elements on the same "
        f"mesh; to a real arm both errors apply. {known}"
    )
