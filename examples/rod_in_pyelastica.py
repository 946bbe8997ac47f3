# %% [markdown]
# # The arm in PyElastica
#
#     python examples/rod_in_pyelastica.py [FOLDER]
#
# A run is exported as a program for PyElastica, and the same load is solved there and by `pneurod`. It takes about a
# minute. FOLDER is the result folder; a finished run in it is used again.

# %%
import importlib.util
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import pneurod

folder = Path(sys.argv[1] if len(sys.argv) == 2 else "results/rod_in_pyelastica")
folder.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# ## 1. The run
#
# A short arm on a coarse mesh, with its own law alone.

# %%
config = folder / "arm.yaml"
config.write_text(
    """
name: arm
geometry: {family: pneunet, chambers: 8}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [15 kPa]
mesh: {size: 8 mm, formulation: p2p0}
law: cell
accuracy: "off"
validation: "off"
""",
    encoding="utf-8",
)
results = pneurod.characterize(config, out=folder / "run")

# %% [markdown]
# ## 2. The export
#
# The command `pneurod export`, called from Python. It writes a program with the functions `build` and `simulate`.

# %%
command = [sys.executable, "-m", "pneurod", "export", str(folder / "run"), "--to", "pyelastica"]
subprocess.run([*command, "--out", str(folder), "--force"], check=True, capture_output=True)
[path] = folder.glob("rod_pyelastica_*.py")
specification = importlib.util.spec_from_file_location("arm", path)
assert specification is not None
assert specification.loader is not None
arm = importlib.util.module_from_spec(specification)
specification.loader.exec_module(arm)

# %% [markdown]
# ## 3. The same load in both programs
#
# PyElastica simulates until the arm is at rest; `pneurod` solves the equilibrium. Both give the material curve of the
# arm, PyElastica at the arc lengths of the table.

# %%
force = (0.0, 0.02)  # N
dynamic = 1e3 * arm.curve(arm.simulate(15.0, force), 15.0)  # mm
static = results.rod(15.0).solve(force=force)

# %% [markdown]
# ## 4. How far apart?
#
# Small differences remain, because PyElastica bends at the nodes between its straight elements.

# %%
same = static.positions(1e3 * np.array(arm.TABLE["s_m"]))
distance = np.linalg.norm(dynamic - same, axis=1).max()
print(f"end in PyElastica at ({dynamic[-1, 0]:.2f}, {dynamic[-1, 1]:.2f}) mm")
print(f"end in pneurod at ({same[-1, 0]:.2f}, {same[-1, 1]:.2f}) mm")
print(f"largest distance {distance:.3f} mm, {100 * distance / static.s[-1]:.3f} % of the length")

figure, axes = plt.subplots()
axes.plot(*dynamic.T, ".", label="PyElastica")
axes.plot(*static.curve.T, label="pneurod")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
axes.legend()
figure.savefig(folder / "rod_in_pyelastica.png")
print(f"picture: {folder / 'rod_in_pyelastica.png'}")
