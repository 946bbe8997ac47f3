# %% [markdown]
# # What it cannot do
#
# A program should say where it ends. Here are things that are asked for and refused, and what is said then.

# %%
from pathlib import Path

import matplotlib.pyplot as plt

import pneurod

folder = Path("results/recipes")


def characterize(out: str, **more: str | dict[str, str]) -> pneurod.Results:
    return pneurod.characterize(
        pneurod.PneuNet(chambers=8),
        folder / out,
        material=pneurod.NamedRubber("dragon_skin_30"),
        pressures=["10 kPa", "20 kPa"],
        settings={"law": "cell", **more},
    )


# %% [markdown]
# ## What is not there
#
# Fibres, motion in time, creep and friction have no key of that name. The answer says what there is instead.

# %%
for key in ("effects.fibre", "dynamics", "effects.creep", "effects.friction"):
    try:
        characterize("refused", **{key: "on"})
    except pneurod.InputError as refused:
        print(f"{key}:\n    {refused}\n")

# %% [markdown]
# ## Beyond what was computed
#
# The arm of the other recipes was inflated to 20 kPa. Its law is not extrapolated, neither in pressure nor in load.

# %%
results = characterize("arm")
try:
    results.rod("25 kPa")
except pneurod.InputError as refused:
    print(f"25 kPa:\n    {refused}\n")

# %% [markdown]
# ## The picture
#
# A force on the end grows until the rod is refused.

# %%
figure, axes = plt.subplots(layout="constrained")
rod, force = results.rod("20 kPa"), 0.0
try:
    while True:
        shape = rod.solve(force=(0.0, force))
        axes.plot(*shape.curve.T, label=f"{force:.2f} N")
        force += 0.02
except pneurod.RodError as refused:
    print(f"{force:.2f} N upwards on the end:\n    {refused}")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal", title="20 kPa")
axes.legend()
figure.savefig(folder / "cannot.png")

# %% [markdown]
# ## What to change
#
# - Another key that you miss. If it is only misspelt, the nearest one is named.
# - `pressures`: with a higher one the law goes on to there, if the arm bears it.
# - All limits are on [one page](../how_to/cannot.md).
