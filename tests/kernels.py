"""Compile the kernels of all solvers once, before several processes of the tests would each do it for themselves.

python -m tests.kernels
"""

from multiprocessing import Process

import fem
import rod
from tests.measured_arm import arm_law


def compile_rods() -> None:
    """Those of rods at rest and in time: two minutes once, seconds from disk."""
    rod.compile_kernels()
    rod.move(rod.Body(arm_law()), 1.0, 0.01)


def compile_elements() -> None:
    """Those of finite elements, of their laws, of a layer and of hoops."""
    for law in (fem.NeoHooke(0.4, 20.0), fem.Hencky(1.2, 0.495)):  # they have all the kernels of the laws between them
        fem.compile_kernels("mixed", law, layer=True)


def main() -> None:
    """Both at the same time."""
    processes = [Process(target=compile_rods), Process(target=compile_elements)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()


if __name__ == "__main__":
    main()
