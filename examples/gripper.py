# %% [markdown]
# # A gripper that squeezes a cylinder
#
# Two soft fingers close around a cylinder that lies on a table, and lift it. The fingers are exported to MuJoCo.

# %%
import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import mujoco
import numpy as np

import pneurod

folder = Path("results/recipes")

# %% [markdown]
# ## The finger
#
# A short arm of four chambers. `law: cell` measures its bending law on one chamber. The mesh is coarse, so that it is
# quick.

# %%
finger = pneurod.characterize(
    pneurod.PneuNet(chambers=4),
    folder / "finger",
    name="finger",
    material=pneurod.StVenantKirchhoff(E="1.2 MPa", nu=0.495, density="1130 kg/m^3", loss_factor=0.15),
    pressures=["15 kPa", "30 kPa"],
    settings={"law": "cell", "mesh": {"size": "8 mm", "formulation": "p2p0"}},
    accuracy="off",
)
xml, module = finger.export("mujoco", folder, force=True)
set_pressure = runpy.run_path(str(module))["set_pressure"]

# %% [markdown]
# ## The scene
#
# The palm moves up and down. The body `clamp` of the finger is attached to it twice, each time with a prefix. The
# fingers hang down and bend towards each other. The cylinder weighs 5 g.

# %%
RADIUS, APART, DEPTH = 0.013, 0.017, 0.036  # m: of the cylinder; half the distance of the fingers; below the palm
scene = mujoco.MjSpec()
scene.option.cone, scene.option.impratio, scene.option.noslip_iterations = mujoco.mjtCone.mjCONE_ELLIPTIC, 10.0, 10
scene.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.2, 0.2, 0.01], pos=[0.0, 0.0, -DEPTH - RADIUS])
palm = scene.worldbody.add_body(name="palm", mass=0.1, inertia=[1e-4] * 3)
palm.add_joint(name="lift", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, 1.0])
lift = scene.add_actuator(name="lift", target="lift", trntype=mujoco.mjtTrn.mjTRN_JOINT)
lift.set_to_position(kp=5000.0, kv=100.0)
for prefix, side in (("left/", -1.0), ("right/", 1.0)):
    quaternion = np.empty(4)  # x of the arm is down, and its y points away from the other finger
    mujoco.mju_mat2Quat(quaternion, np.array([0.0, side, 0.0, 0.0, 0.0, -side, -1.0, 0.0, 0.0]))
    place = palm.add_frame(pos=[side * APART, 0.0, 0.0], quat=quaternion)
    place.attach_body(mujoco.MjSpec.from_file(str(xml)).body("clamp"), prefix, "")
cylinder = scene.worldbody.add_body(name="cylinder", pos=[0.0, 0.0, -DEPTH])
cylinder.add_freejoint()
along_y = [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0]
cylinder.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[RADIUS, 0.012, 0.0], quat=along_y, mass=0.005)
model = scene.compile()
data = mujoco.MjData(model)

# %% [markdown]
# ## Squeeze, lift, hold
#
# The pressure rises to 30 kPa within a second. Then the palm rises by 40 mm. The picture has the points of the fingers
# and the boxes of MuJoCo, seen along the cylinder.

# %%
figure, panels = plt.subplots(1, 3, sharey=True, figsize=(8, 4), layout="constrained")
for axes, end in zip(panels, (0.02, 1.5, 4.0), strict=True):
    while data.time < end:
        for prefix in ("left/", "right/"):
            set_pressure(model, data, 30.0 * min(1.0, data.time), prefix)
        data.ctrl[0] = 0.04 * np.clip(data.time - 1.5, 0.0, 1.0)
        mujoco.mj_step(model, data, 10)
    height = 1e3 * data.body("cylinder").xpos[2]
    print(f"after {end:4.2f} s the cylinder is {height + 1e3 * DEPTH:5.2f} mm above its place on the table")
    for prefix in ("left/", "right/"):
        axes.plot(
            *1e3 * np.array([data.site(f"{prefix}curve{k}").xpos[[0, 2]] for k in range(20)]).T,
            color="teal",
            linewidth=6,
        )
    axes.add_patch(plt.Circle((1e3 * data.body("cylinder").xpos[0], height), 1e3 * RADIUS, color="darkorange"))
    axes.axhline(-1e3 * (DEPTH + RADIUS), color="grey")
    axes.set(title=f"{end:g} s", xlabel="x (mm)", aspect="equal", xlim=(-40, 40), ylim=(-55, 45))
panels[0].set_ylabel("z (mm)")
figure.savefig(folder / "gripper.png")

# %% [markdown]
# ## What to change
#
# - `mass=0.005`: how heavy may the cylinder be? It slips out of the fingers when friction no longer holds it.
# - `30.0`, the pressure, up to the highest one in `pressures`.
# - `APART` and `RADIUS`, or another body in place of the cylinder.
