"""The numbers of the coarse arm, kept from an earlier version, and a comparison of a run with them.

    pneurod run configs/pneunet_coarse.yaml --accuracy off --jobs 1 --out DIR
    python -m tests.golden DIR             # exit status 1 and a line for every number that differs
    python -m tests.golden --accept DIR    # keep DIR's numbers; refused where a number that was kept has changed

Texts and times are left out. On the processor and number of cores that the numbers were made with they agree to 1e-12.
Elsewhere the linear algebra rounds differently, and the solver's own tolerance decides.
"""

import argparse
import csv
import gzip
import json
import math
import os
import platform
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

KEPT = Path(__file__).resolve().parent / "data" / "golden.json.gz"
FILES = ("parameters.json", "experiments.json", "validation.json", "effects.json", "law.json", "run.json")
TABLES = ("curves.csv", "validation_curves.csv")
#: what differs from run to run or from machine to machine although nothing else was computed,
#: and derivatives by differences, whose last digits are rounding
LEFT_OUT = (
    "derivatives",
    "seconds",
    "solver_seconds",
    "share_of_time",
    "versions",
    "packages",
    "machine",
    "cores",
    "memory_GB",
)
#: what rounding decides: how many steps the solver took, and where a largest value is that several places share
ROUNDED = ("newton_iterations", "factorizations", "cutbacks", "at_mm", "at_s_mm")
#: relative tolerance on the same processor, and on another one: Newton's iteration ends at 1e-8 of the forces
SAME, OTHER = 1e-12, 1e-5
#: settings that make this processor calculate as another one (`make portable`)
ARITHMETIC = ("NUMBA_CPU_NAME", "MKL_CBWR", "OPENBLAS_CORETYPE")
#: differences between meshes, of which about two digits cancel
CANCELLED, DIGITS_LEFT = "/mesh_error/", 1e2
#: largest size of numbers that are zero but for rounding
ROUNDING = 1e-14


def numbers_of(directory: Path) -> dict[str, float]:
    """All numbers in the result files of a run, by file and position."""
    found: dict[str, float] = {}
    for name in filter(lambda name: (directory / name).is_file(), FILES):
        content = json.loads((directory / name).read_text(encoding="utf-8"))
        found.update((f"{name}{path}", value) for path, value in _numbers(content, ""))
    for name in filter(lambda name: (directory / name).is_file(), TABLES):
        with (directory / name).open(encoding="utf-8", newline="") as file:
            for index, row in enumerate(csv.DictReader(file)):
                found.update((f"{name}/{key}/{index}", float(text)) for key, text in row.items() if _is_number(text))
    return found


def _numbers(content: Any, path: str) -> Iterator[tuple[str, float]]:
    if isinstance(content, dict):
        for key, value in content.items():
            if key not in LEFT_OUT:
                yield from _numbers(value, f"{path}/{key}")
    elif isinstance(content, list):
        for index, value in enumerate(content):
            yield from _numbers(value, f"{path}/{index}")
    elif isinstance(content, int | float):
        yield path, float(content)


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def processor() -> str:
    """The kind of processor and the number of cores, which decide how the linear algebra rounds, and what is set."""
    return ", ".join([_machine(), *(f"{name}={os.environ[name]}" for name in ARITHMETIC if name in os.environ)])


def _machine() -> str:
    if sys.platform != "linux":
        return f"{platform.system()} {platform.processor()}, {os.cpu_count()} cores"
    lines = [line.partition(":") for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()]
    words = {name.strip(): value.strip() for name, _, value in lines}
    kind = ", ".join(words.get(name, "") for name in ("model name", "cpu family", "model", "stepping"))
    return f"{kind}, {len(os.sched_getaffinity(0))} cores"


def differences(kept: dict[str, float], found: dict[str, float], tolerance: float) -> list[str]:
    """A line for every number that both have and that differs by more than `tolerance` of the largest of its list."""
    sizes: dict[str, float] = {}
    for path, value in kept.items():
        sizes[_list_of(path)] = max(sizes.get(_list_of(path), 0.0), abs(value))
    return [
        f"{path}: {kept[path]!r} was kept, {found[path]!r} was found"
        for path in kept.keys() & found.keys()
        if abs(found[path] - kept[path]) > max(_tolerance(path, tolerance) * sizes[_list_of(path)], ROUNDING)
    ]


def _tolerance(path: str, tolerance: float) -> float:
    return DIGITS_LEFT * tolerance if CANCELLED in path else tolerance


def _is_rounded(path: str) -> bool:
    return any(part.endswith(ROUNDED) for part in path.split("/"))


def _list_of(path: str) -> str:
    """The path without the positions in lists: numbers of one kind have one size."""
    return "/".join(part for part in path.split("/") if not part.isdigit())


def main() -> int:
    """The exit status: 0 where the numbers agree."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=Path)
    parser.add_argument("--accept", action="store_true")
    options = parser.parse_args()
    found = numbers_of(options.directory)
    if options.accept and not KEPT.exists():
        return _keep(found)
    kept = json.loads(gzip.decompress(KEPT.read_bytes()))
    same = kept["processor"] == processor()
    numbers = kept["numbers"]
    if not same:
        numbers, found = ({path: v for path, v in n.items() if not _is_rounded(path)} for n in (numbers, found))
    changed = differences(numbers, found, SAME if same else OTHER)
    missing, new = numbers.keys() - found.keys(), found.keys() - numbers.keys()
    if options.accept and not changed:
        return _keep(found)
    lines = [*changed, *(f"{path} is missing" for path in missing), *(f"{path} is new" for path in new)]
    count = f"{len(found)} numbers, {len(changed)} differ, {len(missing)} missing, {len(new)} new"
    summary = f"{count} ({'same' if same else 'another'} processor)"
    sys.stdout.write("\n".join([*sorted(lines)[:60], summary, ""]))
    return 1 if lines else 0


def _keep(found: dict[str, float]) -> int:
    content = json.dumps({"processor": processor(), "numbers": found})
    KEPT.write_bytes(gzip.compress(content.encode(), mtime=0))
    sys.stdout.write(f"{len(found)} numbers are kept in {KEPT.name}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
