# %% [markdown]
# # A material law of your own
#
# A bar of six tetrahedra is pulled to twice its length. Its law is that of A. Isihara, N. Hashitsume and M. Tatibana
# (J. Chem. Phys. 19 (1951) 1508), W = c10 (I1bar - 3) + c20 (I1bar - 3)^2 + c01 (I2bar - 3) + kappa/2 (J - 1)^2.

# %%
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path
from typing import final

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from pneurod import fem, geometry

Array = NDArray[np.float64]

# %% [markdown]
# ## 1. The law
#
# Of a law in the isochoric invariants I1bar and I2bar only this has to be written. Stress, tangent and the split into
# a shear and a volumetric part follow. A law of another kind derives from `fem.Material` itself. A law that YAML files
# can name stands in `fem/materials`, and in the table `LAWS` there.


# %%
@final
@dataclass(frozen=True)
class Isihara(fem.IsochoricLaw):
    """The constants in MPa; kappa, the bulk modulus, is large because rubber hardly changes its volume."""

    title = "Isihara"

    c10: float
    c20: float
    c01: float
    kappa: float

    def first_invariant_energy(self, invariant: Array) -> tuple[Array, Array, Array]:
        """The part of W that depends on I1bar, with its first two derivatives, MPa."""
        x = invariant - 3.0
        return self.c10 * x + self.c20 * x**2, self.c10 + 2.0 * self.c20 * x, np.full_like(x, 2.0 * self.c20)

    @property
    def second_invariant_modulus(self) -> float:
        return self.c01

    @classmethod
    def uniaxial_terms(cls, stretch: Array) -> dict[str, Array]:
        """Nominal stress of the incompressible bar by constant: the closed form, linear in all three."""
        pull = 2.0 * (stretch - stretch**-2)
        return {"c10": pull, "c20": 2.0 * pull * (stretch**2 + 2.0 / stretch - 3.0), "c01": pull / stretch}


law = Isihara(c10=0.10, c20=0.01, c01=0.03, kappa=500.0)

# %% [markdown]
# ## 2. A bar of 2 x 1 x 1 mm
#
# One brick cut into six tetrahedra, with names for the faces that are held or moved.

# %%
size = np.array([2.0, 1.0, 1.0])
corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * size  # numbered 4 x + 2 y + z
tets = np.array([[0, a, a + b, 7] for a, b, _ in permutations((4, 2, 1))])
brick = geometry.Mesh(corners, tets, {})
triangles = brick.points[brick.boundary]  # (triangle, corner, axis), mm
planes = {"left": (0, 0.0), "right": (0, 2.0), "bottom": (1, 0.0), "back": (2, 0.0)}
faces = {name: brick.boundary[np.all(triangles[..., axis] == at, axis=1)] for name, (axis, at) in planes.items()}
mesh = geometry.Mesh(brick.points, brick.tets, faces)

# %% [markdown]
# ## 3. The model
#
# Three planes that slide, and one end that is moved by 2 mm at load factor 1.

# %%
sliding = [fem.Fixed("left", "x"), fem.Fixed("bottom", "y"), fem.Fixed("back", "z")]
model = fem.Model(mesh, law, supports=[*sliding, fem.Prescribed("right", "x", 2.0)], effects=[])
solution = fem.follow(model, factors=[0.25, 0.5, 0.75, 1.0])

# %% [markdown]
# ## 4. Force over the area at rest (1 mm2) against the closed form
#
# They differ by the small change of volume.

# %%
print("stretch   finite elements   closed form   difference")
for step in solution.steps:
    stretch, stress = 1.0 + step.factor, step.reaction("right")[0]
    terms = Isihara.uniaxial_terms(np.array(stretch))
    closed = sum(getattr(law, name) * float(term) for name, term in terms.items())
    print(f"{stretch:7.2f} {stress:13.5f} MPa {closed:9.5f} MPa {100 * (stress / closed - 1):10.2f} %")

# %% [markdown]
# ## 5. The same with the change of volume in the closed form, and the picture
#
# The difference is that of the solver's tolerance.

# %%
bar = law.uniaxial(np.array([2.0]))
print(f"with the change of volume: {solution.steps[-1].reaction('right')[0] / bar.nominal[0] - 1:.1e}")

folder = Path("results/recipes")
folder.mkdir(parents=True, exist_ok=True)
figure, axes = plt.subplots(layout="constrained")
stretches = np.linspace(1.0, 2.0, 101)
axes.plot(stretches, law.uniaxial(stretches).nominal, label="closed form")
found = np.array([(1.0 + step.factor, step.reaction("right")[0]) for step in solution.steps])
axes.plot(*found.T, "o", label="finite elements")
axes.set(xlabel="stretch", ylabel="nominal stress (MPa)")
axes.legend()
figure.savefig(folder / "own_material.png")

# %% [markdown]
# ## What to change
#
# - `first_invariant_energy`: a law of the first invariant needs nothing else.
# - The constants, and the bar: `fem` takes any mesh of tetrahedra.
