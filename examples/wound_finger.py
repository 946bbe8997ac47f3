# %% [markdown]
# # A finger wound with thread
#
# A soft half disc inflates like a balloon. Thread wound about it keeps the section, and a glued sheet keeps the base
# from growing longer, so that the pressure bends it. How much does each do?

# %%
from pathlib import Path

import matplotlib.pyplot as plt

import pneurod

folder = Path("results/recipes")

# %% [markdown]
# ## Three fingers
#
# `threads` has the axial rigidity of a thread and the distance of its windings. The sheet lies on the bottom. On this
# coarse mesh the small curvature of the bare finger is known to 28 % alone, of which a warning tells.

# %%
thread: dict[str, str | dict[str, str]] = {"threads": {"EA": "40 N", "pitch": "2 mm"}}
kinds: dict[str, dict[str, dict[str, str | dict[str, str]]]] = {
    "bare": {},
    "wound": {"effects.hoops": thread},
    "wound, with a sheet": {"effects.hoops": thread, "effects.strain_limiting_layer": {"faces": "bottom"}},
}
runs = {
    kind: pneurod.characterize(
        pneurod.Semicircular(chambers=5, wall="2 mm"),
        folder / f"finger_{kind.replace(', with a ', '_')}",
        material=pneurod.NamedRubber("dragon_skin_10"),
        pressures=["4 kPa", "8 kPa"],
        settings={"law": "cell", "accuracy": "off", "mesh.size": "4 mm", "mesh.coarser": "off", **effects},
    )
    for kind, effects in kinds.items()
}

# %% [markdown]
# ## How far they bend, and how strong they are

# %%
figure, axes = plt.subplots(layout="constrained")
print("finger                pressure (kPa)   bends by (degrees)   longer by (%)   force (N)")
for kind, results in runs.items():
    for pressure in (4.0, 8.0):
        rod = results.rod(pressure)
        shape = rod.solve()
        longer = 100.0 * (shape.stretch.mean() - 1.0)
        force = rod.solve(end_y=0.0).force[1]
        print(f"{kind:21s} {pressure:14.0f} {shape.bending_deg:20.1f} {longer:15.1f} {force:11.4f}")
    axes.plot(*shape.curve.T, label=f"{kind}, {pressure:g} kPa")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
figure.legend(loc="outside upper center", ncols=3)
figure.savefig(folder / "wound_finger.png")

# %% [markdown]
# ## What to change
#
# - `"pitch"`: with more thread than this hardly anything changes, with less the section grows.
# - `"faces": "inner"` in `effects.hoops`: thread about the cavities. The pressure then pushes on the cavity alone.
# - `"angle": "30 deg"` winds helices to both sides.
