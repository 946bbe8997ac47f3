"""Checks of the installation, and the one command that mends what is missing.

Each heavy library is checked in a process of its own, because one that misses a system library may end its process.
"""

import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from packaging.specifiers import SpecifierSet

import fem
import geometry
import rod
from pipeline.store.provenance import installed, required

#: seconds after which a check is given up: kernels compile in a minute, and in five on a busy machine
PATIENCE_S = 600


@dataclass(frozen=True)
class Finding:
    """The result of one check."""

    subject: str
    sound: bool
    result: str
    mends: str = ""  #: the command that mends it; empty where it is sound


def examine() -> list[Finding]:
    """Check everything pneurod needs: Python, packages, gmsh, pictures, linear solver, threads, disk.

    Without any package of the solver only what rods need is checked.
    """
    rods = required("")
    light = not any(installed(name) for name in required() if name not in rods)
    checked = [check(subject) for subject in (("rods",) if light else CHECKS)]
    return [_python(), *_packages(rods if light else required()), *([_LIGHT] if light else []), *checked, _disk()]


def remedy(findings: Sequence[Finding]) -> str:
    """The one command that mends everything, empty when nothing is wrong."""
    return " && ".join(dict.fromkeys(finding.mends for finding in findings if finding.mends))


def system_packages() -> list[str]:
    """The Debian packages whose libraries gmsh and VTK load."""
    return (Path(__file__).parent / "system_packages.txt").read_text(encoding="utf-8").split()


def _python() -> Finding:
    sound = sys.version_info >= (3, 11)
    return Finding("Python", sound, platform.python_version(), "" if sound else "apt-get install python3.11-venv")


_LIGHT = Finding(
    "solver", True, "not installed; rods of finished folders work, pip install 'pneurod[solve]' brings the rest"
)


def _packages(versions: Mapping[str, SpecifierSet]) -> list[Finding]:
    findings = []
    for name, allowed in versions.items():
        version = installed(name)
        sound = version is not None and version in allowed
        result = version if sound else f"{version or 'not installed'}, required {allowed}"
        findings.append(Finding(name, sound, str(result), "" if sound else _set_up()))
    return findings


def _set_up() -> str:
    """The command that installs the packages: of a clone of the sources, or of an installed package."""
    clone = (Path(__file__).resolve().parents[1] / "setup.sh").is_file()
    return "make setup" if clone else "pip install --upgrade 'pneurod[solve]'"


def check(subject: str) -> Finding:
    """Run one of `CHECKS` in a process of its own."""
    command = [sys.executable, "-m", "pipeline.doctor", subject]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    except subprocess.TimeoutExpired:
        said = f"no answer within {PATIENCE_S // 60} minutes: busy, so this is not known"
        return Finding(subject, True, said)
    if done.returncode == 0:
        return Finding(subject, True, done.stdout.strip())
    error = (done.stderr.strip().splitlines() or [f"ended by signal {-done.returncode}"])[-1]
    missing_library = "lib" in error and ".so" in error
    by_apt = missing_library or done.returncode < 0 or subject == "pictures"
    return Finding(subject, False, error, _apt() if by_apt else _set_up())


def _apt() -> str:
    packages = " ".join(system_packages())
    return f'sudo sh -c "apt-get update && apt-get install -y --no-install-recommends {packages}"'


def _disk() -> Finding:
    here = Path.cwd()
    try:
        with tempfile.TemporaryFile(dir=here):
            free = shutil.disk_usage(here).free / 1e9
    except OSError as failure:
        return Finding(
            "disk", False, f"{here} cannot be written: {failure.strerror}", "cd to a folder you may write to"
        )
    return Finding("disk", True, f"{here} can be written, {free:.0f} GB free")


def _check_gmsh() -> str:
    return f"meshes one chamber with {geometry.PneuNet(chambers=1).body(4.0).mesh.quality.count} tetrahedra"


def _check_pictures() -> str:
    from pipeline.show.drawing import draw_body

    body = geometry.PneuNet(chambers=1).body(4.0).mesh
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "chamber.png"
        draw_body(picture, body.points, body.tets)
        return f"drawn without a display, {picture.stat().st_size} bytes"


def _check_linear_solver() -> str:
    import numpy as np

    from fem.equations.pardiso import available_solver

    solver = available_solver()()
    solver.analyse(np.array([0, 2, 3]), np.array([0, 1, 1]))
    solver.factorize(np.array([2.0, 1.0, -3.0]))
    solution = solver.solve(np.array([3.0, -2.0]))
    solver.close()
    if not np.allclose(solution, [1.0, 1.0]):
        raise ArithmeticError(f"{type(solver).__name__} solves 2 x 2 equations wrongly")
    slower = "" if type(solver).__name__ == "Pardiso" else ", the slower one; PARDISO has no package for this machine"
    return f"{type(solver).__name__}{slower}"


def _check_threads() -> str:
    import numba

    for law in (fem.NeoHooke(0.4, 20.0), fem.Hencky(1.2, 0.495)):  # they have all the kernels of the laws between them
        fem.compile_kernels("mixed", law)
    return f"numba runs {numba.get_num_threads()} threads on {numba.threading_layer()}"


def _check_rods() -> str:
    rod.compile_kernels()
    return "the solvers of rods, with five parameters and with the arm's own law, are compiled"


CHECKS: dict[str, Callable[[], str]] = {
    "gmsh": _check_gmsh,
    "pictures": _check_pictures,
    "linear solver": _check_linear_solver,
    "threads": _check_threads,
    "rods": _check_rods,
}

if __name__ == "__main__":
    sys.stdout.write(CHECKS[sys.argv[1]]() + "\n")
