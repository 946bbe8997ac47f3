"""The error of the default mesh: kappa_0(l/2), alpha2 and F against the limit of this and of a finer mesh."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pipeline.config.config import Config
from pipeline.identify.mesh_error import RELATIVE, OtherNumbers
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.stages import SolvedRun
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.reasons import render_all
from pipeline.values.richardson import extrapolate
from rod import RodError

#: size of the default mesh over that of the finer one
FINER = 1.5


def against_finer_mesh(solved: SolvedRun) -> dict[str, Any]:
    """At the lowest pressure, with as many lines of the rod on the finer mesh as the run chose.

    The error is the difference from the extrapolated limit over that limit, with the standard deviation of the limit.
    """
    if not solved.parameters:
        return {"failure": "no five parameters on the default mesh"}
    first, size = solved.parameters[0], solved.config.mesh.size_mm
    config = replace(solved.config.with_mesh_size(size / FINER), pressures_kPa=(first.pressure_kPa,))
    try:
        outcomes = _solved(config)
    except (InputError, RunFailed) as failure:
        return {"failure": str(failure)}
    free, loaded = (outcomes[name].at(first.pressure_kPa) for name in ("II", "III"))
    if free is None or loaded is None:
        return {"failure": render_all(outcomes.failures)}
    try:
        states = ((first.free, first.loaded), (free, loaded))
        on_default, on_finer = (OtherNumbers.of(first, *pair).numbers(first) for pair in states)
    except RodError as failure:
        return {"failure": str(failure)}
    errors = {}
    for name in RELATIVE:
        values = [on_default[name], on_finer[name]]
        limit = extrapolate((size, size / FINER), values)
        errors[name] = {
            "error": (limit.value - limit.limit) / limit.limit,  # above zero where the number is too large
            "std": limit.limit_std / abs(limit.limit),
            "estimated": first.mesh_errors.get(name),
            "values": values,
        }
    return {"pressure_kPa": first.pressure_kPa, "sizes_mm": [size, size / FINER], "errors": errors}


def _solved(config: Config) -> Outcomes:
    """Raises InputError and RunFailed."""
    with TemporaryDirectory() as folder, open_store(Path(folder), config) as store:
        return simulate(Scene.meshed(config), RunContext.alone(store, Silent()), ("III", "II"))
