"""Solution of one case as by `pneurod run`, from its configuration to its states, and its line of the table."""

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fem.cell.piece import PieceFailed
from geometry import Body, Mesh
from geometry.topology import EDGES, OUTWARD, normals
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.simulate.loadcase import LoadCase, schedule
from pipeline.simulate.outcome import Outcome
from pipeline.simulate.scene import Scene as MeshedScene
from pipeline.simulate.simulate import simulate
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.reasons import render_all
from rod import RodError
from tests.hard_cases.cases import CONFIGS, Check, HardCase, Scene
from tests.hard_cases.rods import fallen
from tests.hard_cases.tubes import TUBES, air_of
from tests.solved import alone


@dataclass(frozen=True)
class Line:
    """The outcome of a case, a line of the table."""

    case: HardCase
    reason: str  #: why it was not solved; empty if it was
    error: float  #: difference from the result of the check; NaN without a check
    steps: int
    cutbacks: int
    factorizations: int
    min_J: float
    min_stretch: float
    max_stretch: float
    aspect: float

    @property
    def as_expected(self) -> bool:
        """True if the case was solved and agrees with its check, or its reason names the expected limit."""
        if self.aspect < self.case.aspect:
            return False
        if self.case.limit:
            return self.case.limit in self.reason
        return not self.reason and self.case.check is not None and self.error <= self.case.check.within


@dataclass(frozen=True)
class Solved:
    """A scene and its outcome."""

    config: Config
    body: Body
    outcome: Outcome


class Refused(Exception):
    """A scene that is refused before anything is solved."""


def line_of(case: HardCase) -> Line:
    """Solve a case and its twin."""
    if case.rod is not None:
        return _line_of_rod(case, *case.rod)
    try:
        solved = solve(case.scene)
    except Refused as refused:
        return Line(case, str(refused), np.nan, 0, 0, 0, np.nan, np.nan, np.nan, np.inf)
    outcome, states = solved.outcome, [record.state for record in solved.outcome.records]
    failure = outcome.failure
    error, reason = np.nan, render_all(failure.reasons) if failure else ""
    if case.limit and not reason:
        reason = "; ".join(record.state.reason for record in outcome.records if record.instability)
    if case.check is not None and not reason:
        error, reason = _error(case.check, solved)
    return Line(
        case,
        reason,
        error,
        len(states),
        sum(state.cutbacks for state in states) + (failure.cutbacks if failure else 0),
        outcome.factorizations + (failure.factorizations if failure else 0),
        min((state.min_J for state in states), default=np.nan),
        min((state.min_stretch for state in states), default=np.nan),
        max((state.max_stretch for state in states), default=np.nan),
        _largest_aspect_ratio(solved.body.mesh),
    )


def _line_of_rod(case: HardCase, name: str, part: float) -> Line:
    """Of a rod or a tube beyond its limit."""
    none, check, steps = (0, 0, np.nan, np.nan, np.nan, np.inf), case.check, 0
    try:
        if name in TUBES:
            found = np.atleast_1d(air_of(name, part))
        else:
            shape, found = fallen(name, part, check.of if check else "end")
            steps = shape.load_steps
    except (PieceFailed, RodError) as refused:
        return Line(case, str(refused), np.nan, 0, *none)
    error = float(np.abs(found - check.value).max() / found.max()) if check else np.nan
    return Line(case, "", error, steps, *none)


def _largest_aspect_ratio(mesh: Mesh) -> float:
    """Largest ratio of the longest edge to the smallest height of one tetrahedron (1.22 when regular)."""
    corners = mesh.points[mesh.tets]
    edges = np.linalg.norm(corners[:, EDGES[:, 0]] - corners[:, EDGES[:, 1]], axis=2).max(axis=1)
    areas = np.linalg.norm(normals(corners[:, OUTWARD].reshape(-1, 3, 3)), axis=1).reshape(-1, 4) / 2
    return float((edges * areas.max(axis=1) / (3 * mesh.volumes)).max())


def solve(scene: Scene) -> Solved:
    """Solve the scene. Raises `Refused` with the sentence that a user would get."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            config, body = _configured(scene, Path(folder))
            at_end = replace(config.end, force_N=scene.force)
            case = LoadCase("hard", scene.experiment, schedule(config, scene.pressures), at_end)
            with alone(Path(folder) / "out", config) as context:
                outcome = simulate(MeshedScene(config, body), context, [case])["hard"]
        except (InputError, RunFailed) as refused:
            raise Refused(str(refused)) from None
    return Solved(config, body, outcome)


def _configured(scene: Scene, folder: Path) -> tuple[Config, Body]:
    """The configuration and the body; an own mesh stands beside a configuration that names it."""
    pressures = sorted({f"{pressure:g} kPa" for pressure in scene.pressures}, key=lambda text: float(text.split()[0]))
    settings = [*scene.settings, f"pressures=[{', '.join(pressures)}]"]
    config = load_config(CONFIGS / f"{scene.config}.yaml", settings)
    body = MeshedScene.meshed(config).body
    if not scene.as_own_mesh:
        return config, body
    body.mesh.write(folder / "body.msh")
    design = config.design
    geometry = f"{{family: own, file: body.msh, curve: {design.curve_y} mm, cell: {design.pitch} mm}}"
    (folder / "own.yaml").write_text(
        "name: own_mesh\n"
        f"geometry: {geometry}\n"
        "material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}\n"
        "mesh: {formulation: p2p0}\n",
        encoding="utf-8",
    )
    config = load_config(
        folder / "own.yaml", [setting for setting in settings if not setting.startswith(("geometry.", "mesh."))]
    )
    return config, MeshedScene.meshed(config).body


def _error(check: Check, solved: Solved) -> tuple[float, str]:
    """The difference from what the check is against, and why there is none."""
    value = _quantity(check.of, solved)
    if check.value is not None:
        return _difference(check.of, value, np.array([check.value]), solved), ""
    assert check.twin is not None
    twin = solve(check.twin)
    if twin.outcome.failure:
        return np.nan, f"the twin was not solved: {render_all(twin.outcome.failure.reasons)}"
    return _difference(check.of, value, check.times * _quantity(check.of, twin), solved), ""


def _quantity(of: str, solved: Solved) -> np.ndarray:
    state = solved.outcome.records[-1].state
    quantities: dict[str, float | tuple[float, float]] = {
        "end": state.end_mm,
        "force": state.reaction_N,
        "clamp": state.clamp_reaction_N,
        "volume": state.cavity_volume_mm3,
        "stretch": state.stretch_of_curve,
    }
    return np.atleast_1d(quantities[of])


def _difference(of: str, value: np.ndarray, other: np.ndarray, solved: Solved) -> float:
    scale = solved.body.length if of == "end" else float(np.abs(other).max())
    return float(np.abs(value - other).max() / scale)
