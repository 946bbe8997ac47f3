"""Cost of naming a limit: factorizations of the states before it and of the search for it, in I, II and III.

    python benchmarks/limits.py [names of arms ...]

Arms of two chambers or short half discs on coarse meshes, each driven to a pressure that it does not bear. Every
experiment searches for itself here; in `pneurod run` I and III stop far beyond the limit of II. The last column but
two is the search over the mean of the states.
"""

import sys
from pathlib import Path

import fem
from pipeline.config.load import load_config
from pipeline.simulation.loadcase import identification_case
from pipeline.simulation.scene import Scene

CONFIGS = Path(__file__).resolve().parent.parent / "configs"
SHORT = ("geometry.chambers=2", "mesh.size=6 mm")
RUBBER = "material={law: neo_hooke, mu: 0.4 MPa, kappa: 40 MPa, density: 1130 kg/m^3}"
HENCKY = "material={law: hencky, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}"
YEOH = "material={law: yeoh, c10: 0.11 MPa, c20: 0.02 MPa, c30: 0 MPa, kappa: 22 MPa, density: 1130 kg/m^3}"
VACUUM = "effects.pressure={cavities: {cavity: -1}}"

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


def row(arm: str, experiment: str) -> str:
    """The line of the table."""
    name, settings, pressures = ARMS[arm]
    listed = ", ".join(f"{pressure:g} kPa" for pressure in pressures)
    config = load_config(CONFIGS / f"{name}.yaml", [*settings, f"pressures=[{listed}]"])
    scene, case = Scene.meshed(config), identification_case(config, experiment)
    solved = fem.Experiment.of(experiment, scene.body, case.end.y_mm)
    model = solved.model(scene.material, scene.effects(case.schedule.reference_MPa), config.mesh.formulation)
    try:
        fem.follow(model, case.schedule.factors)
    except fem.NotConverged as ended:
        end, steps = ended.end, ended.partial.steps
    else:
        return f"| {arm} | {experiment} | solved at {listed} |  |  |  |  |"
    counts = [step.factorizations for step in steps]
    states, times = ", ".join(map(str, counts)), end.factorizations * len(counts) / sum(counts)
    reached, limit = (case.schedule.pressure_at(factor) for factor in (end.reached, end.limit or float("nan")))
    return f"| {arm} | {experiment} | {states} | {end.factorizations} | {times:.1f} | {reached:.4g} | {limit:.4g} |"


def main() -> None:
    """Print the table."""
    print("| arm | experiment | of the states | of the search | over a state | last equilibrium kPa | limit kPa |")  # noqa: T201
    print("|---|---|---|---:|---:|---:|---:|")  # noqa: T201
    for arm in sys.argv[1:] or ARMS:
        for experiment in ("I", "II", "III"):
            print(row(arm, experiment), flush=True)  # noqa: T201


if __name__ == "__main__":
    main()
