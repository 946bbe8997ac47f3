"""Solve all cases, or those whose names contain the given words; print the table and write it into the studies.

python -m tests.hard_cases.run_all [--jobs N] [WORDS]
"""

import argparse
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from tests.hard_cases.cases import HardCase, read_cases
from tests.hard_cases.solve import Line, line_of
from tests.hard_cases.table import summary, table, write_table


def main() -> int:
    """0 where every case ended as expected."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("words", nargs="*")
    options = parser.parse_args()
    cases = [case for case in read_cases() if all(word in case.name for word in options.words)]
    os.environ.update(dict.fromkeys(("MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "OMP_NUM_THREADS"), "1"))
    lines = []
    with ProcessPoolExecutor(options.jobs, get_context("spawn")) as pool:
        for seconds, line in pool.map(_timed, cases):
            lines.append(line)
            mark = "ok " if line.as_expected else "NOT"
            print(f"{mark} {seconds:6.1f} s  {line.case.name}: {line.reason or f'{line.error:.2g}'}", flush=True)  # noqa: T201
    if not options.words:
        write_table(lines)
    print(table(lines), summary(lines), sep="\n")  # noqa: T201
    return int(not all(line.as_expected for line in lines))


def _timed(case: HardCase) -> tuple[float, Line]:
    begin = time.process_time()
    line = line_of(case)
    return time.process_time() - begin, line


if __name__ == "__main__":
    sys.exit(main())
