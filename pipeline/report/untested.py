"""What a run did not test, in sentences."""

from pipeline.report.formatting import listed
from pipeline.report.results import Results
from pipeline.validation.rods import FIVE


def untested(results: Results) -> list[str]:
    """What the numbers of a run do not show; empty where nothing was solved."""
    if not results.reached_pressures:
        return []
    return [*_loads(results), *_range(results), *_slopes(results), _reality(results)]


def _loads(results: Results) -> list[str]:
    """Loads that no parameter was fitted to and that were not solved: others than those of experiment III."""
    if not results.identified_pressures and not results.arm_law:
        return []
    rows = [row for row in results.validation if row.sample == "out" and (row.load or row.rod == FIVE)]
    of_run = {row.pressure_kPa for row in results.experiments}
    (_, height_held), forces = results.end_of_third
    height = "another height" if height_held else "a prescribed height"
    force = "another dead force" if any(forces) else "a dead force"
    kinds = {
        f"{height} of the end": any(row.experiment == "III" and row.load for row in rows),
        f"{force} on the end": any(row.experiment == "dead" for row in rows),
        "a pressure between those of the run": any(row.pressure_kPa not in of_run for row in rows),
    }
    missing = [kind for kind, tested in kinds.items() if not tested]
    if not missing:
        return []
    tested = [kind for kind, tested in kinds.items() if tested]
    if not tested:
        return [f"Not tested: the rods under {', '.join(missing[:-1])} or {missing[-1]}."]
    return [f"Not tested: the rods under {' or '.join(missing)} (tested: {listed(tested)})."]


def _range(results: Results) -> list[str]:
    tested = results.identified_pressures or results.reached_pressures
    low, high = tested[0], tested[-1]
    if low == high:
        return [f"Not tested: pressures other than {low:g} kPa."]
    below = f"below {low:g} kPa and " if low > 0.0 else ""
    return [f"Not tested: pressures {below}above {high:g} kPa."]


def _slopes(results: Results) -> list[str]:
    if results.parameters.get("linear_range_kPa") is None or results.parameters.get("linear_range_tested"):
        return []
    return ["Not tested: whether α₁, α₂ and κ₀ are linear in the pressure, because two pressures always lie on a line."]


def _reality(results: Results) -> str:
    config = results.run.get("config", {})
    materials = (config.get("material") or {}, *(config.get("materials") or {}).values())
    laws = list(dict.fromkeys(filter(None, (material.get("law", "") for material in materials))))
    named = f" (law{'s' if len(laws) > 1 else ''} {listed(laws)})" if laws else ""
    return (
        "Not tested: a real arm. All numbers are those of a simulation of slow, elastic deformation in the plane; "
        f"material{named}, viscosity, inertia, friction and tolerances of manufacture are not checked in a laboratory."
    )
