# %% [markdown]
# # From a drawing to an arm that moves
#
# A pneu-net arm from its dimensions: its law, the arm under a slider, a calibration with photographs, and a motion.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import pneurod

folder = Path("results/recipes")

# %% [markdown]
# ## Drawing and law
#
# The arm has eight chambers of the usual dimensions. One cell and both ends give its law, here on one mesh. The verdict
# says how far it can be relied on.

# %%
results = pneurod.characterize(
    pneurod.PneuNet(chambers=8),
    folder / "tutorial",
    material=pneurod.NamedRubber("dragon_skin_30"),
    pressures=["10 kPa", "20 kPa"],
    settings={"law": "cell", "accuracy": "off"},
)
for line in results.verdict.lines[:2]:
    print(line)

# %% [markdown]
# ## The slider
#
# In a notebook the last line of a cell shows the arm under sliders, with a tip to drag. The page opens offline, too.

# %%
(folder / "tutorial_hand.html").write_text(str(results.hand))
results.hand

# %% [markdown]
# ## The calibration
#
# Four photographs of the tip, with 0.2 mm of scatter, are **synthetic** here: the cast arm is 15 % softer.

# %%
assert isinstance(results.arm_law, pneurod.ArmLaw)
cast, pressures = results.arm_law.scaled(0.85), (4.0, 8.0, 12.0, 16.0)
scatter = np.random.default_rng(3).normal(0.0, 0.2, (4, 2))
tips = np.array([cast.at(pressure).solve().end for pressure in pressures]) + scatter
rows = [f"{pressure},{x:.2f},{y:.2f}" for pressure, (x, y) in zip(pressures, tips, strict=True)]
(folder / "tutorial.csv").write_text("\n".join(["pressure_kPa,tip_x_mm,tip_y_mm", *rows]) + "\n")
report = pneurod.calibrate(results, folder / "tutorial.csv", folder / "tutorial_cast")
modulus, *_ = report.found.estimates
print(f"its moduli are {modulus.mean:.3g} ± {modulus.std:.2g} times those of the drawing")
calibrated = pneurod.read_results(report.directory)

# %% [markdown]
# ## The motion
#
# The pressure rises from rest to 12 kPa within 0.4 s. How far does the calibrated arm swing?

# %%
(folder / "tutorial_rise.csv").write_text("t_s,pressure_kPa\n0,0\n0.4,12\n1.5,12\n")
motion = calibrated.move(folder / "tutorial_rise.csv", seconds=1.5)
late = motion[motion.t_s > 0.4]
print(
    f"its angle goes up to {late.end_angle_deg.abs().max():.1f}°, and ends at {abs(motion.end_angle_deg.iloc[-1]):.1f}°"
)

# %%
figure, (shapes, times) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
shapes.plot(*tips.T, "o", color="black", label="photographs")
for label, rods in (("drawn", results), ("calibrated", calibrated)):
    shapes.plot(*rods.rod(12.0).solve().curve.T, label=f"{label}, 12 kPa")
shapes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
shapes.legend()
times.plot(motion.t_s, motion.end_angle_deg)
times.set(xlabel="t (s)", ylabel="angle of the end (°)")
figure.savefig(folder / "tutorial.png")

# %% [markdown]
# ## What to change
#
# - `pneurod.PneuNet(...)`: other dimensions, or the name of a YAML file with your own STEP file.
# - Leave `accuracy` out for a law whose error of the mesh is below 1 %.
# - `force=(0.0, 0.02)` in `solve` pulls at the tip, as the slider does.
