# %% [markdown]
# # Calibrate an arm with five photographs
#
# A cast arm is not the drawn one. Five photographs of its tip give a rod of the arm on the bench.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import pneurod

folder = Path("results/recipes")
results = pneurod.characterize(  # the arm of the recipe on payloads; a finished run is not repeated
    pneurod.PneuNet(chambers=8),
    folder / "arm",
    material=pneurod.NamedRubber("dragon_skin_30"),
    pressures=["10 kPa", "20 kPa"],
    settings={"law": "cell"},
)

# %% [markdown]
# ## The photographs
#
# They are **synthetic** here: a rod with 1.25 times the modulus and a thicker wall, and 0.3 mm of scatter. With an arm
# of your own, write the file from your photographs and leave this out.

# %%
assert isinstance(results.arm_law, pneurod.ArmLaw)
cast = results.arm_law.with_changes({"geometry.wall": 0.06}).scaled(1.25)
scatter = np.random.default_rng(7).normal(0.0, 0.3, (5, 2))
pressures = [4, 8, 12, 16, 20]
tips = np.array([cast.at(pressure).solve().end for pressure in pressures]) + scatter
rows = [f"{pressure},{x:.2f},{y:.2f}" for pressure, (x, y) in zip(pressures, tips, strict=True)]
(folder / "photographs.csv").write_text("\n".join(["pressure_kPa,tip_x_mm,tip_y_mm", *rows]) + "\n")
print((folder / "photographs.csv").read_text())

# %% [markdown]
# ## Compare, then calibrate
#
# The calibration finds modulus and dimensions together. It writes a folder that all other commands take.

# %%
before = pneurod.compare(results, folder / "photographs.csv")
print(f"before: {before.rms('mm'):.1f} mm, {100 * before.within:.0f} % of the numbers are within what is allowed")
report = pneurod.calibrate(results, folder / "photographs.csv", folder / "cast_arm")
for one in report.found.estimates:
    print(f"{one.name}: {one.mean:.3g} ± {one.std:.2g} {one.unit}")
for line in report.lines:
    print(line)
after = pneurod.compare(report, folder / "photographs.csv")
print(f"after: {after.rms('mm'):.1f} mm, {100 * after.within:.0f} % of the numbers are within what is allowed")

# %% [markdown]
# ## The picture
#
# Under a force that no photograph has seen, the calibrated rod is nearer to the synthetic arm than the drawn one.

# %%
figure, axes = plt.subplots(layout="constrained")
axes.plot(*tips.T, "o", color="black", label="photographs, 4 to 20 kPa")
calibrated = pneurod.read_results(report.directory)
for label, shape in (
    ("drawn", results.rod(20.0).solve(force=(0.0, 0.02))),
    ("calibrated", calibrated.rod(20.0).solve(force=(0.0, 0.02))),
    ("the synthetic arm", cast.at(20.0).solve(force=(0.0, 0.02))),
):
    axes.plot(*shape.curve.T, label=f"{label}, 20 kPa and 0.02 N")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
axes.legend()
figure.savefig(folder / "calibrate.png")

# %% [markdown]
# ## What to change
#
# - The file: other columns are on the page on [results](../results.md#measured-arms), for example a force or a weight.
# - `free=["geometry.wall"]` chooses the dimensions; `align=True` is for photographs with another origin.
# - On the command line: `pneurod calibrate results/recipes/arm photographs.csv`.
