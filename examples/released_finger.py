# %% [markdown]
# # A released finger
#
# A thread pulls an inflated finger up and is cut. How fast does the finger vibrate, and when is it at rest?

# %%
from pathlib import Path

import matplotlib.pyplot as plt

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
# ## What the finger is in time
#
# Frequency and damping ratio of the first vibration at each pressure. This rubber has no measured loss factor, so
# that 0.1 is taken.

# %%
print(results.frequencies[["pressure_kPa", "frequency_1_Hz", "damping_ratio_1", "settles_s"]].to_string(index=False))

# %% [markdown]
# ## Let go at 20 kPa
#
# `release` cuts the thread, which has pulled with `force`, at 0 s. The motion is also in `motion.csv`.

# %%
motion = results.move(pressure="20 kPa", force="[0 N, 0.05 N]", release=True, seconds=2.0, out=folder / "released")
print(f"the end starts at y = {motion.tip_y_mm.iloc[0]:.1f} mm")
print(f"it swings down to {motion.tip_y_mm.min():.1f} mm, and ends at {motion.tip_y_mm.iloc[-1]:.1f} mm")

# %% [markdown]
# ## The picture

# %%
figure, axes = plt.subplots(layout="constrained")
axes.plot(motion.t_s, motion.tip_y_mm)
axes.set(xlabel="time (s)", ylabel="y of the end (mm)", title="let go at 20 kPa")
figure.savefig(folder / "released_finger.png")

# %% [markdown]
# ## What to change
#
# - `material=pneurod.NamedRubber("dragon_skin_30", loss_factor=0.2)`: a rubber that loses more energy.
# - `pressure="0 kPa", orientation="lying", tip_mass="5 g"` in place of the force: the finger, held straight, falls.
# - `pneurod calibrate` finds the loss factor from such a motion on the bench.
