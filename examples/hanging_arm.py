# %% [markdown]
# # A hanging arm with a payload
#
# How far does a mass on the end pull an inflated arm that hangs down? The rod answers in milliseconds.

# %%
from pathlib import Path

import matplotlib.pyplot as plt

import pneurod

folder = Path("results/recipes")

# %% [markdown]
# ## The arm
#
# An arm of eight chambers, of a rubber by name. `law: cell` measures its bending law on one chamber. Other
# recipes use the same folder; a run that is finished is not repeated.

# %%
results = pneurod.characterize(
    pneurod.PneuNet(chambers=8),
    folder / "arm",
    material=pneurod.NamedRubber("dragon_skin_30"),
    pressures=["10 kPa", "20 kPa"],
    settings={"law": "cell"},
)

# %% [markdown]
# ## The rod under a growing payload
#
# `hanging` lets gravity act along the clamped end. The weight of the arm itself acts as well.

# %%
rod = results.rod("20 kPa")
print(f"the arm weighs {results.mass_g:.1f} g")
print("payload (g)   end is below the clamp (mm)   beside it (mm)    bends by (degrees)")
shapes = {}
for mass in (0, 2, 5, 10, 20):
    shapes[mass] = shape = rod.solve(direction="hanging", tip_mass=f"{mass} g")
    down, aside = shape.end
    print(f"{mass:11d} {down:29.1f} {aside:16.1f} {shape.bending_deg:21.0f}")

# %% [markdown]
# ## The picture
#
# A rod lies along x. To show the arm as it hangs, x is drawn downwards.

# %%
figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
for mass, shape in shapes.items():
    axes.plot(shape.curve[:, 1], -shape.curve[:, 0], label=f"{mass} g")
axes.set(xlabel="beside the clamp (mm)", ylabel="height (mm)", aspect="equal", title="20 kPa")
axes.legend()
figure.savefig(folder / "hanging_arm.png")

# %% [markdown]
# ## What to change
#
# - `direction`: `lying`, `standing`, or `"30 deg"` that the clamped end rises.
# - `tip_mass`, and the pressure between 0 and 20 kPa. A load beyond what the law has seen is refused.
# - `material`, here the name of a rubber, and the dimensions of `PneuNet`.
