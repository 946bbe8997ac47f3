# %% [markdown]
# # A finger from an STL file
#
# A closed surface of triangles is enough: the program fills it with elements, finds the cavity, and inflates it.

# %%
from pathlib import Path

import gmsh
import matplotlib.pyplot as plt

import pneurod

folder = Path("results/recipes")
folder.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# ## The file
#
# Here it is made from the finger in `configs/finger.step`, which is 80 mm long. With a file of your own leave this out.

# %%
gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
gmsh.open("configs/finger.step")
gmsh.option.setNumber("Mesh.MeshSizeMax", 5.0)
gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 24)  # triangles around a circle
gmsh.model.mesh.generate(2)
gmsh.write(str(folder / "finger.stl"))
gmsh.finalize()

# %% [markdown]
# ## The run
#
# `curve` is the height of the line whose shape is wanted, here in the middle of the base plate. The finger bends
# because a sheet of paper lies at that height.

# %%
results = pneurod.characterize(
    pneurod.BodyFile(file=str(folder / "finger.stl"), curve="1 mm"),
    folder / "stl_finger",
    name="stl_finger",
    material=pneurod.StVenantKirchhoff(E="1.2 MPa", nu=0.495, density="1130 kg/m^3"),
    pressures=["20 kPa"],
    settings={
        "effects.strain_limiting_layer": "on",
        "law": "five",
        "validation": "off",
        "mesh": {"size": "8 mm", "formulation": "p2p0", "coarser": "off"},
    },
)
print(results)

# %% [markdown]
# ## The picture
#
# One of the pictures of the report, at 20 kPa without load.

# %%
figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
axes.imshow(plt.imread(results.pictures["II_20kPa"]))
axes.axis("off")
figure.savefig(folder / "stl_finger.png")

# %% [markdown]
# ## What to change
#
# - `file`, and `unit="inch"` if it is not in mm; `axes="[x, z, -y]"` if another axis points up.
# - `air={"cavity": ["40 mm", "7 mm", "0 mm"]}` names one of several cavities.
# - `law: five` gives the five parameters; a STEP file can have the arm's own law as well.
