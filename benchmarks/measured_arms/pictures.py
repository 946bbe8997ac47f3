"""The pictures of the measured arms: angle over pressure."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from benchmarks.markdown import ROOT
from benchmarks.measured_arms.arms import Arm
from geometry.arrays import Array
from pipeline.values.plots import COLOURS


def draw_angles(
    arm: Arm, read: tuple[Array, Array] | None, foretold: tuple[Array, Array], second: Mapping[float, float]
) -> None:
    """Angles over pressure as points where they were read, and what was predicted.

    read: kPa and degrees, (n,) each. foretold: kPa (m,), and intervals (3, m) as of `Factor`. second: degrees of
    another test, by kPa.
    """
    pressures, (predicted, *band) = foretold
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot()
    axes.fill_between(pressures, *band, color=COLOURS[0], alpha=0.2, linewidth=0, label="90 %")
    axes.plot(pressures, predicted, color=COLOURS[0], label="predicted", linewidth=1.5)
    if second:
        axes.plot(list(second), list(second.values()), "s", color=COLOURS[1], markersize=4, label="second test")
    if read:
        axes.plot(*read, "o", color="black", markersize=3.5, label="measured")
    axes.set_xlabel("pressure (kPa)")
    axes.set_ylabel("direction of the tip, less that at rest (degrees)")
    axes.set_title(arm.name)
    axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    figure.savefig(ROOT / "docs" / "pictures" / f"measured_arms_{arm.name.replace('-', '')}.png", dpi=130)
