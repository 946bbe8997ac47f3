# %% [markdown]
# # The pressure for a pose
#
# Which pressure bends the arm by 60 degrees, brings its tip to a place, or lets it push with a given force?

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
# ## Three wishes
#
# A wish may have several answers, or none. Without an answer the program says what is nearest.

# %%
bent = results.pressure_for(angle="60 deg")
print(bent)
placed = results.pressure_for(tip=("72 mm", "-33.4 mm"))
print(placed)
pushing = results.pressure_for(force="0.02 N", at_height="0 mm")
print(pushing)
try:
    results.pressure_for(tip=("70 mm", "10 mm"))
except pneurod.InputError as refused:
    print(refused)

# %% [markdown]
# ## The picture
#
# The path of the tip, and the arm at the three pressures.

# %%
figure, axes = plt.subplots(layout="constrained")
tips = np.array([results.rod(float(pressure)).solve().end for pressure in np.linspace(0.0, 20.0, 41)])
axes.plot(*tips.T, ":", color="grey", label="tip from 0 to 20 kPa")
for label, found in (("bends by 60°", bent), ("tip at (72, -33.4) mm", placed)):
    pressure = found.pressure_kPa[0]
    axes.plot(*results.rod(pressure).solve().curve.T, label=f"{pressure:.1f} kPa: {label}")
pressure = pushing.pressure_kPa[0]
held = results.rod(pressure).solve(end_y="0 mm")
axes.plot(*held.curve.T, label=f"{pressure:.1f} kPa: pushes with 0.02 N at height 0")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
axes.legend()
figure.savefig(folder / "pressure_for_pose.png")

# %% [markdown]
# ## What to change
#
# - `angle`, `tip`, or `force` with `at_height`.
# - `direction="hanging", tip_mass="5 g"` gives the answers for an arm with weight and payload.
# - On the command line: `pneurod solve results/recipes/arm --angle "60 deg"`.
