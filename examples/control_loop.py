# %% [markdown]
# # An arm in a control loop
#
# A controller holds the end of an arm at 60 degrees. From 1 s on a force pushes it up. The arm is moved step by step,
# with its mass, its rubber and its law, and the controller sees its angle after each step.

# %%
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import pneurod

folder = Path("results/recipes")
folder.mkdir(parents=True, exist_ok=True)
results = pneurod.read_results("tests/data/results_coarse")  # a stored run; with an arm of your own, its folder

# %% [markdown]
# ## The controller
#
# The law of the arm gives the pressure for 60 degrees at rest. It comes within a second. What is missing is left to a
# PI controller. The angle is filtered first, because the loop would feed the vibration of the arm.

# %%
WANTED, FORCE = 60.0, 0.005  # degrees; N, upwards on the end
STEP, SECONDS, PUSHED_AT = 0.005, 10.0, 1.0  # s
GAIN, SUMMED, FILTER = 0.02, 0.25, 0.25  # kPa per degree, kPa per degree and s, s
at_rest = float(results.pressure_for(angle=f"{WANTED} deg").pressure_kPa.iloc[0])


def hold(motion: Any, *, is_closed: bool) -> list[tuple[float, float, float]]:
    """Times in s, angles in degrees and pressures in kPa; is_closed: whether the controller acts."""
    missing = summed = 0.0
    rows = []
    for k in range(round(SECONDS / STEP)):
        time = k * STEP
        part = np.sin(0.5 * np.pi * min(time, 1.0)) ** 2
        pressure = part * at_rest + is_closed * (GAIN * missing + SUMMED * summed)
        force = (0.0, FORCE if time >= PUSHED_AT else 0.0)
        seen = motion.step(STEP, pressure_kPa=max(pressure, 0.0), force=force)
        missing += STEP / FILTER * (part * WANTED - seen.angle - missing)
        summed += STEP * missing
        rows.append((seen.time, seen.angle, float(seen.pressure[0])))
    return rows


motion = results.moving(pressure="0 kPa")
runs = {"open": hold(motion.copy(), is_closed=False), "closed": hold(motion.copy(), is_closed=True)}
for name, rows in runs.items():
    print(f"{name}: {rows[-1][1]:.1f} degrees at {rows[-1][2]:.2f} kPa after {rows[-1][0]:.0f} s")

# %% [markdown]
# ## The picture

# %%
figure, (above, below) = plt.subplots(2, sharex=True, layout="constrained")
for name, rows in runs.items():
    times, angles, pressures = np.transpose(rows)
    above.plot(times, angles, label=f"{name} loop")
    below.plot(times, pressures)
above.axhline(WANTED, color="grey", linewidth=0.8)
above.set(ylabel="angle of the end (degrees)")
above.legend()
below.set(xlabel="time (s)", ylabel="pressure (kPa)")
figure.savefig(folder / "control_loop.png")

# %% [markdown]
# ## What to change
#
# - `SUMMED`: a larger one is faster, until the loop swings up with the vibration of the arm.
# - `FORCE`: an arm that is pushed beyond its law ends the loop with an error that says how far.
# - `motion.state`: store it, and try another controller from there.
