"""The histogram of the errors of the recommended rod."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

#: ends of the classes, in percent; errors beyond the last stand in the last class
CLASSES = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
TITLES = {"shape": "distance over the length", "force": "error of the end force"}


def counts(errors: Sequence[float]) -> np.ndarray:
    """How many errors lie in each class; errors beyond the ends count in the first and the last."""
    percent = np.clip(100.0 * np.asarray(errors, float), CLASSES[0], CLASSES[-1] * (1.0 - 1e-12))
    return np.histogram(percent, CLASSES)[0]


def draw(errors: Mapping[str, Sequence[float]], path: Path) -> None:
    """Draw the histograms of both errors into a PNG file."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 2.6), layout="constrained")
    for axes, (name, title) in zip(figure.subplots(1, 2, sharey=True), TITLES.items(), strict=True):
        heights = counts(errors.get(name, ()))
        axes.bar(range(len(heights)), heights, width=0.9, align="edge", color="#4477aa")
        axes.set_xticks(range(len(CLASSES)), [f"{end:g}" for end in CLASSES], fontsize=7)
        axes.set_xlabel(f"{title}, %")
        axes.yaxis.get_major_locator().set_params(integer=True)
    figure.axes[0].set_ylabel("designs")
    figure.savefig(path, dpi=120)
