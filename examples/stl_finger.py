# %% [markdown]
# # A finger from an STL file
#
# A closed surface of triangles is enough: the program fills it with elements, finds the cavity, and inflates it.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import trimesh

import pneurod

folder = Path("results/recipes")
folder.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# ## The file
#
# Here it is made of two boxes, the finger of 80 mm and the air in it. With a file of your own leave this out.

# %%
finger = trimesh.creation.box(bounds=[[0.0, 0.0, -8.0], [80.0, 13.0, 8.0]])
air = trimesh.creation.box(bounds=[[3.0, 2.0, -6.0], [77.0, 11.0, 6.0]])
air.invert()  # its triangles face the air
trimesh.util.concatenate([finger, air]).export(folder / "finger.stl")

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
    material=pneurod.NamedRubber("dragon_skin_10"),
    pressures=["10 kPa"],
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
# One of the pictures of the report, at 10 kPa without load.

# %%
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.imshow(plt.imread(results.pictures["II_10kPa"]))
axes.axis("off")
figure.savefig(folder / "stl_finger.png")

# %% [markdown]
# ## What to change
#
# - `file`, and `unit="inch"` if it is not in mm; `axes="[x, z, -y]"` if another axis points up.
# - `air={"cavity": ["40 mm", "7 mm", "0 mm"]}` names one of several cavities.
# - `law: five` gives the five parameters; a STEP file can have the arm's own law as well.
