# %% [markdown]
# # The finite elements alone, on a mesh of your own
#
# A rubber block with an eccentric cavity, drawn and meshed with Gmsh, is inflated. It takes a few seconds.

# %%
from pathlib import Path

import gmsh
import matplotlib.pyplot as plt
import numpy as np

from pneurod import fem, geometry

folder = Path("results/recipes")
folder.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# ## 1. The mesh
#
# Any program that writes a Gmsh file (`.msh`) will do. The faces that are used later need names: here `clamp`, `tip`
# and `cavity`, as physical surfaces. Lengths are in mm.

# %%
gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
block = gmsh.model.occ.addBox(0, 0, 0, 80, 10, 10)
hollow = gmsh.model.occ.addBox(3, 3, 1.5, 74, 5.5, 7)  # the bottom is thicker than the top: the block bends downwards
gmsh.model.occ.cut([(3, block)], [(3, hollow)])
gmsh.model.occ.synchronize()
inside = gmsh.model.getEntitiesInBoundingBox(2, 2, 1, 78, 9, 9, dim=2)  # the six walls of the cavity
ends = {0.0: "clamp", 80.0: "tip"}
gmsh.model.addPhysicalGroup(2, [tag for _, tag in inside], name="cavity")
for x, name in ends.items():
    face = gmsh.model.getEntitiesInBoundingBox(x - 0.1, -1, -1, x + 0.1, 11, 11, dim=2)
    gmsh.model.addPhysicalGroup(2, [tag for _, tag in face], name=name)
gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="rubber")
gmsh.option.setNumber("Mesh.MeshSizeMax", 3.0)
gmsh.model.mesh.generate(3)
gmsh.write(str(folder / "block.msh"))
gmsh.finalize()

mesh = geometry.Mesh.read(folder / "block.msh")
print(f"{mesh.points.shape[0]} vertices, {mesh.tets.shape[0]} tetrahedra, faces {', '.join(sorted(mesh.faces))}")

# %% [markdown]
# ## 2. The model
#
# A law, supports, and effects: here a pressure of 20 kPa (0.02 MPa) that follows the walls. Contact, gravity and other
# effects are added to the same list.

# %%
law = fem.NeoHooke(mu=0.2, kappa=10.0)  # MPa
model = fem.Model(mesh, law, supports=[fem.Fixed("clamp")], effects=[fem.Pressure("cavity", 0.02)])

# %% [markdown]
# ## 3. The load path
#
# Equilibria at four fractions of the pressure. Between them the program chooses the load increments itself.

# %%
solution = fem.follow(model, factors=[0.25, 0.5, 0.75, 1.0])
tip = np.unique(mesh.faces["tip"])
print("pressure (kPa)   tip y (mm)   cavity (mm3)   smallest J")
for step in solution.steps:
    height = (step.positions[tip] - mesh.points[tip])[:, 1].mean()
    print(f"{20 * step.factor:14.1f} {height:12.3f} {step.cavity_volume('cavity'):14.1f} {step.min_J:12.4f}")

# %% [markdown]
# ## 4. A check, and the picture
#
# The support has to carry nothing but what pressure exerts on the closed cavity, which is zero. The picture is a cut
# through the vertices near the middle plane.

# %%
print(f"force on the clamp: {np.abs(solution.steps[-1].reaction('clamp')).max():.6f} N")
figure, axes = plt.subplots(figsize=(8, 2.5), layout="constrained")
middle = np.abs(mesh.points[:, 2] - 5.0) < 1.5
for label, positions in (("at rest", mesh.points), ("20 kPa", solution.steps[-1].positions)):
    axes.plot(*positions[: len(middle)][middle, :2].T, ".", label=label)
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal", ylim=(-6, 14))
axes.legend(loc="center")
figure.savefig(folder / "own_mesh.png")

# %% [markdown]
# ## What to change
#
# - The block, or the file of another program.
# - The law: `fem.Yeoh`, `fem.Ogden`, `fem.Hencky` and others.
# - `effects`: further pressures, `fem.Gravity`, contact.
