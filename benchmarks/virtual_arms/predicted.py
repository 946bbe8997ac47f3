"""What a calibrated drawing foretells of an arm as built, beside what is true."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.foretold import foretell
from benchmarks.virtual_arms.bench import WHAT, write_measured, write_true
from benchmarks.virtual_arms.designs import VirtualArm
from benchmarks.virtual_arms.law import folder_of_law
from benchmarks.virtual_arms.measured import Measurement
from pipeline.answers.measured.table import read_measurements
from pipeline.config.load import load_config
from pipeline.law.piece.pieces import NoArmLaw
from pipeline.results.files import read_plane_law
from pipeline.values.errors import InputError

FILE = "predicted.json"


@dataclass(frozen=True)
class Prediction:
    """One state of an arm."""

    what: str  #: of `WHAT`
    before: float  #: error of the drawing: distance over the length, or part of the force; NaN where it says nothing
    after: float  #: the same of the calibrated arm
    levels: tuple[float, ...]  #: stated probabilities of the smallest intervals that hold the true numbers


@dataclass(frozen=True)
class Judged:
    """An arm and its predictions."""

    arm: str
    family: str
    laws: tuple[str, str]  #: of drawing and arm as built
    stiffness: tuple[float, float]  #: true and found factor of all moduli
    predictions: tuple[Prediction, ...]  #: empty where the arm could not be calibrated
    failure: str = ""  #: why not


def judged(arm: VirtualArm, measurement: Measurement, folder: Path, loaded: bool = False) -> Judged:
    """Calibrate the law of the drawing to the arm, and compare its predictions.

    Files go to `folder`, the law beside it. loaded: the tip under the dead force is measured as well.
    """
    files = folder / "measured.csv", folder / "true.csv"
    write_measured(arm, measurement, files[0], loaded)
    write_true(arm, measurement, files[1])
    laws = str(arm.drawing["material"]["law"]), str(arm.built["material"]["law"])
    found, predictions, failure = float("nan"), tuple[Prediction, ...](), ""
    try:
        found, predictions = _predictions(folder_of_law(arm, folder.parent), *files)
    except (InputError, NoArmLaw) as refused:
        failure = str(refused)
    result = Judged(arm.name, arm.family, laws, (arm.stiffness, found), predictions, failure)
    (folder / FILE).write_text(json.dumps(asdict(result), indent=1) + "\n", encoding="utf-8")
    return result


def _predictions(law: Path, measured: Path, true: Path) -> tuple[float, tuple[Prediction, ...]]:
    """The factor of all moduli, and the predictions."""
    config = load_config(law.with_suffix(".yaml")).record()
    known, others = read_measurements(measured), read_measurements(true)
    foretold = foretell(read_plane_law(law / "law.json"), config, known, others)
    predictions = []
    for what, row in zip(WHAT, others.rows, strict=True):
        levels = tuple(float(foretold.levels[k]) for k in foretold.of(row.line))
        predictions.append(Prediction(what, *foretold.errors(row.line), levels))
    return foretold.modulus, tuple(predictions)
