# %% [markdown]
# # An arm with user-defined dimensions: from a few numbers to a rod model with its errors, and a picture of both
#
#     python examples/own_arm.py [FOLDER]
#
# It takes about half a minute. The results are in FOLDER (results/own_arm by default), with a report for the browser.

# %%
import sys
from pathlib import Path

import matplotlib.pyplot as plt

import pneurod

# %% [markdown]
# ## 1. The design
#
# Every dimension has its unit. Those left out are the ones of the paper's gapped arm. The mesh is coarse, so that
# the example is quick; 4 mm gives better numbers.

# %%
body = pneurod.PneuNet(chambers=8, width="18 mm", chamber_height="14 mm", wall="1.2 mm")
rubber = pneurod.NeoHooke(mu="0.4 MPa", kappa="20 MPa", density="1070 kg/m^3")
mesh = {"size": "8 mm", "formulation": "p2p0", "grading": False}
folder = Path(sys.argv[1] if len(sys.argv) == 2 else "results/own_arm")

# %% [markdown]
# ## 2. The run
#
# Mesh, finite elements, five parameters, the rod and a report.

# %%
results = pneurod.characterize(
    body,
    folder,
    name="own_arm",
    material=rubber,
    pressures=["10 kPa", "20 kPa"],
    settings={"mesh": mesh},
    progress=True,
)

# %% [markdown]
# ## 3. The five parameters at every pressure, with the standard deviations of the identification

# %%
columns = [f"{name}{ending}" for name in ("alpha1_N_mm2", "alpha2_N_mm2", "d_mm") for ending in ("", "_std")]
print(results.parameters.set_index("pressure_kPa")[columns].round(3).to_string())

# %% [markdown]
# ## 4. How good is the rod?
#
# Largest distance to the finite elements, over the length of the arm.

# %%
distances = results.validation.query("experiment == 'III' and rod == 'five' and sample == 'in'").set_index(
    "pressure_kPa"
)["distance_over_length"]
for pressure, distance in distances.items():
    print(f"in experiment III at {pressure:g} kPa the rod is within {100 * distance:.1f} % of the length")

# %% [markdown]
# ## 5. What the rod is for
#
# Shapes under loads that were never simulated, here a mass of 5 g that hangs on the tip of the lying arm at 15 kPa.
# Without `weight=False` the weight of the arm itself would act as well.

# %%
rod = results.rod("15 kPa")
free, loaded = rod.solve(), rod.solve(direction="lying", tip_mass="5 g", weight=False)
print(f"5 g at the tip move it by {loaded.end[1] - free.end[1]:.1f} mm")

# %% [markdown]
# ## 6. A picture
#
# Finite elements and rod at the pressures of the run, and the two shapes of the rod between them. A rod begins at
# (0, 0); in the drawing, and so in the curves of the finite elements, the clamped end of the material curve is higher.

# %%
figure, axes = plt.subplots()
for (experiment, pressure), curve in results.curves.groupby(["experiment", "pressure_kPa"]):
    if experiment == "II":
        axes.plot(curve["x_mm"], curve["y_mm"], ".", label=f"finite elements, {pressure:g} kPa")
        axes.plot(curve["rod_x_mm"], curve["rod_y_mm"], "-", color="black")
axes.plot(*(free.curve + results.curve_start_mm).T, label="rod, 15 kPa")
axes.plot(*(loaded.curve + results.curve_start_mm).T, label="rod, 15 kPa and 5 g")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
axes.legend()
figure.savefig(folder / "own_arm.png")
print(f"picture: {folder / 'own_arm.png'}, report: {results.report}")
