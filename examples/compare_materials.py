# %% [markdown]
# # One arm, two material laws
#
#     python examples/compare_materials.py [FOLDER]
#
# How much do the five parameters depend on the material law? The same short arm is run with St. Venant-Kirchhoff's and
# with Hencky's law, both with the same E and ν. It takes about a minute.

# %%
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

import pneurod

folder = Path(sys.argv[1] if len(sys.argv) == 2 else "results/compare_materials")
folder.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# ## 1. The design
#
# The mesh is coarse, so that the example is quick. `law: five` and `validation: off` leave out the arm's own law and
# the load that tests the rod.

# %%
config = folder / "arm.yaml"
config.write_text(
    """
name: arm
geometry: {family: pneunet, chambers: 8}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [15 kPa]
mesh: {size: 8 mm, formulation: p2p0}
law: five
validation: "off"
""",
    encoding="utf-8",
)

# %% [markdown]
# ## 2. Two runs
#
# `settings` replaces values of the configuration, here the name of the law.

# %%
runs = {
    name: pneurod.characterize(config, out=folder / name, settings={"material.law": name}) for name in ("svk", "hencky")
}

# %% [markdown]
# ## 3. The parameters side by side

# %%
rows = {
    name: results.parameters.iloc[0][["alpha1_N_mm2", "alpha2_N_mm2", "alpha2_N_mm2_std", "d_mm"]]
    for name, results in runs.items()
}
print(pd.DataFrame(rows).T.astype(float).round(2).to_string())

# %% [markdown]
# ## 4. The shapes

# %%
figure, axes = plt.subplots()
for name, results in runs.items():
    free = results.curves.query("experiment == 'II'")
    axes.plot(free["x_mm"], free["y_mm"], label=f"{name}, 15 kPa")
    print(f"{name}: the free end is at y = {free['y_mm'].iloc[-1]:.1f} mm")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
axes.legend()
figure.savefig(folder / "compare_materials.png")
print(f"picture: {folder / 'compare_materials.png'}")
