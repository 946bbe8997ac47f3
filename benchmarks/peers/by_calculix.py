"""CalculiX: an input deck with one step per pressure, its automatic increments, SPOOLES.

    python -m benchmarks.peers.by_calculix four out.json

Needs `ccx` (Debian: apt-get install calculix-ccx). *ELASTIC with NLGEOM is St. Venant-Kirchhoff's law there, C3D10
has four points, and *DLOAD P follows the surface; docs/peers.md compares the results.
"""

import os
import re
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from benchmarks.peers.problem import KPA, NU, TOLERANCE, Body, E, PathResult, report

#: first and largest increment as shares of a step, and how often a step is cut before CalculiX gives up
FIRST, LARGEST, MOST = 0.2, 1.0, 2000
#: corners of the faces P1 to P4 of a C3D10
FACES = np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])


def deck(body: Body, pressures: Sequence[float], first: float = FIRST, largest: float = LARGEST) -> Iterator[str]:
    """Lines of the input deck; forces are relative to their average, the first and the fifth number of FIELD."""
    yield "*NODE,NSET=ALL"
    yield from (f"{number},{x:.15g},{y:.15g},{z:.15g}" for number, (x, y, z) in enumerate(body.points, start=1))
    yield "*ELEMENT,TYPE=C3D10,ELSET=BODY"
    yield from (f"{number}," + ",".join(map(str, nodes + 1)) for number, nodes in enumerate(body.cells, start=1))
    for name in ("clamp", "sym"):
        yield f"*NSET,NSET={name.upper()}"
        yield from (f"{node + 1}," for node in body.nodes(name))
    yield from ("*BOUNDARY", "CLAMP,1,3", "SYM,3,3")
    yield from ("*MATERIAL,NAME=RUBBER", "*ELASTIC", f"{E},{NU}", "*SOLID SECTION,ELSET=BODY,MATERIAL=RUBBER")
    cavity = {tuple(sorted(face)) for face in body.mesh.faces["cavity"].tolist()}
    for pressure in pressures:
        yield from (f"*STEP,NLGEOM,INC={MOST}", "*STATIC", f"{first},1.,1e-6,{largest}")
        yield from ("*CONTROLS,PARAMETERS=FIELD", f"{TOLERANCE},0.01,,,{TOLERANCE}", "*DLOAD")
        for element, corners in enumerate(body.mesh.tets, start=1):
            for face, nodes in enumerate(corners[FACES], start=1):
                if tuple(sorted(nodes.tolist())) in cavity:
                    yield f"{element},P{face},{pressure * KPA}"
        yield from (f"*NODE PRINT,NSET=ALL,FREQUENCY={MOST}", "U", "*END STEP")


def displacements(printed: str) -> list[np.ndarray]:
    """(n, 3) displacements at the end of every step, from the .dat file, mm."""
    blocks = re.split(r"displacements.*\n", printed)[1:]
    return [
        np.array([line.split()[1:] for line in block.splitlines() if line.strip()], dtype=float) for block in blocks
    ]


def results_in(folder: Path, name: str, body: Body, pressures: Sequence[float]) -> PathResult:
    """Answers from the .dat file, increments from .sta (a U marks attempts that failed), iterations from .cvg."""
    fields = displacements((folder / f"{name}.dat").read_text())
    attempts = re.findall(r"^ +\d+ +\d+ +\d+(U?) ", (folder / f"{name}.sta").read_text(), re.MULTILINE)
    iterations = re.findall(r"^ +\d+ +\d+ +\d+ +\d+ ", (folder / f"{name}.cvg").read_text(), re.MULTILINE)
    note = "" if len(fields) == len(pressures) else "CalculiX gave up"
    answers = {pressure: body.answer(field) for pressure, field in zip(pressures, fields, strict=False)}
    return PathResult(answers, attempts.count(""), attempts.count("U"), len(iterations), note)


def set_up() -> Callable[[Sequence[float]], PathResult]:
    body = Body.read()
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}

    def walk(pressures: Sequence[float]) -> PathResult:
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "arm.inp").write_text("\n".join(deck(body, pressures)) + "\n")
            with Path(folder, "arm.log").open("w") as log:
                subprocess.run(["ccx", "arm"], cwd=folder, env=environment, stdout=log, stderr=log, check=False)
            return results_in(Path(folder), "arm", body, pressures)

    return walk


def release() -> str:
    """What `ccx -v` says."""
    output = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    return f"CalculiX {re.findall(r'[0-9.]+', output)[0]}"


if __name__ == "__main__":
    report(release(), "SPOOLES", set_up)
