# %% [markdown]
# # The swing of an arm in PyElastica
#
# The pressure is let out at once. How long does the arm swing? PyElastica tells, as `pneurod move` does.

# %%
import runpy
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
# ## The export
#
# It writes a program with the functions `build`, `simulate` and `curve`, in m, kg and s.

# %%
[program] = results.export("pyelastica", folder, force=True)
arm = runpy.run_path(str(program))

# %% [markdown]
# ## From 20 to 5 kPa
#
# The arm is at rest at 20 kPa when the pressure falls within 10 ms. Velocities decay as the loss factor of the rubber
# says. `tell` is called now and then with the time and the rod.

# %%
SECONDS = 0.6
damping = arm["TABLE"]["loss_factor"] * arm["first_vibration"](5.0)


def pressure(time: float) -> float:
    return 20.0 - 15.0 * min(1.0, time / 0.01)


path: list[tuple[float, ...]] = []
arm["simulate"](
    pressure,
    seconds=SECONDS,
    damping=damping,
    tell=lambda time, rod: path.append((time, *1e3 * arm["curve"](rod, pressure(time))[-1])),
)
times, x, y = np.array(path).T
rest = results.rod(5.0).solve().end
print(f"at rest at 5 kPa the end is at ({rest[0]:.1f}, {rest[1]:.1f}) mm")
print(f"it swings up to y = {y.max():.1f} mm, {y.max() - rest[1]:.1f} mm beyond its place at rest")
passing = times[1:][np.diff(np.sign(y - rest[1])) != 0]
print(f"it passes that height every {1e3 * np.diff(passing).mean():.0f} ms")

# %% [markdown]
# ## The picture

# %%
figure, axes = plt.subplots(layout="constrained")
axes.plot(times, y, label="end of the arm")
axes.axhline(rest[1], color="grey", linestyle=":", label="at rest at 5 kPa, by pneurod")
axes.set(xlabel="time (s)", ylabel="y (mm)")
axes.legend()
figure.savefig(folder / "swing.png")

# %% [markdown]
# ## What to change
#
# - `pressure`, any function of the time between the pressures of the run.
# - `material=pneurod.NamedRubber("dragon_skin_30", loss_factor=0.2)`: a rubber that loses more energy.
# - `force=(0.0, 0.01)` of `simulate`, in N, pulls on the end.
# - PyElastica's own `GravityForces` and contact, in a simulation around `build`.
