# %% [markdown]
# # A sweep over walls
#
# How much does the thickness of the walls matter, and does a higher chamber help? One file describes all designs.

# %%
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

folder = Path("results/recipes")

# %% [markdown]
# ## The sweep
#
# `examples/sweep.yaml` has three walls times three heights. Each is an arm of four chambers that is inflated without
# load (experiment II). The command uses all cores, and continues a sweep that was interrupted.

# %%
print(Path("examples/sweep.yaml").read_text())
command = [sys.executable, "-m", "pneurod", "sweep", "examples/sweep.yaml", "--out", str(folder / "walls")]
subprocess.run(command, check=True, capture_output=True)
table = pd.read_csv(folder / "walls" / "sweep.csv")

# %% [markdown]
# ## The table
#
# How far the arm bends, in degrees, and the largest stretch in its walls.

# %%
at_31 = table.query("pressure_kPa == 31")
wall, height = "geometry.wall_mm", "geometry.chamber_height_mm"
for column in ("II_bending_deg", "II_max_stretch"):
    print(f"{column} at 31 kPa")
    print(at_31.pivot(index=wall, columns=height, values=column).round(2).to_string(), "\n")

# %% [markdown]
# ## The picture

# %%
figure, axes = plt.subplots(layout="constrained")
for pressure, style in ((17.0, "--"), (31.0, "-")):
    for number, (high, rows) in enumerate(table.query("pressure_kPa == @pressure").groupby(height)):
        label = f"{high:g} mm high, {pressure:g} kPa"
        axes.plot(rows[wall], rows["II_bending_deg"], style, color=f"C{number}", marker="o", label=label)
axes.set(xlabel="wall (mm)", ylabel="bending (degrees)", ylim=(20, 55))
axes.legend(ncols=2)
figure.savefig(folder / "wall_sweep.png")

# %% [markdown]
# ## What to change
#
# - `axes` in the file: any key of the configuration with a list of values, or `latin_hypercube` for many keys at once.
# - `run: whole` computes the rod of every design, `run: cell` only its bending law.
# - `mesh.size: 4 mm`, for better numbers.
