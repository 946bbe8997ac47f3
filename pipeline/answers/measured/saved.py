"""The files of a calibrated arm: calibration.json, its law, its predictions, and a run.json for every other command."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.answers.measured.calibration import Calibration
from pipeline.answers.measured.gaussian import Effects, Gaussian, Spread
from pipeline.answers.measured.predicted import Setup
from pipeline.answers.measured.unknowns import MODULUS, Unknown
from pipeline.config.section import key_of
from pipeline.results.laws import law_record
from pipeline.results.unloaded import unloaded_states
from pipeline.store.atomic_file import write_atomic
from pipeline.store.provenance import provenance
from pipeline.store.result_folder import ResultFolder
from pipeline.values.errors import InputError
from pipeline.values.formats import BODY, FORMAT
from pipeline.values.json_values import JsonObject
from pipeline.values.record import Reported
from pipeline.values.run import Run
from rod.arm_law.moved import power_of_modulus

FILE = "calibration.json"
PREDICTION_COLUMNS = ("line", "pressure_kPa", "load", "quantity", "measured", "predicted", "low_90", "high_90")


@dataclass(frozen=True, eq=False)  # arrays inside
class SavedCalibration:
    """What `pneurod compare` needs of a calibration."""

    unknowns: tuple[Unknown, ...]
    setup: Setup
    posterior: Gaussian


def save_calibration(
    folder: ResultFolder, run: Run, file: Path, found: Calibration, remarks: Sequence[Reported]
) -> None:
    """Write everything of a calibrated arm. remarks: what the verdict says of it."""
    law = found.law
    pressures = run.given_between(law.pressures[0], law.pressures[-1]) or [law.pressures[-1]]
    folder.save_json(
        "law.json",
        {
            **law_record(law),
            "unloaded": [*map(asdict, unloaded_states(law, pressures))],
            "mesh_error": _scaled_error(run, found[MODULUS].mean),
        },
    )
    folder.save_json(FILE, record_of(run, file, found))
    rows = [
        (row.line, row.pressure_kPa, row.load, row.quantity, row.measured,
         row.predicted, row.predicted - row.allowed, row.predicted + row.allowed)
        for row in found.predictions
    ]  # fmt: skip
    folder.save_rows("predictions.csv", PREDICTION_COLUMNS, rows)
    config = calibrated_config(run.config, found)
    beside: JsonObject = {"mesh": None if run.mesh is None else asdict(run.mesh), "remarks": [*map(asdict, remarks)]}
    folder.save_json("run.json", {"format": FORMAT, "config": config, **provenance(), **beside})
    if (mesh := run.directory / BODY).is_file():
        write_atomic(folder.path(BODY), mesh.read_bytes())


def record_of(run: Run, file: Path, found: Calibration) -> JsonObject:
    """The content of calibration.json."""
    posterior = found.posterior
    return {
        "format": FORMAT,
        "results": str(run.directory),
        "measured": str(file),
        "numbers": len(found.predictions),
        "unknowns": [estimate.name for estimate in found.estimates],
        **{one.name: {key: value for key, value in asdict(one).items() if key != "name"} for one in found.estimates},
        "setup": asdict(found.setup),
        "correlation": posterior.correlation,
        "scatter": {f"{unit}_std": std for unit, std in posterior.spread.scatter.items()},
        "model_error_std": posterior.spread.model,
        "undetermined": list(found.undetermined),
        "notes": list(found.notes),
        "next_measurement": asdict(found.next_measurement),
        "posterior": {
            "stds_before": posterior.stds_before,
            "units": posterior.units,
            "by_unknown": posterior.effects.by_unknown,
            "by_model": posterior.effects.by_model,
            "pressures_kPa": posterior.effects.pressures,
            "reach_kPa": posterior.spread.reach_kPa,
        },
    }


def _scaled_error(run: Run, factor: float) -> JsonObject | None:
    """The errors of the mesh, of the arm with its factor of all moduli."""
    error = run.law and run.law.mesh_error
    if not error:
        return None

    def scaled(key: str, value: Any) -> Any:
        power = power_of_modulus(key.removesuffix("_std"))
        return [None if v is None else v * factor**power for v in value] if power else value

    return {key: scaled(key, value) for key, value in asdict(error).items()}


def calibrated_config(config: Mapping[str, Any], found: Calibration) -> JsonObject:
    """The configuration of the drawing, with dimensions and moduli of the calibrated arm."""
    changed: dict[str, Any] = json.loads(json.dumps(config, default=dict))
    values = {estimate.name: estimate.mean for estimate in found.estimates}
    values |= found.law.moduli
    for name, value in values.items():
        _write(changed, name, value)
    if found.rubber:
        changed["material"] = {**(changed.get("material") or {}), **found.rubber}
    return changed


def _write(part: Any, name: str, value: float) -> None:
    """Change a value of a part of a configuration, such as effects.hoops.threads.EA or mu.2, if it stands there."""
    first, _, rest = name.partition(".")
    keys = range(len(part)) if isinstance(part, list) else part or ()
    for key in [key for key in keys if first == (key_of(key) if isinstance(key, str) else str(key + 1))]:
        if rest:
            _write(part[key], rest, value)
        else:
            part[key] = value


def read_calibration(directory: Path) -> SavedCalibration | None:
    """The calibration of a folder; None where it is not one of a calibrated arm. Raises InputError."""
    path = directory / FILE
    if not path.is_file():
        return None
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        kept, names = content["posterior"], content["unknowns"]
        known = {name: Unknown(name=name, **content[name]) for name in names}
        unknowns = tuple(replace(one, drawn=1.0 if name == MODULUS else one.mean) for name, one in known.items())
        effects = Effects(*(np.array(kept[key], float) for key in ("by_unknown", "by_model", "pressures_kPa")))
        scatter = {key.removesuffix("_std"): float(std) for key, std in content["scatter"].items()}
        spread = Spread(scatter, float(content["model_error_std"]), float(kept["reach_kPa"]))
        residual, stds = np.zeros(len(effects.pressures)), np.array(kept["stds_before"], float)
        posterior = Gaussian(effects, residual, tuple(kept["units"]), np.zeros(len(names)), stds, spread)
        setup = Setup(**content["setup"])
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as failure:
        raise InputError(f"{path}: is not the calibration of an arm ({failure}); repeat pneurod calibrate") from None
    return SavedCalibration(unknowns, setup, posterior)
