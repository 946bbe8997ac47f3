"""Cost of naming a limit: factorizations of the states before it and of the search for it, in I, II and III.

    python benchmarks/limits.py [names of arms ...]

Arms of two chambers or short half discs on coarse meshes, each driven to a pressure that it does not bear. In the first
table every experiment searches for itself; the last column but two is the search over the mean of the states. The
second table is that of a run, in which I and III ask for the limit of II: at the same pressure, and at one 1.15 times
as large as that limit.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

# the rooms stand beside this folder
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import fem
from benchmarks.arguments import parser_of
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.context import RunContext
from pipeline.progress import Silent
from pipeline.simulation.loadcase import identification_case
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import simulate
from pipeline.store.store import open_store

CONFIGS = Path(__file__).resolve().parent.parent / "configs"
SHORT = ("geometry.chambers=2", "mesh.size=6 mm")
RUBBER = "material={law: neo_hooke, mu: 0.4 MPa, kappa: 40 MPa, density: 1130 kg/m^3}"
HENCKY = "material={law: hencky, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}"
YEOH = "material={law: yeoh, c10: 0.11 MPa, c20: 0.02 MPa, c30: 0 MPa, kappa: 22 MPa, density: 1130 kg/m^3}"
VACUUM = "effects.pressure={cavities: {cavity: -1}}"

#: pressure of the second table over the limit of II
NEAR = 1.15
#: configuration, settings, pressures in kPa, the last of which is beyond the limit
ARMS = {
    "pneunet": ("pneunet_coarse", SHORT, (17.0, 45.0, 90.0)),
    "pneunet, 11 chambers": ("pneunet_coarse", ("mesh.size=7 mm",), (17.0, 45.0, 90.0)),
    "pneunet, mixed": ("pneunet_coarse", (*SHORT, "mesh.formulation=mixed"), (17.0, 31.0, 90.0)),
    "pneunet of rubber": ("pneunet_coarse", (*SHORT, RUBBER), (17.0, 45.0, 150.0)),
    "pneunet of rubber, mixed": ("pneunet_coarse", (*SHORT, RUBBER, "mesh.formulation=mixed"), (17.0, 45.0, 150.0)),
    "semicircular": ("semicircular_coarse", SHORT, (20.0, 60.0, 150.0)),
    "half disc": ("semicircular_single_coarse", ("geometry.length=60 mm", "mesh.size=6 mm"), (20.0, 150.0)),
    "thin half disc, vacuum": (
        "semicircular_single_coarse",
        ("geometry.length=30 mm", "geometry.wall=0.6 mm", "mesh.size=6 mm", VACUUM),
        (0.5, 5.0),
    ),
    "pneunet of Hencky's law, 4 chambers": (
        "pneunet_coarse",
        ("geometry.chambers=4", "mesh.size=6 mm", "geometry.wall=1.4 mm", "geometry.side_wall=1.5 mm", HENCKY),
        (10.0, 25.0, 120.0),
    ),
    "pneunet of Yeoh's law, 3 chambers": (
        "pneunet_coarse",
        ("geometry.chambers=3", "mesh.size=6 mm", "geometry.roof=1 mm", YEOH),
        (5.0, 20.0, 100.0),
    ),
    "semicircular, 5 chambers, thin": (
        "semicircular_coarse",
        ("geometry.chambers=5", "mesh.size=5 mm", "geometry.wall=0.7 mm", "geometry.radius=9 mm"),
        (5.0, 15.0, 60.0),
    ),
    "pneunet, 6 chambers, walls of 1.5 mm": (
        "pneunet_coarse",
        ("geometry.chambers=6", "mesh.size=7 mm", "geometry.wall=1.5 mm"),
        (15.0, 40.0, 150.0),
    ),
    "half disc of Hencky's law, 1.5 mm": (
        "semicircular_single_coarse",
        ("geometry.length=40 mm", "mesh.size=6 mm", "geometry.wall=1.5 mm", HENCKY),
        (20.0, 40.0, 200.0),
    ),
    "two halves": ("bisected_circle_coarse", ("geometry.length=60 mm", "mesh.size=6 mm"), (20.0, 37.0, 150.0)),
}


def config_of(arm: str, pressures_kPa: Sequence[float]) -> Config:
    """The arm at these pressures."""
    name, settings, _ = ARMS[arm]
    return load_config(CONFIGS / f"{name}.yaml", [*settings, f"pressures=[{listed(pressures_kPa)}]"])


def listed(pressures_kPa: Sequence[float]) -> str:
    """Pressures with their unit."""
    return ", ".join(f"{pressure:g} kPa" for pressure in pressures_kPa)


def row(arm: str, experiment: str) -> str:
    """The line of the table."""
    pressures = ARMS[arm][2]
    config = config_of(arm, pressures)
    scene, case = Scene.meshed(config), identification_case(config, experiment)
    solved = fem.Experiment.of(experiment, scene.body, case.end.y_mm)
    model = solved.model(scene.material, scene.effects(case.schedule.reference_MPa), config.mesh.formulation)
    try:
        fem.follow(model, case.schedule.factors)
    except fem.NotConverged as ended:
        end, steps = ended.end, ended.partial.steps
    else:
        return f"| {arm} | {experiment} | solved at {listed(pressures)} |  |  |  |  |"
    counts = [step.factorizations for step in steps]
    states, times = ", ".join(map(str, counts)), end.factorizations * len(counts) / sum(counts)
    reached, limit = (case.schedule.pressure_at(factor) for factor in (end.reached, end.limit or float("nan")))
    return f"| {arm} | {experiment} | {states} | {end.factorizations} | {times:.1f} | {reached:.4g} | {limit:.4g} |"


def rows_of_run(arm: str) -> list[str]:
    """The lines of the second table: at the largest pressure of the arm, and at `NEAR` times the limit of II."""
    *solved, largest = ARMS[arm][2]
    outcomes = outcomes_of_run(config_of(arm, (*solved, largest)))
    limit = outcomes["II"].failure.limit_kPa if outcomes["II"].failure else 0.0
    lines = [line_of_run(arm, largest / limit, outcomes)] if limit else []
    near = NEAR * limit
    if solved and near > solved[-1]:
        lines.append(line_of_run(arm, NEAR, outcomes_of_run(config_of(arm, (*solved, near)))))
    return lines


def outcomes_of_run(config: Config) -> Outcomes:
    """I, II and III as in a run."""
    with TemporaryDirectory() as folder, open_store(Path(folder), config) as store:
        return simulate(Scene.meshed(config), RunContext.alone(store, Silent()))


def line_of_run(arm: str, over_limit: float, outcomes: Outcomes) -> str:
    """Factorizations of the states, those of each search, and all searches over the states at one pressure."""
    states = [record.summary.factorizations for record in outcomes.records]
    searches = [outcome.failure.factorizations if outcome.failure else 0 for outcome in outcomes]
    ratio = sum(searches) * len(states) / len(searches) / sum(states)
    each = ", ".join(map(str, searches))
    return f"| {arm} | {over_limit:.2f} | {sum(states)} | {each} | {ratio:.1f} |"


def main() -> None:
    """Print the tables."""
    parser = parser_of(__doc__)
    parser.add_argument("arms", nargs="*", metavar="ARM", help=f"of these: {'; '.join(ARMS)}")
    names = parser.parse_args().arms or list(ARMS)
    if unknown := [name for name in names if name not in ARMS]:
        parser.error(f"unknown: {', '.join(unknown)}; there are: {'; '.join(ARMS)}")
    print("| arm | experiment | of the states | of the search | over a state | last equilibrium kPa | limit kPa |")  # noqa: T201
    print("|---|---|---|---:|---:|---:|---:|")  # noqa: T201
    for arm in names:
        for experiment in ("I", "II", "III"):
            print(row(arm, experiment), flush=True)  # noqa: T201
    print("\n| arm | pressure over limit of II | of the states | of I, II, III | over the states at one pressure |")  # noqa: T201
    print("|---|---:|---:|---|---:|")  # noqa: T201
    for arm in names:
        for line in rows_of_run(arm):
            print(line, flush=True)  # noqa: T201


if __name__ == "__main__":
    main()
