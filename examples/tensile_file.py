# %% [markdown]
# # A tensile test with warts
#
# The file of a testing machine is rarely clean. This one is made up, so that the right law is known: Yeoh's with
# c10 = 0.09 and c20 = 0.01 MPa. It has decimal commas, semicolons, a slack specimen, a second cycle and a break.

# %%
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

folder = Path("results/recipes/tensile_file")
folder.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# ## The file
#
# Force over extension, of a specimen of 33 mm and 16 mm². The first 0.5 mm only straighten it.

# %%
LENGTH, AREA, SLACK = 33.0, 16.0, 0.5  # mm, mm2, mm
up = np.arange(0.0, 33.1, 0.5)
extension = np.concatenate([up, up[::-1], np.arange(0.0, 66.1, 0.5)])
stretch = 1.0 + np.maximum(extension - SLACK, 0.0) / (LENGTH + SLACK)
stress = 2.0 * (stretch - stretch**-2) * (0.09 + 2.0 * 0.01 * (stretch**2 + 2.0 / stretch - 3.0))
softer = np.where(np.arange(len(stress)) < len(up), 1.0, 0.85)  # after the first loading, up to where that went
force = AREA * stress * np.where(extension > 33.0, 1.0, softer)
force += 0.02 * np.random.default_rng(1).standard_normal(len(force))
force[-3:] = 0.0  # it is torn
rows = [f"{step * 0.1:.1f};{u:.2f};{f:.3f}" for step, (u, f) in enumerate(zip(extension, force, strict=True))]
header = "Probe: 7;;\nPrüfgeschwindigkeit: 300 mm/min;;\nZeit;Verlängerung;Kraft\ns;mm;N\n"
(folder / "pull.csv").write_text((header + "\n".join(rows)).replace(".", ","), encoding="latin-1")

# %% [markdown]
# ## The law
#
# The notes come first: what was left out, and what may be wrong. Then comes the law to take.

# %%
command = [sys.executable, "-m", "pneurod", "material", str(folder / "pull.csv"), "--out", str(folder)]
given = ["--length", f"{LENGTH} mm", "--area", f"{AREA} mm^2", "--density", "1080 kg/m^3"]
done = subprocess.run([*command, *given], check=True, capture_output=True, text=True)
print(done.stderr + done.stdout)

# %% [markdown]
# ## The picture

# %%
figure, axes = plt.subplots(layout="constrained")
axes.plot(1.0 + extension / LENGTH, force / AREA, ".", color="grey", markersize=3, label="the file")
for law, curve in pd.read_csv(folder / "material_curves.csv").groupby("law"):
    axes.plot(curve["stretch"], curve["nominal_stress_MPa"], label=law)
axes.set(xlabel="stretch", ylabel="nominal stress (MPa)", ylim=(-0.05, 0.8))
axes.legend()
figure.savefig(folder.parent / "tensile_file.png")

# %% [markdown]
# ## What to change
#
# - The file: your own, with its length and area. Files with strain and stress need neither.
# - `--cycle 2` takes the second loading, for an arm that has been used.
# - `--for results/recipes/arm` fits the law to the stretches of that arm.
