"""What the steps of a run are expected to take, for the time that is left of it."""

from collections import defaultdict
from collections.abc import Mapping, Sequence

from pipeline.config.config import Config
from pipeline.law.build import PRESSURES
from pipeline.law.meshes import MESHES
from pipeline.simulate.loadcase import identification_case, validation_cases
from pipeline.simulate.simulate import experiments_of

#: s for a pressure of the coarse arm with gaps, by what is told of it
LAW = {"cell": 2.0, "clamped end": 3.0, "tip": 0.2}
EXPERIMENT = 5.0
#: s on the first of the finer meshes of the cell, times as long on each of the next; the last has the highest pressure
FINER, GROWTH = 0.5, 1.7
#: s of what is not told in steps, above all the pictures
REST = 8.0


def expected_of(config: Config) -> Mapping[str, Sequence[float]]:
    """Expected seconds by the names under which steps are told; those that a run adds are not known before."""
    steps, given = defaultdict[str, list[float]](list), config.pressures_kPa
    pressures = [] if config.law == "five" else [{0.0, *given}]
    if not config.is_law_alone:
        if config.accuracy is not None and pressures:
            pressures.append({0.0, *given, *config.validation.pressures_kPa})  # on the mesh of the whole arm
        of_run = [identification_case(config, name) for name in experiments_of(config)]
        for case in (*of_run, *validation_cases(config)):
            steps[case.name] += [EXPERIMENT] * len(case.schedule.pressures_kPa)
        steps["rest"] = [REST]
    for one in pressures:
        for name, effort in LAW.items():
            steps[name] += [effort] * len(one)
    for rung in range(MESHES) if pressures and not config.draft else ():
        steps["cell, mesh"] += [FINER * GROWTH**rung] * (1 + min(len(given), PRESSURES) * (rung < MESHES - 1))
    return steps
