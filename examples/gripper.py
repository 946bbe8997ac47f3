# %% [markdown]
# # A gripper in MuJoCo
#
#     python examples/gripper.py [FOLDER]
#
# Two soft fingers squeeze a cylinder that lies free on a table, hold it and lift it. It takes about a minute. FOLDER is
# the result folder; a finished run in it is used again.

# %%
import importlib.util
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import mujoco
import numpy as np

import pneurod

folder = Path(sys.argv[1] if len(sys.argv) == 2 else "results/gripper")
folder.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# ## 1. The finger
#
# Four chambers are too short for five parameters; the finger has its own law.

# %%
config = folder / "finger.yaml"
config.write_text(
    """
name: finger
geometry: {family: pneunet, chambers: 4}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3, loss_factor: 0.15}
pressures: [15 kPa, 30 kPa]
mesh: {size: 8 mm, formulation: p2p0}
law: cell  # its own law alone: no whole finger is solved
accuracy: "off"  # on the mesh below; 1 % by default
""",
    encoding="utf-8",
)
pneurod.characterize(config, out=folder / "run")
command = [sys.executable, "-m", "pneurod", "export", str(folder / "run"), "--to", "mujoco"]
subprocess.run([*command, "--out", str(folder), "--force"], check=True, capture_output=True)
[path] = folder.glob("rod_mujoco_*.py")
specification = importlib.util.spec_from_file_location("finger", path)
assert specification is not None
assert specification.loader is not None
finger = importlib.util.module_from_spec(specification)
specification.loader.exec_module(finger)

# %% [markdown]
# ## 2. The scene
#
# A palm that moves up and down, and the body `clamp` of the finger attached to it twice, each with a prefix. The
# fingers hang down, and their base plates, towards which they bend, face each other. The cylinder weighs 5 g.

# %%
RADIUS, APART, DEPTH = 0.013, 0.017, 0.036  # m, of the cylinder; half the distance of the fingers; below the palm
scene = mujoco.MjSpec()
scene.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
scene.option.impratio = 10.0
scene.option.noslip_iterations = 10
scene.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.2, 0.2, 0.01], pos=[0.0, 0.0, -DEPTH - RADIUS])
palm = scene.worldbody.add_body(name="palm")
palm.add_joint(name="lift", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, 1.0])
palm.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.03, 0.01, 0.003], pos=[0.0, 0.0, 0.003], mass=0.1)
lift = scene.add_actuator(name="lift", target="lift", trntype=mujoco.mjtTrn.mjTRN_JOINT)
lift.set_to_position(kp=5000.0, kv=100.0)
for name, side in (("left/", -1.0), ("right/", 1.0)):
    # the arm lies along -z of the scene, and its upper side looks away from the other finger
    turned = np.array([[0.0, side, 0.0], [0.0, 0.0, -side], [-1.0, 0.0, 0.0]])
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, turned.ravel())
    place = palm.add_frame(pos=[side * APART, 0.0, 0.0], quat=quaternion)
    place.attach_body(mujoco.MjSpec.from_file(str(path.with_suffix(".xml"))).body("clamp"), name, "")
free = scene.worldbody.add_body(name="cylinder", pos=[0.0, 0.0, -DEPTH])
free.add_freejoint()
along_y = [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0]
free.add_geom(name="cylinder", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[RADIUS, 0.012, 0.0], quat=along_y, mass=0.005)
model = scene.compile()
data = mujoco.MjData(model)

# %% [markdown]
# ## 3. Squeeze, lift, hold
#
# The pressure rises to 30 kPa within a second. Then the palm rises by 40 mm, and everything is held.

# %%
fingers = ("left/", "right/")
pictures, heights = {}, []
cylinder = model.body("cylinder").id
while data.time < 4.0:
    pressure = 30.0 * min(1.0, data.time)
    for name in fingers:
        finger.set_pressure(model, data, pressure, name)
    data.ctrl[0] = 0.04 * np.clip(data.time - 1.5, 0.0, 1.0)
    mujoco.mj_step(model, data, 10)
    heights.append((data.time, 1e3 * (data.xpos[cylinder, 2] + DEPTH)))
    for label, moment in (("open", 0.02), ("squeezed", 1.5), ("lifted", 4.0)):
        if label not in pictures and data.time >= moment - 1e-9:
            pictures[label] = data.geom_xpos.copy(), data.geom_xmat.copy()

forces = dict.fromkeys(fingers, 0.0)
for number, contact in enumerate(data.contact):
    touching = [model.body(model.geom_bodyid[geom]).name for geom in (contact.geom1, contact.geom2)]
    wrench = np.zeros(6)
    mujoco.mj_contactForce(model, data, number, wrench)
    for name in fingers:
        forces[name] += wrench[0] * any(body.startswith(name) for body in touching)

held = [height for time, height in heights if time > 3.0]
print(f"the cylinder is lifted by {held[-1]:.1f} mm, and slips by {max(held) - min(held):.2f} mm in the last second")
print(f"the fingers press with {forces['left/']:.3f} and {forces['right/']:.3f} N")

# %% [markdown]
# ## 4. The picture
#
# Seen along the axis of the cylinder.

# %%
figure, panels = plt.subplots(1, 3, sharey=True, figsize=(10, 4.5), layout="constrained")
corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
for axes, (label, (positions, turns)) in zip(panels, pictures.items(), strict=True):
    for geom in range(model.ngeom):
        x, z = 1e3 * positions[geom, [0, 2]]
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX:
            of_palm = model.geom_bodyid[geom] == model.body("palm").id  # its height is its third axis
            plane = [0, 2] if of_palm else [0, 1]
            box, turn = corners * model.geom_size[geom, plane], turns[geom].reshape(3, 3)[np.ix_([0, 2], plane)]
            axes.fill(*(1e3 * box @ turn.T + [x, z]).T, alpha=0.5, edgecolor="black", linewidth=0.3)
        elif model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CYLINDER:
            axes.add_patch(plt.Circle((x, z), 1e3 * RADIUS, color="darkorange"))
    axes.axhline(-1e3 * (DEPTH + RADIUS), color="grey")
    axes.set(title=label, xlabel="x (mm)", aspect="equal", xlim=(-45, 45))
panels[0].set_ylabel("z (mm)")
figure.savefig(folder / "gripper.png")
print(f"picture: {folder / 'gripper.png'}")
