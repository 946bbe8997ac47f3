"""Arms by finite elements in time: released from a force, and inflated quickly; the air in a chamber that is closed."""

import csv
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi, sin
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.in_time.elements import Branches, Motion, Steps
from fem import Experiment, LineForce, Model, follow
from fem.supports import nodes_at
from geometry.arrays import Array
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.simulate.scene import Scene
from pipeline.values.pressure import in_MPa

#: tonne/mm3 per kg/m3 is in the configuration; what a step leaves of motions of very high frequency
HIGH = 0.5


@dataclass(frozen=True)
class Case:
    """An arm that moves."""

    config: Config
    pressure_kPa: float
    force_N: tuple[float, float]  #: on the end until it is released; zero: the arm is inflated from rest
    branches: Branches
    step: float  #: s
    count: int  #: of steps

    def factor(self, time: float, rise: float) -> float:
        return 1.0 if any(self.force_N) or time > rise else sin(0.5 * pi * time / rise) ** 2
