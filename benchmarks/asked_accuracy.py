"""Accuracy asked for designs that the rule was not made with: chosen, believed before and after, and true.

    python benchmarks/asked_accuracy.py RESULTS

Each design is run with `--accuracy`, and again on two finer meshes (FINER times the chosen size), to which the limit is
extrapolated over the degrees of freedom as in `pneurod accuracy`. Renews the table of docs/accuracy.md between its
marks; finished runs and meshes in RESULTS are kept. Three quarters of an hour with one thread.
"""

import json
import re
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time
from typing import Any

# beside this file stands another with the name of a room; the room must be found, not the file
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

import numpy as np  # noqa: E402

from pipeline.accuracy.ladder import Rung, mesh_choice  # noqa: E402
from pipeline.accuracy.measure import measure  # noqa: E402
from pipeline.accuracy.reference import HEADLINE  # noqa: E402
from pipeline.config.config import Config, load_config  # noqa: E402
from pipeline.progress import Silent  # noqa: E402
from pipeline.richardson import extrapolated  # noqa: E402
from pipeline.run import run  # noqa: E402
from pipeline.store.atomic_file import write_whole  # noqa: E402

DOCS = HERE / "docs" / "accuracy.md"
MARKS = "<!-- asked-accuracy -->", "<!-- end of asked-accuracy -->"
#: sizes of the meshes of the reference over the chosen one
FINER = (0.8, 0.6)
ROUND, GAPPED = "20 kPa", "5 kPa"  #: the walls of the gapped arm do not touch at 5 kPa


@dataclass(frozen=True)
class Asked:
    """A design and the accuracy asked for it."""

    name: str
    words: str
    base: str  #: the file in configs it differs from
    settings: tuple[str, ...]
    percent: float

    @property
    def config(self) -> Config:
        """As `pneurod run --set mesh.size=auto --accuracy` has it."""
        settings = [*self.settings, "mesh.size=auto", f"accuracy={self.percent:g} %"]
        return load_config(HERE / "configs" / f"{self.base}.yaml", settings)


def asked(name: str, words: str, base: str, percent: float, pressures: str, /, **dimensions: str) -> Asked:
    """A design by the dimensions in which it differs from its base."""
    settings = [f"geometry.{key}={value}" for key, value in dimensions.items()]
    return Asked(name, f"{words}, {pressures}", base, (f"pressures=[{pressures}]", *settings), percent)


BISECTED, SEMI, SINGLE, PNEU = (
    f"{name}_coarse" for name in ("bisected_circle", "semicircular", "semicircular_single", "pneunet")
)
DESIGNS = (
    asked(
        *("bisected_92", "bisected circle, l = 92, wall 1.5, divider 2 mm", BISECTED, 2.0, ROUND),
        length="92 mm",
        wall="1.5 mm",
        divider="2 mm",
    ),
    asked(
        *("bisected_90", "bisected circle, l = 90, radius 9, wall 1.2 mm", BISECTED, 3.0, ROUND),
        length="90 mm",
        radius="9 mm",
        wall="1.2 mm",
    ),
    asked(
        *("semicircular_9", "semicircular, 9 chambers, radius 8, wall 1.3 mm", SEMI, 5.0, ROUND),
        chambers="9",
        radius="8 mm",
        wall="1.3 mm",
    ),
    asked("semicircular_7", "semicircular, 7 chambers", SEMI, 5.0, "20 kPa, 30 kPa", chambers="7"),
    asked("single_9", "semicircular, one cavity, radius 9 mm", SINGLE, 3.0, ROUND, radius="9 mm"),
    asked(
        *("semicircular_8", "semicircular, 8 chambers, radius 7, base 3 mm", SEMI, 5.0, ROUND),
        chambers="8",
        radius="7 mm",
        base="3 mm",
    ),
    asked(
        *("single_6", "semicircular, one cavity, radius 6.5, wall 1.3 mm", SINGLE, 5.0, "37 kPa"),  # straight at 20
        radius="6.5 mm",
        wall="1.3 mm",
    ),
    asked("gapped_8", "gapped, 8 chambers", PNEU, 5.0, GAPPED, chambers="8"),
    asked("gapped_7", "gapped, 7 chambers, wall 1.4 mm", PNEU, 5.0, GAPPED, chambers="7", wall="1.4 mm"),
)


def solved(one: Asked, folder: Path) -> dict[str, Any]:
    """What the run chose and believed, what it found at every pressure, and its CPU seconds; kept in `folder`."""
    file = folder / "asked.json"
    if not file.is_file():
        begin = process_time()
        with tempfile.TemporaryDirectory() as out:
            run(one.config, Path(out), 1, True, Silent())
            record, parameters, rows = (
                json.loads((Path(out) / f"{name}.json").read_text(encoding="utf-8"))
                for name in ("run", "parameters", "experiments")
            )
        half, profile = parameters["length_mm"] / 2, parameters["kappa_0"]
        forces = {row["pressure_kPa"]: row["reaction_N"][1] for row in rows if row["experiment"] == "III"}
        numbers = [
            {
                "kappa_0_per_mm": float(np.interp(half, profile["cell_s_mm"], kappa)),
                "alpha2_N_mm2": alpha,
                "force_N": forces[pressure],
            }
            for pressure, kappa, alpha in zip(
                *(parameters["pressures_kPa"], profile["cell_averaged_per_mm"], parameters["alpha2_N_mm2"]),
                strict=True,
            )
        ]
        found = {
            "accuracy": record["accuracy"],
            "degrees_of_freedom": max(record["degrees_of_freedom"].values()),
            "numbers": numbers,
            "cpu_seconds": process_time() - begin,
        }
        write_whole(file, json.dumps(found, indent=2).encode())
    return json.loads(file.read_text(encoding="utf-8"))


def finer(one: Asked, accuracy: Mapping[str, Any], share: float, folder: Path) -> dict[str, Any]:
    """The same numbers on a mesh `share` times as coarse as the chosen one; kept in `folder`."""
    size = share * accuracy["size_mm"]
    file = folder / f"{size:.4g}mm.json"
    if not file.is_file():
        config = one.config
        mesh = replace(config.mesh, size_mm=size, formulation=accuracy["formulation"], grading=accuracy["grading"])
        config = replace(
            config,
            mesh=mesh,
            newton_tolerance=accuracy["newton_tolerance"],
            contact_dhat_mm=accuracy["contact_dhat_mm"],
        )
        found = measure(Rung(mesh_choice(config), size, config))
        if found["failure"]:
            raise RuntimeError(f"{one.name}, mesh of {size:.3g} mm: {found['failure']}")
        write_whole(file, json.dumps(found, indent=2).encode())
    return json.loads(file.read_text(encoding="utf-8"))


@dataclass(frozen=True)
class TrueError:
    """What a number has wrong at the pressure where that is most; relative."""

    to_limit: float
    std: float  #: of the limit
    to_finest: float

    def __str__(self) -> str:
        return f"{100 * self.to_limit:+.1f} ± {100 * self.std:.1f} ({100 * self.to_finest:+.1f})"


def true_errors(found: Mapping[str, Any], references: Sequence[Mapping[str, Any]]) -> list[TrueError]:
    """Of kappa_0(l/2), alpha2 and F."""
    meshes = [found, *references]
    sizes = [mesh["degrees_of_freedom"] ** (-1 / 3) for mesh in meshes]
    errors = []
    for key in HEADLINE:
        each = []
        for place in range(len(found["numbers"])):
            values = [mesh["numbers"][place][key] for mesh in meshes]
            end = extrapolated(sizes, values)
            to_limit, std = values[0] / end.limit - 1.0, abs(end.limit_std / end.limit)
            each.append(TrueError(to_limit, std, values[0] / values[-1] - 1.0))
        errors.append(max(each, key=lambda one: abs(one.to_limit)))
    return errors


def row(one: Asked, found: Mapping[str, Any], errors: Sequence[TrueError]) -> str:
    """A line of the table."""
    accuracy = found["accuracy"]
    after = accuracy["after"]
    before, later = (
        " / ".join(f"{100 * known['believed'][key]:.1f}" for key in HEADLINE) for known in (accuracy, after)
    )
    true = " / ".join(map(str, errors))
    cells = (
        *(
            one.words,
            f"{one.percent:g}",
            f"{accuracy['size_mm']:g}",
            f"{found['degrees_of_freedom']:,}".replace(",", " "),
        ),
        *(f"{accuracy['order']:.1f}", before, later, true, f"{100 * after['identification']:.2g}"),
        f"{found['cpu_seconds']:.0f}",
    )
    return f"| {' | '.join(cells)} |"


TITLES = (
    *("design", "asked %", "size mm", "degrees of freedom", "order", "believed before %", "believed after %"),
    *("true %", "α₂ known to ± %", "CPU s"),
)


def main(results: Path) -> None:
    """Run what is missing and write the table."""
    lines = [f"| {' | '.join(TITLES)} |", "|---|---:|---:|---:|---:|---|---|---|---:|---:|"]
    for one in DESIGNS:
        folder = results / one.name
        folder.mkdir(parents=True, exist_ok=True)
        found = solved(one, folder)
        references = [finer(one, found["accuracy"], share, folder) for share in FINER]
        lines.append(row(one, found, true_errors(found, references)))
        sys.stdout.write(lines[-1] + "\n")
        sys.stdout.flush()
    begin, end = MARKS
    table = "\n".join([begin, "", *lines, "", end])
    text = DOCS.read_text(encoding="utf-8")
    DOCS.write_text(re.sub(f"{begin}.*?{end}", lambda _: table, text, flags=re.DOTALL), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
