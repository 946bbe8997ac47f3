# %% [markdown]
# # A finger that closes on a flow of air
#
# A small pump blows half a litre a minute into a finger. How long does the finger take to close? The pressure follows
# from the air and the volume of the chambers, which grows as the finger bends.

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
# ## Two sources of air
#
# A pump with a constant flow, and a supply at 20 kPa behind a thin tube; 5 cm³ of air are in the tube. The pump is
# switched off after 0.8 s, before the pressure leaves the law of the arm.

# %%
sources = {
    "pump": ("flow 0.5 l/min, dead volume 5 cm^3", 0.8),
    "supply": ("supply 20 kPa, conductance 200 mm^3/s/kPa, dead volume 5 cm^3", 2.0),
}
motions = {}
for name, (air, seconds) in sources.items():
    motions[name] = results.move(pressure="0 kPa", air=air, seconds=seconds, out=folder / f"closing_{name}")
    last = motions[name].iloc[-1]
    print(f"{name}: {last.pressure_kPa:.1f} kPa after {last.t_s:.1f} s; the end is at y = {last.tip_y_mm:.0f} mm")

# %% [markdown]
# ## The picture

# %%
figure, (above, below) = plt.subplots(2, sharex=True, layout="constrained")
for name, motion in motions.items():
    above.plot(motion.t_s, motion.pressure_kPa, label=name)
    below.plot(motion.t_s, motion.tip_y_mm)
above.set(ylabel="pressure (kPa)")
below.set(xlabel="time (s)", ylabel="y of the end (mm)")
above.legend()
figure.savefig(folder / "closing_finger.png")

# %% [markdown]
# ## What to change
#
# - `exponent 1.4` in `air`: compression without loss of heat; the usual 1 keeps the temperature.
# - `conductance`: a longer or thinner tube has less.
# - `air="closed"` with a `force`: what the air of a closed finger does when something presses on it.
