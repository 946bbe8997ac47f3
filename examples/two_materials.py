# %% [markdown]
# # An arm of two materials
#
# Many arms are cast from a soft rubber on a stiffer base. What does the base do?

# %%
from pathlib import Path

import matplotlib.pyplot as plt

import pneurod

folder = Path("results/recipes")

# %% [markdown]
# ## The same arm twice
#
# First of one rubber, then with a base of another one. `materials` names the region and its law.

# %%
base = {"materials": {"base": {"name": "elastosil_m4601"}}}
runs = {
    label: pneurod.characterize(
        pneurod.PneuNet(chambers=8),
        folder / out,
        material=pneurod.NamedRubber("dragon_skin_30"),
        pressures=["10 kPa", "20 kPa"],
        settings={"law": "cell", **regions},
    )
    for label, out, regions in (("one rubber", "arm", {}), ("stiffer base", "two_materials", base))
}

# %% [markdown]
# ## How far they bend, and how strong they are
#
# The force is that of the end when it is held at the height of the clamp.

# %%
figure, axes = plt.subplots(layout="constrained")
print("arm            pressure (kPa)   tip x (mm)   tip y (mm)    bends by (degrees)   force (N)")
for label, results in runs.items():
    for pressure in (10.0, 20.0):
        rod = results.rod(pressure)
        shape, force = rod.solve(), rod.solve(end_y=0.0).force[1]
        x, y = shape.end
        print(f"{label:14s} {pressure:14.0f} {x:12.1f} {y:12.1f} {shape.bending_deg:21.1f} {force:11.4f}")
        axes.plot(*shape.curve.T, label=f"{label}, {pressure:g} kPa")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
axes.legend()
figure.savefig(folder / "two_materials.png")

# %% [markdown]
# ## What to change
#
# - The two names: `ecoflex_00_30`, `ecoflex_00_50`, `dragon_skin_10`, `dragon_skin_20`, `mold_star_16`.
# - `"base": {"law": "svk", "E": "100 MPa", "nu": 0.4}`: a base of plastic.
# - `material` alone compares two rubbers, or two laws of the same rubber.
