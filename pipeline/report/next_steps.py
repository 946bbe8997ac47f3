"""What to do after a run, in sentences with the command or key to use."""

import shlex
from collections.abc import Mapping
from math import inf
from typing import Any

from pipeline.config.arm_law import NO_LAW
from pipeline.report.formatting import percent, rounded
from pipeline.report.mesh import from_file
from pipeline.report.mesh_error import largest_mesh_error
from pipeline.report.results import Curve, Results
from pipeline.report.validation import RodErrors
from pipeline.rods.without_parameters import why_at_no_pressure
from pipeline.validation.rods import ARM_LAW, EXTENSIBLE, FIVE

#: relative error of the mesh from which a finer one is suggested, and its size over the present one
LARGE_MESH_ERROR, SMALLER = 0.1, 2 / 3


def next_steps(results: Results, rod: str) -> list[str]:
    """The next steps, the most urgent one first. `rod`: the name of the rod to take, empty where there is none."""
    return [*_after_failure(results), *_mesh(results, rod), *_loads(results), *_use(results, rod)]


def _after_failure(results: Results) -> list[str]:
    if not results.run.get("failure") and not results.failures:
        return []
    reached = [row.pressure_kPa for row in results.experiments if row.reached]
    if not reached:
        return [f"Next: {_lower(results)} or change the design, because no pressure was reached."]
    steps, failures = [], results.run.get("failures") or ()
    if short := why_at_no_pressure(results.run):
        steps.append(f"Next: whatever the pressures, {short}.")
    if without_law := next((failure for failure in failures if failure.startswith(NO_LAW)), ""):
        steps.append(
            f"Next: {without_law}; take five parameters instead, with --set law=five in another --out, if the arm is "
            "long enough for them."
        )
    return steps if steps and len(steps) == len(failures) else [*steps, *_after_limit(results)]


def _lower(results: Results) -> str:
    """Lower pressures, below the one at which an experiment ended where that is known."""
    end = results.run.get("end_kPa")
    return "lower the pressures" if end is None else f"give pressures below {end:.3g} kPa, where an experiment ended,"


def _after_limit(results: Results) -> list[str]:
    """What to do about pressures and loads that were not reached."""
    given = results.run.get("config", {}).get("pressures_kPa", ())
    if given and results.identified_pressures and not set(given) & set(results.identified_pressures):
        return [
            "Next: give lower pressures (a note says below which), or change walls or material, with another --out."
        ]
    end = results.run.get("end_kPa")
    instead = "" if end is None else f" (an experiment ended at {end:.4g} kPa)"
    return [
        "Next: the first sentence names what was not reached and its cause; leave this pressure or load out, give "
        f"lower ones{instead}, or change walls or material, with another --out."
    ]


def _mesh(results: Results, rod: str) -> list[str]:
    """A finer mesh, or another one that shows the error of the present one."""
    if not (results.identified_pressures or results.arm_law):
        return []
    if accuracy := results.run.get("accuracy"):
        return _for_accuracy(accuracy)
    if from_file(results):
        return ["Next: run the body with a finer mesh in its file too; the difference shows the error of the mesh."]
    steps = _smaller(results, rod)
    if results.identified_pressures and not results.parameters.get("mesh_error"):
        with_pilots = results.run.get("config", {}).get("accuracy") is None  # else these gave no estimate
        steps.append(
            "Next: have the error of the mesh in the five parameters estimated, in another --out, with --set "
            "mesh.coarser=1.5 (II and III once more on a coarser mesh)"
            f"{' or with --set mesh.size=auto --accuracy 5%' if with_pilots else ''}."
        )
    return steps


def _for_accuracy(accuracy: Mapping[str, Any]) -> list[str]:
    """Smaller elements, where the errors are estimated above those requested."""
    present = accuracy.get("after") or accuracy
    if present.get("estimated_error", 0.0) <= accuracy.get("requested", 0.0):
        return []
    beginning = f"Next: the requested accuracy of {percent(accuracy['requested'])} is not reached; "
    if not (finer := accuracy.get("finer")):
        return [
            f"{beginning}no smaller size that is tried would reach it; request a larger error, or leave accuracy out."
        ]
    return [
        f"{beginning}take smaller elements, in another --out: --set mesh.size='{finer['size_mm']:g} mm' with the same "
        f"--accuracy (about {rounded(finer['degrees_of_freedom'])} unknowns)."
    ]


def _smaller(results: Results, rod: str) -> list[str]:
    """Smaller elements, where the error of the mesh is large in the numbers of the rod to take."""
    error, mesh = largest_mesh_error(results, rod), results.run.get("mesh")
    if error < LARGE_MESH_ERROR or not mesh:
        return []
    of_law = " in the arm's own law" if rod == ARM_LAW else ""
    compared = (results.parameters.get("mesh_error") or {}).get("mixed_at_kPa") is not None
    if compared and rod != ARM_LAW and "formulation" not in mesh.get("chosen", {}):
        return [
            f"Next: take mixed elements, in another --out, because the error of the mesh is about {percent(error)} and "
            f"contains the difference between {mesh['formulation']} and mixed elements: --set mesh.formulation=mixed."
        ]
    return [
        f"Next: take smaller elements, in another --out, because the error of the mesh{of_law} is about "
        f"{percent(error)}: for example --set mesh.size='{SMALLER * mesh['size_mm']:.2g} mm'."
    ]


def _loads(results: Results) -> list[str]:
    tested = any(row.sample == "out" and (row.load or row.rod == FIVE) for row in results.validation)
    if not results.validation or tested:
        return []
    return ["Next: test the rod under loads it was not fitted to, with the section `validation` of the configuration."]


def _use(results: Results, rod: str) -> list[str]:
    highest = max(results.reached_pressures, default=inf)
    of_law = results.arm_law.get("pressures_kPa", ())  # between them it is interpolated
    pressures = [min(highest, of_law[-1])] if rod == ARM_LAW and of_law else results.identified_pressures
    if not rod or not pressures:
        return []
    file = shlex.quote(str(results.directory / ("law.json" if rod == ARM_LAW else "parameters.json")))
    folder = shlex.quote(str(results.directory))
    stretch = {EXTENSIBLE: " --stretch", FIVE: " --no-stretch"}.get(rod, "")
    pressure, load = _load_of_third(results, rod, pressures[-1])
    under = "the load of experiment III" if load else "the pressure alone"
    steps = [
        f"To use the rod, for example under {under}: pneurod rod {file} --pressure '{pressure:g} kPa'{load}{stretch}"
    ]
    if rod == ARM_LAW:
        steps.append(
            f"To use the arm's own law in another program (csv or json): pneurod export {folder} --law cell --to csv"
        )
    if results.identified_pressures:
        steps.append(
            "To use the rod with five parameters in another program (csv, json, pyelastica, mujoco, somo or sorosim): "
            f"pneurod export {folder} --to pyelastica{_other_rod(results, rod)}"
        )
    return steps


def _load_of_third(results: Results, rod: str, highest_kPa: float) -> tuple[float, str]:
    """The highest pressure up to this one at which the rod has an equilibrium under the load of experiment III, and the
    options of this load: the rod is known under it, and its answer can be compared with the finite elements.

    Without such a pressure, and where the options do not have the load, the given pressure and no option.
    """
    known = [
        row.pressure_kPa
        for row in results.rows_of(rod)
        if row.experiment == "III" and not (row.load or row.reason) and row.pressure_kPa <= highest_kPa
    ]
    curve = results.curve("III", max(known)) if known else None
    whole = curve is not None and curve["s_mm"][0] == 0.0  # in files of format 1 it begins half a cell farther
    options = _options_of_third(results, rod, curve) if curve is not None and whole else ""
    return (max(known), options) if options else (highest_kPa, "")


def _options_of_third(results: Results, rod: str, curve: Curve) -> str:
    """What acts on the end in experiment III as options of `pneurod rod`; empty where these do not have it.

    A rod with five parameters is given the couple of the edge on the end as well, as where it was compared.
    """
    held, force = results.end_of_third
    x, y = (f"{round(curve[name][-1] - curve[name][0], 6) + 0.0:.9g} mm" for name in ("x_mm", "y_mm"))
    couple = 0.0 if rod == ARM_LAW or not curve.has("moment_N_mm") else float(curve["moment_N_mm"][-1])
    acting = f" --force '[{force[0]:g} N, {force[1]:g} N]'" if any(force) else ""
    with_position = {(True, True): f" --end '[{x}, {y}]'", (False, False): acting}
    options = f" --end-y '{y}'" if held == (False, True) and not acting else with_position.get(held, "")
    return f"{options} --moment '{couple:.6g} N*mm'" if options and couple else options


def _other_rod(results: Results, rod: str) -> str:
    """What is to be known of the exported rod, which does not stretch, where another one is to be taken."""
    exported = RodErrors.of(results, FIVE)
    if rod == FIVE or not sum(exported.loads):
        return ""
    return f" (the rod that does not stretch: its shape is wrong by up to {percent(exported.shape)} of l)"
