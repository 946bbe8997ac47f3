# %% [markdown]
# # The rod alone
#
# A rod needs no finite elements: five parameters and a rest curvature are enough, from wherever they come.

# %%
import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import pneurod

folder = Path("results/recipes")
folder.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# ## 1. A rod of 112 mm
#
# The law M = alpha (kappa - kappa_0) + m0 has one rigidity up to d and another one beyond it.

# %%
law = pneurod.FiveParameters(
    alpha1=180.0,  # N mm2, bending stiffness between the clamp and d
    alpha2=290.0,  # N mm2, beyond d
    m01=0.0,  # N mm
    m02=-0.25,  # N mm
    d=6.0,  # mm
)
rod = pneurod.Rod(length=112.0, kappa_0=-0.012, law=law)  # kappa_0 in 1/mm; a function of s or samples work too

# %% [markdown]
# ## 2. A force on the tip, in N; x points along the clamped end, y up

# %%
figure, axes = plt.subplots(layout="constrained")
print("F_y (N)   tip x (mm)   tip y (mm)   bends by (degrees)   moment at the clamp (N mm)")
for force in np.linspace(0.0, 0.1, 6):
    shape = rod.solve(force=(0.0, force))
    x, y = shape.end
    axes.plot(*shape.curve.T, label=f"{force:.2f} N")
    print(f"{force:7.3f} {x:12.2f} {y:12.2f} {shape.bending_deg:20.2f} {shape.moment[0]:28.3f}")

# %% [markdown]
# ## 3. The other way round
#
# The height of the tip is prescribed, and the force that this needs is computed.

# %%
prescribed = rod.solve(end_y=-20.0)
axes.plot(*prescribed.curve.T, "--", color="black", label="tip at y = -20 mm")
print(f"a tip at y = -20 mm needs F_y = {prescribed.force[1]:.4f} N")

# %% [markdown]
# ## 4. How long one shape takes, and the picture

# %%
count = 200
start = time.process_time()
for force in np.linspace(0.001, 0.1, count):
    rod.solve(force=(0.0, force))
print(f"{1000 * (time.process_time() - start) / count:.2f} ms per shape")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
axes.legend()
figure.savefig(folder / "rod_alone.png")

# %% [markdown]
# ## What to change
#
# - The parameters, for example those of a paper.
# - `kappa_0`: a function of the arc length, or samples.
# - `rod.solve(end=(60.0, -40.0))` holds the tip at a place, `direction="hanging", tip_mass="2 g"` hangs a mass on it.
