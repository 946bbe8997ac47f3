# %% [markdown]
# # A gripper that squeezes a cylinder off its centre
#
# Two soft fingers close around a cylinder that lies on a table, and lift it. It lies askew and beside the plane of the
# fingers, and so bends them sideways and twists them. The fingers are exported to MuJoCo.

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
# An arm of eight chambers. `law: cell` measures its bending law on one chamber; `law_in_space` does so out of the plane
# too. The mesh is coarse, so that it is quick.

# %%
finger = pneurod.characterize(
    pneurod.PneuNet(chambers=8),
    folder / "finger",
    name="finger",
    material=pneurod.StVenantKirchhoff(E="1.2 MPa", nu=0.495, density="1130 kg/m^3", loss_factor=0.15),
    pressures=["15 kPa", "30 kPa"],
    settings={"law": "cell", "law_in_space": True, "mesh": {"size": "8 mm", "formulation": "p2p0"}},
    accuracy="off",
)
xml, module = finger.export("mujoco", folder, force=True)
set_pressure = runpy.run_path(str(module))["set_pressure"]

# %% [markdown]
# ## The scene
#
# The palm moves up and down. The body `clamp` of the finger is attached to it twice, each time with a prefix. The
# fingers hang down and bend towards each other. The cylinder weighs 3 g.
#
# Fingers that bend in their plane alone show the difference. Their hinges are `joint0`, `joint1`, ...; a huge inertia
# locks the others.

# %%
RADIUS, HALF, APART, DEPTH = 0.013, 0.015, 0.02, 0.076  # m: radius, half length; fingers; depth
BESIDE, AXIS = 0.003, [np.sin(0.3), np.cos(0.3), 0.0]  # m from the plane of the fingers; direction, askew


def gripper(in_plane_alone: bool) -> tuple[mujoco.MjModel, mujoco.MjData]:
    scene = mujoco.MjSpec()
    scene.option.cone, scene.option.impratio, scene.option.noslip_iterations = mujoco.mjtCone.mjCONE_ELLIPTIC, 10.0, 10
    scene.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.2, 0.2, 0.01], pos=[0.0, 0.0, -DEPTH - RADIUS])
    palm = scene.worldbody.add_body(name="palm", mass=0.1, inertia=[1e-4] * 3)
    palm.add_joint(name="lift", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, 1.0])
    scene.add_actuator(target="lift", trntype=mujoco.mjtTrn.mjTRN_JOINT).set_to_position(kp=5000.0, kv=100.0)
    for prefix, side in (("left/", -1.0), ("right/", 1.0)):
        quaternion = np.empty(4)  # x of the arm is down, and its y points away from the other finger
        mujoco.mju_mat2Quat(quaternion, np.array([0.0, side, 0.0, 0.0, 0.0, -side, -1.0, 0.0, 0.0]))
        arm = mujoco.MjSpec.from_file(str(xml))
        for joint in arm.joints if in_plane_alone else ():
            joint.armature = 0.0 if joint.name.startswith("joint") else 1e3  # kg m2
        palm.add_frame(pos=[side * APART, 0.0, 0.0], quat=quaternion).attach_body(arm.body("clamp"), prefix, "")
    body = scene.worldbody.add_body(name="cylinder", pos=[0.0, BESIDE, -DEPTH])
    body.add_freejoint()
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[RADIUS, HALF, 0.0], zaxis=AXIS, mass=0.003)
    return (model := scene.compile()), mujoco.MjData(model)


# %% [markdown]
# ## Squeeze, lift, hold
#
# The pressure rises to 30 kPa within a second. Then the palm rises by 40 mm. The picture has the points of the fingers
# and the rims of the cylinder, seen along y and along x. Fingers that give way sideways lie on the cylinder and hold
# it. Those that bend in their plane alone touch it at its edges and lose it.

# %%
figure, rows = plt.subplots(2, 4, figsize=(8, 5.4), layout="tight", subplot_kw={"xlim": (-60, 60), "ylim": (-95, 45)})
rims = [[RADIUS * np.cos(t), RADIUS * np.sin(t), z] for z in (-HALF, HALF) for t in np.linspace(0.0, 6.3)]
sites = [*(f"curve{k}" for k in range(20)), "tip"]
for kind, panels in zip(("in space", "in plane"), rows, strict=True):
    model, data = gripper(kind == "in plane")
    for end, views in ((1.5, panels[:2]), (4.0, panels[2:])):
        while data.time < end:
            for prefix in ("left/", "right/"):
                set_pressure(model, data, 30.0 * min(1.0, data.time), prefix)
            data.ctrl[0] = 0.04 * np.clip(data.time - 1.5, 0.0, 1.0)
            mujoco.mj_step(model, data, 10)
        fingers = [np.array([data.site(prefix + site).xpos for site in sites]) for prefix in ("left/", "right/")]
        held = data.geom_xpos[-1] + rims @ data.geom_xmat[-1].reshape(3, 3).T
        for across, axes in enumerate(views):
            for points, width in ((fingers[0], 4), (fingers[1], 4), (held, 1)):
                axes.plot(*1e3 * points[:, [across, 2]].T, linewidth=width)
            axes.axhline(-1e3 * (DEPTH + RADIUS), color="grey")
            axes.set(title=f"{end:g} s", xlabel=f"{'xy'[across]} (mm)", ylabel=f"{kind}: z (mm)", aspect="equal")
            axes.label_outer()
        aside, up = 1e3 * (fingers[1] - fingers[0])[-1, 1], 1e3 * (held[:, 2].mean() + DEPTH)
        print(f"{kind}, {end:g} s: ends {aside:.1f} mm apart along y, cylinder {up:4.1f} mm above its place")
figure.savefig(folder / "gripper.png", dpi=80)

# %% [markdown]
# ## What to change
#
# - `mass=0.003`: how heavy may the cylinder be? It slips out of the fingers when friction no longer holds it.
# - `30.0`, the pressure, up to the highest one in `pressures`.
# - `BESIDE` and `ASKEW`, or another body in place of the cylinder.
