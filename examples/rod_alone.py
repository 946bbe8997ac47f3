# %% [markdown]
# # The rod alone: five parameters and a rest curvature, and its shapes under loads in about a millisecond each
#
#     python examples/rod_alone.py [FOLDER]
#
# FOLDER, if given, is the result folder of a run, whose rod is bent as well.

# %%
import sys
import time

import numpy as np

import pneurod

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
print("F_y (N)   tip x (mm)   tip y (mm)   tip angle (rad)   moment at the clamp (N mm)")
for force in np.linspace(0.0, 0.1, 6):
    shape = rod.solve(force=(0.0, force))
    x, y = shape.end
    print(f"{force:7.3f} {x:12.2f} {y:12.2f} {shape.end_angle:17.4f} {shape.moment[0]:28.3f}")

# %% [markdown]
# ## 3. The other way round
#
# The height of the tip is prescribed, and the force that this needs is computed.

# %%
prescribed = rod.solve(end_y=-20.0)
print(f"a tip at y = -20 mm needs F_y = {prescribed.force[1]:.4f} N")

# %% [markdown]
# ## 4. How long one shape takes

# %%
count = 200
start = time.perf_counter()
for force in np.linspace(0.001, 0.1, count):
    rod.solve(force=(0.0, force))
print(f"{1000 * (time.perf_counter() - start) / count:.2f} ms per shape")

# %% [markdown]
# ## 5. The same with the rod of a run, at the middle of its pressures

# %%
if len(sys.argv) == 2:
    results = pneurod.read_results(sys.argv[1])
    pressure = sum(results.pressures_kPa) / len(results.pressures_kPa)
    x, y = results.rod(pressure).solve(force=(0.0, 0.05)).end
    print(f"{results.run.design} at {pressure:g} kPa under 0.05 N: tip at ({x:.2f}, {y:.2f}) mm")
